//! Streaming identification of an arm: measured points in, parameters of the arm out.

use crate::arms::{Tracker, joints, stored, vector};
use crate::common::{puma, scara, ur10, ur10_on_a_rail};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::check_point::CheckPoint;
use truearm::measurement::MeasurementError;
use truearm::parameters::{Axis, Parameter};
use truearm::reidentify::Reidentify;
use truearm::solve::SolveError;
use truearm::streaming::{Lambda, Settings, StreamingError, StreamingIdentification};
use truearm::{ArmParameters, Link, LinkParameter, Scalar};

const TOOL: [f64; 3] = [0.06, -0.025, 0.11];
const SIGMA: f64 = 2e-5;
const P: usize = 8;
type Stored<T, const N: usize> = ArmParameters<'static, T, N>;

/// Three offsets, three of links, two of the tool: all but the base's and the last joint's.
fn chosen() -> [Parameter; P] {
    let link = |joint, parameter| Parameter::Link { joint, parameter };
    let [x, y, _] = Parameter::TOOL;
    let [a, b, c] = [1, 2, 3].map(Parameter::JointOffset);
    [
        a,
        b,
        c,
        link(1, LinkParameter::A),
        link(2, LinkParameter::Beta),
        link(2, LinkParameter::A),
        x,
        y,
    ]
}

/// The arm with every chosen parameter changed by up to `share` of its usual scale.
fn changed<const N: usize>(links: [Link<f64>; N], share: f64, seed: u64) -> Stored<f64, N> {
    let mut arm = stored(links, TOOL);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for parameter in chosen() {
        let by = rng.random_range(-1.0..1.0) * share * parameter.usual_scale(&arm);
        parameter.apply(&mut arm, by);
    }
    arm
}

fn begun<T: Scalar, const N: usize>(
    links: [Link<f64>; N],
    sigma: f64,
) -> (Stored<T, N>, StreamingIdentification<'static, T, N, P>) {
    let was = stored(links, TOOL);
    let stream = Settings::new(&was, chosen(), T::from_f64(sigma)).start(&was).unwrap();
    (was, stream)
}

/// So little changed that the arm is linear: what re-identification of all points
/// together finds, and as sure of it.
fn equals_reidentification<T: Scalar, const N: usize>(links: [Link<f64>; N], tolerance: f64) {
    for seed in 0..5 {
        let (was, mut stream) = begun::<T, N>(links, SIGMA);
        let mut tracker = Tracker::<T, N>::new(&changed(links, 2e-3, seed), SIGMA, seed);
        let points = tracker.points(40);
        let held = points.iter().filter(|point| stream.push(*point).unwrap()).count();
        assert_eq!((stream.points(), held), (40, 8));
        let one = stream.identified(Lambda::Prior).unwrap();
        let sigma = T::from_f64(SIGMA);
        let all = Reidentify::new(&was, chosen(), sigma).run(&was, &points).unwrap();
        for k in 0..P {
            let apart = (one.change[k] - all.change[k]).to_f64().abs();
            assert!(apart < tolerance * one.sigma[k].to_f64(), "{k}: {one:?} {all:?}");
            let ratio = (one.sigma[k] / all.sigma[k]).to_f64();
            assert!((ratio - 1.0).abs() < 1e-2, "{k}: {ratio}");
        }
        assert_eq!((one.rank, one.determined), (all.rank, all.determined));
        assert_eq!(one.parameters.sequence, was.sequence + 1);
        let close = |a: T, b: T| (a / b - T::ONE).abs().to_f64() < 2e-2;
        assert!(close(one.rms_before, all.rms_before) && close(one.rms_after, all.rms_after));
    }
}

#[test]
fn streaming_equals_reidentification() {
    equals_reidentification::<f64, 6>(ur10(), 0.02);
    equals_reidentification::<f64, 6>(puma(), 0.02);
    equals_reidentification::<f64, 4>(scara(), 0.02);
    equals_reidentification::<f64, 7>(ur10_on_a_rail(), 0.02);
    equals_reidentification::<f32, 6>(ur10(), 0.3);
    equals_reidentification::<f32, 7>(ur10_on_a_rail(), 0.3);
}

/// By every rule the arm is better by far, the held-out points say by how much, and
/// sigma is what noise does.
#[test]
fn noise_is_what_is_left() {
    let (mut square, mut count) = (0.0, 0.0);
    for seed in 0..40 {
        let real = changed(ur10(), 0.01, seed);
        let mut tracker = Tracker::<f64, 6>::new(&real, SIGMA, seed);
        let (was, mut stream) = begun::<f64, 6>(ur10(), SIGMA);
        let before = tracker.error(&was);
        tracker.points(60).iter().for_each(|point| {
            stream.push(point).unwrap();
        });
        for rule in [Lambda::Prior, Lambda::LCurve, Lambda::TwoStep, Lambda::Fixed(1e-3)] {
            let found = stream.identified(rule).unwrap();
            let after = tracker.error(&found.parameters);
            assert!(after < 0.3 * before && after < 2.0 * SIGMA, "{rule:?}: {before} {after}");
            let held_out = found.held_out.unwrap() / SIGMA;
            assert!((1.0..2.6).contains(&held_out), "{rule:?}: {held_out}");
            assert!(found.rms_after < found.rms_before && found.lambda > 0.0);
            if rule == Lambda::Prior {
                let right = changed(ur10(), 0.01, seed);
                for (k, parameter) in chosen().into_iter().enumerate() {
                    // What applying the rest makes of the parameter is what is left of it.
                    let mut left = found.parameters.clone();
                    parameter.apply(&mut left, 1.0);
                    let (with, own) =
                        (value(&left, parameter), value(&found.parameters, parameter));
                    assert!((with - own - 1.0).abs() < 1e-9);
                    square += ((own - value(&right, parameter)) / found.sigma[k]).powi(2);
                    count += 1.0;
                }
            }
        }
    }
    let ratio: f64 = square / count;
    // 320 squares, not all independent of each other.
    assert!((ratio - 1.0).abs() < 0.3, "{ratio}");
}

