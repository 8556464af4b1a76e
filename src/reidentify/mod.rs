//! Re-identification on the controller: after a crash or a tool change a few
//! parameters are fitted anew to about ten measured points, or some dozen touches of a
//! plate or distances from an anchor ([`crate::measurement`]).
//!
//! All is measured at the [`tool`](crate::ArmParameters::tool) of the stored parameters, the
//! point of the calibration; [`Arm::with_parameters`] makes of what is found the arm with the
//! production tool.
//!
//! Gauss-Newton about the stored parameters. Each chosen [`Parameter`] has a prior:
//! its `scale` is the standard deviation of how far it may have moved, so that
//! lambda = 1 is the maximum a posteriori estimate and a direction that the
//! measurements do not show stays where it was. The six of a moved tracker, and the place
//! of a plane or an anchor, have none; they are fitted and not stored.
//!
//! Memory: the measurements stay with the caller; beside them one [`Triangle`] of P
//! parameters with a copy for the solve and an [`Arm`] with two sets of parameters. On a
//! Cortex-M4F in `f32` ten points take 0.37 million instructions for five unknowns, 1.03
//! million for eleven, 60 touches 2.38 million for seven (counted by `reidentify` and
//! `touches` in tests/firmware/src/bin).

mod error;
mod outcome;
mod station;

pub use error::ReidentifyError;
pub use outcome::Reidentified;
use outcome::Residuals;

use nalgebra::Vector3;

use crate::arm::{Arm, ArmParameters};
use crate::blob::storable;
use crate::kinematics::Pose;
use crate::measurement::{Equations, Measurement, Unknowns};
use crate::parameters::{Certainty, Parameter, apply, first_bad, first_bad_scale};
use crate::scalar::Scalar;
use crate::solve::{Misfit, SolveError, Triangle};

/// Steps at most; three are usual.
const MOST_STEPS: u8 = 10;
/// A step that no longer matters, rad or m.
const FINE: f32 = 1e-6;
/// After all steps one that matters little, in `f32`: so far, and by that share of what its
/// parameter is uncertain by.
const COARSE: f32 = 1e-5;
const NOTHING: f32 = 0.01;

/// What to identify anew, and how well it is measured: at the `tool` of the stored
/// parameters, not at a production tool.
///
/// ```
/// use truearm::parameters::Parameter;
/// use truearm::reidentify::Reidentify;
/// use truearm::{Arm6, blob::Blob, check_point::CheckPoint};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
/// let stored = Blob::check(slot)?.parameters::<f32, 6>()?;
/// # let mut crashed = stored.clone();
/// # Parameter::JointOffset(2).apply(&mut crashed, 5e-3);
/// # let crashed = Arm6::new(&crashed);
/// # let tracker = |q: &[f32; 6]| crashed.real_pose(q).translation;
/// let unknowns = [1, 2].map(Parameter::JointOffset);
/// let points = [0.1, 0.4, 0.7, 1.0].map(|turn| {
///     let q = [turn, -1.2, 1.0 + turn, -1.2, -1.57, 0.8];
///     CheckPoint::plain(q, tracker(&q), stored.reference_temperature)
/// });
/// let found = Reidentify::new(&stored, unknowns, 20e-6).run(&stored, &points)?;
/// assert!((found.change[1] - 5e-3).abs() < 1e-5, "joint 3 moved by 5 mrad");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reidentify<T, const P: usize> {
    /// The parameters; each once. Those of a tracker's place all six or none; those of the
    /// place of a plane or an anchor before the arm's.
    pub parameters: [Parameter; P],
    /// How far each may have moved, 1 sigma, in its unit; infinite for no prior, as those
    /// of a tracker's place must be.
    pub scale: [T; P],
    /// Standard deviation of a measured coordinate, height or distance about the model, m: of
    /// the instrument and of what the stored parameters leave of a sound arm, which is their
    /// `rms_after` over sqrt 3 and as a rule the more. Stated as less than half, it makes a sound
    /// session look like one that contradicts it.
    pub sigma: T,
}

/// What is being fitted.
#[derive(Clone, Copy, PartialEq)]
enum Freedom {
    /// Where tracker, planes and anchors stand.
    Places,
    All,
}

impl<T: Scalar, const P: usize> Reidentify<T, P> {
    /// With the usual prior for this arm, see [`Parameter::usual_scale`]; sigma in m.
    #[must_use]
    pub fn new<const N: usize>(
        stored: &ArmParameters<'_, T, N>,
        parameters: [Parameter; P],
        sigma: T,
    ) -> Self {
        Self { parameters, scale: parameters.map(|p| p.usual_scale(stored)), sigma }
    }

