//! Where a camera's image has a corner of a board, or a target: a pinhole with
//! Brown's distortion. The camera is in hand and the board stands still, or the
//! other way round; a row without a board sees the marker itself, or a point
//! that does not move. Detection happened elsewhere: corners come as pixels.

use nalgebra::{DMatrix, Matrix2x3, Matrix3, Vector3};
use truearm::Pose;

use super::partials::any;
use super::plate::hole;
use super::{ArmPart, Body, Bound, Column, Kind, Measure, Partials, Registry, Seen, Told, Unclear};
use crate::model::{Form, Instrument, Row, Values};

/// Of the columns `camera`, `image` and `plate` with `hole`, or `anchor`.
pub struct Pixel;

const AT: &str = "a pixel needs u_px and v_px";
const FAR: &str = "give it in pixels";
/// Where [`Row::refers`] has what is seen, behind the camera.
const SEEN: usize = 1;

impl Kind for Pixel {
    fn name(&self) -> &'static str {
        "pixel"
    }

    fn columns(&self) -> &'static [Column] {
        &[
            Column { name: "u_px", within: [-1e5, 1e5], missing: AT, wrong: FAR },
            Column { name: "v_px", within: [-1e5, 1e5], missing: AT, wrong: FAR },
        ]
    }

    fn labels(&self) -> &'static [&'static str] {
        &["camera", "image", "plate", "hole", "anchor"]
    }

    fn bind(&self, told: &Told, book: &mut dyn Registry) -> Result<Bound, Unclear> {
        let label = (told.text)("camera");
        let camera = book.known(Form::Camera, label).ok_or_else(|| {
            let help = "give it in instruments.toml: [[cameras]] with label, focal_px, centre_px";
            ("camera", format!("camera \"{label}\" is not known"), help.to_owned())
        })?;
        if !(told.text)("hole").is_empty() {
            let (plate, known) = hole(told, book)?;
            let known = known.iter().copied().collect();
            return Ok(Bound { refers: vec![camera, plate], known });
        }
        let anchor = (told.text)("anchor");
        let anchor = (!anchor.is_empty()).then(|| book.instrument(&[Form::Anchor], anchor));
        let refers = std::iter::once(camera).chain(anchor).collect();
        Ok(Bound { refers, known: Vec::new() })
    }

    fn components(&self) -> &'static [&'static str] {
        &["u", "v"]
    }

    fn measure(&self, _component: usize) -> Measure {
        Measure::Pixel
    }

    fn check(&self) -> &'static str {
        "that u_px and v_px are not swapped (u to the right, v down), the camera's \
         constants and mounting, the labels of corners, and its first guess"
    }

    fn leaves(&self) -> &'static str {
        "where the arm stands; the overall scale where no board has known coordinates"
    }

    fn of_marker(&self, row: &Row) -> bool {
        row.refers.len() <= SEEN
    }

    fn turns(&self) -> bool {
        true
    }

    fn is_image(&self) -> bool {
        true
    }

    fn corner(&self, row: &Row) -> Option<(Vector3<f64>, [f64; 2])> {
        let corner =
            Vector3::new(*row.measured.get(2)?, *row.measured.get(3)?, *row.measured.get(4)?);
        Some((corner, [row.measured[0], row.measured[1]]))
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let row = seen.row(index);
        let sight = Sight::new(index, seen);
        let camera = sight.camera;
        let (local, with_there, with_frame) = camera.local(&sight.there());
        let view = project(camera, &local);
        let with_local = DMatrix::from_column_slice(2, 3, view.with_point.as_slice());
        let with_there = &with_local * with_there;
        let mut of_camera = DMatrix::zeros(2, camera.free.len());
        of_camera.columns_mut(0, 6).copy_from(&(&with_local * with_frame));
        of_camera.columns_mut(6, 9).copy_from(&view.with_numbers);
        let mut instruments = vec![(row.refers[0], of_camera)];
        if let Some((place, thing)) = sight.thing {
            let own = sight.own;
            let axes = thing.place.rotation;
            let mut with_place = DMatrix::zeros(3, thing.free.len());
            with_place.columns_mut(0, 3).copy_from(&any(&(axes * -own.cross_matrix())));
            with_place.columns_mut(3, 3).copy_from(&any(&axes));
            instruments.push((place, &with_there * any(&sight.turn()) * with_place));
        }
        Partials {
            residual: Values::from_fn(2, |c| row.measured[c] - view.at[c]),
            arm: vec![sight.pull(index, &with_there)],
            instruments,
        }
    }
}

/// What a camera sees in one row, and what either hangs on.
struct Sight<'a> {
    camera: &'a Instrument,
    /// The board or the point, with its place in the list; else the marker.
    thing: Option<(usize, &'a Instrument)>,
    /// What is seen, in the frame of the board.
    own: Vector3<f64>,
    /// The same in the frame that the board is mounted in.
    mounted: Vector3<f64>,
    /// The last frame, in the station's.
    flange: Pose<f64>,
}

