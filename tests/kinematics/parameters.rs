//! The vocabulary of parameters: each column is the derivative of what applying the
//! parameter does, on arms of every kind.

use crate::arms::{joints, state, stored, vector, with_terms};
use crate::common::{puma, scara, ur10, ur10_on_a_rail};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::{Blob, encode_with, encoded_len, factor_len};
use truearm::parameters::{Axis, Parameter, apply};
use truearm::{Arm, ArmParameters, JointKind, Link, LinkParameter, Pose, Scalar, State};

const TOOL: [f64; 3] = [0.06, -0.025, 0.11];

/// A production tool outlives the parameters; where none was given the point that is
/// measured goes with them.
#[test]
fn other_parameters_keep_the_production_tool() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let mut found = was.clone();
    Parameter::JointOffset(1).apply(&mut found, 4e-3);
    Parameter::TOOL[0].apply(&mut found, 2e-3);
    let q = [0.3, -1.0, 1.3, 0.2, -0.7, 0.9];
    let tool = Pose::from_rotation_vector(vector([0.0, 0.1, 0.2]), vector([0.3, 0.0, -0.4]));
    let arm = Arm::new(&was).with_tool(tool).with_parameters(&found);
    let expected = Arm::new(&found).with_tool(tool);
    assert_eq!(arm, expected);
    assert_eq!(arm.with_parameters(&was), Arm::new(&was).with_tool(tool), "and again");
    assert!(
        (arm.real_pose(&q).translation - Arm::new(&found).real_pose(&q).translation).norm() > 0.1
    );
    assert_eq!(Arm::new(&was).with_parameters(&found), Arm::new(&found));
}

/// All of an arm's, under all of their names.
fn all<const N: usize>(arm: &ArmParameters<'_, f64, N>) -> Vec<Parameter> {
    let offsets = (0..N as u8).map(Parameter::JointOffset);
    Parameter::of_arm(N as u8, arm.terms.len() as u8).chain(offsets).collect()
}

fn moved<const N: usize>(
    arm: &ArmParameters<'static, f64, N>,
    rng: &mut ChaCha8Rng,
) -> ArmParameters<'static, f64, N> {
    let mut arm = arm.clone();
    let mut small = || vector(core::array::from_fn(|_| rng.random_range(-0.01..0.01)));
    (arm.base_translation, arm.base_rotation) = (small(), small());
    arm
}

/// Column and difference quotient; as far apart as a share of the longest column.
fn derivative_holds<const N: usize>(
    arm: &ArmParameters<'static, f64, N>,
    links: &[Link<f64>; N],
    seed: u64,
    share: f64,
) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let arm = moved(arm, &mut rng);
    let (q, state): (_, State<f64, N>) = (joints(links, &mut rng), state(&mut rng));
    let folded = Arm::new(&arm);
    let at = folded.linearised(&q, &state);
    assert_eq!(at.point(), folded.real_pose_in(&q, &state).translation);
    // A tracker sees the same, turned and from elsewhere.
    let station =
        Pose::from_rotation_vector(Vector3::new(0.3, -2.0, 0.7), Vector3::new(0.4, -1.1, 2.0));
    let seen = folded.linearised(&q, &state).seen_from(&station);
    assert!((seen.point() - station.transform_point(&at.point())).norm() < 1e-12);
    for parameter in all(&arm) {
        let column = parameter.column(&at);
        let turned = station.rotation * column;
        assert!((parameter.column(&seen) - turned).norm() < 1e-12 * column.norm().max(1.0));
        let step = 1e-6;
        let [before, after] = [-step, step].map(|step| {
            let mut there = arm.clone();
            parameter.apply(&mut there, step);
            Arm::new(&there).real_pose_in(&q, &state).translation
        });
        let quotient = (after - before) / (2.0 * step);
        let bound = share * quotient.norm().max(1.0);
        assert!((quotient - column).norm() < bound, "{parameter}: {quotient:?} {column:?}");
        // In single precision the same.
        let in_f32 = single(&arm);
        let folded = Arm::new(&in_f32);
        let state = State {
            approach: state.approach,
            payload: state.payload as f32,
            temperature: state.temperature as f32,
            torque: None,
        };
        let column32 = parameter.column(&folded.linearised(&q.map(|q| q as f32), &state));
        assert!(
            (column32.map(f64::from) - column).norm() < 1e-4 * column.norm().max(1.0),
            "{parameter}"
        );
    }
}

