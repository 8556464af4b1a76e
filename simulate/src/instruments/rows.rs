//! What each kind measures at a pose, as cells of a row.

use nalgebra::{DVector, Rotation3, Vector3};
use rand::{Rng, RngExt};

use super::{Cell, Row, rotation};
use crate::body::apply;
use crate::{normal, vector};

type Pose = Vec<f64>;

pub(super) fn mm(m: f64) -> String {
    format!("{:.8}", m * 1e3)
}

pub(super) fn say(row: &mut Row, column: &'static str, value: String) {
    row.insert(column, value);
}

impl Cell {
    /// The rows of one measurement of a kind.
    pub(super) fn measure(
        &self,
        kind: &'static str,
        number: usize,
        rng: &mut impl Rng,
    ) -> Vec<(Pose, Row)> {
        let mut row = self.begun(kind);
        let q = match kind {
            "point" | "pose" => {
                let q = self.pose(rng);
                self.tracked(kind, &q, &mut row, rng);
                q
            }
            "distance" => self.length(number, &mut row, rng),
            "pair" => return self.pair(number, row, rng),
            "touch" => self.touch(number, &mut row, rng),
            "sphere" => self.touch_ball(&mut row, rng),
            "cylinder" => self.touch_pipe(&mut row, rng),
            "plate" => self.hole(&mut row, rng),
            "closure" => self.closed(number, &mut row, rng),
            "range" => self.range(number, &mut row, rng),
            "inclination" => self.inclined(&mut row, rng),
            other => panic!("no kind {other}"),
        };
        vec![(q, row)]
    }

    pub(super) fn begun(&self, kind: &str) -> Row {
        Row::from([
            ("kind", kind.to_owned()),
            ("sigma_mm", mm(self.sigmas.length)),
            ("sigma_deg", format!("{:.9}", self.sigmas.angle.to_degrees())),
            ("sigma_px", format!("{}", self.sigmas.pixel)),
        ])
    }

    /// A point or a pose at joint values that somebody chose.
    pub(super) fn tracked_at(&self, kind: &str, q: &[f64], rng: &mut impl Rng) -> (Pose, Row) {
        let mut row = self.begun(kind);
        self.tracked(kind, q, &mut row, rng);
        (q.to_vec(), row)
    }

    pub(super) fn noise(&self, rng: &mut impl Rng) -> f64 {
        self.sigmas.length * normal(rng)
    }

    fn tracked(&self, kind: &str, q: &[f64], row: &mut Row, rng: &mut impl Rng) {
        let seen = apply(&self.base, &self.target(q)) + vector(rng) * self.sigmas.length;
        let names = ["x_mm", "y_mm", "z_mm"].into_iter();
        names.zip(seen.iter()).for_each(|(column, x)| say(row, column, mm(*x)));
        if kind == "pose" {
            self.turned(q, row, rng);
        }
    }

    fn turned(&self, q: &[f64], row: &mut Row, rng: &mut impl Rng) {
        let wrong = Rotation3::from_scaled_axis(vector(rng) * self.sigmas.angle);
        let turn = wrong.matrix() * rotation(&self.base) * self.axes(q);
        let axis = Rotation3::from_matrix_unchecked(turn).scaled_axis();
        let (sin, cos) = (axis.norm() / 2.0).sin_cos();
        let v = axis / axis.norm().max(1e-12) * sin;
        for (column, x) in ["qx", "qy", "qz", "qw"].into_iter().zip([v.x, v.y, v.z, cos]) {
            say(row, column, format!("{x:.12}"));
        }
    }

    fn length(&self, number: usize, row: &mut Row, rng: &mut impl Rng) -> Pose {
        let (q, anchor) = (self.pose(rng), number % self.anchors.len());
        let far = (self.target(&q) - self.anchors[anchor]).norm() + self.noise(rng);
        say(row, "distance_mm", mm(far));
        say(row, "anchor", format!("A{anchor}"));
        q
    }

