use core::fmt;

use super::check::{Blob, head_of, kind_of};
use super::fields;
use super::layout::{RECORD, uncertain_parameters};
use super::term;
use super::values::{mdh, vector};
use crate::arm::{Arm, State};
use crate::effects::MAX_TERMS;
use crate::kinematics::{Link, LinkParameter};
use crate::scalar::Scalar;

use nalgebra::Vector3;

/// Covariance of a blob's parameters, still in place: a triangular factor over
/// [base translation, base rotation, tool point, links, terms]: the order of
/// [`Parameter::of_arm`](crate::parameters::Parameter::of_arm).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Covariance<'a> {
    pub(super) blob: Blob<'a>,
}

/// Why a covariance says nothing of an arm: it is not that of its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum CovarianceError {
    /// The arm is another robot.
    WrongRobot {
        /// Id in the blob.
        blob: u64,
        /// Id of the arm.
        arm: u64,
    },
    /// The arm has an older or a newer set of parameters.
    WrongSequence {
        /// Sequence number of the blob.
        blob: u32,
        /// Of the arm's parameters.
        arm: u32,
    },
    /// The same robot and number, but not the same joints, corrections, terms or curves.
    OtherParameters,
}

impl fmt::Display for CovarianceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongRobot { blob, arm } => {
                write!(f, "a covariance of robot {blob:#018x} where the arm is {arm:#018x}")
            }
            Self::WrongSequence { blob, arm } => {
                write!(f, "a covariance of sequence {blob} where the arm has {arm}")
            }
            Self::OtherParameters => f.write_str("a covariance of other parameters than the arm's"),
        }
    }
}

impl core::error::Error for CovarianceError {}

impl<'a> Covariance<'a> {
    /// Parameters it speaks of.
    #[must_use]
    pub fn parameters(&self) -> usize {
        uncertain_parameters(self.blob.joints(), self.blob.terms())
    }

    /// The factor: a lower triangle column by column, SI.
    pub fn factor(&self) -> impl Iterator<Item = f32> + use<'a> {
        self.blob.factor.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))
    }

    /// Whether it is that of this arm's parameters; tool and base aside.
    ///
    /// # Errors
    /// What is not the same.
    pub fn check<T: Scalar, const N: usize>(
        &self,
        arm: &Arm<'_, T, N>,
    ) -> Result<(), CovarianceError> {
        let (blob, of) = (&self.blob, arm.robot_id());
        if blob.robot_id() != of {
            return Err(CovarianceError::WrongRobot { blob: blob.robot_id(), arm: of });
        }
        if blob.sequence() != arm.sequence() {
            let (blob, arm) = (blob.sequence(), arm.sequence());
            return Err(CovarianceError::WrongSequence { blob, arm });
        }
        let records = blob.records.chunks_exact(RECORD);
        let same_links = records.zip(arm.real().links()).all(|(record, real)| {
            let [kind, ..] = head_of(record);
            let kind = kind_of(kind).unwrap_or_default();
            let link = Link { kind, parameters: mdh(&fields::NOMINAL, record) };
            link.corrected(&mdh(&fields::CORRECTION, record)) == *real
        });
        let terms = term::each(blob.terms).map(term::from_bytes);
        let same_terms = terms.eq(arm.terms().iter().copied().map(Some));
        let (own, other) = (blob.curves(), arm.curves());
        let same_curves = own.is_empty() && other.is_empty() || own == other;
        if blob.joints() == N && same_links && same_terms && same_curves {
            Ok(())
        } else {
            Err(CovarianceError::OtherParameters)
        }
    }

    /// One standard deviation of where the tool point is, along x, y, z of the
    /// nominal base, m: `sqrt(diag(J L L' J'))`, first order in the errors; on top the
    /// band of each curve, an independent error of its joint's angle, as wide as it is at `q`.
    ///
    /// `arm` is the arm of this blob. Its own tool point was identified together
    /// with the geometry and counts with its covariance; another one (given by
    /// [`Arm::with_tool`]) counts as exact in the identified flange frame, and
    /// then what points could not tell of the flange shows: with one reflector
    /// that is as wide as the manufacturing tolerances.
    ///
    /// Costs P(P + 1) / 2 times three multiply-adds for P parameters, 46,474
    /// instructions on a Cortex-M4F for six joints and 24 terms: a check point's
    /// work, not every tick's. No heap; 2 KB of stack then in `f32`.
    ///
    /// # Errors
    /// As [`Covariance::check`]: the arm is not the one of this blob.
    pub fn point_sigma<T: Scalar, const N: usize>(
        &self,
        arm: &Arm<'_, T, N>,
        q: &[T; N],
        state: &State<T, N>,
    ) -> Result<[T; 3], CovarianceError> {
        self.check(arm)?;
        let terms = arm.terms();
        let inputs = arm.inputs(q, state);
        let joints = arm.deflection_at(&inputs).deflected(q);
        let jacobian = arm.real().identification_jacobian(&joints);
        let zero = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let tool = if self.is_own_tool(arm) { jacobian.tool } else { [zero; 3] };
        let link = |c: &crate::kinematics::LinkColumns<T>| LinkParameter::ALL.map(|p| *c.get(p));
        let columns = jacobian.links.each_ref().map(link);
        // Base compliance turns about the base's own axes, which are the outer
        // ones to within the small residual base, as in the identification.
        let mut of_terms = [zero; MAX_TERMS];
        for (column, term) in of_terms.iter_mut().zip(terms) {
            *column =
                term.column(&inputs, arm.real().links(), &jacobian.links, &jacobian.base_rotation);
        }
        let [bx, by, bz] = jacobian.base_translation;
        let [rx, ry, rz] = jacobian.base_rotation;
        let [tx, ty, tz] = tool;
        let frames = [bx, by, bz, rx, ry, rz, tx, ty, tz];
        let of_terms = of_terms.get(..terms.len()).unwrap_or(&[]);
        let parts = [&frames, columns.as_flattened(), of_terms];

        let mut numbers = self.factor();
        let mut variance = [T::ZERO; 3];
        for column in 0..self.parameters() {
            let mut sum = zero;
            // The column begins at its own row.
            let mut skip = column;
            for part in parts {
                let rows = part.get(skip..).unwrap_or(&[]);
                skip = skip.saturating_sub(part.len());
                for (derivative, number) in rows.iter().zip(&mut numbers) {
                    sum += *derivative * T::from_f32(number);
                }
            }
            for (variance, sum) in variance.iter_mut().zip([sum.x, sum.y, sum.z]) {
                *variance += sum * sum;
            }
        }
        // Where the joint really is differs from the curve's by an angle of its own.
        for curve in arm.curves().iter() {
            let joint = usize::from(curve.joint());
            if let (Some(link), Some(at)) = (jacobian.links.get(joint), q.get(joint).copied()) {
                let off = link.theta * T::from_f32(curve.band_at(at));
                for (variance, off) in variance.iter_mut().zip([off.x, off.y, off.z]) {
                    *variance += off * off;
                }
            }
        }
        Ok(variance.map(T::sqrt))
    }

    /// Whether the arm still carries the tool point of the blob.
    fn is_own_tool<T: Scalar, const N: usize>(&self, arm: &Arm<T, N>) -> bool {
        let own = vector::<T>(&fields::TOOL, self.blob.header);
        arm.real().tool().translation == own
    }
}
