//! Simulated arms whose truth is known, and sessions in which they are
//! measured. Kinematics are those of the 4x4 oracle of the crate's tests;
//! effects are exact constructions. Nothing here knows how truearm identifies.

#![allow(missing_docs, reason = "for the studies and tests of this repository only")]

pub mod arm;
pub mod body;
pub mod dirty;
pub mod draw;
pub mod effects;
pub mod instruments;
#[path = "../../tests/common/mod.rs"]
pub mod oracle;
pub mod robots;
pub mod warming;

use body::Moment;
use nalgebra::{Rotation3, Vector3};
use rand::{Rng, RngExt};
use truearm::JointKind;

/// An arm as its file describes it, SI units.
#[derive(Debug, Clone)]
pub struct Robot {
    pub joints: Vec<Joint>,
    /// Mass and its centre in the link's frame; empty if not stated.
    pub masses: Vec<(f64, Vector3<f64>)>,
    /// In the base frame; none if not stated.
    pub gravity: Option<Vector3<f64>>,
    /// In the last frame.
    pub tool: Vector3<f64>,
}

/// A joint and the link before it.
#[derive(Debug, Clone)]
pub struct Joint {
    pub kind: JointKind,
    /// alpha, a, theta, d, beta
    pub link: [f64; 5],
    pub limits: Option<[f64; 2]>,
    pub gear_ratio: Option<f64>,
}

/// Standard normal (Box-Muller).
pub fn normal(rng: &mut impl Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random_range(1e-12..1.0), rng.random_range(0.0..1.0));
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// Three of them.
pub fn vector(rng: &mut impl Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| normal(rng))
}

/// A rigid motion as a matrix: a rotation vector, rad, and a translation, m.
pub fn rigid(turn: &Vector3<f64>, shift: &Vector3<f64>) -> oracle::Matrix<f64> {
    let rotation = Rotation3::from_scaled_axis(*turn);
    let mut m = oracle::identity();
    for (i, row) in m.iter_mut().enumerate().take(3) {
        (0..3).for_each(|j| row[j] = rotation[(i, j)]);
        row[3] = shift[i];
    }
    m
}

/// At rest at these joints for long, from below, without payload at 20 degrees.
pub fn at_rest(q: &[f64]) -> Moment {
    Moment {
        q: q.to_vec(),
        before: q.to_vec(),
        directions: vec![1; q.len()],
        time: 0.0,
        temperature: 20.0,
        links: 20.0,
        payload: 0.0,
        later: false,
    }
}

/// Rows of cells, the header first, as the text of a CSV file.
pub fn csv<C: AsRef<[u8]>>(rows: impl IntoIterator<Item = impl IntoIterator<Item = C>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(row).expect("rows as long as the header");
    }
    let bytes = writer.into_inner().expect("memory takes every byte");
    String::from_utf8(bytes).expect("cells of text")
}
