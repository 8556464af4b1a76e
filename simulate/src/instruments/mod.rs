//! A cell with more in it than a tracker: anchors, planes, a plate, a sphere, a
//! cylinder, a camera; and what each of them measures of an arm. All of it from
//! 4x4 matrices: what must be touched is found by Newton steps of difference
//! quotients. Nothing here comes from the crate.

use std::collections::BTreeMap;
use std::fmt::Write;

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};
use rand::{Rng, RngExt};
use truearm::JointKind;

use crate::body::apply;
use crate::oracle::{self, Matrix};
use crate::{csv, normal, rigid, vector};

/// Standard deviations of what is measured, m, rad and px.
#[derive(Debug, Clone, Copy)]
pub struct Sigmas {
    pub length: f64,
    pub angle: f64,
    pub pixel: f64,
}

/// A pinhole with Brown's distortion.
#[derive(Debug, Clone)]
pub struct Camera {
    /// Its frame in the last one, or, where it stands still, in the arm's.
    pub place: Matrix<f64>,
    pub in_hand: bool,
    /// fx, fy, cx, cy, px
    pub pinhole: [f64; 4],
    /// k1, k2, p1, p2, k3
    pub brown: [f64; 5],
}

/// The arm and what stands around it, in the arm's own frame.
#[derive(Debug, Clone)]
pub struct Cell {
    pub kinds: Vec<JointKind>,
    /// alpha, a, theta, d, beta of each joint.
    pub links: Vec<[f64; 5]>,
    pub tool: Vector3<f64>,
    /// How the marker's frame is turned in the last one.
    pub turn: Rotation3<f64>,
    /// The arm in the station's frame.
    pub base: Matrix<f64>,
    pub anchors: Vec<Vector3<f64>>,
    /// Normal and distance from the origin.
    pub planes: Vec<(Vector3<f64>, f64)>,
    /// Centre and radius.
    pub sphere: (Vector3<f64>, f64),
    /// A point of the axis, the axis, the radius.
    pub cylinder: (Vector3<f64>, Vector3<f64>, f64),
    pub plate: Matrix<f64>,
    /// In the plate's frame.
    pub holes: Vec<Vector3<f64>>,
    pub camera: Camera,
    pub up: Vector3<f64>,
    pub sigmas: Sigmas,
}

/// The columns of the file beside those of the joints.
const COLUMNS: [&str; 23] = [
    "kind",
    "x_mm",
    "y_mm",
    "z_mm",
    "qx",
    "qy",
    "qz",
    "qw",
    "distance_mm",
    "anchor",
    "pair",
    "plate",
    "hole",
    "surface",
    "camera",
    "image",
    "u_px",
    "v_px",
    "incl_x_deg",
    "incl_y_deg",
    "sigma_mm",
    "sigma_deg",
    "sigma_px",
];

type Row = BTreeMap<&'static str, String>;

impl Cell {
    /// Around an arm as it really is.
    pub fn around(
        (kinds, links): (Vec<JointKind>, Vec<[f64; 5]>),
        tool: Vector3<f64>,
        sigmas: Sigmas,
        rng: &mut impl Rng,
    ) -> Self {
        let pinhole = [1800.0, 1802.0, 640.0, 512.0];
        let tilt = |rng: &mut _, by: f64| Rotation3::from_scaled_axis(vector(rng) * by);
        let normals = [Vector3::z(), Vector3::x(), Vector3::y()];
        let planes =
            normals.map(|n| (tilt(rng, 0.1) * n, -0.55 - 0.1 * rng.random_range(0.0..1.0)));
        let grid = |k: usize| Vector3::new((k % 5) as f64, (k / 5) as f64, 0.0) * 0.1;
        Self {
            kinds,
            links,
            tool,
            turn: tilt(rng, 0.1),
            base: rigid(&vector(rng), &Vector3::from_fn(|_, _| rng.random_range(-3.0..3.0))),
            anchors: [[1.6, 0.3, -0.2], [-0.7, 1.5, 0.1], [0.2, -1.3, 0.9]]
                .map(Vector3::from)
                .to_vec(),
            planes: planes.to_vec(),
            sphere: (Vector3::new(0.6, 0.3, 0.1), 0.12),
            cylinder: (Vector3::new(-0.5, 0.5, 0.3), Vector3::new(0.3, 0.2, 1.0).normalize(), 0.1),
            plate: rigid(&(vector(rng) * 0.1), &Vector3::new(0.35, -0.25, 0.05)),
            holes: (0..25).map(grid).collect(),
            camera: Camera {
                place: rigid(&(vector(rng) * 0.05), &Vector3::new(0.04, 0.06, 0.05)),
                in_hand: true,
                pinhole,
                brown: [-0.1, 0.05, 5e-4, -4e-4, 0.0],
            },
            up: tilt(rng, 0.01) * Vector3::z(),
            sigmas,
        }
    }