impl<'a> Sight<'a> {
    fn new(index: usize, seen: &'a dyn Seen) -> Self {
        let (row, pose) = (seen.row(index), seen.pose(index));
        let thing = row.refers.get(SEEN).map(|i| (*i, seen.instrument(*i)));
        let corner = || Vector3::new(row.measured[2], row.measured[3], row.measured[4]);
        let own = if row.measured.len() > 2 { corner() } else { Vector3::zeros() };
        let marker = seen.marker(index);
        let mounted = thing.map_or(marker, |(_, thing)| thing.place.transform_point(&own));
        let translation = pose.translation - pose.rotation * marker;
        let flange = Pose { translation, ..pose };
        Self { camera: seen.instrument(row.refers[0]), thing, own, mounted, flange }
    }

    /// Whether what is seen moves with the flange.
    fn moves(&self) -> bool {
        self.thing.is_none_or(|(_, thing)| thing.on_flange)
    }

    /// From the frame that the board is mounted in to that of the camera.
    fn turn(&self) -> Matrix3<f64> {
        match (self.camera.on_flange, self.moves()) {
            (true, false) => self.flange.rotation.transpose(),
            (false, true) => self.flange.rotation,
            _ => Matrix3::identity(),
        }
    }

    /// What is seen in the frame that the camera is mounted in, m.
    fn there(&self) -> Vector3<f64> {
        match (self.camera.on_flange, self.moves()) {
            (true, false) => self.flange.inverse().transform_point(&self.mounted),
            (false, true) => self.flange.transform_point(&self.mounted),
            _ => self.mounted,
        }
    }

    /// How the arm moves it there.
    fn pull(&self, row: usize, with_there: &DMatrix<f64>) -> ArmPart {
        let mut pull = DMatrix::zeros(2, 6);
        let at = self.flange.translation;
        let lever = match (self.camera.on_flange, self.moves()) {
            // Against the flange, which moves and turns under the camera.
            (true, false) => Some((with_there * any(&self.turn()) * -1.0, self.mounted - at)),
            (false, true) => Some((with_there.clone(), self.there() - at)),
            _ => None,
        };
        if let Some((with_flange, lever)) = lever {
            pull.columns_mut(0, 3).copy_from(&with_flange);
            pull.columns_mut(3, 3).copy_from(&(&with_flange * any(&lever.cross_matrix()) * -1.0));
        }
        if self.thing.is_some() {
            return ArmPart { row, body: Body::Flange, pull };
        }
        // The marker's own place already holds its lever.
        pull.columns_mut(3, 3).fill(0.0);
        ArmPart { row, body: Body::Target, pull }
    }
}

/// A place in an image, px, and how it moves.
pub struct View {
    /// u and v.
    pub at: [f64; 2],
    /// With a point of the camera's frame, px/m.
    pub with_point: Matrix2x3<f64>,
    /// With the camera's numbers.
    pub with_numbers: DMatrix<f64>,
}

/// Steps from the axis to a point at which a lens is looked at.
const STEPS: usize = 32;

/// Whether a lens shows what is farther from its axis farther out, up to this point of its
/// frame: beyond where Brown's polynomial turns back it is of no lens.
#[must_use]
pub fn is_unfolded(camera: &Instrument, point: &Vector3<f64>) -> bool {
    let [k1, k2, k3] = [4, 5, 8].map(|k| camera.numbers[k]);
    let edge = (point.x.powi(2) + point.y.powi(2)) / point.z.powi(2);
    (1..=STEPS).all(|k| {
        let r2 = edge * (k as f64 / STEPS as f64).powi(2);
        1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + 7.0 * r2 * k3)) > 0.0
    })
}

/// Where a camera's image has a point of its frame. Behind the camera a point is
/// taken to be a millimetre before it: a first guess may be.
#[must_use]
pub fn project(camera: &Instrument, point: &Vector3<f64>) -> View {
    let [fx, fy, cx, cy, k1, k2, p1, p2, k3] = core::array::from_fn(|k| camera.numbers[k]);
    let depth = point.z.max(1e-3);
    let (x, y) = (point.x / depth, point.y / depth);
    let r2 = x * x + y * y;
    let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
    let slope = k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3);
    let u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
    let v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
    let du = [
        radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
        2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
    ];
    let dv = [
        2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
        radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
    ];
    // Numbers are in thousands of pixels.
    let [fx, fy, cx, cy] = [fx, fy, cx, cy].map(|px| px * 1e3);
    let row = |f: f64, d: [f64; 2]| [d[0], d[1], -(d[0] * x + d[1] * y)].map(|w| f * w / depth);
    let (with_u, with_v) = (row(fx, du), row(fy, dv));
    let mut with_point = Matrix2x3::from_rows(&[with_u.into(), with_v.into()]);
    if point.z < 1e-3 {
        with_point.column_mut(2).fill(0.0);
    }
    let r4 = r2 * r2;
    let of_u = [1e3 * u, 0.0, 1e3, 0.0, fx * x * r2, fx * x * r4, fx * 2.0 * x * y];
    let of_v = [0.0, 1e3 * v, 0.0, 1e3, fy * y * r2, fy * y * r4, fy * (r2 + 2.0 * y * y)];
    let rest = [[fx * (r2 + 2.0 * x * x), fx * x * r4 * r2], [fy * 2.0 * x * y, fy * y * r4 * r2]];
    let all = of_u.iter().chain(&rest[0]).chain(&of_v).chain(&rest[1]).copied();
    let with_numbers = DMatrix::from_row_iterator(2, 9, all);
    View { at: [fx * u + cx, fy * v + cy], with_point, with_numbers }
}
