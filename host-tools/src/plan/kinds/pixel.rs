//! Images: of a board from a camera in hand or of one in hand from a camera that stands
//! still, of a point that does not move, or of the marker. A board shows the side that the
//! z of its frame points to, and at least half of its corners are in the image.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;

use super::{Candidate, Spot, placed, some};
use crate::error::Result;
use crate::model::{Form, Instrument, PlannedRow};
use crate::observations::pixel::{is_unfolded, project};
use crate::plan::cell::{Cell, direction};

/// How near anything may be to a camera, m.
const NEAREST: f64 = 0.05;
/// A single point is looked at from so far, m.
const POINT: [f64; 2] = [0.3, 0.8];
/// A board from so far, where 1 fills the image.
const FILLED: [f64; 2] = [0.5, 1.5];
/// Least sine by which a camera stands above the plane of a board.
const STEEP: f64 = 0.4;
/// How far aside of its normal a board is looked at, tangent.
const ASIDE: f64 = 1.0;
/// Corners without which an image says little.
const FEWEST: usize = 4;

/// One a camera and board; where there is no board, a camera and point, or a camera alone,
/// which then sees the marker.
pub fn spots(cell: &Cell) -> Result<Vec<Box<dyn Spot>>> {
    let table = "[[cameras]] with label, xyz_mm, rpy_deg, focal_px and centre_px";
    let cameras: Vec<&Instrument> =
        some(cell.book.of(&[Form::Camera]).collect(), "pixel", "camera", table)?;
    let mut all: Vec<Box<dyn Spot>> = Vec::new();
    for camera in cameras {
        placed(camera, "cameras", "xyz_mm and rpy_deg")?;
        let image = cell.book.range_of(Form::Camera, &camera.label).unwrap_or([f64::INFINITY; 2]);
        let view =
            |thing, corners, label| View { camera: camera.clone(), image, thing, corners, label };
        let before = all.len();
        for board in cell.book.of(&[Form::Plate]).filter(|b| b.on_flange != camera.on_flange) {
            placed(board, "plates", "xyz_mm and rpy_deg")?;
            let corners = cell.book.holes_of(&board.label);
            all.push(Box::new(view(Some(board.clone()), corners, "plate")));
        }
        if all.len() == before && camera.on_flange {
            let points = cell.book.of(&[Form::Anchor]).map(|anchor| -> Box<dyn Spot> {
                let corners = vec![(String::new(), Vector3::zeros())];
                Box::new(view(Some(anchor.clone()), corners, "anchor"))
            });
            all.extend(points);
        } else if all.len() == before {
            let corners = vec![(String::new(), Vector3::zeros())];
            all.push(Box::new(view(None, corners, "")));
        }
    }
    some(all, "pixel", "board or point for the camera to see", "[[plates]] or [[anchors]]")
}

struct View {
    camera: Instrument,
    /// Width and height, px.
    image: [f64; 2],
    /// A board or a point; else the marker.
    thing: Option<Instrument>,
    /// What is seen of it, in its frame.
    corners: Vec<(String, Vector3<f64>)>,
    /// The column that names the thing.
    label: &'static str,
}

impl Spot for View {
    fn name(&self) -> String {
        let seen = self.thing.as_ref().map_or_else(
            || "the marker".to_owned(),
            |thing| format!("{} \"{}\"", thing.form.name(), thing.label),
        );
        format!("an image of {seen} by camera \"{}\"", self.camera.label)
    }

