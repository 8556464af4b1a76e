//! Re-identification on the controller: after a crash or a tool change a few
//! parameters are fitted anew to about ten measured points.
//!
//! Gauss-Newton about the stored parameters. Each chosen parameter has a prior:
//! its `scale` is the standard deviation of how far it may have moved, so that
//! lambda = 1 is the maximum a posteriori estimate and a direction that the
//! points do not show stays where it was. The six unknowns of a moved tracker
//! have none; they are fitted and not stored.
//!
//! Memory: the points stay with the caller; beside them one [`Triangle`] of P
//! parameters with a copy for the solve and an [`Arm`] with two sets of
//! parameters. On a Cortex-M4F in
//! `f32` ten points take 0.24 million instructions for five unknowns, 0.7 million
//! for eleven (counted by tests/firmware/src/bin/reidentify.rs).

mod error;
mod station;

pub use error::ReidentifyError;

use nalgebra::Vector3;

use crate::arm::{Arm, ArmParameters};
use crate::check_point::CheckPoint;
use crate::kinematics::{IdentificationJacobian, LinkParameter, MdhParameters, Pose, dot};
use crate::scalar::Scalar;
use crate::solve::{SolveError, Triangle};

/// Steps at most; three are usual.
const MOST_STEPS: u8 = 10;

/// A parameter to identify anew. Joints and axes count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unknown {
    /// A parameter of a link: a joint offset is its `Theta`.
    Link {
        /// The joint.
        joint: u8,
        /// Which of its five.
        parameter: LinkParameter,
    },
    /// A coordinate of the tool point in the flange frame: 0, 1, 2.
    Tool(u8),
    /// Where the tracker stands: rotation of the commanded frame about the
    /// tracker's x, y, z (0, 1, 2), translation along them (3, 4, 5). All six
    /// or none.
    Station(u8),
}

impl Unknown {
    /// The offset of a joint.
    #[must_use]
    pub const fn offset(joint: u8) -> Self {
        Self::Link { joint, parameter: LinkParameter::Theta }
    }

    /// The three of the tool point.
    pub const TOOL: [Self; 3] = [Self::Tool(0), Self::Tool(1), Self::Tool(2)];

    /// The six of a moved tracker.
    pub const STATION: [Self; 6] = [
        Self::Station(0),
        Self::Station(1),
        Self::Station(2),
        Self::Station(3),
        Self::Station(4),
        Self::Station(5),
    ];

    /// Prior standard deviation unless the user knows better: 20 mrad for a
    /// joint offset, 20 mm for the tool, 1 mm or 1 mrad for the rest of a link,
    /// none for the tracker.
    #[must_use]
    pub fn usual_scale<T: Scalar>(self) -> T {
        match self {
            Self::Link { parameter: LinkParameter::Theta, .. } | Self::Tool(_) => T::from_f64(0.02),
            Self::Link { .. } => T::from_f64(0.001),
            Self::Station(_) => T::ONE / T::ZERO,
        }
    }
}

/// What to identify anew, and how well the points are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reidentify<T, const P: usize> {
    /// The parameters; each once.
    pub unknowns: [Unknown; P],
    /// How far each may have moved, 1 sigma, rad or m; infinite for no prior.
    pub scale: [T; P],
    /// Standard deviation of a measured coordinate, m.
    pub sigma: T,
}

/// The outcome of [`Reidentify::run`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reidentified<'t, T, const N: usize, const P: usize> {
    /// To be stored: corrections and tool changed, `sequence` one higher.
    pub parameters: ArmParameters<'t, T, N>,
    /// From the commanded to the points' frame; the identity unless the
    /// tracker's place was unknown.
    pub station: Pose<T>,
    /// By how much each unknown changed, rad or m; zero for the tracker.
    pub change: [T; P],
    /// Standard deviation of each unknown after the fit, rad or m.
    pub sigma: [T; P],
    /// Whether the points, rather than the prior, determine it: its standard
    /// deviation is less than half of its scale.
    pub determined: [bool; P],
    /// Independent directions among the unknowns that the points show.
    pub rank: usize,
    /// RMS 3-D distance of the points from the stored model, m; with an
    /// unknown tracker after fitting its place alone.
    pub rms_before: T,
    /// The same from the new model. Of fitted points: no measure of quality.
    pub rms_after: T,
    /// Gauss-Newton steps taken.
    pub steps: u8,
}

/// What is being fitted.
#[derive(Clone, Copy, PartialEq)]
enum Freedom {
    Station,
    All,
}

