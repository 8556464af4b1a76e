//! What an effect goes with: a joint's angle, its load, the time.

use truearm::JointKind;
use truearm::effects::{ActsOn, Order, Term, time_constant};

use super::super::numbers::period;
use super::Seen;
use crate::model::arm::RowInputs;
use crate::model::{Clock, ModelTerm};
use crate::units::{duration, joint_from_file, joint_to_file, joint_unit};

/// Cycles a turn above which one cycle is shown in place of a turn.
const FOLDED: f64 = 4.0;

/// Something recorded or computed of a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Covariate {
    /// A joint's value.
    Angle(usize),
    /// Where in its cycle a joint is, of so many a turn.
    Cycle(usize, f64),
    /// A joint's gravity torque.
    Torque(usize),
    /// Overturning moment about the base's x or y.
    Moment(usize),
    /// Size of the gravity moment across a joint's axis.
    Across(usize),
    /// Temperature above reference, of an arm that follows it with this time constant, s.
    Warmth(f64),
    /// Side of its gap on which a joint rests, by this term.
    Side(Term<f64>),
    /// Side from which a joint came to rest.
    Arrival(usize),
    /// How far the session has come, in what a drift goes with.
    Session(Clock),
    /// Series of measurements.
    Series,
}

impl Covariate {
    /// Of a term.
    pub fn of(term: &ModelTerm) -> Self {
        let term = match term {
            ModelTerm::Arm(term) => term,
            ModelTerm::Drift { course, .. } => return Self::Session(course.clock),
            ModelTerm::Lag { joint, .. } => return Self::Arrival(*joint),
            ModelTerm::Remount { .. } => return Self::Series,
        };
        let (joint, source) = (usize::from(term.joint), usize::from(term.source));
        match (term.effect.acts_on(), term.effect.order()) {
            (ActsOn::Base, _) => Self::Moment(usize::from(term.component)),
            (ActsOn::Axis, _) => Self::Across(joint),
            (ActsOn::Lengths, _) => Self::Warmth(time_constant(std::slice::from_ref(term))),
            (_, Order::Cycles) if term.order > FOLDED => Self::Cycle(joint, term.order),
            (_, Order::Friction) => Self::Side(*term),
            (_, Order::Harmonic | Order::Cycles) => Self::Angle(joint),
            _ if term.effect.is_coupled() => Self::Angle(source),
            _ if term.needs_load() => Self::Torque(joint),
            _ => Self::Angle(joint),
        }
    }

    /// What the axis says.
    pub fn label(&self, kinds: &[JointKind]) -> String {
        let unit = |j: &usize| kinds.get(*j).map_or("degrees", |kind| joint_unit(*kind));
        let slides = |j: &usize| matches!(kinds.get(*j), Some(JointKind::Prismatic));
        match self {
            Self::Angle(j) => format!("reading of joint {}, {}", j + 1, unit(j)),
            Self::Cycle(j, n) => {
                format!("reading of joint {} within one cycle of {}, degrees", j + 1, period(*n))
            }
            Self::Torque(j) if slides(j) => {
                format!("gravity force on joint {}, N", j + 1)
            }
            Self::Torque(j) => format!("gravity torque on joint {}, N m", j + 1),
            Self::Moment(k) => {
                format!("overturning moment about the base's {}, N m", ["x", "y"][*k % 2])
            }
            Self::Across(j) => format!("gravity moment across the axis of joint {}, N m", j + 1),
            Self::Warmth(0.0) => "temperature above reference, K".to_owned(),
            Self::Warmth(tau) => {
                format!("temperature above reference as the arm has it, {} late, K", duration(*tau))
            }
            Self::Side(t) => format!("side of its gap on which joint {} rests", t.joint + 1),
            Self::Arrival(j) => format!("side that joint {} came to rest moving to", j + 1),
            Self::Session(Clock::Rows) => "number in the session, thousands of rows".to_owned(),
            Self::Session(Clock::Time) => "time, hours".to_owned(),
            Self::Series => String::new(),
        }
    }

    /// Of a kept row, in the unit of the label.
    pub fn value(&self, seen: &Seen, k: usize) -> f64 {
        let row = seen.kept[k];
        let (of, inputs) = (&seen.on.data.rows[row], &seen.conditions.rows[row]);
        match self {
            Self::Angle(j) => joint_to_file(seen.state.links[*j].kind, of.q[*j]),
            Self::Cycle(j, n) => of.q[*j].to_degrees().rem_euclid(360.0 / n),
            Self::Torque(j) => inputs.torque.get(*j).copied().unwrap_or(f64::NAN),
            Self::Moment(k) => inputs.moment[*k % 2],
            Self::Across(j) => inputs.across.get(*j).map_or(f64::NAN, |[x, y]| x.hypot(*y)),
            Self::Warmth(tau) => inputs.warmth_at(*tau),
            Self::Side(term) => place(inputs.basis(&of.q, term)),
            Self::Arrival(j) => of.directions.get(*j).map_or(f64::NAN, |d| place(f64::from(*d))),
            // A base that settles is shown against time, as one that drifts.
            Self::Session(clock) => clock.at(of),
            Self::Series => {
                let place =
                    seen.conditions.series.iter().position(|s| Some(s) == of.series.as_ref());
                place.map_or(f64::NAN, |place| place as f64 + 1.0)
            }
        }
    }

    /// Basis of a term where this is `x` and everything else nothing.
    pub fn basis(&self, term: &ModelTerm, x: f64, seen: &Seen) -> f64 {
        match term {
            ModelTerm::Arm(term) => self.basis_of_arm(term, x, seen),
            ModelTerm::Drift { course, .. } => course.after(x),
            ModelTerm::Lag { .. } => side(x),
            ModelTerm::Remount { series, .. } => {
                let place = seen.conditions.series.iter().position(|s| s == series);
                f64::from(u8::from(place.map(|p| p as f64 + 1.0) == Some(x.round())))
            }
        }
    }

    fn basis_of_arm(&self, term: &Term<f64>, x: f64, seen: &Seen) -> f64 {
        let joints = seen.state.links.len();
        let mut q = vec![0.0; joints];
        let mut inputs = RowInputs { torque: vec![0.0; joints], ..RowInputs::default() };
        match self {
            Self::Angle(j) => q[*j] = joint_from_file(seen.state.links[*j].kind, x),
            Self::Cycle(j, _) => q[*j] = x.to_radians(),
            Self::Torque(j) => inputs.torque[*j] = x,
            Self::Moment(k) => inputs.moment[*k % 2] = x,
            Self::Across(j) => {
                inputs.across = vec![[0.0; 2]; joints];
                inputs.across[*j] = [x, 0.0];
            }
            Self::Warmth(_) => inputs.warmth = x,
            Self::Side(_) => return side(x),
            Self::Arrival(_) | Self::Session(_) | Self::Series => {}
        }
        inputs.basis(&q, term)
    }

    /// Names of its values, if it has some instead of numbers.
    pub fn names(&self, seen: &Seen) -> Vec<String> {
        match self {
            Self::Series => seen.conditions.series.clone(),
            Self::Side(_) | Self::Arrival(_) => {
                ["negative", "positive"].map(str::to_owned).to_vec()
            }
            _ => Vec::new(),
        }
    }
}

/// Where a side stands among its names: the negative one first; an unknown one nowhere.
fn place(side: f64) -> f64 {
    if side == 0.0 { f64::NAN } else { 1.5 + 0.5 * side.signum() }
}

/// The side at a place.
fn side(place: f64) -> f64 {
    2.0 * (place - 1.5)
}
