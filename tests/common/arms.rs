//! Arms as a controller has them stored, and points measured on what has become of them.

#![allow(dead_code, reason = "each test file uses a part")]

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::check_point::CheckPoint;
use truearm::effects::{ActsOn, Effect, Masses, Order, Term};
use truearm::{
    Approach, Arm, ArmParameters, Curves, JointKind, Link, MdhParameters, Scalar, State,
};

pub fn vector<T: Scalar>(v: [f64; 3]) -> Vector3<T> {
    let [x, y, z] = v.map(T::from_f64);
    Vector3::new(x, y, z)
}

/// An arm of these links, rigid.
pub fn stored<T: Scalar, const N: usize>(
    links: [Link<f64>; N],
    tool: [f64; 3],
) -> ArmParameters<'static, T, N> {
    ArmParameters {
        robot_id: 7,
        sequence: 41,
        created: 0,
        nominal: links.map(|l| Link {
            kind: l.kind,
            parameters: MdhParameters::from_array(l.parameters.to_array().map(T::from_f64)),
        }),
        corrections: [MdhParameters::from_array([T::ZERO; 5]); N],
        base_translation: vector([0.0; 3]),
        base_rotation: vector([0.0; 3]),
        tool: vector(tool),
        terms: truearm::heapless::Vec::new(),
        curves: Curves::NONE,
        masses: None,
        reference_temperature: T::from_f64(20.0),
        limits: [None; N],
        covered: [None; N],
        rms_before: T::from_f64(1e-3),
        rms_after: T::from_f64(2e-5),
        orientation_identified: false,
    }
}

/// A term of every effect, with masses to load them.
pub fn with_terms<T: Scalar, const N: usize>(arm: &mut ArmParameters<'static, T, N>) {
    for (k, effect) in Effect::ALL.iter().enumerate() {
        let lengths = effect.acts_on() == ActsOn::Lengths;
        let joint = if lengths { Term::<T>::ALL } else { (k % N) as u8 };
        let order = match effect.order() {
            Order::None => 0.0,
            Order::Harmonic => 2.0,
            Order::Cycles => 100.0,
            Order::Friction => 5.0,
            Order::TimeConstant => 1500.0,
        };
        let term = Term {
            effect: *effect,
            joint,
            source: ((k + 1) % N) as u8,
            component: (k % 2) as u8,
            order: T::from_f64(order),
            coefficient: T::from_f32(effect.usual() * 0.05),
        };
        arm.terms.push(term).unwrap();
    }
    arm.masses = Some(Masses {
        gravity: vector([0.3, 0.0, -9.8]),
        mass: [T::from_f64(4.0); N],
        com: [vector([0.05, 0.02, 0.1]); N],
        payload_com: vector([0.0, 0.03, 0.1]),
    });
}

/// Joint values all over the place; sliding ones within half a metre.
pub fn joints<const N: usize>(links: &[Link<f64>; N], rng: &mut ChaCha8Rng) -> [f64; N] {
    links.map(|link| match link.kind {
        JointKind::Revolute => rng.random_range(-2.5..2.5),
        JointKind::Prismatic => rng.random_range(-0.5..0.5),
    })
}

/// Any state.
pub fn state<T: Scalar, const N: usize>(rng: &mut ChaCha8Rng) -> State<T, N> {
    State {
        approach: [(); N]
            .map(|()| if rng.random_bool(0.5) { Approach::Positive } else { Approach::Negative }),
        payload: T::from_f64(rng.random_range(0.0..5.0)),
        temperature: T::from_f64(rng.random_range(10.0..40.0)),
        torque: None,
    }
}

/// What a tracker sees of an arm, with so much noise, m.
pub struct Tracker<T: Scalar, const N: usize> {
    links: [Link<f64>; N],
    real: Arm<'static, f64, N>,
    noise: f64,
    rng: ChaCha8Rng,
    scalar: core::marker::PhantomData<T>,
}

impl<T: Scalar, const N: usize> Tracker<T, N> {
    pub fn new(real: &ArmParameters<'static, f64, N>, noise: f64, seed: u64) -> Self {
        let rng = ChaCha8Rng::seed_from_u64(seed);
        let scalar = core::marker::PhantomData;
        Self { links: real.nominal, real: Arm::new(real), noise, rng, scalar }
    }

    fn normal(&mut self) -> f64 {
        let (a, b): (f64, f64) =
            (self.rng.random_range(1e-12..1.0), self.rng.random_range(0.0..1.0));
        (-2.0 * a.ln()).sqrt() * (core::f64::consts::TAU * b).cos()
    }

    pub fn point(&mut self) -> CheckPoint<T, N> {
        let q = joints(&self.links, &mut self.rng);
        // What the arm is given is what it is.
        let q = q.map(|q| T::from_f64(q).to_f64());
        let noise = Vector3::from_fn(|_, _| self.normal()) * self.noise;
        let point = self.real.real_pose(&q).translation + noise;
        let temperature = T::from_f64(20.0);
        CheckPoint::plain(q.map(T::from_f64), vector(point.into()), temperature)
    }

    pub fn points(&mut self, count: usize) -> Vec<CheckPoint<T, N>> {
        (0..count).map(|_| self.point()).collect()
    }

    /// RMS distance of a model from the arm over other poses, m.
    pub fn error(&self, found: &ArmParameters<'_, T, N>) -> f64 {
        let arm = Arm::new(found);
        let mut rng = ChaCha8Rng::seed_from_u64(999);
        let sum: f64 = (0..200)
            .map(|_| {
                let q = joints(&self.links, &mut rng).map(|q| T::from_f64(q).to_f64());
                let seen = arm.real_pose(&q.map(T::from_f64)).translation.map(T::to_f64);
                (seen - self.real.real_pose(&q).translation).norm_squared()
            })
            .sum();
        (sum / 200.0).sqrt()
    }
}
