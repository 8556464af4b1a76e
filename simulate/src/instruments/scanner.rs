//! A range finder that sees along a fan of rays from one point, on the flange, and
//! three planes around the arm.

use nalgebra::{Matrix3, Vector3};
use rand::Rng;

use super::rows::{mm, say};
use super::{Cell, Row, rotation};
use crate::body::apply;
use crate::normal;
use crate::oracle::{self, Matrix};

/// Where it sits in the last frame, and its rays: in its plane of x and z, at these
/// angles from z.
#[derive(Debug, Clone)]
pub struct Scanner {
    pub place: Matrix<f64>,
    pub rays: Vec<f64>,
    /// Nearest and farthest that it sees, m.
    pub sees: [f64; 2],
}

/// Poses tried for each that is measured.
const TRIED: usize = 20_000;
/// Least cosine between a ray and the normal of what it hits.
const STEEP: f64 = 0.4;

impl Scanner {
    fn way(angle: f64) -> Vector3<f64> {
        Vector3::new(angle.sin(), 0.0, angle.cos())
    }

    /// What instruments.toml states of it: each ray from a drawing of where it
    /// should sit.
    #[must_use]
    pub fn stated(&self, nominal: &Matrix<f64>) -> String {
        let ray = |(k, angle): (usize, &f64)| {
            let way = rotation(nominal) * Self::way(*angle);
            let at = apply(nominal, &Vector3::zeros()) * 1e3;
            format!(
                "[[rays]]\nmarker = \"ray{k}\"\norigin_mm = [{}, {}, {}]\n\
                 direction = [{}, {}, {}]\nguess = true\n",
                at.x, at.y, at.z, way.x, way.y, way.z
            )
        };
        self.rays.iter().enumerate().map(ray).collect()
    }
}

impl Cell {
    /// A file of ranges at so many poses for each plane; every ray hits the plane
    /// from its front.
    ///
    /// # Panics
    /// Where hardly any pose sees a plane.
    pub fn scans(&self, scanner: &Scanner, poses: usize, rng: &mut impl Rng) -> String {
        let mut rows = Vec::new();
        for plane in 0..self.planes.len() {
            for _ in 0..poses {
                let mut tried = 0;
                let (q, ranges) = loop {
                    let q = self.pose(rng);
                    if let Some(ranges) = self.ranges(scanner, plane, &q) {
                        break (q, ranges);
                    }
                    tried += 1;
                    assert!(tried < TRIED, "hardly any pose sees plane {plane}");
                };
                for (k, range) in ranges.into_iter().enumerate() {
                    let mut row = Row::from([
                        ("kind", "range".to_owned()),
                        ("marker", format!("ray{k}")),
                        ("surface", format!("P{plane}")),
                        ("sigma_mm", mm(self.sigmas.length)),
                    ]);
                    say(&mut row, "distance_mm", mm(range + self.sigmas.length * normal(rng)));
                    rows.push((q.clone(), row));
                }
            }
        }
        self.text(&rows)
    }

    /// How far each ray goes, if all of them end on a plane within reach.
    fn ranges(&self, scanner: &Scanner, plane: usize, q: &[f64]) -> Option<Vec<f64>> {
        let (normal, far) = self.planes[plane];
        let seen = oracle::product(&self.flange(q), &scanner.place);
        let (at, axes) = (apply(&seen, &Vector3::zeros()), rotation(&seen));
        let range = |angle: &f64| {
            let down = -normal.dot(&(axes * Scanner::way(*angle)));
            let range = (normal.dot(&at) - far) / down;
            let [near, end] = scanner.sees;
            (down > STEEP && (near..end).contains(&range)).then_some(range)
        };
        scanner.rays.iter().map(range).collect()
    }

    /// Where the scanner is in the arm's frame, and how it is turned.
    #[must_use]
    pub fn scanner_at(&self, scanner: &Scanner, q: &[f64]) -> (Vector3<f64>, Matrix3<f64>) {
        let seen = oracle::product(&self.flange(q), &scanner.place);
        (apply(&seen, &Vector3::zeros()), rotation(&seen))
    }
}

/// The angle between two orientations, rad.
#[must_use]
pub fn apart(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    let turn = a * b.transpose();
    let sines = Vector3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    );
    (sines.norm() / 2.0).atan2((turn.trace() - 1.0) / 2.0)
}
