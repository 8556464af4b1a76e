//! The arm of all peers, as each of them wants it, and poses of it.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{Chain, Link, Pose};

use crate::run::Result;

#[path = "../../../tests/common/ur10.rs"]
mod ur10;

const POSES: usize = 1000;
const TOOL: [f64; 3] = [0.05, -0.03, 0.12];

/// Writes `links.txt`, a link a line; `arm.txt`, the constant transforms before each
/// joint and behind the last (rows of a 3x4 matrix); `tool.txt`; `poses.txt`, joint
/// values in rad; `positions.txt`, where truearm has the tool, m.
pub fn write(folder: &Path) -> Result {
    let links = ur10::UR10;
    let tool = Pose::translation(TOOL[0], TOOL[1], TOOL[2]);
    let chain = Chain::new(
        &links.map(|[alpha, a, theta, d, beta]| Link::revolute(alpha, a, theta, d, beta)),
        Pose::identity(),
        tool,
    );
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    let pi = core::f64::consts::PI;
    let poses: Vec<[f64; 6]> =
        (0..POSES).map(|_| [(); 6].map(|()| rng.random_range(-pi..pi))).collect();
    let points = poses.iter().map(|q| chain.forward(q).translation.data.0[0]);
    fs::write(folder.join("links.txt"), lines(links))?;
    fs::write(folder.join("arm.txt"), lines(transforms(&links, tool)))?;
    fs::write(folder.join("tool.txt"), lines([TOOL]))?;
    fs::write(folder.join("positions.txt"), lines(points))?;
    fs::write(folder.join("poses.txt"), lines(poses))?;
    Ok(())
}

/// From each joint to the next at joint values 0: for peers whose joints turn about z.
fn transforms(links: &[[f64; 5]; 6], tool: Pose<f64>) -> Vec<[f64; 12]> {
    let turn = |axis, angle| {
        let mut vector = Vector3::zeros();
        vector[axis] = angle;
        Pose::from_rotation_vector(Vector3::zeros(), vector)
    };
    let mut before = Pose::identity();
    let mut all = Vec::new();
    for [alpha, a, theta, d, beta] in *links {
        let to_axis = turn(0, alpha).compose(&Pose::translation(a, 0.0, 0.0));
        all.push(before.compose(&to_axis.compose(&turn(2, theta))));
        before = Pose::translation(0.0, 0.0, d).compose(&turn(1, beta));
    }
    all.push(before.compose(&tool));
    all.iter()
        .map(|pose| {
            let entry = |k: usize| match k % 4 {
                3 => pose.translation[k / 4],
                column => pose.rotation[(k / 4, column)],
            };
            core::array::from_fn(entry)
        })
        .collect()
}

/// Numbers that read back as the same bits.
fn lines<const N: usize>(rows: impl IntoIterator<Item = [f64; N]>) -> String {
    let mut text = String::new();
    for row in rows {
        let words: Vec<_> = row.iter().map(|value| format!("{value:e}")).collect();
        let _ = writeln!(text, "{}", words.join(" "));
    }
    text
}
