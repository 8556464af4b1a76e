//! A cell with more in it than a tracker: anchors, planes, a plate, a sphere, a
//! cylinder, a camera; and what each of them measures of an arm. All of it from
//! 4x4 matrices: what must be touched is found by Newton steps of difference
//! quotients. Nothing here comes from the crate.

mod camera;
mod planned;
mod rows;
mod scanner;

use std::collections::BTreeMap;
use std::fmt::Write;

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};
use rand::{Rng, RngExt};
use truearm::JointKind;

use crate::arm::Arm;
use crate::body::apply;
use crate::oracle::{self, Matrix};
use crate::{at_rest, csv, rigid, vector};
pub use scanner::{Scanner, apart};

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
    /// The same arm with what it does beyond rigid geometry; none where it does nothing.
    pub bent: Option<Arm>,
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

/// Springs come to rest to 1e-12 rad; what is touched is met to so much, m.
const AT_REST: f64 = 1e-9;

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
            bent: None,
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
        if let Some(arm) = &self.bent {
            return arm.last_frame(&at_rest(q));
        }
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
            if *kind == "pixel" {
                rows.extend(self.images(*count, rng));
                continue;
            }
            for number in 0..*count {
                rows.extend(self.measure(kind, number, rng));
            }
        }
        self.text(&rows)
    }

    /// A file of points or poses at joint values that somebody chose.
    pub fn file_at(&self, kind: &str, poses: &[Vec<f64>], rng: &mut impl Rng) -> String {
        let rows: Vec<_> = poses.iter().map(|q| self.tracked_at(kind, q, rng)).collect();
        self.text(&rows)
    }

    fn text(&self, rows: &[(Vec<f64>, Row)]) -> String {
        let names = self.kinds.iter().enumerate().map(|(j, kind)| {
            let unit = if *kind == JointKind::Revolute { "deg" } else { "mm" };
            format!("q{}_{unit}", j + 1)
        });
        // Labels of markers only where there is more than one.
        let labels = rows.iter().any(|(_, row)| row.contains_key("marker"));
        let columns = || COLUMNS.into_iter().chain(labels.then_some("marker"));
        let header: Vec<String> = names.chain(columns().map(str::to_owned)).collect();
        let line = |(q, row): &(Vec<f64>, Row)| {
            let joint = |(q, kind): (&f64, &JointKind)| match kind {
                JointKind::Revolute => format!("{:.11}", q.to_degrees()),
                JointKind::Prismatic => format!("{:.10}", q * 1e3),
            };
            let joints = q.iter().zip(&self.kinds).map(joint);
            let cells = columns().map(|c| row.get(c).cloned().unwrap_or_default());
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

    /// Joint values near a random pose at which the target is where all of these are
    /// nothing: of the rigid arm first, from where the bent one is near.
    fn solved(&self, zero: impl Fn(Vector3<f64>) -> DVector<f64>, rng: &mut impl Rng) -> Vec<f64> {
        let rigid = Self { bent: None, ..self.clone() };
        loop {
            let found = rigid.near(self.pose(rng), &|q| zero(rigid.target(q)), 1e-13);
            let bent = match &self.bent {
                Some(_) => found.and_then(|q| self.near(q, &|q| zero(self.target(q)), AT_REST)),
                None => found,
            };
            if let Some(q) = bent {
                return q;
            }
        }
    }

    /// The same near these, to so much; `None` where that leads nowhere.
    fn near(
        &self,
        mut q: Vec<f64>,
        zero: &impl Fn(&[f64]) -> DVector<f64>,
        much: f64,
    ) -> Option<Vec<f64>> {
        for _ in 0..30 {
            let now = zero(&q);
            if now.amax() < much {
                return Some(q);
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
            let step = jacobian.svd(true, true).solve(&now, 1e-9).ok()?;
            let shorter = (0.4 / step.amax()).min(1.0);
            q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q -= step * shorter);
            if q.iter().any(|q| q.abs() > 3.0) {
                return None;
            }
        }
        None
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
