//! Where to measure after an alarm of the drift watch, chosen before any: poses
//! for a re-identification.

use nalgebra::{DMatrix, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::kinematics::IdentificationJacobian;
use truearm::{Chain, Pose};
use truearm_host::model::Robot;

const JOINTS: usize = 6;

/// The poses: of 1,000 random ones, one by one those that leave the least
/// variance of the tool point over other poses (I-optimal) when the parameters
/// of `columns` are unknown, under the usual prior of the controller in units of the noise. They
/// know the nominal arm only, and not what will have moved.
pub fn choose(
    robot: &Robot,
    count: usize,
    sigma: f64,
    columns: impl Fn(&IdentificationJacobian<f64, JOINTS>) -> Vec<Vector3<f64>>,
) -> Vec<[f64; JOINTS]> {
    let Ok(nominal) = <[_; JOINTS]>::try_from(robot.nominal()) else { return Vec::new() };
    let tool = Pose { translation: robot.tool, ..Pose::identity() };
    let chain = Chain::new(&nominal, Pose::identity(), tool);
    let mut rng = ChaCha8Rng::seed_from_u64(4242);
    let mut random = |count: usize| -> Vec<([f64; JOINTS], DMatrix<f64>)> {
        let pose = |_| {
            // As an f32 holds it: what the controller reads is where it was.
            let q = [0; JOINTS].map(|_| f64::from(rng.random_range(-2.6..2.6_f32)));
            let columns = columns(&chain.identification_jacobian(&q));
            let rows = DMatrix::from_fn(3, columns.len(), |i, k| columns[k][i]);
            (q, rows.transpose() * rows)
        };
        (0..count).map(pose).collect()
    };
    let others = random(300);
    let unknowns = others.first().map_or(0, |(_, square)| square.nrows());
    let none = DMatrix::zeros(unknowns, unknowns);
    let mean = others.iter().fold(none, |sum, (_, square)| sum + square);
    let mut candidates = random(1000);
    // The usual prior of the controller, in units of the noise.
    let mut information = DMatrix::identity(unknowns, unknowns) * (sigma / 0.02).powi(2);
    let mut chosen = Vec::new();
    while chosen.len() < count {
        let left = |square: &DMatrix<f64>| {
            (&information + square).try_inverse().map_or(f64::MAX, |c| (c * &mean).trace())
        };
        let scores: Vec<f64> = candidates.iter().map(|c| left(&c.1)).collect();
        let best = (0..scores.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b]));
        let (q, square) = candidates.swap_remove(best.unwrap_or(0));
        information += square;
        chosen.push(q);
    }
    chosen
}
