//! The repertoire: what an arm does beyond rigid geometry.
//!
//! A model is a list of [`Term`]s. Every term is linear in its coefficient and
//! deflects a joint, the base or a length a little; its derivative is a known
//! [`Term::basis`] times a geometric column. Identification and controller
//! share this code. Beside them stand [`Curves`], which are too large to be terms.
//!
//! A file an effect: its descriptor (name, place, components, unit, what it
//! needs), its basis, and what it folds into for the tick. To add one, write
//! its file and its row in the table below; `blob/FORMAT.md` lists it, too.

#[macro_use]
mod repertoire;

mod approach;
mod descriptor;
mod folded;
mod inputs;
mod statics;
mod term;
mod wave;

mod backlash;
mod base_compliance;
mod encoder_eccentricity;
mod gear_transmission_error;
mod joint_compliance;
mod joint_coupling;
mod joint_error_curve;
mod joint_gain;
mod joint_periodic_error;
mod joint_stiffening;
mod lateral_compliance;
mod thermal_expansion;

use heapless::Vec;

pub use approach::Approach;
pub(crate) use descriptor::FINE;
pub use descriptor::{ActsOn, NeedsLoad, Order};
pub use inputs::TermInputs;
pub use joint_error_curve::{Curve, Curves, Gaps};
pub(crate) use joint_error_curve::{EXPONENTS, HEAD as CURVE_HEAD, first as first_curve};
pub(crate) use statics::GravityModel;
pub use statics::{Load, Masses};
pub use term::{Term, deflection};
pub use thermal_expansion::time_constant;

use crate::kinematics::{Deflection, JointKind};
use crate::scalar::Scalar;

/// Most terms of an arm.
pub const MAX_TERMS: usize = 24;

repertoire! {
    // In the order of their codes in a blob.
    effects {
        /// A joint turns under its gravity torque.
        JointCompliance in joint_compliance,
        /// The base tilts under the overturning moment.
        BaseCompliance in base_compliance,
        /// An eccentric encoder disc: one or two waves a turn.
        EncoderEccentricity in encoder_eccentricity,
        /// A gear's kinematic error: waves of a multiple of its ratio.
        GearTransmissionError in gear_transmission_error,
        /// Waves of an order that is tied to nothing known.
        JointPeriodicError in joint_periodic_error,
        /// The encoder's scale.
        JointGain in joint_gain,
        /// A joint turns with another one.
        JointCoupling in joint_coupling,
        /// Half the play of a joint.
        Backlash in backlash,
        /// Lengths grow with temperature.
        ThermalExpansion in thermal_expansion,
        /// What its gravity torque turns a joint by beyond a linear spring.
        JointStiffening in joint_stiffening,
        /// The axis of a joint tilts under the moment across it.
        LateralCompliance in lateral_compliance,
    }
    // What they fold into, in the order of the sum.
    smooth {
        springs: joint_compliance::Springs<T, N>,
        stiffening: joint_stiffening::Stiffening<T, N>,
        tilt: base_compliance::Tilt<T>,
        bearings: lateral_compliance::Bearings<T, N>,
        slopes: joint_coupling::Slopes<T>,
        gaps: backlash::Gaps<T>,
        growth: thermal_expansion::Growth<T, N>,
    }
}
