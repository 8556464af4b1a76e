use super::check::{Blob, Reader};
use super::layout::{REALS, uncertain_parameters};
use crate::arm::{Arm, State};
use crate::effects::{MAX_TERMS, Term};
use crate::kinematics::LinkParameter;
use crate::scalar::Scalar;

use nalgebra::Vector3;

/// Covariance of a blob's parameters, still in place: a triangular factor over
/// [base translation, base rotation, tool point, links, terms].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Covariance<'a> {
    pub(super) blob: &'a Blob<'a>,
}

impl Covariance<'_> {
    /// Parameters it speaks of.
    #[must_use]
    pub fn parameters(&self) -> usize {
        uncertain_parameters(self.blob.joints(), self.blob.terms())
    }

    /// The factor: a lower triangle column by column, SI.
    pub fn factor(&self) -> impl Iterator<Item = f32> {
        self.blob.factor.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))
    }

    /// One standard deviation of where the tool point is, along x, y, z of the
    /// nominal base, m: `sqrt(diag(J L L' J'))`, first order in the errors.
    ///
    /// `arm` is the arm of this blob. Its own tool point was identified together
    /// with the geometry and counts with its covariance; another one (given by
    /// [`Arm::with_tool`]) counts as exact in the identified flange frame, and
    /// then what points could not tell of the flange shows: with one reflector
    /// that is as wide as the manufacturing tolerances.
    ///
    /// Costs P(P + 1) / 2 times three multiply-adds for P parameters, 42,458
    /// instructions on a Cortex-M4F for six joints and 24 terms: a check point's
    /// work, not every tick's. No heap; 2 KB of stack then in `f32`.
    /// NaN if the arm has another number of joints or terms than the blob.
    #[must_use]
    pub fn point_sigma<T: Scalar, const N: usize>(
        &self,
        arm: &Arm<T, N>,
        q: &[T; N],
        state: &State<T, N>,
    ) -> [T; 3] {
        let terms = arm.terms();
        if self.blob.joints() != N || self.blob.terms() != terms.len() {
            return [T::from_f32(f32::NAN); 3];
        }
        let inputs = arm.inputs(q, state);
        let mut bent = *q;
        for (q, bend) in bent.iter_mut().zip(&arm.bending(q, state).joints) {
            *q += *bend;
        }
        let jacobian = arm.real().identification_jacobian(&bent);
        let zero = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let tool = if self.is_own_tool(arm) { jacobian.tool } else { [zero; 3] };
        let link = |c: &crate::kinematics::LinkColumns<T>| LinkParameter::ALL.map(|p| *c.get(p));
        let columns = jacobian.links.each_ref().map(link);
        // Base compliance turns about the base's own axes, which are the outer
        // ones to within the small residual base, as in the identification.
        let mut of_terms = [zero; MAX_TERMS];
        for (column, term) in of_terms.iter_mut().zip(terms) {
            let basis = Term::basis(term, &inputs);
            *column =
                term.column(basis, arm.real().links(), &jacobian.links, &jacobian.base_rotation);
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
        variance.map(T::sqrt)
    }

    /// Whether the arm still carries the tool point of the blob.
    fn is_own_tool<T: Scalar, const N: usize>(&self, arm: &Arm<T, N>) -> bool {
        let mut reader = Reader(self.blob.header[REALS].get(24..).unwrap_or(&[]));
        let own = [0; 3].map(|_| T::from_f32(reader.f32()));
        let carried = &arm.real().tool().translation;
        [carried.x, carried.y, carried.z] == own
    }
}
