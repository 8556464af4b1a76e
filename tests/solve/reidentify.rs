//! Re-identification from a few points, on an oracle of 4x4 matrices.

use crate::arms;
use crate::common::{forward, identity, ur10, ur10_on_a_rail};
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::check_point::CheckPoint;
use truearm::effects::{Effect, Term};
use truearm::measurement::MeasurementError;
use truearm::parameters::{Axis, Parameter, apply};
use truearm::reidentify::{Reidentified, Reidentify, ReidentifyError};
use truearm::streaming::{Lambda, Settings};
use truearm::{Approach, Arm, ArmParameters, JointKind, Link, LinkParameter, Pose, Scalar, State};

const TOOL: [f64; 3] = [0.06, -0.025, 0.11];

fn stored<T: Scalar>() -> ArmParameters<'static, T, 6> {
    arms::stored(ur10(), TOOL)
}

/// The arm after an accident: what changed, where the tracker stands.
#[derive(Clone, Copy)]
struct Truth {
    links: [[f64; 5]; 6],
    tool: [f64; 3],
    station: Pose<f64>,
}

impl Truth {
    fn same() -> Self {
        let links = ur10().map(|l| l.parameters.to_array());
        Self { links, tool: TOOL, station: Pose::identity() }
    }

    /// Joints 2 and 5 slipped, the tool was bent.
    fn crashed() -> Self {
        let mut truth = Self::same();
        truth.links[1][2] += 0.008;
        truth.links[4][2] -= 0.015;
        truth.tool = [TOOL[0] + 0.002, TOOL[1] - 0.003, TOOL[2] + 0.001];
        truth
    }

    fn point(&self, q: &[f64; 6]) -> Vector3<f64> {
        let mut x: Vec<f64> = self.links.iter().flatten().copied().collect();
        x.extend([0.0; 6]);
        x.extend(self.tool);
        let m = forward(&[JointKind::Revolute; 6], &identity(), &x, q);
        self.station.transform_point(&Vector3::new(m[0][3], m[1][3], m[2][3]))
    }
}

fn somewhere() -> Pose<f64> {
    let r = Rotation3::from_euler_angles(0.7, -2.1, 2.8);
    Pose { rotation: Matrix3::from_fn(|i, j| r[(i, j)]), translation: Vector3::new(2.0, -1.5, 0.4) }
}

fn joints(rng: &mut ChaCha8Rng) -> [f64; 6] {
    core::array::from_fn(|_| rng.random_range(-2.5..2.5))
}

fn measured<T: Scalar>(
    truth: &Truth,
    count: usize,
    noise: f64,
    seed: u64,
) -> Vec<CheckPoint<T, 6>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let points = (0..count).map(|_| {
        let q = joints(&mut rng);
        let mut p = truth.point(&q);
        for v in p.iter_mut() {
            // Sum of twelve: normal enough.
            let sum: f64 = (0..12).map(|_| rng.random_range(-0.5..0.5)).sum();
            *v += noise * sum;
        }
        let p = Vector3::new(T::from_f64(p.x), T::from_f64(p.y), T::from_f64(p.z));
        CheckPoint::plain(q.map(T::from_f64), p, T::from_f64(20.0))
    });
    points.collect()
}

/// RMS distance of the arm from the truth over other poses, m; the truth's
/// station is left out, it is not the arm's.
fn error<T: Scalar>(parameters: &ArmParameters<T, 6>, truth: &Truth) -> f64 {
    let arm = Arm::new(parameters);
    let truth = Truth { station: Pose::identity(), ..*truth };
    let mut rng = ChaCha8Rng::seed_from_u64(999);
    let sum: f64 = (0..200)
        .map(|_| {
            let q = joints(&mut rng);
            let p = arm.real_pose(&q.map(T::from_f64)).translation.map(T::to_f64);
            (p - truth.point(&q)).norm_squared()
        })
        .sum();
    (sum / 200.0).sqrt()
}

const CRASHED: [Parameter; 5] = [
    Parameter::JointOffset(1),
    Parameter::JointOffset(4),
    Parameter::TOOL[0],
    Parameter::TOOL[1],
    Parameter::TOOL[2],
];