impl<T: Scalar, const P: usize> Reidentify<T, P> {
    /// With the usual prior, see [`Unknown::usual_scale`]; sigma in m.
    #[must_use]
    pub fn new(unknowns: [Unknown; P], sigma: T) -> Self {
        Self { unknowns, scale: unknowns.map(Unknown::usual_scale), sigma }
    }

    /// Fits the unknowns to the points, starting from the stored parameters.
    ///
    /// # Errors
    /// See [`ReidentifyError`].
    pub fn run<'t, const N: usize>(
        &self,
        stored: &ArmParameters<'t, T, N>,
        points: &[CheckPoint<T, N>],
    ) -> Result<Reidentified<'t, T, N, P>, ReidentifyError> {
        let moved = self.check::<N>(points)?;
        let mut out = Reidentified {
            parameters: stored.clone(),
            station: Pose::identity(),
            change: [T::ZERO; P],
            sigma: [T::ZERO; P],
            determined: [false; P],
            rank: 0,
            rms_before: T::ZERO,
            rms_after: T::ZERO,
            steps: 0,
        };
        if moved {
            out.station = station::place(&Arm::new(stored), points)?;
            self.settle(&mut out, points, Freedom::Station)?;
        }
        out.rms_before = rms(&out, points);
        let triangle = self.settle(&mut out, points, Freedom::All)?;
        out.rms_after = rms(&out, points);
        // Columns of one size; where there is no prior, of rad and m.
        let units = self.scale.map(|s| if s.is_finite() { s } else { T::ONE });
        out.rank = triangle.spectrum(&units)?.rank();
        let variances = triangle.variances(T::ONE, &self.scale)?;
        let half = T::from_f32(0.5);
        let all = out.sigma.iter_mut().zip(&mut out.determined).zip(&variances).zip(&self.scale);
        for (((sigma, determined), variance), scale) in all {
            *sigma = variance.sqrt();
            *determined = *sigma < half * *scale;
        }
        if let Some(unknown) = out.sigma.iter().position(|s| !s.is_finite()) {
            return Err(ReidentifyError::Undetermined { unknown });
        }
        if !(out.rms_before.is_finite() && out.rms_after.is_finite()) {
            return Err(SolveError::NotFinite.into());
        }
        // The last number would be refused: no set could follow it.
        let next = stored.sequence.checked_add(1).filter(|next| *next < u32::MAX);
        out.parameters.sequence = next.ok_or(ReidentifyError::LastSequence)?;
        Ok(out)
    }

    /// Whether the tracker's place is among the unknowns.
    fn check<const N: usize>(&self, points: &[CheckPoint<T, N>]) -> Result<bool, ReidentifyError> {
        if !(self.sigma > T::ZERO && self.sigma.is_finite()) {
            return Err(ReidentifyError::BadSigma);
        }
        let exists = |unknown: &Unknown| match *unknown {
            Unknown::Link { joint, .. } => usize::from(joint) < N,
            Unknown::Tool(k) => k < 3,
            Unknown::Station(k) => k < 6,
        };
        let stations = self.unknowns.iter().filter(|u| matches!(u, Unknown::Station(_))).count();
        for (unknown, this) in self.unknowns.iter().enumerate() {
            let repeated = self.unknowns.iter().take(unknown).any(|other| other == this);
            let alone = matches!(this, Unknown::Station(_)) && stations != 6;
            if !exists(this) || repeated || alone {
                return Err(ReidentifyError::BadUnknown { unknown });
            }
        }
        let needed = P.div_ceil(3);
        if points.len() < needed {
            return Err(ReidentifyError::TooFewPoints { points: points.len(), needed });
        }
        match points.iter().position(|p| !p.is_finite()) {
            Some(point) => Err(ReidentifyError::PointNotFinite { point }),
            None => Ok(stations == 6),
        }
    }

    /// Gauss-Newton steps until they no longer matter; the last triangle.
    fn settle<const N: usize>(
        &self,
        out: &mut Reidentified<T, N, P>,
        points: &[CheckPoint<T, N>],
        freedom: Freedom,
    ) -> Result<Triangle<T, P>, ReidentifyError> {
        let (fine, coarse) = (T::from_f32(1e-6), T::from_f32(1e-5));
        for step_number in 1..=MOST_STEPS {
            let arm = Arm::new(&out.parameters);
            let mut triangle = Triangle::new();
            let weight = T::ONE / (self.sigma * self.sigma);
            for point in points {
                let (columns, rhs) = self.equations(out, &arm, point, freedom);
                triangle.push_weighted(&columns, &rhs, weight)?;
            }
            let x = triangle.solve(T::ONE, &self.scale)?.x;
            let mut largest = T::ZERO;
            let mut station = [T::ZERO; 6];
            for ((unknown, change), x) in self.unknowns.iter().zip(&mut out.change).zip(&x) {
                let step = if let Unknown::Station(k) = unknown {
                    if let Some(slot) = station.get_mut(usize::from(*k)) {
                        *slot = *x;
                    }
                    *x
                } else {
                    let step = *x - *change;
                    *change = *x;
                    apply(&mut out.parameters, *unknown, step);
                    step
                };
                if step.abs() > largest {
                    largest = step.abs();
                }
            }
            let [rx, ry, rz, x, y, z] = station;
            let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
            let turn = Pose::from_rotation_vector(none, Vector3::new(rx, ry, rz));
            out.station.rotation = turn.compose(&out.station).rotation;
            out.station.translation += Vector3::new(x, y, z);
            out.steps = step_number;
            // In f32 a weak direction may go on trembling by some 1e-6.
            if largest < fine || (step_number == MOST_STEPS && largest < coarse) {
                return Ok(triangle);
            }
        }
        Err(ReidentifyError::NotConverged)
    }

    /// The three equations of a point, a column an unknown. The right-hand side
    /// is the residual plus what the changes so far explain, so that the prior
    /// counts from the stored parameters.
    fn equations<const N: usize>(
        &self,
        at: &Reidentified<T, N, P>,
        arm: &Arm<T, N>,
        point: &CheckPoint<T, N>,
        freedom: Freedom,
    ) -> ([[T; 3]; P], [T; 3]) {
        let (predicted, jacobian) = point.linearised(arm);
        let turned = Pose { translation: Vector3::new(T::ZERO, T::ZERO, T::ZERO), ..at.station };
        let seen = at.station.transform_point(&predicted);
        let mut rhs = point.point - seen;
        let mut columns = [[T::ZERO; 3]; P];
        for ((column, unknown), change) in columns.iter_mut().zip(&self.unknowns).zip(&at.change) {
            let derivative = match *unknown {
                Unknown::Station(k) => station::column(k, &(seen - at.station.translation)),
                // A column of zeros holds its unknown.
                _ if freedom == Freedom::Station => continue,
                _ => turned.transform_point(&of_arm(&jacobian, *unknown)),
            };
            rhs += derivative * *change;
            *column = [derivative.x, derivative.y, derivative.z];
        }
        (columns, [rhs.x, rhs.y, rhs.z])
    }
}

