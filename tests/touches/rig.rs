//! What is touched, where it really is, and an arm that touches it.

use nalgebra::{Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::measurement::{Anchor, Measurement, Plane, Reading};
use truearm::parameters::{Axis, Parameter};
use truearm::{Arm, Scalar, State};

use super::arms::{joints, vector};
use super::common::ur10;
use super::{RADIUS, Stored, Taken};

pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random_range(1e-12..1.0), rng.random_range(0.0..1.0));
    (-2.0 * a.ln()).sqrt() * (core::f64::consts::TAU * b).cos()
}

pub fn anywhere(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

/// A plane by its definition: a point, a normal, how far it lies below where it is stated.
#[derive(Clone, Copy)]
pub struct Face {
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
}

impl Face {
    pub fn anywhere(rng: &mut ChaCha8Rng) -> Self {
        Self { point: anywhere(rng), normal: anywhere(rng).normalize() }
    }

    pub fn height(&self, p: &Vector3<f64>) -> f64 {
        self.normal.dot(&(p - self.point))
    }

    pub fn plane<T: Scalar>(&self) -> Plane<T> {
        Plane::new(vector(self.point.into()), vector(self.normal.into())).unwrap()
    }

    /// Turned about its point by a rotation whose tangent is |w| and that is about `w`, of
    /// which the part along the normal turns nothing; then moved along its normal.
    pub fn moved(&self, w: &Vector3<f64>, offset: f64) -> Self {
        let across = w - self.normal * w.dot(&self.normal);
        let angle = across.norm().atan();
        let turned = match across.norm() > 0.0 {
            true => Rotation3::new(across.normalize() * angle) * self.normal,
            false => self.normal,
        };
        Self { point: self.point + turned * offset, normal: turned }
    }
}

/// What is touched, and where it really is.
#[derive(Clone, Copy)]
pub enum Thing {
    Face(Face),
    Ball(Vector3<f64>),
}

impl Thing {
    pub fn value(&self, p: &Vector3<f64>) -> f64 {
        match self {
            Self::Face(face) => face.height(p),
            Self::Ball(ball) => (p - ball).norm(),
        }
    }

    /// A reading of it, where it is stated to be; of unknown place under the label 3.
    pub fn reading<T: Scalar>(&self, unknown: bool, value: T) -> Reading<T> {
        match self {
            Self::Face(face) if unknown => {
                Reading::Height { plane: face.plane().unknown(3), height: value }
            }
            Self::Face(face) => Reading::Height { plane: face.plane(), height: value },
            Self::Ball(ball) => {
                let anchor = Anchor::new(vector((*ball).into()));
                let anchor = if unknown { anchor.unknown(3) } else { anchor };
                Reading::Distance { anchor, distance: value }
            }
        }
    }

    pub fn moved(&self, parameter: Parameter, by: f64) -> Self {
        let along =
            |axis: Axis| Vector3::from_fn(|k, _| if Axis::ALL[k] == axis { by } else { 0.0 });
        let none = Vector3::zeros();
        match (*self, parameter) {
            (Self::Face(face), Parameter::PlaneRotation { axis, .. }) => {
                Self::Face(face.moved(&along(axis), 0.0))
            }
            (Self::Face(face), Parameter::PlaneOffset(_)) => Self::Face(face.moved(&none, by)),
            (Self::Ball(ball), Parameter::AnchorTranslation { axis, .. }) => {
                Self::Ball(ball + along(axis))
            }
            (same, _) => same,
        }
    }
}

/// The arm after an accident, and what is read of it, exact but for noise.
pub struct Bench {
    real: Arm<'static, f64, 6>,
    noise: f64,
    rng: ChaCha8Rng,
}

impl Bench {
    pub fn new(real: &Stored<f64>, noise: f64, seed: u64) -> Self {
        Self { real: Arm::new(real), noise, rng: ChaCha8Rng::seed_from_u64(seed) }
    }

    /// Joint values as `T` has them, and where the tool then is.
    pub fn pose<T: Scalar>(&mut self) -> ([T; 6], Vector3<f64>) {
        let q = joints(&ur10(), &mut self.rng).map(T::from_f64);
        (q, self.real.real_pose(&q.map(T::to_f64)).translation)
    }

    /// A reading of a thing that is said to be at `stated`, of unknown place or not.
    pub fn taken<T: Scalar>(&mut self, real: &Thing, stated: &Thing, unknown: bool) -> Taken<T> {
        let (q, point) = self.pose();
        let value = real.value(&point) + normal(&mut self.rng) * self.noise;
        let reading = stated.reading(unknown, T::from_f64(value));
        Measurement { q, state: State::at(T::from_f64(20.0)), reading }
    }

    /// A touch with the ball: the arm comes down on the face by a joint that moves it there.
    pub fn touch<T: Scalar>(&mut self, face: &Face, stated: Plane<T>) -> Taken<T> {
        loop {
            let (q, _) = self.pose::<T>();
            let mut q = q.map(T::to_f64);
            let trigger = RADIUS + normal(&mut self.rng) * self.noise;
            let height = |q: &[f64; 6]| face.height(&self.real.real_pose(q).translation) - trigger;
            for _ in 0..20 {
                let mut further = q;
                further[1] += 1e-6;
                q[1] -= 1e-6 * height(&q) / (height(&further) - height(&q));
            }
            // As an encoder has it, which an f32 must hold.
            let read = q.map(T::from_f64);
            if height(&read.map(T::to_f64)).abs() < 2e-6 && q[1].abs() < 3.0 {
                return stated.touched(read, T::from_f64(RADIUS), T::from_f64(20.0));
            }
        }
    }
}