const MOVED: [Parameter; 11] = {
    let mut all = [Parameter::STATION[0]; 11];
    let mut i = 0;
    while i < 11 {
        all[i] = if i < 6 { Parameter::STATION[i] } else { CRASHED[i - 6] };
        i += 1;
    }
    all
};

#[test]
fn exact_points_give_the_arm_back() {
    let truth = Truth::crashed();
    assert!(error(&stored::<f64>(), &truth) > 5e-3);
    let task = Reidentify::new(&stored(), CRASHED, 2e-5);
    let found = task.run(&stored(), &measured(&truth, 10, 0.0, 1)).unwrap();
    // The prior of 20 mrad pulls by (sigma / scale)^2.
    assert!(error(&found.parameters, &truth) < 1e-8, "{found:?}");
    assert!((found.change[0] - 0.008).abs() < 1e-7 && (found.change[1] + 0.015).abs() < 1e-7);
    assert_eq!((found.rank, found.determined), (5, [true; 5]));
    assert_eq!(found.parameters.sequence, 42);
    assert!(found.rms_before > 3e-3 && found.rms_after < 1e-8);
    assert!(found.steps <= 5);
    let in_f32 = Reidentify::new(&stored(), CRASHED, 2e-5_f32);
    let found = in_f32.run(&stored(), &measured(&truth, 10, 0.0, 1)).unwrap();
    assert!(error(&found.parameters, &truth) < 1e-6);
}

#[test]
fn a_moved_tracker_is_found_from_anywhere() {
    let truth = Truth { station: somewhere(), ..Truth::crashed() };
    let found = Reidentify::new(&stored(), MOVED, 2e-5)
        .run(&stored(), &measured(&truth, 10, 0.0, 2))
        .unwrap();
    assert!(error(&found.parameters, &truth) < 1e-7);
    assert!((found.station.translation - truth.station.translation).norm() < 1e-7);
    assert_eq!((found.rank, found.determined), (11, [true; 11]));
    let in_f32 = Reidentify::new(&stored(), MOVED, 2e-5_f32);
    let found = in_f32.run(&stored(), &measured(&truth, 10, 0.0, 2)).unwrap();
    assert!(error(&found.parameters, &truth) < 5e-6, "{}", error(&found.parameters, &truth));
}

#[test]
fn sigma_is_what_noise_does() {
    let (truth, noise) = (Truth::crashed(), 2e-5);
    let task = Reidentify::new(&stored(), CRASHED, noise);
    let (mut square, mut predicted) = (0.0, 0.0);
    for seed in 0..200 {
        let found = task.run(&stored(), &measured(&truth, 10, noise, seed)).unwrap();
        square += ((found.change[0] - 0.008) / found.sigma[0]).powi(2) / 200.0;
        square += ((found.change[3] + 0.003) / found.sigma[3]).powi(2) / 200.0;
        predicted += 2.0 / 200.0;
    }
    // Chi-square of 400 degrees: 0.07 relative standard deviation.
    assert!((square / predicted - 1.0_f64).abs() < 0.25, "{square}");
}

/// A turned last joint is a moved tool; an offset of joint 1 a turned base.
/// Few points near each other and many unknowns: a weak direction trembles in `f32`, by more than
/// a fixed threshold and by little of what it is uncertain by.
#[test]
fn single_precision_settles_wherever_double_does() {
    let unknowns: [Parameter; 13] = core::array::from_fn(|k| match k {
        0..6 => Parameter::STATION[k],
        6..10 => Parameter::JointOffset(k as u8 - 5),
        _ => Parameter::TOOL[k - 10],
    });
    let about = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    for count in [5, 10] {
        for _ in 0..60 {
            let mut truth = Truth::same();
            for link in &mut truth.links[1..5] {
                link[2] += rng.random_range(-1e-3..1e-3);
            }
            let point = |_| {
                let near = about.map(|q: f64| f64::from((q + rng.random_range(-0.2..0.2)) as f32));
                let noise = Vector3::from_fn(|_, _| rng.random_range(-35e-6..35e-6));
                (near, truth.point(&near) + noise)
            };
            let points: Vec<([f64; 6], Vector3<f64>)> = (0..count).map(point).collect();
            let single: Vec<_> = points
                .iter()
                .map(|(q, p)| CheckPoint::plain(q.map(|q| q as f32), p.map(|p| p as f32), 20.0))
                .collect();
            let double: Vec<_> =
                points.iter().map(|(q, p)| CheckPoint::plain(*q, *p, 20.0)).collect();
            let (own, exact) = (stored::<f32>(), stored::<f64>());
            let single = Reidentify::new(&own, unknowns, 20e-6).run(&own, &single).unwrap();
            let double = Reidentify::new(&exact, unknowns, 20e-6).run(&exact, &double).unwrap();
            for ((a, b), sigma) in single.change.iter().zip(double.change).zip(double.sigma) {
                let off = (f64::from(*a) - b).abs() / sigma;
                assert!(off < 0.05, "{count} points: {off} of what it is uncertain by");
            }
        }
    }
}