    /// The last frame in the arm's.
    pub fn flange(&self, q: &[f64]) -> Matrix<f64> {
        let joints = self.kinds.iter().zip(&self.links).zip(q);
        joints.fold(oracle::identity(), |m, ((kind, link), q)| {
            oracle::product(&m, &oracle::link(*kind, *link, *q))
        })
    }

    /// The target in the arm's frame, m.
    pub fn target(&self, q: &[f64]) -> Vector3<f64> {
        apply(&self.flange(q), &self.tool)
    }

    fn axes(&self, q: &[f64]) -> Matrix3<f64> {
        rotation(&self.flange(q)) * self.turn.matrix()
    }

    /// A file of so many rows of each kind.
    pub fn file(&self, wanted: &[(&'static str, usize)], rng: &mut impl Rng) -> String {
        let mut rows = Vec::new();
        for (kind, count) in wanted {
            for number in 0..*count {
                rows.extend(self.measure(kind, number, rng));
            }
        }
        self.text(&rows)
    }

    fn text(&self, rows: &[(Vec<f64>, Row)]) -> String {
        let names = self.kinds.iter().enumerate().map(|(j, kind)| {
            let unit = if *kind == JointKind::Revolute { "deg" } else { "mm" };
            format!("q{}_{unit}", j + 1)
        });
        let header: Vec<String> = names.chain(COLUMNS.map(str::to_owned)).collect();
        let line = |(q, row): &(Vec<f64>, Row)| {
            let joint = |(q, kind): (&f64, &JointKind)| match kind {
                JointKind::Revolute => format!("{:.11}", q.to_degrees()),
                JointKind::Prismatic => format!("{:.10}", q * 1e3),
            };
            let joints = q.iter().zip(&self.kinds).map(joint);
            let cells = COLUMNS.map(|c| row.get(c).cloned().unwrap_or_default());
            joints.chain(cells).collect::<Vec<String>>()
        };
        csv(std::iter::once(header).chain(rows.iter().map(line)))
    }

    /// Anywhere.
    pub fn pose(&self, rng: &mut impl Rng) -> Vec<f64> {
        let any = |kind: &JointKind| match kind {
            JointKind::Revolute => rng.random_range(-2.6..2.6),
            JointKind::Prismatic => rng.random_range(0.0..1.5),
        };
        self.kinds.iter().map(any).collect()
    }

    /// Joint values near a random pose at which all of these are nothing.
    fn solved(&self, zero: impl Fn(&[f64]) -> DVector<f64>, rng: &mut impl Rng) -> Vec<f64> {
        'anew: loop {
            let mut q = self.pose(rng);
            for _ in 0..60 {
                let now = zero(&q);
                if now.amax() < 1e-13 {
                    return q;
                }
                let mut jacobian = DMatrix::zeros(now.len(), q.len());
                for j in 0..q.len() {
                    let by = |step: f64| {
                        let mut moved = q.clone();
                        moved[j] += step;
                        zero(&moved)
                    };
                    jacobian.set_column(j, &((by(1e-6) - by(-1e-6)) / 2e-6));
                }
                let Ok(step) = jacobian.svd(true, true).solve(&now, 1e-9) else { continue 'anew };
                let shorter = (0.4 / step.amax()).min(1.0);
                q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q -= step * shorter);
                if q.iter().any(|q| q.abs() > 3.0) {
                    continue 'anew;
                }
            }
        }
    }

    fn measure(
        &self,
        kind: &'static str,
        number: usize,
        rng: &mut impl Rng,
    ) -> Vec<(Vec<f64>, Row)> {
        let mm = |m: f64| format!("{:.8}", m * 1e3);
        let noise = |rng: &mut _| self.sigmas.length * normal(rng);
        let mut row = Row::from([
            ("kind", kind.to_owned()),
            ("sigma_mm", mm(self.sigmas.length)),
            ("sigma_deg", format!("{:.9}", self.sigmas.angle.to_degrees())),
            ("sigma_px", format!("{}", self.sigmas.pixel)),
        ]);
        let mut say = |column: &'static str, value: String| drop(row.insert(column, value));
        let q = match kind {
            "point" | "pose" => {
                let q = self.pose(rng);
                let seen = apply(&self.base, &self.target(&q)) + vector(rng) * self.sigmas.length;
                ["x_mm", "y_mm", "z_mm"]
                    .into_iter()
                    .zip(seen.iter())
                    .for_each(|(c, x)| say(c, mm(*x)));
                if kind == "pose" {
                    let wrong = Rotation3::from_scaled_axis(vector(rng) * self.sigmas.angle);
                    let turn = wrong.matrix() * rotation(&self.base) * self.axes(&q);
                    let turn = Rotation3::from_matrix_unchecked(turn);
                    let axis = turn.scaled_axis();
                    let (sin, cos) = (axis.norm() / 2.0).sin_cos();
                    let v = axis / axis.norm().max(1e-12) * sin;
                    let all = [v.x, v.y, v.z, cos];
                    let names = ["qx", "qy", "qz", "qw"];
                    names.into_iter().zip(all).for_each(|(c, x)| say(c, format!("{x:.12}")));
                }
                q
            }
            "distance" => {
                let (q, anchor) = (self.pose(rng), number % self.anchors.len());
                let far = (self.target(&q) - self.anchors[anchor]).norm() + noise(rng);
                say("distance_mm", mm(far));
                say("anchor", format!("A{anchor}"));
                q
            }
            "pair" => {
                let (q, other) = (self.pose(rng), self.pose(rng));
                let far = (self.target(&q) - self.target(&other)).norm() + noise(rng);
                say("pair", format!("{number}"));
                let first = (other, row.clone());
                row.insert("distance_mm", mm(far));
                return vec![first, (q, row)];
            }
            "touch" => {
                let (plane, off) = (number % self.planes.len(), noise(rng));
                let (normal, far) = self.planes[plane];
                say("surface", format!("P{plane}"));
                let from = |q: &[f64]| (self.target(q)).dot(&normal) - far - off;
                self.solved(|q| DVector::repeat(1, from(q)), rng)
            }
            "sphere" => {
                let off = noise(rng);
                say("kind", "touch".to_owned());
                say("surface", "ball".to_owned());
                let from =
                    |q: &[f64]| (self.target(q) - self.sphere.0).norm() - self.sphere.1 - off;
                // From outside: the last frame stands farther off.
                loop {
                    let q = self.solved(|q| DVector::repeat(1, from(q)), rng);
                    let flange = apply(&self.flange(&q), &Vector3::zeros());
                    if (flange - self.sphere.0).norm() > self.sphere.1 {
                        break q;
                    }
                }
            }
            "cylinder" => {
                let off = noise(rng);
                say("kind", "touch".to_owned());
                say("surface", "pipe".to_owned());
                let (point, axis, radius) = self.cylinder;
                let from = |q: &[f64]| (self.target(q) - point).cross(&axis).norm() - radius - off;
                loop {
                    let q = self.solved(|q| DVector::repeat(1, from(q)), rng);
                    if (self.target(&q) - point).dot(&axis).abs() < 0.5 {
                        break q;
                    }
                }
            }
            "plate" => {
                let hole = rng.random_range(0..self.holes.len());
                let there =
                    apply(&self.plate, &self.holes[hole]) + vector(rng) * self.sigmas.length;
                say("plate", "plate".to_owned());
                say("hole", format!("H{hole}"));
                self.solved(
                    |q| DVector::from_column_slice((self.target(q) - there).as_slice()),
                    rng,
                )
            }
            "closure" => {
                let point = self.anchors[number % 3] * 0.5 + vector(rng) * self.sigmas.length;
                say("anchor", format!("C{}", number % 3));
                self.solved(
                    |q| DVector::from_column_slice((self.target(q) - point).as_slice()),
                    rng,
                )
            }
            "range" => loop {
                let (q, plane) = (self.pose(rng), number % self.planes.len());
                let (normal, far) = self.planes[plane];
                let way = self.axes(&q).column(2).into_owned();
                let range = (far - normal.dot(&self.target(&q))) / normal.dot(&way);
                if (0.05..2.0).contains(&range) && normal.dot(&way).abs() > 0.4 {
                    say("distance_mm", mm(range + noise(rng)));
                    say("surface", format!("P{plane}"));
                    break q;
                }
            },
            "inclination" => loop {
                let q = self.pose(rng);
                let sines = self.axes(&q).transpose() * self.up;
                if sines.x.abs().max(sines.y.abs()) < 0.7 {
                    for (c, name) in ["incl_x_deg", "incl_y_deg"].into_iter().enumerate() {
                        let angle = sines[c].asin() + self.sigmas.angle * normal(rng);
                        say(name, format!("{:.10}", angle.to_degrees()));
                    }
                    break q;
                }
            },
            "pixel" => return self.image(number, rng),
            other => panic!("no kind {other}"),
        };
        vec![(q, row)]
    }

    /// All corners of the board that one exposure sees.
    fn image(&self, number: usize, rng: &mut impl Rng) -> Vec<(Vec<f64>, Row)> {
        let camera = &self.camera;
        let middle = apply(
            &self.plate,
            &(self.holes.iter().sum::<Vector3<f64>>() / self.holes.len() as f64),
        );
        loop {
            // Somewhere above the board, looking down at its middle.
            let eye = middle
                + Vector3::new(
                    rng.random_range(-0.35..0.35),
                    rng.random_range(-0.35..0.35),
                    rng.random_range(0.45..0.8),
                );
            let aim = middle + vector(rng) * 0.03;
            let look = (aim - eye).normalize();
            let roll = rng.random_range(-0.8..0.8_f64);
            let side = Vector3::new(roll.cos(), roll.sin(), 0.0);
            let y = look.cross(&side).normalize();
            let wanted = Matrix3::from_columns(&[y.cross(&look), y, look]);
            let off = |q: &[f64]| {
                let seen = oracle::product(&self.flange(q), &camera.place);
                let at = apply(&seen, &Vector3::zeros()) - eye;
                let turn = Rotation3::from_matrix_unchecked(rotation(&seen) * wanted.transpose());
                let turn = turn.scaled_axis();
                DVector::from_vec(vec![at.x, at.y, at.z, turn.x, turn.y, turn.z])
            };
            let q = self.solved(off, rng);
            let seen = oracle::product(&self.flange(&q), &camera.place);
            let mut rows = Vec::new();
            for (k, hole) in self.holes.iter().enumerate() {
                let there = apply(&self.plate, hole) - apply(&seen, &Vector3::zeros());
                let Some(place) = self.project(&(rotation(&seen).transpose() * there)) else {
                    continue;
                };
                let [u, v] = place.map(|x| x + self.sigmas.pixel * normal(rng));
                rows.push((
                    q.clone(),
                    Row::from([
                        ("kind", "pixel".to_owned()),
                        ("camera", "cam".to_owned()),
                        ("image", format!("{number}")),
                        ("plate", "plate".to_owned()),
                        ("hole", format!("H{k}")),
                        ("u_px", format!("{u:.6}")),
                        ("v_px", format!("{v:.6}")),
                        ("sigma_px", format!("{}", self.sigmas.pixel)),
                    ]),
                ));
            }
            if rows.len() > self.holes.len() / 2 {
                return rows;
            }
        }
    }

    /// Where the image has a point of the camera's frame, px.
    fn project(&self, point: &Vector3<f64>) -> Option<[f64; 2]> {
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

    /// What is stated beside the rows: coordinates of holes, forms of surfaces, the
    /// camera from its data sheet and a tape measure.
    pub fn stated(&self, known_radius: bool) -> String {
        let mut out = String::from("[[plates]]\nlabel = \"plate\"\n[plates.holes]\n");
        for (k, hole) in self.holes.iter().enumerate() {
            let [x, y, z] = [hole.x, hole.y, hole.z].map(|x| x * 1e3);
            let _ = writeln!(out, "H{k} = [{x}, {y}, {z}]");
        }
        let radius = |r: f64| match known_radius {
            true => format!("radius_mm = {}\n", r * 1e3),
            false => String::new(),
        };
        for (label, shape, r) in
            [("ball", "sphere", self.sphere.1), ("pipe", "cylinder", self.cylinder.2)]
        {
            let radius = radius(r);
            let _ = write!(out, "[[surfaces]]\nlabel = \"{label}\"\nshape = \"{shape}\"\n{radius}");
        }
        let [fx, fy, cx, cy] = self.camera.pinhole;
        let place = self.camera.place;
        let at = [0, 1, 2].map(|i| (place[i][3] * 1e3).round());
        let _ = write!(
            out,
            "[[cameras]]\nlabel = \"cam\"\nmounted = \"flange\"\nguess = true\nxyz_mm = {at:?}\n\
             rpy_deg = [0.0, 0.0, 0.0]\nfocal_px = [{fx}, {fy}]\ncentre_px = [{cx}, {cy}]\n\
             distortion = {:?}\n",
            self.camera.brown
        );
        out
    }
}

fn rotation(m: &Matrix<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| m[i][j])
}
