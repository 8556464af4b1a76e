//! Drift watch: check points measured now and then, a running chi-square that
//! says when to re-calibrate, and which group of parameters moved.
//!
//! Each point gives an innovation, measured less predicted, of three
//! coordinates with standard deviation sigma: its normalised square is
//! chi-square of 3 degrees while nothing has moved. A one-sided CUSUM (Page,
//! *Continuous inspection schemes*, Biometrika 41, 1954) adds these squares less a
//! reference of 4.2, starts again at zero, and alarms beyond a threshold:
//!
//! `S = max(0, S + |innovation|^2 / sigma^2 - 4.2)`
//!
//! The reference is the one that best detects a doubling of the variance, a
//! shift of one sigma in every coordinate. The thresholds are such that while
//! nothing moves an alarm comes once in 100, 1,000 or 10,000 points on average
//! (run lengths by the integral equation of Brook and Evans, Biometrika 59,
//! 1972, 400 states); tests/solve/drift.rs measures it. CUSUM rather than EWMA, because its last zero
//! dates the change: from there on each point's equations are folded into the
//! triangle of every group, and the group that explains most of the chi-square
//! for its number of parameters is the suspect. Every group is fitted under its
//! usual prior ([`Parameter::usual_scale`]): an offset that moves no point, of a
//! joint whose axis the tool lies on, would have to be absurd to explain one, and
//! explains nothing.

mod error;
mod group;

use nalgebra::Vector3;

pub use error::DriftError;
pub use group::{Explanation, Group};
use group::{explanation, length};

use crate::arm::Arm;
use crate::check_point::CheckPoint;
use crate::kinematics::dot;
use crate::parameters::Parameter;
use crate::scalar::Scalar;
use crate::solve::Triangle;

/// Subtracted from each point's chi-square.
pub const REFERENCE: f64 = 4.2;

/// How rarely the watch may alarm while nothing has moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FalseAlarms {
    /// Once in 100 points on average.
    OneIn100,
    /// Once in 1,000 points.
    #[default]
    OneIn1000,
    /// Once in 10,000 points.
    OneIn10000,
}

impl FalseAlarms {
    /// The CUSUM's threshold.
    #[must_use]
    pub const fn threshold(self) -> f64 {
        match self {
            Self::OneIn100 => 9.534,
            Self::OneIn1000 => 18.117,
            Self::OneIn10000 => 27.060,
        }
    }

    /// Points from one false alarm to the next, on average.
    #[must_use]
    pub const fn points(self) -> u32 {
        match self {
            Self::OneIn100 => 100,
            Self::OneIn1000 => 1_000,
            Self::OneIn10000 => 10_000,
        }
    }
}

/// What one point says.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use = "it may ask for a re-calibration"]
pub struct Verdict<T> {
    /// Squared normalised innovation of this point, chi-square of 3 degrees.
    pub chi_square: T,
    /// The running sum, 0 while all is well.
    pub level: T,
    /// Where it alarms.
    pub threshold: T,
    /// Points since the sum was last zero: since the change, if there was one. Once it has
    /// alarmed it goes on from there: points that leave the sum at zero are not counted, and
    /// do not begin anew.
    pub since: u32,
    /// Re-calibrate. Stays until [`DriftWatch::restart`].
    pub recalibrate: bool,
}

/// The watch over an arm of N joints; `6 N + 81` numbers of memory. A point
/// costs an identification Jacobian and about `30 N + 700` operations.
///
/// ```
/// use truearm::drift::{DriftWatch, FalseAlarms, Group};
/// use truearm::nalgebra::Vector3;
/// use truearm::parameters::Parameter;
/// use truearm::{Arm6, blob::Blob, check_point::CheckPoint};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
/// let stored = Blob::check(slot)?.parameters()?;
/// let arm = Arm6::<f32>::new(&stored);
/// # let mut slipped = stored.clone();
/// # Parameter::JointOffset(2).apply(&mut slipped, 1e-3);
/// # let slipped = Arm6::new(&slipped);
/// # let tracker = |q: &[f32; 6]| slipped.real_pose(q).translation;
/// let mut watch = DriftWatch::new(20e-6, FalseAlarms::OneIn1000)?;
/// let q = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
/// let point = CheckPoint::plain(q, tracker(&q), arm.reference_temperature());
/// let verdict = watch.push(&arm, &point, &Vector3::zeros())?;
/// assert!(verdict.recalibrate, "joint 3 slipped by 1 mrad");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriftWatch<T, const N: usize> {
    sigma: T,
    threshold: T,
    level: T,
    since: u32,
    alarmed: bool,
    offsets: [Triangle<T, 1>; N],
    tool: Triangle<T, 3>,
    base: Triangle<T, 6>,
}