#[test]
fn what_the_points_cannot_tell_is_said() {
    let [x, y, z] = Parameter::TOOL;
    let chosen = [Parameter::JointOffset(5), x, y, z];
    let task = Reidentify::new(&stored(), chosen, 2e-5);
    let found = task.run(&stored(), &measured(&Truth::same(), 10, 0.0, 3)).unwrap();
    assert_eq!(found.rank, 3);
    // 20 mrad are 1.3 mm at this tool, whose prior is 20 mm.
    assert_eq!(found.determined, [false, true, true, true]);
    let mut chosen = [Parameter::JointOffset(0); 7];
    chosen[..6].copy_from_slice(&Parameter::STATION);
    let task = Reidentify::new(&stored(), chosen, 2e-5);
    let found = task.run(&stored(), &measured(&Truth::same(), 10, 0.0, 3)).unwrap();
    assert_eq!(found.rank, 6);
    assert!(!found.determined[6]);
    // What is not known is left as it was.
    assert!(found.change[6].abs() < 1e-6);
    // Base and tracker together: the base's prior is what places either.
    let mut chosen = [Parameter::BASE[0]; 12];
    chosen[..6].copy_from_slice(&Parameter::BASE);
    chosen[6..].copy_from_slice(&Parameter::STATION);
    let task = Reidentify::new(&stored(), chosen, 2e-5);
    let found = task.run(&stored(), &measured(&Truth::same(), 10, 0.0, 3)).unwrap();
    assert_eq!((found.rank, &found.determined[..6]), (6, &[false; 6][..]));
    assert!(found.sigma[6..].iter().all(|sigma| (sigma - 0.02_f64).abs() < 1e-4));
}

#[test]
fn any_parameter_can_be_chosen_and_terms_keep_acting() {
    let mut parameters = stored::<f64>();
    let term = |effect, joint, coefficient| Term {
        effect,
        joint,
        source: 0,
        component: 0,
        order: 1.0,
        coefficient,
    };
    parameters.terms.push(term(Effect::EncoderEccentricity, 2, 2e-3)).unwrap();
    parameters.terms.push(term(Effect::JointGain, 1, 1e-3)).unwrap();
    let mut bent = parameters.clone();
    bent.corrections[2].a = 0.0015;
    bent.corrections[3].beta = -0.002;
    let arm = Arm::new(&bent);
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let points: Vec<_> = (0..10)
        .map(|_| {
            let q = joints(&mut rng);
            let state =
                State { approach: [Approach::Positive; 6], payload: 2.0, ..State::at(30.0) };
            CheckPoint { q, state, point: arm.real_pose_in(&q, &state).translation }
        })
        .collect();
    let link = |joint, parameter| Parameter::Link { joint, parameter };
    let chosen = [link(2, LinkParameter::A), link(3, LinkParameter::Beta)];
    let found = Reidentify::new(&parameters, chosen, 1e-5).run(&parameters, &points).unwrap();
    assert!((found.change[0] - 0.0015).abs() < 1e-6 && (found.change[1] + 0.002).abs() < 1e-6);
    let rest = ArmParameters { corrections: bent.corrections, ..found.parameters };
    assert_eq!(rest, ArmParameters { sequence: 42, rms_before: 0.0, rms_after: 0.0, ..bent });
}