fn value(arm: &Stored<f64, 6>, parameter: Parameter) -> f64 {
    match parameter.canonical(&arm.nominal) {
        Parameter::Link { joint, parameter } => {
            let values = arm.corrections[usize::from(joint)].to_array();
            values[LinkParameter::ALL.iter().position(|p| *p == parameter).unwrap()]
        }
        Parameter::Tool(Axis::X) => arm.tool.x,
        Parameter::Tool(_) => arm.tool.y,
        _ => unreachable!(),
    }
}

/// Mean square error of what was found over sigma^2, of arms changed by up to `share`
/// of the usual scale.
fn calibration(share: f64, forgetting: f64, points: usize) -> f64 {
    let mut square = 0.0;
    for seed in 0..100 {
        let real = changed(ur10(), share, seed);
        let mut tracker = Tracker::<f64, 6>::new(&real, SIGMA, seed);
        let was = stored(ur10(), TOOL);
        let mut stream =
            Settings { forgetting, ..Settings::new(&was, chosen(), SIGMA) }.start(&was).unwrap();
        for point in tracker.points(points) {
            stream.push(&point).unwrap();
        }
        let found = stream.fit(Lambda::Prior).unwrap();
        for (k, parameter) in chosen().into_iter().enumerate() {
            let left = value(&found.parameters, parameter) - value(&real, parameter);
            square += (left / found.sigma[k]).powi(2);
        }
    }
    square / (100.0 * P as f64)
}

/// Sigma is of the noise: linearising adds to it where much has changed, and points that
/// faded count as measured the worse.
#[test]
fn sigma_is_without_what_linearising_leaves() {
    let little = calibration(0.01, 1.0, 30);
    assert!((little - 1.0).abs() < 0.25, "{little}");
    let much = calibration(0.5, 1.0, 30);
    assert!(much > 10.0, "{much}");
    let faded = calibration(0.01, 0.95, 200);
    // Of weights w^k the variance is 1 / (1 + w) of what their sum says.
    assert!((faded - 0.51).abs() < 0.15, "{faded}");
    println!("little {little:.2}, much {much:.0}, faded {faded:.2}");
}

/// What linearising leaves is of second order, and relinearising takes it away from the
/// points that come then.
#[test]
fn a_large_change_is_relinearised() {
    for seed in 0..10 {
        let real = changed(ur10(), 0.5, seed);
        let mut tracker = Tracker::<f64, 6>::new(&real, 0.0, seed);
        let was = stored(ur10(), TOOL);
        let mut settings = Settings::new(&was, chosen(), SIGMA);
        settings.forgetting = 0.5;
        let mut stream = settings.start(&was).unwrap();
        let mut errors = Vec::new();
        for _ in 0..3 {
            tracker.points(60).iter().for_each(|point| {
                stream.push(point).unwrap();
            });
            let found = stream.identified(Lambda::Fixed(1e-9)).unwrap();
            errors.push(tracker.error(&found.parameters));
            stream.relinearise(&found);
        }
        assert!(errors[1] < 0.1 * errors[0] && errors[2] < 1e-6, "{errors:?}");
    }
}

