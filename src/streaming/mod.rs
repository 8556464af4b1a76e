//! Streaming identification: one measured point of this arm after the other, or touch, or
//! distance, in memory that does not grow, and at any time parameters of this arm.
//!
//! Linear in the parameters: each measurement's equations are taken at the stored ones. What
//! that leaves out is of second order, half of the distance that a rotation of the
//! identified size moves the tool, times that rotation: 0.5 um a metre for 1 mrad, 50 um
//! for 10 mrad; a fit that it is too much for contradicts its measurements and is refused
//! ([`StreamingError::Inconsistent`]). [`StreamingIdentification::relinearise`] takes the
//! measurements from then on at what was found, [`StreamingIdentification::fit`], whatever that
//! leaves; where only a few are there and the change is large,
//! [`crate::reidentify`] iterates over them instead. Touches and distances, also of planes
//! and anchors of unknown place: [`crate::measurement`].
//!
//! ```
//! use truearm::check_point::CheckPoint;
//! use truearm::parameters::Parameter;
//! use truearm::streaming::{Lambda, Settings};
//! use truearm::{Arm, ArmParameters, Pose, blob::Blob};
//!
//! # fn main() -> Result<(), Box<dyn core::error::Error>> {
//! # let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
//! let stored: ArmParameters<f32, 6> = Blob::check(bytes)?.parameters()?;
//! # let mut slipped = stored.clone();
//! # Parameter::JointOffset(2).apply(&mut slipped, 1e-3);
//! # let slipped = Arm::new(&slipped);
//! # let tracker = |q: &[f32; 6]| slipped.real_pose(q).translation;
//! // Which parameters, and 20 um a measured coordinate. Every fifth point judges.
//! let [x, y, z] = Parameter::TOOL;
//! let offsets = [1, 2, 3, 4].map(Parameter::JointOffset);
//! let chosen = [offsets[0], offsets[1], offsets[2], offsets[3], x, y, z];
//! let running = Arm::new(&stored).with_tool(Pose::translation(0.0, 0.0, 0.15));
//! let mut stream = Settings::new(&stored, chosen, 20e-6).start(&stored)?;
//! for k in 0..40 {
//!     let q = [0.3, -1.2, 1.4, -0.5, 0.8, 0.2].map(|q| q * (1.0 + 0.7 * (k as f32).sin()));
//!     stream.push(&CheckPoint::plain(q, tracker(&q), stored.reference_temperature))?;
//! }
//! let found = stream.identified(Lambda::Prior)?;
//! assert!((found.change[1] - 1e-3).abs() < 5e-5, "joint 3 slipped by 1 mrad");
//! // To be stored, and driven with at once, by the production tool.
//! let arm = running.with_parameters(&found.parameters);
//! # assert_eq!(arm.real().tool(), running.real().tool());
//! # Ok(())
//! # }
//! ```

mod error;
mod outcome;

pub use error::StreamingError;
pub use outcome::Identified;

use crate::arm::{Arm, ArmParameters};
use crate::blob::storable;
use crate::measurement::{Equations, Measurement, Unknowns};
use crate::parameters::{Certainty, Parameter, apply, first_bad, first_bad_scale};
use crate::scalar::Scalar;
use crate::solve::{Misfit, SolveError, StreamingTikhonov, Triangle};

/// What to identify, and how well it is measured: at the `tool` of the stored parameters,
/// not at a production tool.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings<T, const P: usize> {
    /// The parameters; each once, none of a tracker's place. Those of the place of a plane
    /// or an anchor are beside the arm's.
    pub parameters: [Parameter; P],
    /// How far each may be from the stored one, 1 sigma, in its unit; the unit in which
    /// lambda weighs it. Infinite for no penalty; such parameters come first.
    pub scale: [T; P],
    /// Standard deviation of a measured coordinate, height or distance about the model, m: of
    /// the instrument and of what the stored parameters leave of a sound arm, which is their
    /// `rms_after` over sqrt 3 and as a rule the more. Stated as less than half, it makes a sound
    /// session look like one that contradicts it.
    pub sigma: T,
    /// Every so many measurements one only judges; none if 0, and then
    /// [`Lambda::TwoStep`] has nothing to judge by.
    pub every: u32,
    /// Weight of all earlier measurements at each new one, above 0, at most 1: they fade
    /// with a time constant of `1 / (1 - forgetting)` measurements.
    pub forgetting: T,
}

/// How strongly the stored parameters are held to.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Lambda<T> {
    /// As the scales and sigma say, lambda = 1: the maximum a posteriori estimate.
    Prior,
    /// At the corner of the L-curve of the fitted points (paper Eq. 15-16).
    LCurve,
    /// Best on the held-out points: the paper's two-step rule, see
    /// [`StreamingTikhonov::choose`].
    TwoStep,
    /// This one.
    Fixed(T),
}