/// When, and how well, is of the set that was stored; where it holds is kept.
#[test]
fn what_is_found_does_not_claim_the_record_of_what_was_stored() {
    let ranges = [Some([-1.0, 1.0]); 6];
    let was = ArmParameters { created: 1_700_000_000, covered: ranges, ..stored::<f64>() };
    let points = measured(&Truth::crashed(), 40, 0.0, 1);
    let at_once = Reidentify::new(&was, CRASHED, 2e-5).run(&was, &points).unwrap().parameters;
    let mut stream = Settings::new(&was, CRASHED, 2e-5).start(&was).unwrap();
    for point in &points {
        stream.push(point).unwrap();
    }
    let streamed = stream.identified(Lambda::Prior).unwrap().parameters;
    for found in [at_once, streamed] {
        assert_eq!((found.created, found.rms_before, found.rms_after), (0, 0.0, 0.0));
        assert_eq!((found.sequence, found.covered), (42, was.covered));
    }
}

/// A base that came loose, on the floor or under a rail, and how stiff a joint is: what
/// an arm borrows from the vocabulary is found like an offset.
fn a_loosened_base_is_found<T: Scalar, const N: usize>(links: [Link<f64>; N], exact: f64) {
    let (was, truth) = (arms::stored::<T, N>(links, TOOL), arms::stored(links, TOOL));
    for seed in 0..10 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut real = truth.clone();
        let moved: [f64; 6] = core::array::from_fn(|_| rng.random_range(-0.01..0.01));
        apply(&mut real, &Parameter::BASE, &moved);
        let mut tracker = arms::Tracker::<T, N>::new(&real, 0.0, seed);
        let sigma = T::from_f64(2e-5);
        let task = Reidentify::new(&was, Parameter::BASE, sigma);
        let found = task.run(&was, &tracker.points(10)).unwrap();
        assert!(tracker.error(&was) > 1e-3);
        assert!(tracker.error(&found.parameters) < exact, "seed {seed}: {found:?}");
        assert_eq!((found.rank, found.determined), (6, [true; 6]));
        let same = ArmParameters {
            base_translation: was.base_translation,
            base_rotation: was.base_rotation,
            sequence: was.sequence,
            rms_before: was.rms_before,
            rms_after: was.rms_after,
            ..found.parameters
        };
        assert_eq!(same, was);
    }
}

#[test]
fn a_loosened_base_is_found_on_the_floor_and_under_a_rail() {
    a_loosened_base_is_found::<f64, 6>(ur10(), 1e-7);
    a_loosened_base_is_found::<f64, 7>(ur10_on_a_rail(), 1e-7);
    a_loosened_base_is_found::<f32, 6>(ur10(), 3e-6);
    a_loosened_base_is_found::<f32, 7>(ur10_on_a_rail(), 3e-6);
}

/// Coefficients of terms beside an offset.
#[test]
fn coefficients_of_terms_are_found() {
    let mut was = stored::<f64>();
    arms::with_terms(&mut was);
    let chosen: Vec<_> = [0, 2, 4, 5].into_iter().map(Parameter::Term).collect();
    let chosen = [Parameter::JointOffset(1), chosen[0], chosen[1], chosen[2], chosen[3]];
    let mut real = was.clone();
    let by = chosen.map(|parameter| 0.3 * parameter.usual_scale(&was));
    apply(&mut real, &chosen, &by);
    let (arm, mut rng) = (Arm::new(&real), ChaCha8Rng::seed_from_u64(8));
    let points: Vec<_> = (0..30)
        .map(|_| {
            let (q, state) = (joints(&mut rng), arms::state(&mut rng));
            CheckPoint { q, state, point: arm.real_pose_in(&q, &state).translation }
        })
        .collect();
    let found = Reidentify::new(&was, chosen, 1e-6).run(&was, &points).unwrap();
    for (k, parameter) in chosen.iter().enumerate() {
        let error = (found.change[k] - by[k]).abs() / parameter.usual_scale(&was);
        assert!(error < 1e-4, "{parameter}: {error:e} {found:?}");
    }
    assert_eq!(found.determined, [true; 5]);
}