#[test]
fn bad_input_is_an_error_that_names_it() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let start = |parameters, sigma| Settings::new(&was, parameters, sigma).start(&was).map(|_| ());
    for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(start(chosen(), sigma), Err(StreamingError::BadSigma));
    }
    let theta = Parameter::Link { joint: 1, parameter: LinkParameter::Theta };
    let all = [Parameter::JointOffset(6), Parameter::Term(0), Parameter::STATION[2], theta];
    for (before, parameter) in all.into_iter().enumerate() {
        let (mut list, index) = (chosen(), before + 1);
        list[index] = parameter;
        let error = StreamingError::BadParameter { index, parameter };
        assert_eq!(start(list, SIGMA), Err(error));
        assert!(error.to_string().contains(&format!("parameter {}, {parameter}", index + 1)));
    }
    let mut settings = Settings::new(&was, chosen(), SIGMA);
    settings.forgetting = 0.0;
    let error = settings.start(&was).unwrap_err();
    assert_eq!(error, StreamingError::Solve(SolveError::BadForgetting));
    assert!(std::error::Error::source(&error).is_some());

    settings.forgetting = 1.0;
    settings.every = 0;
    let mut stream = settings.start(&was).unwrap();
    let few = StreamingError::TooFewEquations { equations: 0, needed: P as u32 };
    assert_eq!(stream.identified(Lambda::Prior), Err(few));
    let mut tracker = Tracker::<f64, 6>::new(&was, SIGMA, 1);
    for point in tracker.points(20) {
        assert_eq!(stream.push(&point), Ok(false));
    }
    let before = stream.clone();
    let mut bad = [tracker.point(); 2];
    bad[0].q[2] = f64::NAN;
    bad[1].state.payload = f64::INFINITY;
    let not_finite = StreamingError::BadMeasurement(MeasurementError::NotFinite);
    for point in bad {
        assert_eq!(stream.push(&point), Err(not_finite));
    }
    let mut far = tracker.point();
    far.point.z = 1e160;
    assert_eq!(stream.push(&far), Err(StreamingError::Solve(SolveError::Overflow)));
    assert_eq!(stream, before);
    assert_eq!(stream.identified(Lambda::TwoStep), Err(StreamingError::NothingHeldOut));
    assert_eq!(stream.identified(Lambda::Prior).unwrap().held_out, None);
    let bad = StreamingError::Solve(SolveError::BadLambda);
    assert_eq!(stream.identified(Lambda::Fixed(-1.0)), Err(bad));
}

/// Before any point is measured.
#[test]
fn a_bad_scale_is_refused_at_the_start() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let good = Settings::new(&was, chosen(), SIGMA);
    for (index, parameter) in chosen().into_iter().enumerate() {
        let late: &[f64] = if index > 0 { &[f64::INFINITY] } else { &[] };
        for scale in [0.0, -1.0, f64::NAN].iter().chain(late) {
            let mut settings = good;
            settings.scale[index] = *scale;
            let error = settings.start(&was).unwrap_err();
            assert_eq!(error, StreamingError::BadScale { index, parameter }, "{scale}");
            let place = index + 1;
            assert!(error.to_string().contains(&format!("parameter {place}, {parameter}")));
        }
    }
    let mut settings = good;
    settings.scale[..2].fill(f64::INFINITY);
    let mut stream = settings.start(&was).unwrap();
    for point in Tracker::<f64, 6>::new(&changed(ur10(), 0.01, 1), SIGMA, 1).points(40) {
        stream.push(&point).unwrap();
    }
    for rule in [Lambda::Prior, Lambda::LCurve, Lambda::TwoStep, Lambda::Fixed(0.1)] {
        stream.identified(rule).unwrap();
    }
}

/// A tool on the last axis does not tell the last joint's offset.
#[test]
fn what_the_points_cannot_tell_is_said() {
    let was = stored::<f64, 6>(puma(), [0.0, 0.0, 0.1]);
    let parameters = [Parameter::JointOffset(5), Parameter::JointOffset(4)];
    let mut stream = Settings::new(&was, parameters, SIGMA).start(&was).unwrap();
    for point in Tracker::<f64, 6>::new(&was, SIGMA, 1).points(20) {
        stream.push(&point).unwrap();
    }
    let found = stream.identified(Lambda::Prior).unwrap();
    assert_eq!((found.determined, found.rank), ([false, true], 1));
    assert!(found.change[0].abs() < 1e-9 && (found.sigma[0] - 0.02).abs() < 1e-6, "{found:?}");
    let without = stream.identified(Lambda::Fixed(0.0));
    assert_eq!(without, Err(StreamingError::Undetermined { index: 0 }));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn no_nan_comes_out(
        seed in any::<u64>(),
        points in prop::collection::vec(
            (prop::array::uniform3(any::<f32>()), any::<f32>(), prop::bool::ANY),
            1..12,
        ),
        scale in any::<f32>(),
        lambda in any::<f32>(),
        sigma in prop_oneof![Just(2e-5_f32), any::<f32>()],
    ) {
        let was = stored::<f32, 6>(ur10(), TOOL);
        let mut settings = Settings::new(&was, chosen(), sigma);
        settings.scale[3] = scale;
        let Ok(mut stream) = settings.start(&was) else { return Ok(()) };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for (point, joint, bad) in points {
            let mut q = joints(&ur10(), &mut rng).map(|q| q as f32);
            if bad {
                q[2] = joint;
            }
            let point = if bad { point.into() } else { vector([0.5, 0.2, 0.3]) };
            let _ = stream.push(&CheckPoint::plain(q, point, 20.0));
        }
        for rule in [Lambda::Prior, Lambda::LCurve, Lambda::TwoStep, Lambda::Fixed(lambda)] {
            match stream.identified(rule) {
                Ok(found) => {
                    let links = found.parameters.corrections.iter().flat_map(|c| c.to_array());
                    let held_out = found.held_out.unwrap_or(0.0);
                    let rest = [found.lambda, found.rms_before, found.rms_after, held_out];
                    let all = links.chain(found.change).chain(found.sigma).chain(rest);
                    prop_assert!(all.clone().all(|v| v.is_finite()), "{:?}", found);
                }
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
    }
}
