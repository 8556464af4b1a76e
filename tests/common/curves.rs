//! Random smooth curves, and what a table makes of them.

#![allow(dead_code, reason = "each test file uses a part")]

use core::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::blob::{curve_len, encode_curve};

/// A periodic Gaussian process of standard deviation 1 with a squared-exponential
/// covariance of this length scale, rad, drawn as a Fourier series.
pub struct Smooth(Vec<[f64; 2]>);

impl Smooth {
    pub fn new(length: f64, rng: &mut ChaCha8Rng) -> Self {
        // Beyond, an amplitude is below 1e-6.
        let orders = (5.3 / length) as usize;
        let share = |k: usize| (-0.25 * (k as f64 * length).powi(2)).exp();
        let total: f64 = (1..=orders).map(|k| share(k).powi(2)).sum();
        let mut normal = || {
            let (a, b): (f64, f64) = (rng.random_range(1e-12..1.0), rng.random_range(0.0..1.0));
            (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
        };
        Self(
            (1..=orders)
                .map(|k| [normal(), normal()].map(|n| n * share(k) / total.sqrt()))
                .collect(),
        )
    }

    pub fn at(&self, q: f64) -> f64 {
        let wave = |(k, [c, s]): (usize, &[f64; 2])| {
            let angle = (k + 1) as f64 * q;
            c * angle.cos() + s * angle.sin()
        };
        self.0.iter().enumerate().map(wave).sum()
    }
}

/// Nodes whose cubic B-spline goes through these values at the nodes.
pub fn through(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let mut nodes = values.to_vec();
    // A neighbour counts a quarter of the node: 40 sweeps leave 1e-12.
    for _ in 0..40 {
        for k in 0..n {
            nodes[k] = (6.0 * values[k] - nodes[(k + n - 1) % n] - nodes[(k + 1) % n]) / 4.0;
        }
    }
    nodes
}

/// The bytes of a curve with these nodes, rad.
pub fn bytes(joint: u8, band: f32, nodes: &[f64]) -> Vec<u8> {
    let most = nodes.iter().fold(0.0, |most: f64, node| most.max(node.abs()));
    let step = (most / 32_767.0) as f32;
    let steps: Vec<i16> = nodes.iter().map(|n| (n / f64::from(step)).round() as i16).collect();
    let mut out = vec![0; curve_len(nodes.len())];
    encode_curve(joint, step, band, &steps, &mut out).unwrap();
    out
}

/// A random smooth curve of 0.4 mrad and a length scale of 3 degrees for each joint.
pub fn of_joints(joints: &[u8], nodes: usize, rng: &mut ChaCha8Rng) -> Vec<u8> {
    let curve = |joint: &u8| {
        let smooth = Smooth::new(3_f64.to_radians(), rng);
        let values: Vec<f64> =
            (0..nodes).map(|k| 4e-4 * smooth.at(TAU * k as f64 / nodes as f64)).collect();
        bytes(*joint, 2e-5, &through(&values))
    };
    joints.iter().flat_map(curve).collect()
}
