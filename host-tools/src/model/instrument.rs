//! What was measured with and on: places, sizes and constants beside the arm
//! that a row refers to, known or to be found with it.

use nalgebra::{DMatrix, DVector, Vector3};
use truearm::Pose;

/// What an instrument is, and so which of its numbers mean something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// How the frame of a marker is turned in the last frame; its z is a ray.
    Turn,
    /// A point that does not move: of a ballbar, a draw wire, a cone to touch.
    Anchor,
    /// A plane: the z of its frame points out of it.
    Plane,
    /// A sphere about its origin; its radius.
    Sphere,
    /// A cylinder about its z; its radius.
    Cylinder,
    /// A plate, or a board, with holes, balls or corners of known coordinates.
    Plate,
    /// A camera that looks along its z, x to the right and y down; its constants.
    Camera,
    /// The direction up: z.
    Up,
    /// The ball at the end of a marker; its radius.
    Probe,
    /// What an instrument that measures lengths to the anchor of its label adds to each.
    Zero,
}

/// Names of the six freedoms of a place, about and along its own axes.
const FREEDOMS: [&str; 6] = ["rx", "ry", "rz", "x", "y", "z"];
const RADIUS: &[&str] = &["radius"];
const ZERO: &[&str] = &["offset"];
/// Focal lengths and centre in thousands of pixels, Brown's distortion.
const CAMERA: &[&str] = &["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"];

impl Form {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Turn,
        Self::Anchor,
        Self::Plane,
        Self::Sphere,
        Self::Cylinder,
        Self::Plate,
        Self::Camera,
        Self::Up,
        Self::Probe,
        Self::Zero,
    ];

    /// As in files and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Turn => "marker orientation",
            Self::Anchor => "anchor",
            Self::Plane => "plane",
            Self::Sphere => "sphere",
            Self::Cylinder => "cylinder",
            Self::Plate => "plate",
            Self::Camera => "camera",
            Self::Up => "up",
            Self::Probe => "probe",
            Self::Zero => "zero of anchor",
        }
    }

    /// Which of the six freedoms of its place something depends on: rotations
    /// about its own x, y, z, then shifts along them.
    #[must_use]
    pub fn freedoms(self) -> [bool; 6] {
        let [o, l] = [false, true];
        match self {
            Self::Turn => [l, l, l, o, o, o],
            Self::Anchor | Self::Sphere => [o, o, o, l, l, l],
            Self::Plane => [l, l, o, o, o, l],
            Self::Cylinder => [l, l, o, l, l, o],
            Self::Plate | Self::Camera => [l; 6],
            Self::Up => [l, l, o, o, o, o],
            Self::Probe | Self::Zero => [o; 6],
        }
    }

    /// Names of its numbers.
    #[must_use]
    pub fn numbers(self) -> &'static [&'static str] {
        match self {
            Self::Sphere | Self::Cylinder | Self::Probe => RADIUS,
            Self::Camera => CAMERA,
            Self::Zero => ZERO,
            _ => &[],
        }
    }

    /// Whether a number is a length, m.
    #[must_use]
    pub fn has_lengths(self) -> bool {
        [RADIUS, ZERO].contains(&self.numbers())
    }
}

/// An instrument, or what it is held against.
#[derive(Debug, Clone, PartialEq)]
pub struct Instrument {
    /// What it is.
    pub form: Form,
    /// Its label in the files.
    pub label: String,
    /// Its frame in that of the station, or in the last frame where it is
    /// mounted there, m.
    pub place: Pose<f64>,
    /// Its numbers: radii in m, focal lengths and centre in thousands of pixels.
    pub numbers: Vec<f64>,
    /// Which of the six freedoms of its place and of its numbers are unknown.
    pub free: Vec<bool>,
    /// Whether the place was stated, be it as a guess.
    pub stated: bool,
    /// Whether it moves with the flange.
    pub on_flange: bool,
    /// How well it was found: the factor L of the covariance L L' of the six freedoms of
    /// its place and of its numbers, SI; empty where nothing of it was found.
    pub spread: DMatrix<f64>,
}