    /// Fits the parameters to measurements, [`CheckPoint`](crate::check_point::CheckPoint)s
    /// or any others, starting from the stored parameters. What it gives can be stored:
    /// [`encode`](crate::blob::encode) takes it, and the measurements agree with it.
    ///
    /// # Errors
    /// See [`ReidentifyError`].
    pub fn run<'t, M, const N: usize>(
        &self,
        stored: &ArmParameters<'t, T, N>,
        measurements: &[M],
    ) -> Result<Reidentified<'t, T, N, P>, ReidentifyError>
    where
        M: Copy + Into<Measurement<T, N>>,
    {
        let found = self.fitted(stored, measurements)?.judged()?;
        storable(&found.parameters)?;
        Ok(found)
    }

    /// The same whatever the [`Misfit`], where this is asked for: to find out by it which
    /// parameters moved, or which measurement is wrong. To be [judged](Reidentified::judged)
    /// before it is stored.
    ///
    /// # Errors
    /// See [`ReidentifyError`]; never [`ReidentifyError::Inconsistent`].
    pub fn fit<'t, M, const N: usize>(
        &self,
        stored: &ArmParameters<'t, T, N>,
        measurements: &[M],
    ) -> Result<Reidentified<'t, T, N, P>, ReidentifyError>
    where
        M: Copy + Into<Measurement<T, N>>,
    {
        let found = self.fitted(stored, measurements)?;
        storable(&found.parameters)?;
        Ok(found)
    }

    fn fitted<'t, M, const N: usize>(
        &self,
        stored: &ArmParameters<'t, T, N>,
        measurements: &[M],
    ) -> Result<Reidentified<'t, T, N, P>, ReidentifyError>
    where
        M: Copy + Into<Measurement<T, N>>,
    {
        let all = measurements.iter().map(|measurement| (*measurement).into());
        self.check(stored, all.clone())?;
        let mut out = Reidentified {
            parameters: stored.clone(),
            station: Pose::identity(),
            change: [T::ZERO; P],
            sigma: [T::ZERO; P],
            determined: [false; P],
            rank: 0,
            rms_before: T::ZERO,
            rms_after: T::ZERO,
            misfit: Misfit { chi_square: T::ZERO, freedom: T::ZERO },
            worst: 0,
            steps: 0,
        };
        if self.parameters.iter().any(|parameter| parameter.is_station()) {
            out.station = station::place(&Arm::new(stored), all.clone())?;
        }
        if !self.parameters.iter().all(|parameter| parameter.is_of_arm()) {
            self.settle(&mut out, all.clone(), Freedom::Places)?;
        }
        out.rms_before = self.residuals(&out, all.clone()).rms();
        let triangle = self.settle(&mut out, all.clone(), Freedom::All)?;
        let left = self.residuals(&out, all);
        (out.rms_after, out.worst) = (left.rms(), left.worst);
        let certainty = Certainty::of(&triangle, T::ONE, &self.scale)?;
        if let Some(index) = certainty.undetermined() {
            return Err(ReidentifyError::Undetermined { index });
        }
        let equations = T::from_f32(left.equations as f32);
        let freedom = equations - certainty.fitted(T::ONE, &self.scale);
        out.misfit = Misfit { chi_square: left.sum / self.sigma / self.sigma, freedom };
        Certainty { sigma: out.sigma, determined: out.determined, rank: out.rank } = certainty;
        let figures = [out.rms_before, out.rms_after, out.misfit.chi_square];
        if !figures.iter().all(|figure| figure.is_finite()) {
            return Err(SolveError::Overflow.into());
        }
        out.parameters.follow().ok_or(ReidentifyError::LastSequence)?;
        Ok(out)
    }

    fn check<const N: usize>(
        &self,
        stored: &ArmParameters<'_, T, N>,
        all: impl Iterator<Item = Measurement<T, N>> + Clone,
    ) -> Result<(), ReidentifyError> {
        if !(self.sigma > T::ZERO && self.sigma.is_finite()) {
            return Err(ReidentifyError::BadSigma);
        }
        if let Some((index, parameter)) = first_bad(&self.parameters, stored) {
            return Err(ReidentifyError::BadParameter { index, parameter });
        }
        if let Some((index, parameter)) = first_bad_scale(&self.parameters, &self.scale) {
            return Err(ReidentifyError::BadScale { index, parameter });
        }
        let of_station = self.parameters.iter().filter(|p| p.is_station()).count();
        if of_station > 0 && of_station < Parameter::STATION.len() {
            let alone = self.parameters.iter().copied().enumerate().find(|(_, p)| p.is_station());
            if let Some((index, parameter)) = alone {
                return Err(ReidentifyError::BadParameter { index, parameter });
            }
        }
        let (mut equations, needed) = (0_u32, P as u32);
        for measurement in all.clone() {
            equations = equations.saturating_add(measurement.equations());
        }
        if equations < needed {
            return Err(ReidentifyError::TooFewEquations { equations, needed });
        }
        for (index, measurement) in all.enumerate() {
            let checked = measurement.check(&self.parameters);
            checked.map_err(|why| ReidentifyError::BadMeasurement { index, why })?;
        }
        Ok(())
    }

    /// Gauss-Newton steps until they no longer matter; the last triangle.
    fn settle<const N: usize>(
        &self,
        out: &mut Reidentified<T, N, P>,
        all: impl Iterator<Item = Measurement<T, N>> + Clone,
        freedom: Freedom,
    ) -> Result<Triangle<T, P>, ReidentifyError> {
        for step_number in 1..=MOST_STEPS {
            let triangle = self.triangle(out, all.clone(), freedom)?;
            let x = triangle.solve(T::ONE, &self.scale)?.x;
            let steps = self.step(out, &x);
            out.steps = step_number;
            if steps.iter().all(|step| *step < T::from_f32(FINE)) {
                return Ok(triangle);
            }
            // In f32 a weak direction goes on trembling, by as much more as it is weaker.
            if step_number == MOST_STEPS {
                let certain = Certainty::of(&triangle, T::ONE, &self.scale)?;
                let coarse = |sigma: T| T::from_f32(COARSE) + sigma * T::from_f32(NOTHING);
                let mut all = steps.iter().zip(&certain.sigma);
                if all.all(|(step, sigma)| *step < coarse(*sigma)) {
                    return Ok(triangle);
                }
            }
        }
        Err(ReidentifyError::NotConverged)
    }

    /// The equations of all measurements about where everything is now. Their right-hand
    /// side is the residual plus what the changes so far explain, so that the prior
    /// counts from the stored parameters.
    fn triangle<const N: usize>(
        &self,
        at: &Reidentified<'_, T, N, P>,
        all: impl Iterator<Item = Measurement<T, N>>,
        freedom: Freedom,
    ) -> Result<Triangle<T, P>, ReidentifyError> {
        let arm = Arm::new(&at.parameters);
        let mut triangle = Triangle::new();
        let unknowns = Unknowns {
            parameters: &self.parameters,
            change: &at.change,
            arm_held: freedom == Freedom::Places,
            weight: T::ONE / self.sigma,
        };
        for (index, measurement) in all.enumerate() {
            let mut seen = arm.linearised(&measurement.q, &measurement.state);
            seen.move_to(&at.station);
            let equations = measurement.equations_at(&seen, &unknowns);
            match equations.map_err(|why| ReidentifyError::BadMeasurement { index, why })? {
                Equations::Point(columns, rhs) => triangle.push(&columns, &rhs)?,
                Equations::Number(columns, rhs) => triangle.push(&columns, &rhs)?,
            }
        }
        Ok(triangle)
    }

    /// Moves the arm and the tracker to the solution `x`; how far each went, in the
    /// unit of its parameter.
    fn step<const N: usize>(&self, out: &mut Reidentified<'_, T, N, P>, x: &[T; P]) -> [T; P] {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let (mut turn, mut shift) = (none, none);
        let (mut steps, mut sizes) = ([T::ZERO; P], [T::ZERO; P]);
        let moved = steps.iter_mut().zip(&mut sizes);
        let all = self.parameters.iter().zip(&mut out.change).zip(x).zip(moved);
        for (((parameter, change), x), (step, size)) in all {
            match parameter {
                Parameter::StationRotation(axis) => turn += axis.unit() * *x,
                Parameter::StationTranslation(axis) => shift += axis.unit() * *x,
                _ => {
                    *step = *x - *change;
                    *change = *x;
                }
            }
            *size = if parameter.is_station() { x.abs() } else { step.abs() };
        }
        apply(&mut out.parameters, &self.parameters, &steps);
        let turn = Pose::from_rotation_vector(none, turn);
        out.station.rotation = turn.compose(&out.station).rotation;
        out.station.translation += shift;
        sizes
    }

    /// What the model leaves of the measurements.
    // Not inlined: it is asked for twice.
    #[inline(never)]
    fn residuals<const N: usize>(
        &self,
        at: &Reidentified<T, N, P>,
        all: impl Iterator<Item = Measurement<T, N>>,
    ) -> Residuals<T> {
        let arm = Arm::new(&at.parameters);
        let mut left = Residuals { sum: T::ZERO, count: T::ZERO, equations: 0, worst: 0 };
        let mut most = T::ZERO;
        for (index, measurement) in all.enumerate() {
            let point = at.station.transform_point(&measurement.predicted(&arm));
            let square = measurement.reading.miss_square(&point, &self.parameters, &at.change);
            let equations = measurement.equations();
            let each = square / T::from_f32(equations as f32);
            if each > most {
                (most, left.worst) = (each, index);
            }
            left.sum += square;
            left.count += T::ONE;
            left.equations = left.equations.saturating_add(equations);
        }
        left
    }
}
