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

use nalgebra::{Matrix3, Vector3};

use crate::arm::{Arm, ArmParameters};
use crate::check_point::CheckPoint;
use crate::kinematics::{IdentificationJacobian, LinkParameter, MdhParameters, Pose};
use crate::kinematics::{axis, cross, dot};
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
pub struct Reidentified<T, const N: usize, const P: usize> {
    /// To be stored: corrections and tool changed, `sequence` one higher.
    pub parameters: ArmParameters<T, N>,
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

/// Why a re-identification gave no parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ReidentifyError {
    /// Fewer equations than unknowns.
    TooFewPoints {
        /// Points given.
        points: usize,
        /// Points needed.
        needed: usize,
    },
    /// This point has a number that is none.
    PointNotFinite {
        /// Its 0-based index.
        point: usize,
    },
    /// This unknown names no parameter of the arm, repeats an earlier one, or is
    /// one of fewer than six of the tracker.
    BadUnknown {
        /// Its 0-based index.
        unknown: usize,
    },
    /// The standard deviation is not a positive number.
    BadSigma,
    /// The points lie on a line, which leaves the tracker's place open.
    PointsOnALine,
    /// The points do not determine this unknown, which has no prior.
    Undetermined {
        /// Its 0-based index.
        unknown: usize,
    },
    /// The steps do not become small: joints or points are not what they seem.
    NotConverged,
    /// A solve failed.
    Solve(SolveError),
}

impl core::fmt::Display for ReidentifyError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFewPoints { points, needed } => {
                write!(f, "{points} points where {needed} or more are needed")
            }
            Self::PointNotFinite { point } => write!(f, "point {point} is not finite"),
            Self::BadUnknown { unknown } => {
                write!(
                    f,
                    "unknown {unknown} does not exist, or twice, or its five companions do not"
                )
            }
            Self::BadSigma => f.write_str("sigma must be a positive number"),
            Self::PointsOnALine => f.write_str("the points lie on a line"),
            Self::Undetermined { unknown } => {
                write!(f, "the points do not determine unknown {unknown}, which has no prior")
            }
            Self::NotConverged => f.write_str("the steps do not become small"),
            Self::Solve(error) => write!(f, "{error}"),
        }
    }
}

impl core::error::Error for ReidentifyError {}

impl From<SolveError> for ReidentifyError {
    fn from(error: SolveError) -> Self {
        Self::Solve(error)
    }
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
    pub fn run<const N: usize>(
        &self,
        stored: &ArmParameters<T, N>,
        points: &[CheckPoint<T, N>],
    ) -> Result<Reidentified<T, N, P>, ReidentifyError> {
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
            out.station = self.place(&Arm::new(stored), points)?;
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
        out.parameters.sequence = stored.sequence.wrapping_add(1);
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
                Unknown::Station(k) => station_column(k, &(seen - at.station.translation)),
                // A column of zeros holds its unknown.
                _ if freedom == Freedom::Station => continue,
                _ => turned.transform_point(&of_arm(&jacobian, *unknown)),
            };
            rhs += derivative * *change;
            *column = [derivative.x, derivative.y, derivative.z];
        }
        (columns, [rhs.x, rhs.y, rhs.z])
    }

    /// Where the tracker stands, from three of the points: the first, the one
    /// farthest from it, the one farthest from the line of these two.
    fn place<const N: usize>(
        &self,
        arm: &Arm<T, N>,
        points: &[CheckPoint<T, N>],
    ) -> Result<Pose<T>, ReidentifyError> {
        let Some((first, rest)) = points.split_first() else {
            return Err(ReidentifyError::TooFewPoints { points: 0, needed: 3 });
        };
        let origin = (first.predicted(arm), first.point);
        let farthest = |measure: &dyn Fn(&Vector3<T>) -> T| {
            let mut most = (T::ZERO, origin);
            for point in rest {
                let predicted = point.predicted(arm);
                let size = measure(&(predicted - origin.0));
                if size > most.0 {
                    most = (size, (predicted, point.point));
                }
            }
            (most.1.0 - origin.0, most.1.1 - origin.1)
        };
        let along = farthest(&|v| dot(v, v));
        let aside = farthest(&|v| {
            let c = cross(&along.0, v);
            dot(&c, &c)
        });
        let (there, here) = (frame(&along.0, &aside.0), frame(&along.1, &aside.1));
        let (Some(there), Some(here)) = (there, here) else {
            return Err(ReidentifyError::PointsOnALine);
        };
        let turn = Pose { rotation: here, ..Pose::identity() }
            .compose(&Pose { rotation: there.transpose(), ..Pose::identity() });
        Ok(Pose { translation: origin.1 - turn.transform_point(&origin.0), ..turn })
    }
}

/// Right-handed axes: x along the first vector, y towards the second; `None`
/// where the two are within a milliradian of one line.
fn frame<T: Scalar>(along: &Vector3<T>, aside: &Vector3<T>) -> Option<Matrix3<T>> {
    let normal = cross(along, aside);
    let (length, height) = (dot(along, along).sqrt(), dot(&normal, &normal).sqrt());
    // Written so that a NaN is none, either.
    (height > T::from_f32(1e-3) * length * length).then(|| {
        let (x, z) = (along / length, normal / height);
        Matrix3::from_columns(&[x, cross(&z, &x), z])
    })
}

fn station_column<T: Scalar>(component: u8, arm: &Vector3<T>) -> Vector3<T> {
    let unit = axis(&Pose::identity().rotation, usize::from(component % 3));
    if component < 3 { cross(&unit, arm) } else { unit }
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