/// An identification under way.
///
/// Memory: [`crate::solve::Memory`], and the stored parameters with an [`Arm`]. A point
/// costs an identification Jacobian, P columns and what
/// [`Triangle::push`] states.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamingIdentification<'t, T, const N: usize, const P: usize> {
    settings: Settings<T, P>,
    stored: ArmParameters<'t, T, N>,
    /// Where points are linearised, and how far that is from `stored`.
    arm: Arm<'t, T, N>,
    change: [T; P],
    stream: StreamingTikhonov<T, P>,
    /// Weights of the measurements that are fitted and that judge.
    weights: [T; 2],
    /// Sums of the weights of all equations and of their squares.
    weighed: [T; 2],
    equations: u32,
}

impl<T: Scalar, const P: usize> Settings<T, P> {
    /// With the usual prior for this arm, see [`Parameter::usual_scale`]; sigma in m.
    /// Every fifth point judges, nothing is forgotten.
    #[must_use]
    pub fn new<const N: usize>(
        stored: &ArmParameters<'_, T, N>,
        parameters: [Parameter; P],
        sigma: T,
    ) -> Self {
        let scale = parameters.map(|p| p.usual_scale(stored));
        Self { parameters, scale, sigma, every: 5, forgetting: T::ONE }
    }

    /// Begins, without points, at the stored parameters.
    ///
    /// # Errors
    /// A parameter, scale, sigma or forgetting factor that is none, by name.
    pub fn start<'t, const N: usize>(
        self,
        stored: &ArmParameters<'t, T, N>,
    ) -> Result<StreamingIdentification<'t, T, N, P>, StreamingError> {
        if !(self.sigma > T::ZERO && self.sigma.is_finite()) {
            return Err(StreamingError::BadSigma);
        }
        let mut all = self.parameters.iter().copied().enumerate();
        let of_station = all.find(|(_, parameter)| parameter.is_station());
        if let Some((index, parameter)) = first_bad(&self.parameters, stored).or(of_station) {
            return Err(StreamingError::BadParameter { index, parameter });
        }
        if let Some((index, parameter)) = self.first_bad_scale() {
            return Err(StreamingError::BadScale { index, parameter });
        }
        Ok(StreamingIdentification {
            settings: self,
            stored: stored.clone(),
            arm: Arm::new(stored),
            change: [T::ZERO; P],
            stream: StreamingTikhonov::new(self.every, self.forgetting)?,
            weights: [T::ZERO; 2],
            weighed: [T::ZERO; 2],
            equations: 0,
        })
    }

    /// The first that no solve would take.
    fn first_bad_scale(&self) -> Option<(usize, Parameter)> {
        let mut pairs = self.scale.iter().zip(self.scale.iter().skip(1));
        let late = pairs.position(|(before, scale)| before.is_finite() && !scale.is_finite());
        let mut behind = self.parameters.iter().copied().enumerate().skip(1);
        let late = late.and_then(|pair| behind.nth(pair));
        first_bad_scale(&self.parameters, &self.scale).or(late)
    }
}

impl<'t, T: Scalar, const N: usize, const P: usize> StreamingIdentification<'t, T, N, P> {
    /// Takes a measurement in the commanded frame, a
    /// [`CheckPoint`](crate::check_point::CheckPoint) or any other; whether it only judges.
    ///
    /// # Errors
    /// [`StreamingError::BadMeasurement`], or [`StreamingError::Solve`] where the
    /// model makes no number of it or it is too far from the model; nothing has been
    /// added then.
    pub fn push<M>(&mut self, measurement: &M) -> Result<bool, StreamingError>
    where
        M: Copy + Into<Measurement<T, N>>,
    {
        let measurement: Measurement<T, N> = (*measurement).into();
        let Settings { parameters, sigma, .. } = &self.settings;
        measurement.check(parameters).map_err(StreamingError::BadMeasurement)?;
        let at = self.arm.linearised(&measurement.q, &measurement.state);
        let unknowns =
            Unknowns { parameters, change: &self.change, arm_held: false, weight: T::ONE / *sigma };
        let equations = measurement.equations_at(&at, &unknowns);
        let judges = match equations.map_err(StreamingError::BadMeasurement)? {
            Equations::Point(columns, rhs) => self.stream.push(&columns, &rhs)?,
            Equations::Number(columns, rhs) => self.stream.push(&columns, &rhs)?,
        };
        let equations = measurement.equations();
        self.equations = self.equations.saturating_add(equations);
        let fading = self.settings.forgetting;
        for (sum, fading) in self.weighed.iter_mut().zip([fading, fading * fading]) {
            *sum = *sum * fading + T::from_f32(equations as f32);
        }
        let [fitted, held_out] = &mut self.weights;
        for (sum, counts) in [(fitted, !judges), (held_out, judges)] {
            *sum *= fading;
            if counts {
                *sum += T::ONE;
            }
        }
        Ok(judges)
    }

    /// Measurements taken.
    #[must_use]
    pub fn points(&self) -> u32 {
        self.stream.points()
    }

