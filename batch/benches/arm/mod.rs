//! The arm and the poses of both benchmarks.

pub use poses::POSES;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{Chain, Link, Pose, Scalar};

mod poses;

#[path = "../../../tests/common/ur10.rs"]
mod ur10;

pub fn chain<T: Scalar>() -> Chain<T, 6> {
    let links = ur10::UR10.map(|link| {
        let [alpha, a, theta, d, beta] = link.map(T::from_f64);
        Link::revolute(alpha, a, theta, d, beta)
    });
    Chain::new(&links, Pose::identity(), Pose::translation(T::ZERO, T::ZERO, T::from_f64(0.1)))
}

/// A slice a joint.
pub fn joints<T: Scalar>() -> [Vec<T>; 6] {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    [(); 6].map(|()| (0..POSES).map(|_| T::from_f64(rng.random_range(-3.2..3.2))).collect())
}