fn single<const N: usize>(arm: &ArmParameters<'static, f64, N>) -> ArmParameters<'static, f32, N> {
    let mut out = stored::<f32, N>(arm.nominal, arm.tool.into());
    out.base_translation = arm.base_translation.map(|v| v as f32);
    out.base_rotation = arm.base_rotation.map(|v| v as f32);
    if !arm.terms.is_empty() {
        slightly_bent(&mut out);
    }
    out
}

/// Every effect, at a tenth of the usual size: columns are those of the arm that terms
/// do not bend, and what they leave out goes with how far the terms bend it.
fn slightly_bent<T: Scalar, const N: usize>(arm: &mut ArmParameters<'static, T, N>) {
    with_terms(arm);
    arm.terms.iter_mut().for_each(|term| term.coefficient *= T::from_f64(0.1));
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 40,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_column_is_the_derivative_of_applying(seed in any::<u64>()) {
        derivative_holds(&stored(ur10(), TOOL), &ur10(), seed, 1e-7);
        derivative_holds(&stored(puma(), TOOL), &puma(), seed, 1e-7);
        derivative_holds(&stored(scara(), TOOL), &scara(), seed, 1e-7);
        derivative_holds(&stored(ur10_on_a_rail(), TOOL), &ur10_on_a_rail(), seed, 1e-7);
    }

    /// Columns leave out how lengths grow and base and axes tilt.
    #[test]
    fn of_terms_too(seed in any::<u64>()) {
        let (mut six, mut seven) = (stored(ur10(), TOOL), stored(ur10_on_a_rail(), TOOL));
        slightly_bent(&mut six);
        slightly_bent(&mut seven);
        derivative_holds(&six, &ur10(), seed, 5e-3);
        derivative_holds(&seven, &ur10_on_a_rail(), seed, 5e-3);
    }

    /// One rotation, in whatever order its parts are given; up to half a turn.
    #[test]
    fn rotations_of_the_base_are_one(
        w in prop::array::uniform3(-1.5..1.5_f64),
        r in prop::array::uniform3(-1.5..1.5_f64),
        exponent in -9.0..0.0_f64,
        turned in 0..3_usize,
    ) {
        let w = w.map(|w| w * 10_f64.powf(exponent));
        let mut arm = stored::<f64, 6>(ur10(), TOOL);
        arm.base_rotation = vector(r);
        let mut chosen = Axis::ALL.map(Parameter::BaseRotation);
        let mut steps = w;
        chosen.rotate_left(turned);
        steps.rotate_left(turned);
        apply(&mut arm, &chosen, &steps);
        let expected = Rotation3::new(Vector3::from(w)) * Rotation3::new(Vector3::from(r));
        let pose = Pose::from_rotation_vector(Vector3::zeros(), arm.base_rotation);
        prop_assert!((pose.rotation - expected.matrix()).norm() < 1e-14);
        prop_assert!(arm.base_rotation.norm() < core::f64::consts::PI + 1e-12);
    }

    #[test]
    fn a_rotation_vector_comes_back(
        v in prop::array::uniform3(-1.0..1.0_f64),
        half_turns in 0.0..0.99999_f64,
        exponent in -12.0..0.0_f64,
    ) {
        fn back<T: Scalar>(v: Vector3<f64>) -> f64 {
            let given = v.map(T::from_f64);
            let pose = Pose::from_rotation_vector(vector([0.0; 3]), given);
            (pose.rotation_vector().map(T::to_f64) - v).norm()
        }
        let Some(axis) = Vector3::from(v).try_normalize(1e-3) else { return Ok(()) };
        let v = axis * half_turns * core::f64::consts::PI * 10_f64.powf(exponent);
        prop_assert!(back::<f64>(v) < 1e-14, "{v:?}");
        prop_assert!(back::<f32>(v) < 1e-6, "{v:?}");
        prop_assert!(back::<f32>(v) < 1e-6 * v.norm().max(1e-2), "{v:?}");
    }
}

#[test]
fn a_joint_offset_knows_its_joint() {
    let arm = stored::<f64, 7>(ur10_on_a_rail(), TOOL);
    let link = |joint, parameter| Parameter::Link { joint, parameter };
    for (joint, nominal) in (0..7).zip(&arm.nominal) {
        let offset = Parameter::JointOffset(joint);
        let slides = nominal.kind == JointKind::Prismatic;
        let own = if slides { LinkParameter::D } else { LinkParameter::Theta };
        assert_eq!(offset.canonical(&arm.nominal), link(joint, own));
        assert_eq!(offset.unit(&arm), if slides { "m" } else { "rad" });
        for parameter in LinkParameter::ALL {
            let this = link(joint, parameter);
            let scale = if parameter == own { 0.02 } else { 0.001 };
            assert_eq!(this.usual_scale(&arm), scale, "{this}");
            assert_eq!(this.unit(&arm), if parameter.is_length() { "m" } else { "rad" });
        }
        assert_eq!(offset.usual_scale(&arm), 0.02);
        assert_eq!(offset.to_string(), format!("joint offset of joint {}", joint + 1));
    }
}

#[test]
fn what_an_arm_does_not_have_leaves_it_alone() {
    let mut arm = stored::<f64, 6>(ur10(), TOOL);
    with_terms(&mut arm);
    let terms = arm.terms.len() as u8;
    let link = Parameter::Link { joint: 6, parameter: LinkParameter::A };
    let folded = Arm::new(&arm);
    let at = folded.linearised(&[0.3; 6], &folded.state());
    for parameter in [Parameter::JointOffset(6), link, Parameter::Term(terms), Parameter::Term(255)]
    {
        assert!(!parameter.exists_in(&arm));
        assert_eq!(parameter.column(&at), Vector3::zeros());
        assert_eq!((parameter.usual_scale(&arm), parameter.unit(&arm)), (0.0, ""));
        let mut same = arm.clone();
        parameter.apply(&mut same, 1.0);
        assert_eq!(same, arm);
    }
    for parameter in Parameter::STATION {
        assert!(parameter.exists_in(&arm) && parameter.is_station());
        let mut same = arm.clone();
        parameter.apply(&mut same, 1.0);
        assert_eq!(same, arm);
    }
    for parameter in all(&arm) {
        let scale = parameter.usual_scale(&arm);
        assert!(parameter.exists_in(&arm) && scale > 0.0 && scale.is_finite(), "{parameter}");
        assert!(!parameter.unit(&arm).is_empty() && !parameter.is_station());
    }
}

/// A covariance's k-th parameter is the k-th of [`Parameter::of_arm`].
fn covariance_follows<const N: usize>(links: [Link<f64>; N]) {
    let mut arm = stored::<f32, N>(links, TOOL);
    with_terms(&mut arm);
    let terms = arm.terms.len();
    // As a blob has it: orders are rounded there.
    let mut bytes = vec![0; encoded_len(N, terms)];
    let length = encode_with(&arm, None, &mut bytes).unwrap();
    let arm: ArmParameters<'_, f32, N> =
        Blob::check(&bytes[..length]).unwrap().parameters().unwrap();
    let (folded, mut rng) = (Arm::new(&arm), ChaCha8Rng::seed_from_u64(3));
    let q = joints(&links, &mut rng).map(|q| q as f32);
    let state = state(&mut rng);
    let at = folded.linearised(&q, &state);
    let all: Vec<_> = Parameter::of_arm(N as u8, terms as u8).collect();
    let mut diagonal = 0;
    for (k, parameter) in all.iter().enumerate() {
        let mut factor = vec![0.0; factor_len(N, terms)];
        factor[diagonal] = 1e-3;
        diagonal += all.len() - k;
        let mut bytes = vec![0; encoded_len(N, terms) + 4 * factor.len()];
        let length = encode_with(&arm, Some(&factor), &mut bytes).unwrap();
        let blob = Blob::check(&bytes[..length]).unwrap();
        let sigma = blob.covariance().unwrap().point_sigma(&folded, &q, &state).unwrap();
        let column = parameter.column(&at);
        for (sigma, own) in sigma.iter().zip(column.iter()) {
            let error = (*sigma - own.abs() * 1e-3).abs();
            assert!(error < 1e-6 * column.norm().max(1e-3), "{parameter}: {sigma} {own}");
        }
    }
}

#[test]
fn a_covariance_has_the_same_order() {
    covariance_follows(ur10());
    covariance_follows(ur10_on_a_rail());
}
