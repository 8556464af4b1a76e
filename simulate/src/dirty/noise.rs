//! Noise as trackers and arms have it, and as it is stated.

use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};

/// Of one coordinate, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Common to all readings of a pose.
    pub of_pose: f64,
    /// Of a reading near the tracker.
    pub of_reading: f64,
    /// Growth of the latter with the range, per m.
    pub range: f64,
    /// Degrees of freedom of its tails; none for Gaussian noise.
    pub tails: Option<f64>,
    /// What the robot file says.
    pub stated: f64,
}

impl Noise {
    /// Rightly stated within a factor 3 either way.
    pub fn draw(rng: &mut ChaCha8Rng) -> Self {
        let total = 1e-5 * 5.0_f64.powf(rng.random_range(0.0..1.0));
        // What a pose's readings share, as a share of the variance.
        let shared = if rng.random_bool(0.5) { rng.random_range(0.0..0.8) } else { 0.0 };
        let mut noise = Self {
            of_pose: total * f64::sqrt(shared),
            of_reading: total * f64::sqrt(1.0 - shared),
            range: if rng.random_bool(0.3) { rng.random_range(0.05..0.4) } else { 0.0 },
            tails: rng.random_bool(0.4).then(|| rng.random_range(3.0..8.0)),
            stated: 0.0,
        };
        let wrong = 3.0_f64.powf(rng.random_range(-1.0..1.0));
        // Three digits, as a file gives it.
        noise.stated = (total * wrong * 1e6).round().max(1.0) * 1e-6;
        noise
    }

    /// What all readings of a pose share.
    pub fn pose(&self, rng: &mut ChaCha8Rng) -> Vector3<f64> {
        Vector3::from_fn(|_, _| normal(rng)) * self.of_pose
    }

    /// What one reading has of its own, so far from the tracker.
    pub fn reading(&self, range: f64, rng: &mut ChaCha8Rng) -> Vector3<f64> {
        let sigma = self.of_reading * (1.0 + self.range * range);
        let one = |rng: &mut ChaCha8Rng| match self.tails {
            // Of unit variance.
            Some(freedom) => {
                let tails = StudentT::new(freedom).unwrap_or_else(|_| unreachable!("above 3"));
                let value: f64 = tails.sample(rng);
                value * ((freedom - 2.0) / freedom).sqrt()
            }
            None => normal(rng),
        };
        Vector3::from_fn(|_, _| one(rng)) * sigma
    }
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}