    fn draw(&self, cell: &Cell, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let q = match &self.thing {
            None => cell.anywhere(rng)?,
            Some(thing) => {
                let (eye, camera, own) = (self.eye(rng), &self.camera.place, &thing.place);
                let flange = match self.camera.on_flange {
                    true => own.compose(&eye).compose(&camera.inverse()),
                    false => camera.compose(&eye.inverse()).compose(&own.inverse()),
                };
                cell.near(&flange, &cell.start(rng))?
            }
        };
        let seen = self.seen(cell, &q)?;
        let enough = self.corners.len().div_ceil(2).max(FEWEST.min(self.corners.len()));
        let row = |corner: &str| {
            let mut labels = vec![("camera", self.camera.label.clone())];
            labels.extend(self.thing.iter().map(|thing| (self.label, thing.label.clone())));
            labels.extend((!corner.is_empty()).then(|| ("hole", corner.to_owned())));
            PlannedRow { q: q.clone(), labels }
        };
        (seen.len() >= enough).then(|| seen.into_iter().map(row).collect())
    }
}

impl View {
    /// A place of the camera in the frame of what it looks at.
    fn eye(&self, rng: &mut ChaCha8Rng) -> Pose<f64> {
        let count = self.corners.len() as f64;
        let middle = self.corners.iter().map(|(_, c)| c).sum::<Vector3<f64>>() / count;
        let radius = self.corners.iter().map(|(_, c)| (c - middle).norm()).fold(0.0, f64::max);
        let is_board = radius > 0.0;
        let far = if is_board {
            (radius / self.opening()).max(NEAREST) * rng.random_range(FILLED[0]..FILLED[1])
        } else {
            rng.random_range(POINT[0]..POINT[1])
        };
        let from = match is_board {
            true => {
                let mut aside = || rng.random_range(-ASIDE..ASIDE);
                Vector3::new(aside(), aside(), 1.0).normalize()
            }
            false => direction(rng),
        };
        let aim = middle + direction(rng) * 0.3 * radius;
        let eye = middle + from * far;
        let look = (aim - eye).normalize();
        let roll = rng.random_range(-PI..PI);
        let x = crate::plan::cell::across(&look);
        let y = look.cross(&x);
        let x = x * f64::cos(roll) + y * f64::sin(roll);
        Pose { rotation: Matrix3::from_columns(&[x, look.cross(&x), look]), translation: eye }
    }

    /// Tangent of the angle from the axis to the nearest border of the image.
    fn opening(&self) -> f64 {
        let near = |k: usize| {
            let [focal, centre] = [self.camera.numbers[k], self.camera.numbers[2 + k]];
            let centre = centre * 1e3;
            centre.min(self.image[k] - centre).max(1.0) / (focal * 1e3)
        };
        near(0).min(near(1))
    }

    /// The corners that are in the image; `None` from behind the board.
    fn seen(&self, cell: &Cell, q: &[f64]) -> Option<Vec<&str>> {
        let camera = cell.mounted(self.camera.on_flange, &self.camera.place, q);
        let place = match &self.thing {
            Some(thing) => cell.mounted(thing.on_flange, &thing.place, q),
            None => cell.target(q),
        };
        let eye = place.inverse().transform_point(&camera.translation);
        if self.corners.len() > 1 && eye.z < STEEP * eye.norm() {
            return None;
        }
        let seen = |(_, corner): &&(String, Vector3<f64>)| {
            let local = camera.inverse().transform_point(&place.transform_point(corner));
            local.z > NEAREST && self.is_inside(&local)
        };
        Some(self.corners.iter().filter(seen).map(|(label, _)| label.as_str()).collect())
    }

    /// Whether a point of the camera's frame is in the image of its lens, and in that of a
    /// pinhole twice as large: far aside Brown's polynomials are of no lens.
    fn is_inside(&self, local: &Vector3<f64>) -> bool {
        let at = project(&self.camera, local).at;
        is_unfolded(&self.camera, local)
            && (0..2).all(|k| {
                let [focal, centre] =
                    [self.camera.numbers[k] * 1e3, self.camera.numbers[2 + k] * 1e3];
                let straight = focal * local[k] / local.z + centre;
                let size = self.image[k];
                (0.0..=size).contains(&at[k]) && (-0.5 * size..=1.5 * size).contains(&straight)
            })
    }
}
