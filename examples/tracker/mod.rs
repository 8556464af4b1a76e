//! A simulated laser tracker: points on an arm that is not quite what its
//! controller has stored.

#![allow(dead_code, reason = "each example uses a part")]

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::{Blob, DecodeError};
use truearm::check_point::CheckPoint;
use truearm::nalgebra::Vector3;
use truearm::{Arm6, ArmParameters6};

/// Standard deviation of a measured coordinate, m.
pub const SIGMA: f32 = 20e-6;

/// What the controller has: see the example `load`.
pub fn stored() -> Result<ArmParameters6<'static, f32>, DecodeError> {
    Blob::check(include_bytes!("../../tests/data/firmware/ur10.blob"))?.parameters()
}

pub struct Tracker {
    /// What the arm really is.
    arm: Arm6<'static, f32>,
    rng: ChaCha8Rng,
}

impl Tracker {
    pub fn before(real: &ArmParameters6<'static, f32>) -> Self {
        Self { arm: Arm6::new(real), rng: ChaCha8Rng::seed_from_u64(1) }
    }

    /// The arm has changed.
    pub fn now_before(&mut self, real: &ArmParameters6<'static, f32>) {
        self.arm = Arm6::new(real);
    }

    /// Drives the arm somewhere in front of the robot and measures its tool.
    pub fn point(&mut self) -> CheckPoint<f32, 6> {
        let middle = [0.0, -1.2, 1.6, -1.2, -1.57, 0.0];
        let q = middle.map(|q| q + self.rng.random_range(-0.7..0.7));
        let half = 3.0_f32.sqrt() * SIGMA;
        let noise: [f32; 3] = [0; 3].map(|_| self.rng.random_range(-half..half));
        let point = self.arm.real_pose(&q).translation + Vector3::from(noise);
        CheckPoint::plain(q, point, self.arm.reference_temperature())
    }

    /// Largest distance of 200 tool points from where these parameters have
    /// them, m: without noise, at poses that nobody measured.
    pub fn error_of(&mut self, parameters: &ArmParameters6<'static, f32>) -> f32 {
        let model = Arm6::new(parameters);
        let points: Vec<_> = (0..200).map(|_| self.point()).collect();
        let error = |point: &CheckPoint<f32, 6>| {
            (point.predicted(&self.arm) - point.predicted(&model)).norm()
        };
        points.iter().map(error).fold(0.0, f32::max)
    }
}