/// Derivative of the tool point to a parameter of the arm.
fn of_arm<T: Scalar, const N: usize>(
    jacobian: &IdentificationJacobian<T, N>,
    unknown: Unknown,
) -> Vector3<T> {
    let column = match unknown {
        Unknown::Link { joint, parameter } => {
            jacobian.links.get(usize::from(joint)).map(|link| *link.get(parameter))
        }
        Unknown::Tool(k) => jacobian.tool.get(usize::from(k)).copied(),
        Unknown::Station(_) => None,
    };
    column.unwrap_or_else(|| Vector3::new(T::ZERO, T::ZERO, T::ZERO))
}

fn apply<T: Scalar, const N: usize>(
    parameters: &mut ArmParameters<T, N>,
    unknown: Unknown,
    step: T,
) {
    match unknown {
        Unknown::Link { joint, parameter } => {
            if let Some(link) = parameters.corrections.get_mut(usize::from(joint)) {
                let values = link.to_array();
                let mut which = LinkParameter::ALL.iter();
                let of =
                    |value| if which.next() == Some(&parameter) { value + step } else { value };
                *link = MdhParameters::from_array(values.map(of));
            }
        }
        Unknown::Tool(0) => parameters.tool.x += step,
        Unknown::Tool(1) => parameters.tool.y += step,
        Unknown::Tool(_) => parameters.tool.z += step,
        Unknown::Station(_) => {}
    }
}

/// RMS 3-D distance of the points from the model, m.
fn rms<T: Scalar, const N: usize, const P: usize>(
    at: &Reidentified<T, N, P>,
    points: &[CheckPoint<T, N>],
) -> T {
    let arm = Arm::new(&at.parameters);
    let mut sum = T::ZERO;
    for point in points {
        let rest = point.point - at.station.transform_point(&point.predicted(&arm));
        sum += dot(&rest, &rest);
    }
    (sum / T::from_f32(points.len() as f32)).sqrt()
}
