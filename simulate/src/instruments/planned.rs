//! A planned file taken to the cell: the arm goes where the rows say, what is to be
//! touched is touched near there, and the readings are filled in. And what a user states
//! beforehand of where everything stands.

use std::fmt::Write;

use nalgebra::{DVector, Rotation3, Vector3};
use rand::Rng;

use super::rows::{mm, say};
use super::{AT_REST, Cell, Row, rotation};
use crate::body::apply;
use crate::oracle::{self, Matrix};
use crate::{normal, vector};

/// Columns of labels.
const LABELS: [&str; 8] = ["anchor", "pair", "plate", "hole", "surface", "camera", "image", "kind"];

impl Cell {
    /// The file of measurements that comes of a planned one.
    ///
    /// # Panics
    /// Where the real arm does not come to what a row says.
    pub fn filled(&self, planned: &str, rng: &mut impl Rng) -> String {
        let mut lines = planned.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let header = lines.next().unwrap_or_default();
        let at = |name: &str| header.iter().position(|column| *column == name);
        let joint = |j: usize| {
            let names = [format!("planned{}_deg", j + 1), format!("q{}_deg", j + 1)];
            names.iter().find_map(|name| at(name)).unwrap_or_else(|| panic!("no joint {j}"))
        };
        let joints: Vec<usize> = (0..self.kinds.len()).map(joint).collect();
        let mut rows: Vec<(Vec<f64>, Row)> = Vec::new();
        for cells in lines {
            let value = |column: &usize| cells[*column].parse::<f64>().map(f64::to_radians);
            let q: Vec<f64> = joints.iter().filter_map(|c| value(c).ok()).collect();
            let mut row = self.begun(at("kind").map_or("point", |kind| cells[kind]));
            for name in LABELS {
                if let Some(column) = at(name) {
                    say(&mut row, name, cells[column].to_owned());
                }
            }
            let before = rows.last().map(|(q, _)| q.clone());
            let read = self.fill(&q, before.as_deref(), &mut row, rng);
            rows.extend(read.map(|q| (q, row)));
        }
        self.text(&rows)
    }

    /// Fills in one row; where the arm then is, `None` where nothing is read.
    fn fill(
        &self,
        q: &[f64],
        before: Option<&[f64]>,
        row: &mut Row,
        rng: &mut impl Rng,
    ) -> Option<Vec<f64>> {
        match row["kind"].as_str() {
            "touch" | "plate" | "closure" => return Some(self.contact(q, row, rng)),
            "distance" => {
                let anchor = self.anchors[number(row, "anchor")];
                let far = (self.target(q) - anchor).norm() + self.noise(rng);
                say(row, "distance_mm", mm(far));
            }
            "pair" => {
                // Either row may have it: the second one knows the first.
                let far = before.map(|b| (self.target(q) - self.target(b)).norm());
                let far = far.map_or(0.0, |far| far + self.noise(rng));
                say(row, "distance_mm", mm(far));
            }
            "range" => {
                let (plane, far) = self.planes[number(row, "surface")];
                let way = self.axes(q).column(2).into_owned();
                let range = (far - plane.dot(&self.target(q))) / plane.dot(&way);
                say(row, "distance_mm", mm(range + self.noise(rng)));
            }
            "inclination" => {
                let sines = self.axes(q).transpose() * self.up;
                for (c, name) in ["incl_x_deg", "incl_y_deg"].into_iter().enumerate() {
                    let angle = sines[c].asin() + self.sigmas.angle * normal(rng);
                    say(row, name, format!("{:.10}", angle.to_degrees()));
                }
            }
            "pixel" => self.image(q, row, rng)?,
            other => panic!("no kind {other}"),
        }
        Some(q.to_vec())
    }

    /// Where the arm is when it touches what a row says, near these joints.
    fn contact(&self, q: &[f64], row: &Row, rng: &mut impl Rng) -> Vec<f64> {
        let off = vector(rng) * self.sigmas.length;
        let zero = |q: &[f64]| {
            let at = self.target(q);
            let full =
                |point: Vector3<f64>| DVector::from_column_slice((at - point - off).as_slice());
            match (row["kind"].as_str(), row.get("surface").map(String::as_str)) {
                ("plate", _) => full(apply(&self.plate, &self.holes[number(row, "hole")])),
                ("closure", _) => full(self.anchors[number(row, "anchor")] * 0.5),
                (_, Some("ball")) => {
                    DVector::repeat(1, (at - self.sphere.0).norm() - self.sphere.1 - off.x)
                }
                (_, Some("pipe")) => {
                    let (point, axis, radius) = self.cylinder;
                    DVector::repeat(1, (at - point).cross(&axis).norm() - radius - off.x)
                }
                _ => {
                    let (plane, far) = self.planes[number(row, "surface")];
                    DVector::repeat(1, at.dot(&plane) - far - off.x)
                }
            }
        };
        self.near(q.to_vec(), &zero, AT_REST).unwrap_or_else(|| panic!("{row:?} is not reached"))
    }

