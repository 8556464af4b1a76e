//! The crate's kinematics for a joint count known only at run time: the same
//! `Chain<f64, N>` that the controller links, chosen by N.

use nalgebra::Vector3;
use truearm::{Chain, Link, Pose};

/// Calls `$body` with the constant `N` equal to the run-time `$n`.
macro_rules! with_joints {
    ($n:expr, $N:ident => $body:expr) => {{
        macro_rules! arm {
            ($count:literal) => {{
                const $N: usize = $count;
                $body
            }};
        }
        match $n {
            1 => arm!(1),
            2 => arm!(2),
            3 => arm!(3),
            4 => arm!(4),
            5 => arm!(5),
            6 => arm!(6),
            7 => arm!(7),
            8 => arm!(8),
            9 => arm!(9),
            10 => arm!(10),
            11 => arm!(11),
            12 => arm!(12),
            13 => arm!(13),
            14 => arm!(14),
            15 => arm!(15),
            16 => arm!(16),
            n => unreachable!("robot files have 1 to 16 joints, not {n}"),
        }
    }};
}
pub(crate) use with_joints;

/// The tool point and its derivatives at one pose.
#[derive(Debug, Clone)]
pub struct Derivatives {
    /// The tool point.
    pub point: Vector3<f64>,
    /// To rotation and translation of the base, in the outer frame.
    pub base: [Vector3<f64>; 6],
    /// To the tool point in the last frame.
    pub tool: [Vector3<f64>; 3],
    /// To alpha, a, theta, d, beta of each link.
    pub links: Vec<[Vector3<f64>; 5]>,
}

/// A chain of any number of joints.
pub trait Kinematics: Send + Sync {
    /// Tool pose at joint values `q`.
    fn pose(&self, q: &[f64]) -> Pose<f64>;
    /// Tool point and derivatives at joint values `q`.
    fn derivatives(&self, q: &[f64]) -> Derivatives;
}

impl<const N: usize> Kinematics for Chain<f64, N> {
    fn pose(&self, q: &[f64]) -> Pose<f64> {
        self.forward(&fixed(q))
    }

    fn derivatives(&self, q: &[f64]) -> Derivatives {
        let j = self.identification_jacobian(&fixed(q));
        let [rx, ry, rz] = j.base_rotation;
        let [tx, ty, tz] = j.base_translation;
        let links = j.links.iter().map(|l| [l.alpha, l.a, l.theta, l.d, l.beta]).collect();
        Derivatives { point: j.point, base: [rx, ry, rz, tx, ty, tz], tool: j.tool, links }
    }
}

/// A slice whose length the file reader has checked.
pub(crate) fn fixed<T: Copy, const N: usize>(q: &[T]) -> [T; N] {
    q.try_into().unwrap_or_else(|_| unreachable!("every row has a value for every joint"))
}

/// The chain of these links with this base and tool point.
#[must_use]
pub fn chain(links: &[Link<f64>], base: Pose<f64>, tool: Vector3<f64>) -> Box<dyn Kinematics> {
    let tool = Pose { translation: tool, ..Pose::identity() };
    with_joints!(links.len(), N => Box::new(Chain::<f64, N>::new(&fixed(links), base, tool)))
}
