//! Arms that miss by millimetres, of several kinds, and where their tools are.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::Blob;
use truearm::effects::{Effect, Masses, Term};
use truearm::{
    Approach, Arm, ArmParameters, Curves, JointKind, Link, MdhParameters, Pose, Scalar, Settings,
    State, Task,
};

/// Which terms an arm has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Terms {
    /// None.
    None,
    /// Compliance, a gear error, temperature: none that jumps.
    Smooth,
    /// Play as well.
    All,
}

/// Corrections of up to `most` (m, rad) and terms of the sizes of real arms.
pub fn parameters<T: Scalar, const N: usize>(
    links: &[Link<f64>; N],
    most: f64,
    terms: Terms,
) -> ArmParameters<'static, T, N> {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut number = |most: f64| T::from_f64(rng.random_range(-most..most));
    let nominal = links.map(|link| Link {
        kind: link.kind,
        parameters: MdhParameters::from_array(link.parameters.to_array().map(T::from_f64)),
    });
    let corrections = [(); N].map(|()| MdhParameters::from_array([(); 5].map(|()| number(most))));
    let mut vector = |most: f64| Vector3::new(number(most), number(most), number(most));
    let masses = Masses {
        gravity: Vector3::new(T::ZERO, T::ZERO, T::from_f64(-9.81)),
        mass: [T::from_f64(6.0); N],
        com: [(); N].map(|()| vector(0.2)),
        payload_com: vector(0.1),
    };
    let term = |effect, joint, component, order: f64, coefficient: f64| Term {
        effect,
        joint,
        source: 0,
        component,
        order: T::from_f64(order),
        coefficient: T::from_f64(coefficient),
    };
    let all = [
        term(Effect::JointCompliance, 1, 0, 0.0, 2e-5),
        term(Effect::JointPeriodicError, 2, 0, 20.0, 2e-4),
        term(Effect::JointPeriodicError, 3, 1, 128.0, 4e-5),
        term(Effect::BaseCompliance, 0, 0, 0.0, 1e-6),
        term(Effect::ThermalExpansion, Term::<f64>::ALL, 0, 0.0, 2e-5),
        term(Effect::Backlash, 0, 0, 0.0, 1e-4),
        term(Effect::Backlash, 1, 0, 5.0, 1e-4),
    ];
    let count = match terms {
        Terms::None => 0,
        Terms::Smooth => 5,
        Terms::All => 7,
    };
    ArmParameters {
        robot_id: 1,
        sequence: 1,
        created: 0,
        nominal,
        corrections,
        base_translation: vector(1e-3),
        base_rotation: vector(1e-3),
        tool: vector(0.2),
        terms: heapless::Vec::from_slice(&all[..count]).unwrap(),
        curves: Curves::NONE,
        masses: Some(masses),
        reference_temperature: T::from_f64(20.0),
        limits: [None; N],
        covered: [Some([-T::ONE, T::ONE]); N],
        rms_before: T::ZERO,
        rms_after: T::ZERO,
        orientation_identified: true,
    }
}

/// A shipped blob, with the orientation taken as identified.
pub fn shipped<T: Scalar>(bytes: &'static [u8]) -> ArmParameters<'static, T, 6> {
    let parameters = Blob::check(bytes).unwrap().parameters().unwrap();
    ArmParameters { orientation_identified: true, ..parameters }
}

pub const UR10: &[u8] = include_bytes!("../data/firmware/ur10.blob");
pub const UR10_TERMS: &[u8] = include_bytes!("../data/firmware/ur10-terms.blob");

/// Seven turning joints, neighbours across each other, as of a KUKA iiwa.
pub fn seven() -> [Link<f64>; 7] {
    const H: f64 = core::f64::consts::FRAC_PI_2;
    let row = |alpha, d| Link::revolute(alpha, 0.0, 0.0, d, 0.0);
    [
        row(0.0, 0.36),
        row(-H, 0.0),
        row(H, 0.42),
        row(H, 0.0),
        row(-H, 0.4),
        row(-H, 0.0),
        row(H, 0.126),
    ]
}

/// A UR10 hung on a rail along x.
pub fn rail() -> [Link<f64>; 7] {
    const H: f64 = core::f64::consts::FRAC_PI_2;
    let [a, b, c, d, e, f] = super::common::ur10();
    let rail = Link::prismatic(H, 0.0, 0.0, 0.1, 0.0);
    let first = Link::revolute(-H, 0.0, 0.0, a.parameters.d, 0.0);
    [rail, first, b, c, d, e, f]
}

pub fn state<T: Scalar, const N: usize>() -> State<T, N> {
    State {
        approach: [Approach::Positive; N],
        payload: T::from_f64(3.0),
        temperature: T::from_f64(27.0),
        torque: None,
    }
}

/// A command anywhere in the joint space: three quarters of a turn either way,
/// a metre either way on a rail.
pub fn anywhere<T: Scalar, const N: usize>(rng: &mut ChaCha8Rng, arm: &Arm<T, N>) -> [T; N] {
    arm.nominal().links().map(|link| match link.kind {
        JointKind::Revolute => T::from_f64(rng.random_range(-4.7..4.7)),
        JointKind::Prismatic => T::from_f64(rng.random_range(-1.0..1.0)),
    })
}

/// How far the tool is from its target at `joints`, m, as the law weighs it:
/// the position, or for a pose `sqrt(|dp|^2 + rotation_length^2 |dw|^2)`. In
/// f64, from the poses alone.
pub fn miss<T: Scalar, const N: usize>(
    arm: &Arm<T, N>,
    command: &[T; N],
    joints: &[T; N],
    state: &State<T, N>,
    settings: &Settings<T, N>,
) -> f64 {
    let wide =
        |pose: Pose<T>| (pose.translation.map(Scalar::to_f64), pose.rotation.map(Scalar::to_f64));
    let (p, r) = wide(arm.nominal().forward(command));
    let (q, s) = wide(arm.real_pose_in(joints, state));
    let position = (p - q).norm();
    if settings.task == Task::Position {
        return position;
    }
    let turn = r.transpose() * s;
    let sine = Vector3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    )
    .norm()
        / 2.0;
    let angle = sine.atan2((turn.trace() - 1.0) / 2.0);
    position.hypot(settings.rotation_length.to_f64() * angle)
}