    /// The parameters as all measurements so far have them. They can be stored:
    /// [`encode`](crate::blob::encode) takes them, and the measurements agree with them.
    ///
    /// # Errors
    /// See [`StreamingError`]; the measurements stay.
    pub fn identified(
        &mut self,
        rule: Lambda<T>,
    ) -> Result<Identified<'t, T, N, P>, StreamingError> {
        let found = self.fitted(rule)?.judged()?;
        storable(&found.parameters)?;
        Ok(found)
    }

    /// The same whatever the [`Misfit`], where this is asked for: for [`Self::relinearise`]
    /// after a change that one linearisation does not hold for. To be
    /// [judged](Identified::judged) before it is stored.
    ///
    /// # Errors
    /// See [`StreamingError`]; never [`StreamingError::Inconsistent`].
    pub fn fit(&mut self, rule: Lambda<T>) -> Result<Identified<'t, T, N, P>, StreamingError> {
        let found = self.fitted(rule)?;
        storable(&found.parameters)?;
        Ok(found)
    }

    fn fitted(&mut self, rule: Lambda<T>) -> Result<Identified<'t, T, N, P>, StreamingError> {
        let (equations, needed) = (self.equations, P as u32);
        if equations < needed {
            return Err(StreamingError::TooFewEquations { equations, needed });
        }
        let (lambda, scale) = (self.lambda(rule)?, self.settings.scale);
        let held_out = self.judge(lambda)?;
        let all = self.stream.all()?;
        let change = all.solve(lambda, &scale)?.x;
        let certainty = Certainty::of(&all, lambda, &scale)?;
        if let Some(index) = certainty.undetermined() {
            return Err(StreamingError::Undetermined { index });
        }
        let misfit = self.misfit(all.residual_square(&change), certainty.fitted(lambda, &scale))?;
        let Certainty { sigma, determined, rank } = certainty;
        let [fitted, judging] = self.weights;
        let rms = |x: &[T; P]| self.rms(&all, x, fitted + judging);
        let (rms_before, rms_after) = (rms(&[T::ZERO; P])?, rms(&change)?);
        let mut parameters = self.stored.clone();
        apply(&mut parameters, &self.settings.parameters, &change);
        parameters.follow().ok_or(StreamingError::LastSequence)?;
        Ok(Identified {
            parameters,
            change,
            sigma,
            determined,
            rank,
            lambda,
            rms_before,
            rms_after,
            misfit,
            held_out,
        })
    }

    /// Of weighed squared residuals, and so many unknowns that they determine. What fades
    /// leaves less of its noise in them, but takes less of it into the parameters: of readings
    /// that are all alike by the share of the squared weights.
    fn misfit(&self, chi_square: T, fitted: T) -> Result<Misfit<T>, StreamingError> {
        let [weights, squares] = self.weighed;
        let freedom = weights - fitted * (squares / weights);
        if chi_square.is_finite() && freedom.is_finite() {
            Ok(Misfit { chi_square, freedom })
        } else {
            Err(SolveError::Overflow.into())
        }
    }

    /// From now on measurements are linearised about what was found; those before stay as
    /// they are, and what they and the scale say is still counted from the stored
    /// parameters. Worth it where the change is large, see [`crate::streaming`];
    /// with a forgetting factor the error of the earlier ones fades. `found` is a
    /// result of this identification.
    pub fn relinearise(&mut self, found: &Identified<'t, T, N, P>) {
        self.arm = Arm::new(&found.parameters);
        self.change = found.change;
    }

    fn lambda(&mut self, rule: Lambda<T>) -> Result<T, StreamingError> {
        match rule {
            Lambda::Prior => Ok(T::ONE),
            Lambda::Fixed(lambda) => Ok(lambda),
            Lambda::LCurve => {
                let choice = self.stream.choose(&self.settings.scale)?;
                choice.l_curve.ok_or(StreamingError::NoCorner)
            }
            Lambda::TwoStep => {
                let choice = self.stream.choose(&self.settings.scale)?;
                choice.two_step.ok_or(StreamingError::NothingHeldOut)
            }
        }
    }

    /// RMS of the held-out measurements from the solution of the fitted ones, m.
    #[inline(never)]
    fn judge(&mut self, lambda: T) -> Result<Option<T>, StreamingError> {
        let [_, judging] = self.weights;
        if judging <= T::ZERO {
            return Ok(None);
        }
        let x = self.stream.fitted()?.solve(lambda, &self.settings.scale)?.x;
        self.rms(self.stream.held_out(), &x, judging).map(Some)
    }

    /// RMS distance of so many measurements, m. The square of one that was held out may be
    /// beyond `T` though all that are fitted are within.
    fn rms(&self, triangle: &Triangle<T, P>, x: &[T; P], many: T) -> Result<T, StreamingError> {
        let rms = (triangle.residual_square(x) / many).sqrt() * self.settings.sigma;
        if rms.is_finite() { Ok(rms) } else { Err(SolveError::Overflow.into()) }
    }
}