impl Instrument {
    /// One of which nothing is known.
    #[must_use]
    pub fn unknown(form: Form, label: &str) -> Self {
        let numbers = vec![0.0; form.numbers().len()];
        let mut free = form.freedoms().to_vec();
        free.extend(numbers.iter().map(|_| true));
        let (label, place) = (label.to_owned(), Pose::identity());
        Self {
            form,
            label,
            place,
            numbers,
            free,
            stated: false,
            on_flange: matches!(form, Form::Turn | Form::Probe),
            spread: DMatrix::zeros(0, 0),
        }
    }

    /// The same, all of it known.
    #[must_use]
    pub fn known(mut self) -> Self {
        self.free.iter_mut().for_each(|free| *free = false);
        self
    }

    /// Which of its numbers are unknown, the six of the place first.
    #[must_use]
    pub fn unknowns(&self) -> Vec<usize> {
        (0..self.free.len()).filter(|k| self.free[*k]).collect()
    }

    /// Whether something of it is fixed where the station is, so that the arm
    /// has a place to be found.
    #[must_use]
    pub fn holds_station(&self) -> bool {
        let place = self.form.freedoms().into_iter().zip(&self.free);
        !self.on_flange && place.into_iter().any(|(has, free)| has && !free)
    }

    /// Name of a number, with the label where there is one.
    #[must_use]
    pub fn name_of(&self, component: usize) -> String {
        let name = match component.checked_sub(6) {
            None => FREEDOMS[component],
            Some(number) => self.form.numbers()[number],
        };
        match self.label.as_str() {
            "" => format!("{} {name}", self.form.name()),
            label => format!("{} {label} {name}", self.form.name()),
        }
    }

    /// Whether a number is a length, m; else an angle or a plain number.
    #[must_use]
    pub fn is_length(&self, component: usize) -> bool {
        match component.checked_sub(6) {
            None => component >= 3,
            Some(_) => self.form.has_lengths(),
        }
    }

    /// The same with what a covariance of its [`Self::unknowns`] says of it, SI.
    #[must_use]
    pub fn found_within(&self, covariance: &DMatrix<f64>) -> Self {
        let (own, all) = (self.unknowns(), self.free.len());
        // Where rounding leaves no factor: no sum of n numbers varies by more than n times
        // their own squares.
        let largest = || {
            let variance = |v: f64| (own.len() as f64 * v.max(0.0)).sqrt();
            DMatrix::from_diagonal(&covariance.diagonal().map(variance))
        };
        let factor = covariance.clone().cholesky().map_or_else(largest, |factor| factor.l());
        let mut spread = DMatrix::zeros(all, all);
        for (i, row) in own.iter().enumerate() {
            own.iter().enumerate().for_each(|(j, column)| spread[(*row, *column)] = factor[(i, j)]);
        }
        Self { spread, ..self.clone() }
    }

    /// Variance of something that moves with its freedoms and numbers like this.
    #[must_use]
    pub fn variance(&self, pull: &DVector<f64>) -> f64 {
        if self.spread.is_empty() { 0.0 } else { self.spread.tr_mul(pull).norm_squared() }
    }

    /// Moved by a step of its unknowns, about and along its own axes.
    #[must_use]
    pub fn moved(&self, step: &[f64]) -> Self {
        let mut out = self.clone();
        let v = |k: usize| Vector3::new(step[k], step[k + 1], step[k + 2]);
        out.place = self.place.compose(&Pose::from_rotation_vector(v(3), v(0)));
        out.numbers.iter_mut().zip(&step[6..]).for_each(|(number, step)| *number += step);
        out
    }

    /// A point of the frame that the place is in, as seen from this one, and how
    /// it moves: with the point itself (3 x 3), and with the six freedoms of the
    /// place (3 x 6).
    #[must_use]
    pub fn local(&self, point: &Vector3<f64>) -> (Vector3<f64>, DMatrix<f64>, DMatrix<f64>) {
        let turn = self.place.rotation.transpose();
        let local = turn * (point - self.place.translation);
        let mut own = DMatrix::zeros(3, 6);
        own.view_mut((0, 0), (3, 3)).copy_from(&local.cross_matrix());
        own.view_mut((0, 3), (3, 3)).copy_from(&-nalgebra::Matrix3::identity());
        (local, DMatrix::from_column_slice(3, 3, turn.as_slice()), own)
    }
}