    /// `None` where a corner at the border falls outside.
    fn image(&self, q: &[f64], row: &mut Row, rng: &mut impl Rng) -> Option<()> {
        let seen = match self.camera.in_hand {
            true => oracle::product(&self.flange(q), &self.camera.place),
            false => self.camera.place,
        };
        let corner = match row.get("hole") {
            Some(_) => apply(&self.plate, &self.holes[number(row, "hole")]),
            None => self.target(q),
        };
        let local = rotation(&seen).transpose() * (corner - apply(&seen, &Vector3::zeros()));
        let place = self.project(&local)?;
        for (name, x) in ["u_px", "v_px"].into_iter().zip(place) {
            say(row, name, format!("{:.6}", x + self.sigmas.pixel * normal(rng)));
        }
        Some(())
    }

    /// What the user states: places to so many metres and radians, as guesses or as known.
    pub fn placed(&self, off: f64, guess: bool, rng: &mut impl Rng) -> String {
        let guess = format!("guess = {guess}\n");
        let mut shift = |p: Vector3<f64>| {
            let p = (p + vector(rng) * off) * 1e3;
            format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z)
        };
        let mut out = String::new();
        for (k, anchor) in self.anchors.iter().enumerate() {
            for (label, place) in [("A", *anchor), ("C", anchor * 0.5)] {
                let place = shift(place);
                let _ =
                    write!(out, "[[anchors]]\nlabel = \"{label}{k}\"\nxyz_mm = {place}\n{guess}");
            }
        }
        for (k, (normal, far)) in self.planes.iter().enumerate() {
            let (point, way) = (shift(normal * *far), shift(*normal));
            let _ = write!(
                out,
                "[[surfaces]]\nlabel = \"P{k}\"\npoint_mm = {point}\nnormal = {way}\n{guess}"
            );
        }
        let (point, radius) = (shift(self.sphere.0), self.sphere.1 * 1e3);
        let _ = write!(
            out,
            "[[surfaces]]\nlabel = \"ball\"\nshape = \"sphere\"\npoint_mm = {point}\n\
             radius_mm = {radius:?}\n{guess}"
        );
        let (point, way) = (shift(self.cylinder.0), shift(self.cylinder.1));
        let _ = write!(
            out,
            "[[surfaces]]\nlabel = \"pipe\"\nshape = \"cylinder\"\npoint_mm = {point}\n\
             normal = {way}\nradius_mm = {:?}\n{guess}",
            self.cylinder.2 * 1e3
        );
        let _ =
            write!(out, "[[plates]]\nlabel = \"plate\"\n{}{guess}", frame(&self.plate, &mut shift));
        out += "[plates.holes]\n";
        for (k, hole) in self.holes.iter().enumerate() {
            let [x, y, z] = [hole.x, hole.y, hole.z].map(|x| x * 1e3);
            let _ = writeln!(out, "H{k} = [{x:?}, {y:?}, {z:?}]");
        }
        let [fx, fy, cx, cy] = self.camera.pinhole;
        let mounted = if self.camera.in_hand { "flange" } else { "fixed" };
        let _ = write!(
            out,
            "[[cameras]]\nlabel = \"cam\"\nmounted = \"{mounted}\"\n{}{guess}\
             focal_px = [{fx:?}, {fy:?}]\ncentre_px = [{cx:?}, {cy:?}]\ndistortion = {:?}\n",
            frame(&self.camera.place, &mut shift),
            self.camera.brown
        );
        out
    }
}

/// The keys of a frame.
fn frame(of: &Matrix<f64>, shift: &mut impl FnMut(Vector3<f64>) -> String) -> String {
    let turn = Rotation3::from_matrix_unchecked(rotation(of)).euler_angles();
    let [r, p, y] = [turn.0, turn.1, turn.2].map(f64::to_degrees);
    format!("xyz_mm = {}\nrpy_deg = [{r:?}, {p:?}, {y:?}]\n", shift(apply(of, &Vector3::zeros())))
}

/// The number in a label such as `P2`.
fn number(row: &Row, column: &str) -> usize {
    let digits = row[column].trim_start_matches(|c: char| !c.is_ascii_digit());
    digits.parse().unwrap_or_else(|_| panic!("no number in {column} {}", row[column]))
}