#[test]
fn bad_input_is_an_error_that_names_it() {
    let good = measured::<f64>(&Truth::same(), 10, 0.0, 5);
    let run = |chosen: [Parameter; 5], sigma: f64, points: &[CheckPoint<f64, 6>]| {
        Reidentify::new(&stored(), chosen, sigma).run(&stored(), points).map(|_| ())
    };
    assert_eq!(run(CRASHED, 1e-5, &good), Ok(()));
    assert_eq!(
        run(CRASHED, 1e-5, &good[..1]),
        Err(ReidentifyError::TooFewEquations { equations: 3, needed: 5 })
    );
    assert_eq!(
        run(CRASHED, 1e-5, &[]),
        Err(ReidentifyError::TooFewEquations { equations: 0, needed: 5 })
    );
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(run(CRASHED, sigma, &good), Err(ReidentifyError::BadSigma));
    }
    let theta_of_joint_2 = Parameter::Link { joint: 1, parameter: LinkParameter::Theta };
    let all = [
        Parameter::JointOffset(6),
        Parameter::Term(0),
        Parameter::StationRotation(Axis::Y),
        // The same as an offset that is there.
        theta_of_joint_2,
    ];
    for (before, parameter) in all.into_iter().enumerate() {
        let (mut chosen, index) = (CRASHED, before + 1);
        chosen[index] = parameter;
        let expected = ReidentifyError::BadParameter { index, parameter };
        assert_eq!(run(chosen, 1e-5, &good), Err(expected));
        // Counted from 1 in a text.
        let said = expected.to_string();
        assert!(said.contains(&format!("parameter {},", index + 1)), "{said}");
    }
    let mut points = good.clone();
    points[3].state.temperature = f64::NAN;
    let not_finite = ReidentifyError::BadMeasurement { index: 3, why: MeasurementError::NotFinite };
    assert_eq!(run(CRASHED, 1e-5, &points), Err(not_finite));
    // Only joint 6 turns, and the tool lies on its axis but for a hair: a line.
    let mut line = good.clone();
    for (i, point) in line.iter_mut().enumerate() {
        point.q = good[0].q;
        point.point = good[0].point + Vector3::new(i as f64, 0.0, 0.0) * 1e-3;
    }
    let moved = Reidentify::new(&stored(), MOVED, 1e-5).run(&stored(), &line);
    assert_eq!(moved.map(|_| ()), Err(ReidentifyError::PointsOnALine));
}

/// What would be ignored in the answer must not make it look surer or settled.
#[test]
fn a_bad_scale_is_refused_by_name() {
    let points = measured::<f64>(&Truth::crashed(), 10, 0.0, 5);
    let good = Reidentify::new(&stored(), MOVED, 2e-5);
    for (index, parameter) in MOVED.into_iter().enumerate() {
        let finite: &[f64] = if parameter.is_station() { &[1e-9, 1.0] } else { &[] };
        for scale in [0.0, -1.0, f64::NAN].iter().chain(finite) {
            let mut task = good;
            task.scale[index] = *scale;
            let error = task.run(&stored(), &points).unwrap_err();
            assert_eq!(error, ReidentifyError::BadScale { index, parameter }, "{scale}");
            let must = if index < 6 { "infinite" } else { "positive" };
            let place = index + 1;
            assert!(
                error
                    .to_string()
                    .contains(&format!("parameter {place}, {parameter}, must be {must}"))
            );
        }
    }
}

fn finite(found: &Reidentified<f32, 6, 11>) -> bool {
    let p = &found.parameters;
    let links = p.corrections.iter().flat_map(|c| c.to_array());
    let numbers = links.chain(p.tool.iter().copied()).chain(found.change).chain(found.sigma);
    let station = found.station.rotation.iter().chain(found.station.translation.iter()).copied();
    numbers.chain(station).chain([found.rms_before, found.rms_after]).all(|v| v.is_finite())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn no_nan_comes_out(
        seed in 0_u64..1000,
        exponent in -3.0..38.0_f32,
        which in 0..10_usize,
        sigma in prop_oneof![Just(2e-5_f32), any::<f32>()],
        bad in any::<f32>(),
        scale in prop_oneof![Just(0.02_f32), any::<f32>()],
    ) {
        let mut points = measured::<f32>(&Truth::crashed(), 10, 1e-5, seed);
        points[which].point.x = 10_f32.powf(exponent);
        points[which].q[which % 6] = bad;
        let mut task = Reidentify::new(&stored(), MOVED, sigma);
        task.scale[7] = scale;
        match task.run(&stored::<f32>(), &points) {
            Ok(found) => prop_assert!(finite(&found), "{found:?}"),
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}
