//! Images of a board.

use nalgebra::{DVector, Matrix3, Rotation3, Vector3};
use rand::{Rng, RngExt};

use super::{Cell, Row, rotation};
use crate::body::apply;
use crate::oracle::{self, Matrix};
use crate::{normal, rigid, vector};

/// Poses tried for an image at most.
const TRIED: usize = 500;
/// How near the camera comes to where it is sent, m and rad: what it sees is
/// computed from where it then is.
const CLOSE: f64 = 1e-3;

impl Cell {
    /// So many exposures, each from near where the last one was: an arm goes from
    /// one to the next without folding through itself.
    ///
    /// # Panics
    /// Where hardly any pose sees the board.
    pub(super) fn images(&self, count: usize, rng: &mut impl Rng) -> Vec<(Vec<f64>, Row)> {
        let (mut all, mut last, mut number) = (Vec::new(), None, 0);
        for _ in 0..TRIED * count {
            if number == count {
                return all;
            }
            let eye = self.eye(rng);
            let from = last.take().unwrap_or_else(|| self.pose(rng));
            let found = self.near(from, &|q| self.off(q, &eye), CLOSE);
            let rows = found.as_deref().map_or_else(Vec::new, |q| self.exposed(q, number, rng));
            if rows.len() > self.holes.len() / 2 {
                all.extend(rows);
                number += 1;
                // Now and then from elsewhere, for the other branches of the arm.
                last = found.filter(|_| rng.random_bool(0.8));
            }
        }
        panic!("{number} of {count} images: hardly any pose sees the board")
    }

    /// Somewhere above the board, looking down at its middle.
    fn eye(&self, rng: &mut impl Rng) -> Matrix<f64> {
        let middle = self.holes.iter().sum::<Vector3<f64>>() / self.holes.len() as f64;
        let middle = apply(&self.plate, &middle);
        let aside = rng.random_range(-0.35..0.35);
        let above = rng.random_range(0.45..0.8);
        let eye = middle + Vector3::new(aside, rng.random_range(-0.35..0.35), above);
        let look = (middle + vector(rng) * 0.03 - eye).normalize();
        let roll = rng.random_range(-0.8..0.8_f64);
        let y = look.cross(&Vector3::new(roll.cos(), roll.sin(), 0.0)).normalize();
        let turn = Matrix3::from_columns(&[y.cross(&look), y, look]);
        rigid(&Rotation3::from_matrix_unchecked(turn).scaled_axis(), &eye)
    }

    /// How far the camera is from there: a length, and the sines of what it is
    /// turned by (an angle from a cosine is known to 1e-8 only, and Newton's steps
    /// then go on for ever).
    fn off(&self, q: &[f64], eye: &Matrix<f64>) -> DVector<f64> {
        let seen = oracle::product(&self.flange(q), &self.camera.place);
        let at = apply(&seen, &Vector3::zeros()) - apply(eye, &Vector3::zeros());
        let turn = rotation(&seen) * rotation(eye).transpose();
        let sine = |i: usize, j: usize| (turn[(i, j)] - turn[(j, i)]) / 2.0;
        // Half a turn away the sines are nothing as well.
        let away = if turn.trace() < 0.0 { 1.0 } else { 0.0 };
        let [x, y, z] = [sine(2, 1) + away, sine(0, 2), sine(1, 0)];
        DVector::from_vec(vec![at.x, at.y, at.z, x, y, z])
    }

    /// All corners of the board that one exposure sees.
    fn exposed(&self, q: &[f64], number: usize, rng: &mut impl Rng) -> Vec<(Vec<f64>, Row)> {
        let seen = oracle::product(&self.flange(q), &self.camera.place);
        let corner = |(k, hole): (usize, &Vector3<f64>)| {
            let there = apply(&self.plate, hole) - apply(&seen, &Vector3::zeros());
            let place = self.project(&(rotation(&seen).transpose() * there))?;
            let [u, v] = place.map(|x| x + self.sigmas.pixel * normal(rng));
            let row = Row::from([
                ("kind", "pixel".to_owned()),
                ("camera", "cam".to_owned()),
                ("image", format!("{number}")),
                ("plate", "plate".to_owned()),
                ("hole", format!("H{k}")),
                ("u_px", format!("{u:.6}")),
                ("v_px", format!("{v:.6}")),
                ("sigma_px", format!("{}", self.sigmas.pixel)),
            ]);
            Some((q.to_vec(), row))
        };
        self.holes.iter().enumerate().filter_map(corner).collect()
    }

    /// Where the image has a point of the camera's frame, px.
    pub(super) fn project(&self, point: &Vector3<f64>) -> Option<[f64; 2]> {
        let [fx, fy, cx, cy] = self.camera.pinhole;
        let [k1, k2, p1, p2, k3] = self.camera.brown;
        let (x, y) = (point.x / point.z, point.y / point.z);
        let r2 = x * x + y * y;
        let radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
        let u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
        let v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
        let [u, v] = [fx * u + cx, fy * v + cy];
        let inside = (0.0..1280.0).contains(&u) && (0.0..1024.0).contains(&v) && point.z > 0.1;
        inside.then_some([u, v])
    }
}
