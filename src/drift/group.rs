//! Groups of parameters that move together, and what each explains.

use crate::parameters::{Parameter, USUAL_SCALE};
use crate::scalar::Scalar;
use crate::solve::Triangle;

/// Parameters that move together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Group {
    /// The offset of a joint, counted from 0: [`Parameter::JointOffset`].
    JointOffset(u8),
    /// The tool point: [`Parameter::TOOL`].
    Tool,
    /// The base or the tracker: [`Parameter::BASE`].
    Base,
}

impl core::fmt::Display for Group {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::JointOffset(joint) => write!(f, "{}", Parameter::JointOffset(*joint)),
            Self::Tool => f.write_str("tool point"),
            Self::Base => f.write_str("base"),
        }
    }
}

/// How well a group explains what was seen since the change.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Explanation<T> {
    /// The group.
    pub group: Group,
    /// Chi-square that it explains, less what its shift costs under the prior.
    pub explained: T,
    /// Parameters it takes for it: 1, 3 or 6.
    pub degrees: u8,
    /// Chi-square of all points since the change.
    pub total: T,
    /// Fitted shift: of an offset, rad, or m of a prismatic joint; length of the
    /// tool's, m; of the base's translation, m.
    pub shift: T,
}

pub(super) fn explanation<T: Scalar, const P: usize>(
    group: Group,
    triangle: &Triangle<T, P>,
    size: impl Fn([T; P]) -> T,
) -> Explanation<T> {
    // Of a joint offset, the tool and the base alike, see `Parameter::usual_scale`.
    let scale = [T::from_f64(USUAL_SCALE); P];
    let shift = triangle.solve(T::ONE, &scale).map_or(T::ZERO, |s| size(s.x));
    let explained = triangle.explained_square_with(T::ONE, &scale).unwrap_or(T::ZERO);
    Explanation { group, explained, degrees: P as u8, total: triangle.total_square(), shift }
}

pub(super) fn length<T: Scalar>(x: T, y: T, z: T) -> T {
    (x * x + y * y + z * z).sqrt()
}
