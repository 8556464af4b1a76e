//! The constants of a folded chain, for code that walks many poses at once.

use super::chain::Chain;
use super::pose::Pose;
use super::step::Step;
use crate::scalar::Scalar;

/// What [`Chain::forward`] computes with. Point and axes of the tool go through
/// it so, a vector `v` standing for each of the three:
///
/// 1. They begin as the columns and the translation of `tip`.
/// 2. From the last step to the first: a prismatic joint adds `q` to the point's
///    z; `v` becomes `Rz(angle) v`; if there is a step before, `v` becomes
///    `Rx(twist) v` with that step's twist, and the point moves by its offset.
/// 3. `root` takes them to the frame that the base is given in.
///
/// ```
/// use truearm::{Chain, Link, Pose};
///
/// // One turning joint 0.2 m above the base, the tool 0.3 m beside its axis.
/// let tool = Pose::translation(0.3, 0.0, 0.0);
/// let chain = Chain::new(&[Link::revolute(0.0, 0.0, 0.1, 0.2, 0.0)], Pose::identity(), tool);
/// let walk = chain.walk();
/// let (sin, cos) = (0.7_f64 + walk.steps[0].theta).sin_cos();
/// let tip = walk.tip.translation;
/// let x = cos * tip.x - sin * tip.y;
/// assert!((x - chain.forward(&[0.7]).translation.x).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walk<T, const N: usize> {
    /// All behind the last joint, its link's `d` and beta included.
    pub tip: Pose<T>,
    /// The joints, the first one first.
    pub steps: [Step<T>; N],
    /// All before the first joint, its link's alpha and `a` included.
    pub root: Pose<T>,
}

impl<T: Scalar, const N: usize> Chain<T, N> {
    /// The constants that poses are computed from.
    #[must_use]
    pub fn walk(&self) -> Walk<T, N> {
        Walk { tip: self.tip, steps: self.joints.map(|joint| joint.step()), root: self.root }
    }
}