impl<T: Scalar, const N: usize> DriftWatch<T, N> {
    /// With the standard deviation of an innovation's coordinate, m: of the
    /// measurement alone where points come with a baseline, else of measurement
    /// and model together (cross-validated RMS / sqrt 3).
    ///
    /// # Errors
    /// [`DriftError::BadSigma`].
    pub fn new(sigma: T, alarms: FalseAlarms) -> Result<Self, DriftError> {
        let weight = T::ONE / (sigma * sigma);
        if !(sigma > T::ZERO && weight > T::ZERO && weight.is_finite()) {
            return Err(DriftError::BadSigma);
        }
        Ok(Self {
            sigma,
            threshold: T::from_f64(alarms.threshold()),
            level: T::ZERO,
            since: 0,
            alarmed: false,
            offsets: [Triangle::new(); N],
            tool: Triangle::new(),
            base: Triangle::new(),
        })
    }

    /// Forgets all points, after a re-calibration.
    pub fn restart(&mut self) {
        self.level = T::ZERO;
        self.alarmed = false;
        self.begin();
    }

    fn begin(&mut self) {
        self.since = 0;
        self.offsets = [Triangle::new(); N];
        self.tool = Triangle::new();
        self.base = Triangle::new();
    }

    /// Takes a point in the commanded frame, that of the arm's tool. `baseline` is what measured less
    /// predicted was right after calibration at the same joints, m, and takes
    /// out what the model never explained; zero if not known.
    ///
    /// # Errors
    /// [`DriftError::NotFinite`], [`DriftError::Solve`]; the watch is then as before.
    pub fn push(
        &mut self,
        arm: &Arm<T, N>,
        point: &CheckPoint<T, N>,
        baseline: &Vector3<T>,
    ) -> Result<Verdict<T>, DriftError> {
        let at = point.linearised(arm);
        let innovation = (point.point - at.point() - baseline) / self.sigma;
        let chi_square = dot(&innovation, &innovation);
        let level = self.level + chi_square - T::from_f64(REFERENCE);
        if !(point.is_finite() && level.is_finite()) {
            return Err(DriftError::NotFinite);
        }
        let mut next = *self;
        if level > T::ZERO {
            let rhs = [innovation.x, innovation.y, innovation.z];
            let column = |parameter: Parameter| {
                let v = parameter.column(&at) / self.sigma;
                [v.x, v.y, v.z]
            };
            for (offset, joint) in next.offsets.iter_mut().zip(0_u8..) {
                offset.push(&[column(Parameter::JointOffset(joint))], &rhs)?;
            }
            next.tool.push(&Parameter::TOOL.map(column), &rhs)?;
            next.base.push(&Parameter::BASE.map(column), &rhs)?;
            next.level = level;
            next.since = self.since.saturating_add(1);
            next.alarmed = self.alarmed || level > self.threshold;
        } else {
            next.level = T::ZERO;
            // What led to an alarm stays to be looked at.
            if !self.alarmed {
                next.begin();
            }
        }
        *self = next;
        Ok(Verdict {
            chi_square,
            level: self.level,
            threshold: self.threshold,
            since: self.since,
            recalibrate: self.alarmed,
        })
    }

    /// What each group explains of the points that [`Verdict::since`] counts; joints first.
    pub fn explanations(&self) -> impl Iterator<Item = Explanation<T>> {
        let offsets = self.offsets.iter().zip(0_u8..).map(|(triangle, joint)| {
            explanation(Group::JointOffset(joint), triangle, |[shift]| shift.abs())
        });
        let tool = explanation(Group::Tool, &self.tool, |[x, y, z]| length(x, y, z));
        let base = explanation(Group::Base, &self.base, |[_, _, _, x, y, z]| length(x, y, z));
        offsets.chain([tool, base])
    }

    /// The group that explains most for its size: chi-square less
    /// `degrees * ln(3 points)`, the Bayesian information criterion. `None`
    /// while the sum is zero and it has not alarmed, or when no group pays for its parameters. An
    /// offset of the first joint moves the base and one of the last may move
    /// the tool: of equals the smaller group is named.
    #[must_use]
    pub fn suspect(&self) -> Option<Explanation<T>> {
        let price = ln(3 * u64::from(self.since));
        let net = |s: &Explanation<T>| s.explained - T::from_f32(f32::from(s.degrees)) * price;
        let mut best: Option<Explanation<T>> = None;
        for group in self.explanations().filter(|s| net(s) > T::ZERO) {
            if best.is_none_or(|best| net(&group) > net(&best)) {
                best = Some(group);
            }
        }
        best
    }
}

/// Natural logarithm, good to 6 %: between powers of two the chord.
fn ln<T: Scalar>(count: u64) -> T {
    let Some(exponent) = count.checked_ilog2() else { return T::ZERO };
    let power = (1_u64 << exponent) as f32;
    let fraction = (count as f32 - power) / power;
    T::from_f32((exponent as f32 + fraction) * core::f32::consts::LN_2)
}