    fn pair(&self, number: usize, mut row: Row, rng: &mut impl Rng) -> Vec<(Pose, Row)> {
        let (q, other) = (self.pose(rng), self.pose(rng));
        let far = (self.target(&q) - self.target(&other)).norm() + self.noise(rng);
        say(&mut row, "pair", format!("{number}"));
        let first = (other, row.clone());
        say(&mut row, "distance_mm", mm(far));
        vec![first, (q, row)]
    }

    fn touch(&self, number: usize, row: &mut Row, rng: &mut impl Rng) -> Pose {
        let (plane, off) = (number % self.planes.len(), self.noise(rng));
        let (normal, far) = self.planes[plane];
        say(row, "surface", format!("P{plane}"));
        self.solved(|at| DVector::repeat(1, at.dot(&normal) - far - off), rng)
    }

    fn touch_ball(&self, row: &mut Row, rng: &mut impl Rng) -> Pose {
        let off = self.noise(rng);
        say(row, "kind", "touch".to_owned());
        say(row, "surface", "ball".to_owned());
        let from = |at: Vector3<f64>| (at - self.sphere.0).norm() - self.sphere.1 - off;
        // From outside: the last frame stands farther off.
        loop {
            let q = self.solved(|at| DVector::repeat(1, from(at)), rng);
            let flange = apply(&self.flange(&q), &Vector3::zeros());
            if (flange - self.sphere.0).norm() > self.sphere.1 {
                return q;
            }
        }
    }

    fn touch_pipe(&self, row: &mut Row, rng: &mut impl Rng) -> Pose {
        let off = self.noise(rng);
        say(row, "kind", "touch".to_owned());
        say(row, "surface", "pipe".to_owned());
        let (point, axis, radius) = self.cylinder;
        let from = |at: Vector3<f64>| (at - point).cross(&axis).norm() - radius - off;
        loop {
            let q = self.solved(|at| DVector::repeat(1, from(at)), rng);
            if (self.target(&q) - point).dot(&axis).abs() < 0.5 {
                return q;
            }
        }
    }

    fn at(&self, point: &Vector3<f64>, rng: &mut impl Rng) -> Pose {
        self.solved(|at| DVector::from_column_slice((at - point).as_slice()), rng)
    }

    fn hole(&self, row: &mut Row, rng: &mut impl Rng) -> Pose {
        let hole = rng.random_range(0..self.holes.len());
        let there = apply(&self.plate, &self.holes[hole]) + vector(rng) * self.sigmas.length;
        say(row, "plate", "plate".to_owned());
        say(row, "hole", format!("H{hole}"));
        self.at(&there, rng)
    }

    fn closed(&self, number: usize, row: &mut Row, rng: &mut impl Rng) -> Pose {
        let point = self.anchors[number % 3] * 0.5 + vector(rng) * self.sigmas.length;
        say(row, "anchor", format!("C{}", number % 3));
        self.at(&point, rng)
    }

    fn range(&self, number: usize, row: &mut Row, rng: &mut impl Rng) -> Pose {
        loop {
            let (q, plane) = (self.pose(rng), number % self.planes.len());
            let (normal, far) = self.planes[plane];
            let way = self.axes(&q).column(2).into_owned();
            let range = (far - normal.dot(&self.target(&q))) / normal.dot(&way);
            if (0.05..2.0).contains(&range) && normal.dot(&way).abs() > 0.4 {
                say(row, "distance_mm", mm(range + self.noise(rng)));
                say(row, "surface", format!("P{plane}"));
                return q;
            }
        }
    }

    fn inclined(&self, row: &mut Row, rng: &mut impl Rng) -> Pose {
        loop {
            let q = self.pose(rng);
            let sines = self.axes(&q).transpose() * self.up;
            if sines.x.abs().max(sines.y.abs()) < 0.7 {
                for (c, name) in ["incl_x_deg", "incl_y_deg"].into_iter().enumerate() {
                    let angle = sines[c].asin() + self.sigmas.angle * normal(rng);
                    say(row, name, format!("{:.10}", angle.to_degrees()));
                }
                return q;
            }
        }
    }
}
