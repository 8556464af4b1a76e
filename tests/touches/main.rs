//! Touches of planes and distances from anchors, streamed and re-identified: against an
//! oracle of 4x4 matrices, difference quotients, and the same said by points.

#[path = "../common/arms.rs"]
mod arms;
#[path = "../common/mod.rs"]
mod common;
mod rig;

use arms::{joints, stored, vector};
use common::ur10;
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rig::{Bench, Face, Thing, anywhere, normal};
use truearm::check_point::CheckPoint;
use truearm::measurement::{Anchor, Measurement, MeasurementError, Plane, PlaneError, Reading};
use truearm::parameters::{Axis, Parameter, apply};
use truearm::reidentify::{Reidentified, Reidentify, ReidentifyError};
use truearm::solve::Misfit;
use truearm::streaming::{Identified, Lambda, Settings, StreamingError};
use truearm::{Arm, ArmParameters, LinkParameter, Pose, Scalar, State};

const TOOL: [f64; 3] = [0.06, -0.025, 0.11];
const SIGMA: f64 = 1e-5;
const RADIUS: f64 = 3e-3;
type Stored<T> = ArmParameters<'static, T, 6>;
type Taken<T> = Measurement<T, 6>;

/// What one measurement of a stream of one parameter without prior makes of it, from
/// which its column follows: `x = before + rest / column`.
fn column<T: Scalar>(
    was: &Stored<T>,
    parameter: Parameter,
    before: f64,
    taken: &Taken<T>,
    rest: f64,
) -> f64 {
    let mut settings = Settings::new(was, [parameter], T::ONE);
    (settings.scale, settings.every) = ([T::ONE / T::ZERO], 0);
    let mut stream = settings.start(was).unwrap();
    let mut parameters = was.clone();
    parameter.apply(&mut parameters, T::from_f64(before));
    stream.relinearise(&Identified {
        parameters,
        change: [T::from_f64(before)],
        sigma: [T::ONE],
        determined: [true],
        rank: 1,
        lambda: T::ZERO,
        rms_before: T::ZERO,
        rms_after: T::ZERO,
        misfit: Misfit { chi_square: T::ZERO, freedom: T::ONE },
        held_out: None,
    });
    stream.push(taken).unwrap();
    let found = stream.identified(Lambda::Fixed(T::ZERO)).unwrap();
    rest / (found.change[0].to_f64() - before)
}

/// The column of a parameter that differs by `before` from where it was, against a
/// difference quotient of the oracle's height or distance.
fn column_holds<T: Scalar>(thing: Thing, parameter: Parameter, before: f64, seed: u64, bound: f64) {
    let (was, same) = (stored::<T, 6>(ur10(), TOOL), stored::<f64, 6>(ur10(), TOOL));
    let before = if parameter.is_of_arm() { before / 3.0 } else { before };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let q = joints(&ur10(), &mut rng).map(|q| T::from_f64(q).to_f64());
    let value = |by: f64| {
        let mut arm = same.clone();
        parameter.apply(&mut arm, by);
        thing.moved(parameter, by).value(&Arm::new(&arm).real_pose(&q).translation)
    };
    let step = 1e-5;
    let quotient = (value(before + step) - value(before - step)) / (2.0 * step);
    // What hardly moves it would be rounding, in f32.
    if quotient.abs() < 1e-2 {
        return;
    }
    // What an arm may be off by is bounded.
    let rest = 0.05 * quotient;
    let reading = thing.reading(!parameter.is_of_arm(), T::from_f64(value(before) + rest));
    let state = State::at(T::from_f64(20.0));
    let taken = Measurement { q: q.map(T::from_f64), state, reading };
    let column = column(&was, parameter, before, &taken, rest);
    assert!((column - quotient).abs() < bound, "{parameter}: {column} {quotient}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    /// Of every parameter of the arm and of a place, where it is stated to be and beside it.
    #[test]
    fn columns_are_difference_quotients(seed in any::<u64>(), before in -0.3..0.3_f64) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let turns = Axis::ALL.map(|axis| Parameter::PlaneRotation { plane: 3, axis });
        let of_plane = turns.into_iter().chain([Parameter::PlaneOffset(3)]);
        let face = Thing::Face(Face::anywhere(&mut rng));
        let ball = Thing::Ball(anywhere(&mut rng) * 2.0);
        let all = || Parameter::of_arm(6, 0);
        let of_face = all().chain(of_plane).map(|parameter| (face, parameter));
        let of_ball = all().chain(Parameter::anchor(3)).map(|parameter| (ball, parameter));
        for (thing, parameter) in of_face.chain(of_ball) {
            column_holds::<f64>(thing, parameter, before, seed, 1e-7);
            column_holds::<f32>(thing, parameter, before, seed, 1e-3);
        }
    }
}

/// RMS distance of a model from the arm over other poses, m.
fn error<T: Scalar>(found: &ArmParameters<'_, T, 6>, real: &Stored<f64>) -> f64 {
    arms::Tracker::<T, 6>::new(real, 0.0, 0).error(found)
}

const OFFSETS: [Parameter; 2] = [Parameter::JointOffset(1), Parameter::JointOffset(3)];

fn crashed() -> Stored<f64> {
    let mut real = stored::<f64, 6>(ur10(), TOOL);
    apply(&mut real, &OFFSETS, &[0.006, -0.009]);
    real
}

/// Reads three heights in place of a point: over planes that stand on each other at right
/// angles, through places that are known.
fn as_heights<T: Scalar>(point: &CheckPoint<T, 6>, faces: &[Face; 3]) -> [Taken<T>; 3] {
    faces.map(|face| {
        let height = T::from_f64(face.height(&point.point.map(T::to_f64)));
        let reading = Reading::Height { plane: face.plane(), height };
        Measurement { q: point.q, state: point.state, reading }
    })
}

fn a_point_is_three_heights<T: Scalar>(seed: u64, bound: f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let turn = Rotation3::new(anywhere(&mut rng) * 3.0);
    let faces = [0, 1, 2]
        .map(|k| Face { point: anywhere(&mut rng), normal: turn.matrix().column(k).into_owned() });
    let was = stored::<T, 6>(ur10(), TOOL);
    let points = arms::Tracker::<T, 6>::new(&crashed(), SIGMA, seed).points(8);
    let heights: Vec<_> = points.iter().flat_map(|point| as_heights(point, &faces)).collect();
    let [x, y, z] = Parameter::TOOL;
    let chosen = [OFFSETS[0], OFFSETS[1], x, y, z];
    let task = Reidentify::new(&was, chosen, T::from_f64(SIGMA));
    let [one, other] = [task.run(&was, &points), task.run(&was, &heights)].map(Result::unwrap);
    let mut settings = Settings::new(&was, chosen, T::from_f64(SIGMA));
    settings.every = 0;
    let (mut by_points, mut by_heights) =
        (settings.start(&was).unwrap(), settings.start(&was).unwrap());
    points.iter().for_each(|point| assert_eq!(by_points.push(point), Ok(false)));
    heights.iter().for_each(|height| assert_eq!(by_heights.push(height), Ok(false)));
    let [first, second] = [by_points, by_heights].map(|mut s| s.identified(Lambda::Prior).unwrap());
    let near = |a: &[T; 5], b: &[T; 5], unit: f64| {
        a.iter().zip(b).all(|(a, b)| (a.to_f64() - b.to_f64()).abs() < unit * bound)
    };
    assert!(near(&one.change, &other.change, 1.0), "{one:?} {other:?}");
    assert!(near(&first.change, &second.change, 1.0), "{first:?} {second:?}");
    assert!(
        near(&one.sigma, &other.sigma, SIGMA * 1e3)
            && near(&first.sigma, &second.sigma, SIGMA * 1e3)
    );
    assert_eq!((one.rank, one.determined), (other.rank, other.determined));
    // Squares of three heights are that of a point, a third as many times.
    let ratio = one.rms_after.to_f64() / other.rms_after.to_f64();
    assert!((ratio / 3_f64.sqrt() - 1.0).abs() < 1e5 * bound, "{ratio}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn a_point_is_three_heights_over_known_planes(seed in any::<u64>()) {
        a_point_is_three_heights::<f64>(seed, 1e-11);
        a_point_is_three_heights::<f32>(seed, 3e-6);
    }
}

fn plate() -> Face {
    Face { point: Vector3::new(0.5, 0.2, -0.1), normal: Vector3::z() }
}

/// A crash, then touches of a known plate: each parameter within its interval in 95 of 100
/// accidents.
#[test]
fn intervals_hold_after_a_crash() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let (mut inside, runs) = (0, 400);
    for seed in 0..runs {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let by = [0; 2].map(|_| normal(&mut rng) * 5e-3);
        let mut real = was.clone();
        apply(&mut real, &OFFSETS, &by);
        let mut bench = Bench::new(&real, SIGMA, seed);
        let touches: Vec<Taken<f64>> =
            (0..20).map(|_| bench.touch(&plate(), plate().plane())).collect();
        let found = Reidentify::new(&was, OFFSETS, SIGMA).run(&was, &touches).unwrap();
        assert_eq!((found.determined, found.rank), ([true; 2], 2));
        let off = |k: usize| (found.change[k] - by[k]).abs() / found.sigma[k];
        inside += (0..2).filter(|k| off(*k) < 1.96).count();
    }
    let share = inside as f64 / (2.0 * runs as f64);
    println!("{share:.3} of {} within 1.96 sigma", 2 * runs);
    // 800 of probability 0.95: a standard deviation of 0.008.
    assert!((share - 0.95).abs() < 0.025, "{share}");
}

/// A plate that the arm has learned by few touches is not known exactly: held as found the
/// intervals are too narrow, with its own deviations as their prior they hold.
#[test]
fn a_learned_plate_is_as_sure_as_what_learned_it() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let about = plate().plane::<f64>().unknown(0);
    let place = Parameter::plane(0, Axis::Z);
    let [a, b, c] = place;
    let (mut narrow, mut inside, runs) = (0, 0, 400);
    for seed in 0..runs {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let lies = plate().moved(&(anywhere(&mut rng) * 0.01), 1e-3);
        let mut before = Bench::new(&was, SIGMA, seed);
        let touches: Vec<Taken<f64>> = (0..8).map(|_| before.touch(&lies, about)).collect();
        let learned = Reidentify::new(&was, place, SIGMA).run(&was, &touches).unwrap();
        let found = about.found(&place, &learned.change);
        let by = [0; 2].map(|_| normal(&mut rng) * 5e-3);
        let mut real = was.clone();
        apply(&mut real, &OFFSETS, &by);
        let mut after = Bench::new(&real, SIGMA, seed + 1000);
        let touches: Vec<Taken<f64>> = (0..20).map(|_| after.touch(&lies, found)).collect();
        let held = Reidentify::new(&was, OFFSETS, SIGMA).run(&was, &touches).unwrap();
        let open: Vec<_> =
            touches.iter().map(|t| found.unknown(0).touched(t.q, RADIUS, 20.0)).collect();
        let chosen = [a, b, c, OFFSETS[0], OFFSETS[1]];
        let mut task = Reidentify::new(&was, chosen, SIGMA);
        task.scale[..3].copy_from_slice(&learned.sigma);
        let freed = task.run(&was, &open).unwrap();
        for k in 0..2 {
            narrow += usize::from((held.change[k] - by[k]).abs() < 1.96 * held.sigma[k]);
            inside += usize::from((freed.change[k + 3] - by[k]).abs() < 1.96 * freed.sigma[k + 3]);
        }
    }
    let share = |count: usize| count as f64 / (2.0 * runs as f64);
    println!("{:.3} with the plate held, {:.3} with its prior", share(narrow), share(inside));
    assert!((share(inside) - 0.95).abs() < 0.025 && share(narrow) < 0.9);
}

/// Held-out touches are off by the noise and what the fitted ones leave open; streamed
/// about what was found, the answer is that of the re-identification.
#[test]
fn streamed_touches_judge_and_relinearise() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let real = crashed();
    let mut bench = Bench::new(&real, SIGMA, 1);
    let touches: Vec<Taken<f64>> =
        (0..200).map(|_| bench.touch(&plate(), plate().plane())).collect();
    let found = Reidentify::new(&was, OFFSETS, SIGMA).run(&was, &touches).unwrap();
    let start = || Settings::new(&was, OFFSETS, SIGMA).start(&was).unwrap();
    let mut stream = start();
    let judging = touches.iter().filter(|touch| stream.push(*touch).unwrap()).count();
    assert_eq!((judging, stream.points()), (40, 200));
    let first = stream.fit(Lambda::Prior).unwrap();
    let mut stream = start();
    stream.relinearise(&first);
    touches.iter().for_each(|touch| assert!(stream.push(touch).is_ok()));
    let second = stream.identified(Lambda::Prior).unwrap();
    // 40 of one coordinate each: a standard deviation of 11 %.
    let held_out = second.held_out.unwrap();
    assert!((held_out / SIGMA - 1.0).abs() < 0.35, "{held_out:e}");
    for k in 0..2 {
        let apart = |x: &Identified<f64, 6, 2>| (x.change[k] - found.change[k]).abs();
        assert!(apart(&second) < 0.05 * found.sigma[k] && apart(&first) > apart(&second));
        assert!((second.sigma[k] / found.sigma[k] - 1.0).abs() < 0.01);
    }
}

fn places_are_found_with_the_arm<T: Scalar>(seed: u64, exact: f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let was = stored::<T, 6>(ur10(), TOOL);
    let real = crashed();
    let (turn, offset) = (anywhere(&mut rng) * 0.2, rng.random_range(-0.05..0.05));
    let ball = anywhere(&mut rng) * 0.2 + Vector3::new(1.5, 0.0, 0.0);
    let off = anywhere(&mut rng) * 0.05;
    let [face, ball] = [Thing::Face(plate()), Thing::Ball(ball)];
    let lies = Thing::Face(plate().moved(&turn, offset));
    let stands = match ball {
        Thing::Ball(ball) => Thing::Ball(ball + off),
        face => face,
    };
    let mut bench = Bench::new(&real, 0.0, seed);
    let mut taken: Vec<Taken<T>> = (0..15).map(|_| bench.taken(&lies, &face, true)).collect();
    taken.extend((0..15).map(|_| bench.taken::<T>(&stands, &ball, true)));
    let ([a, b, c], [d, e, f]) = (Parameter::plane(3, Axis::Z), Parameter::anchor(3));
    let chosen = [a, b, c, d, e, f, OFFSETS[0], OFFSETS[1]];
    let found = Reidentify::new(&was, chosen, T::from_f64(SIGMA)).run(&was, &taken).unwrap();
    assert_eq!((found.determined, found.rank), ([true; 8], 8));
    let left = error(&found.parameters, &real);
    assert!(left < exact && found.steps <= 6, "{left:e} {found:?}");
    let (Thing::Face(lies), Thing::Ball(stands)) = (lies, stands) else { return };
    for reading in [taken[0].reading, taken[20].reading] {
        match reading {
            Reading::Height { plane, .. } => {
                let plane = plane.found(&chosen, &found.change);
                let normal = plane.normal().map(T::to_f64);
                let height = lies.height(&plane.point().map(T::to_f64));
                assert!((normal - lies.normal).norm() < exact && height.abs() < exact);
                assert_eq!(plane.label(), None);
            }
            Reading::Distance { anchor, .. } => {
                let anchor = anchor.found(&chosen, &found.change);
                assert!((anchor.point().map(T::to_f64) - stands).norm() < exact);
            }
            Reading::Point(_) => {}
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]
    /// A plate that leans by up to 0.3 rad and lies 50 mm off, and a ball that is 50 mm
    /// off, in one solve with what slipped.
    #[test]
    fn unknown_places_are_found_with_the_arm(seed in any::<u64>()) {
        places_are_found_with_the_arm::<f64>(seed, 1e-7);
        places_are_found_with_the_arm::<f32>(seed, 2e-5);
    }
}

/// A plate of unknown place says nothing of where the arm stands, a flat one nothing of
/// how it turns about what is upright: the prior holds that, and it is said.
#[test]
fn what_touches_cannot_tell_is_said() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let mut bench = Bench::new(&was, SIGMA, 1);
    let face = Thing::Face(plate());
    let known: Vec<Taken<f64>> = (0..30).map(|_| bench.taken(&face, &face, false)).collect();
    let chosen = [Parameter::JointOffset(0), OFFSETS[0]];
    let found = Reidentify::new(&was, chosen, SIGMA).run(&was, &known).unwrap();
    assert_eq!((found.determined, found.rank), ([false, true], 1));
    assert!(found.change[0].abs() < 1e-9 && (found.sigma[0] - 0.02).abs() < 1e-6, "{found:?}");

    let unknown: Vec<Taken<f64>> = (0..30).map(|_| bench.taken(&face, &face, true)).collect();
    let ([a, b, c], base) = (Parameter::plane(3, Axis::Z), Parameter::BASE);
    let chosen = [a, b, c, base[0], base[1], base[2], base[3], base[4], base[5]];
    let found = Reidentify::new(&was, chosen, SIGMA).run(&was, &unknown).unwrap();
    assert_eq!((&found.determined[3..], found.rank), (&[false; 6][..], 3));
    assert!(found.change[3..].iter().all(|change| change.abs() < 1e-6), "{found:?}");
}

/// An arm twice as large in front of a wall twice as far touches the same: with the wall's
/// offset unknown one direction more is open, and distances close it.
#[test]
fn touches_of_an_unknown_wall_leave_the_scale_open() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let mut bench = Bench::new(&was, 0.0, 4);
    let wall = Face { point: Vector3::new(0.7, 0.0, 0.0), normal: -Vector3::x() };
    let stated = wall.plane().unknown(0);
    let mut all: Vec<Taken<f64>> = (0..80).map(|_| bench.touch(&wall, stated)).collect();
    let length = |k: u8| Parameter::Link {
        joint: k / 2,
        parameter: if k.is_multiple_of(2) { LinkParameter::A } else { LinkParameter::D },
    };
    let mut chosen = [Parameter::PlaneOffset(0); 16];
    (0..12).for_each(|k| chosen[1 + usize::from(k)] = length(k));
    chosen[13..].copy_from_slice(&Parameter::TOOL);
    let rank = |taken: &[Taken<f64>], offset: f64| {
        let mut task = Reidentify::new(&was, chosen, SIGMA);
        (task.scale, task.scale[0]) = ([0.02; 16], offset);
        let found = task.run(&was, taken).unwrap();
        (found.rank, found.sigma[0])
    };
    // Held to a nanometre it is known; free it is as unknown as the size of the arm.
    let (known, (open, sigma)) = (rank(&all, 1e-9).0, rank(&all, f64::INFINITY));
    let ball = Thing::Ball(Vector3::new(0.5, 0.5, -0.3));
    all.extend((0..10).map(|_| bench.taken::<f64>(&ball, &ball, false)));
    let (closed, then) = rank(&all, f64::INFINITY);
    assert!(open == known && closed > open, "{known} {open} {closed}");
    assert!(sigma > 0.01 && then < 1e-4, "{sigma:e} {then:e}");
}

/// Labels are counted from 0 in the code and from 1 in a text.
#[test]
fn places_have_names_units_and_no_prior() {
    let mut arm = stored::<f64, 6>(ur10(), TOOL);
    let same = arm.clone();
    let names = ["rotation of plane 2 about z", "rotation of plane 2 about x", "offset of plane 2"];
    let of_plane = Parameter::plane(1, Axis::Y);
    for (parameter, (name, unit)) in of_plane.iter().zip(names.iter().zip(["rad", "rad", "m"])) {
        assert_eq!((parameter.to_string().as_str(), parameter.unit(&arm)), (*name, unit));
    }
    assert_eq!(Parameter::anchor(0)[2].to_string(), "translation of anchor 1 along z");
    for parameter in of_plane.into_iter().chain(Parameter::anchor(0)) {
        assert!(!parameter.is_of_arm() && parameter.usual_scale(&arm) == f64::INFINITY);
        parameter.apply(&mut arm, 0.1);
        assert_eq!(arm, same);
    }
}

#[test]
fn bad_input_is_an_error_that_names_it() {
    let was = stored::<f64, 6>(ur10(), TOOL);
    let (p, n) = (Vector3::new(0.5, 0.0, 0.0), Vector3::new(0.0, 0.0, 2.0));
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        assert_eq!(Plane::new(p, n * bad), Err(PlaneError::NotFinite));
        let at = Plane::new(p * bad, n);
        assert_eq!(at.is_err(), !(p * bad).iter().all(|v| v.is_finite()));
    }
    for none in [0.0, 1e-20, -0.0] {
        assert_eq!(Plane::new(p, n * none), Err(PlaneError::NoNormal));
    }
    for c in [p, n, (p + n) * 0.5, p + (n - p) * 1.0001] {
        assert_eq!(Plane::through([p, n, c]), Err(PlaneError::PointsOnALine));
    }
    assert_eq!(Plane::through([p, n, p * f64::NAN]), Err(PlaneError::NotFinite));

    let mut bench = Bench::new(&was, SIGMA, 1);
    let face = Thing::Face(plate());
    let good: Vec<Taken<f64>> = (0..10).map(|_| bench.taken(&face, &face, false)).collect();
    let run = |taken: &[Taken<f64>]| Reidentify::new(&was, OFFSETS, SIGMA).run(&was, taken);
    assert_eq!(run(&good[..1]), Err(ReidentifyError::TooFewEquations { equations: 1, needed: 2 }));
    let at = Arm::new(&was).real_pose(&good[4].q).translation;
    let plane = plate().plane::<f64>();
    let far = Vector3::new(0.0, f64::NAN, 0.0);
    let bad = [
        (plane.touched(good[4].q, f64::NAN, 20.0), MeasurementError::NotFinite),
        (plane.touched(good[4].q, 0.0, f64::INFINITY), MeasurementError::NotFinite),
        (plane.touched([f64::NAN; 6], 0.0, 20.0), MeasurementError::NotFinite),
        (Anchor::new(far).distance(good[4].q, 1.0, 20.0), MeasurementError::NotFinite),
        (Anchor::new(at).distance(good[4].q, 0.0, 20.0), MeasurementError::AtAnchor),
        (plane.unknown(0).touched(good[4].q, 0.0, 20.0), MeasurementError::PlaceNotChosen),
        (
            Anchor::new(at).unknown(7).distance(good[4].q, 1.0, 20.0),
            MeasurementError::PlaceNotChosen,
        ),
    ];
    let mut stream = Settings::new(&was, OFFSETS, SIGMA).start(&was).unwrap();
    good.iter().for_each(|touch| assert!(stream.push(touch).is_ok()));
    let before = stream.clone();
    for (taken, why) in bad {
        let mut all = good.clone();
        all[4] = taken;
        assert_eq!(run(&all), Err(ReidentifyError::BadMeasurement { index: 4, why }));
        assert_eq!(stream.push(&taken), Err(StreamingError::BadMeasurement(why)));
        assert_eq!(stream, before);
        assert!(
            ReidentifyError::BadMeasurement { index: 4, why }
                .to_string()
                .starts_with("measurement 5 is ")
        );
    }
    // A plane that nothing touches, and touches that say nothing of a free one.
    let chosen = [Parameter::PlaneOffset(1), OFFSETS[0]];
    let lost = Reidentify::new(&was, chosen, SIGMA).run(&was, &good);
    assert_eq!(lost, Err(ReidentifyError::Undetermined { index: 0 }));
    let mut stream = Settings::new(&was, chosen, SIGMA).start(&was).unwrap();
    good.iter().for_each(|touch| assert!(stream.push(touch).is_ok()));
    assert_eq!(stream.identified(Lambda::Prior), Err(StreamingError::Undetermined { index: 0 }));
    // No three points say where the tracker is.
    let station = Reidentify::new(&was, Parameter::STATION, SIGMA).run(&was, &good);
    assert_eq!(station, Err(ReidentifyError::PointsOnALine));
}

/// Points, touches and distances in one list, seen by a tracker that was moved; planes and
/// anchors are where the tracker has them.
#[test]
fn kinds_mix_and_a_moved_tracker_takes_them() {
    let (was, real) = (stored::<f64, 6>(ur10(), TOOL), crashed());
    let turn = Rotation3::from_euler_angles(0.7, -2.1, 2.8);
    let station = Pose { rotation: turn.into_inner(), translation: Vector3::new(2.0, -1.5, 0.4) };
    let mut bench = Bench::new(&real, 0.0, 3);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let things = [Thing::Face(Face::anywhere(&mut rng)), Thing::Ball(anywhere(&mut rng) * 3.0)];
    let mut all: Vec<Taken<f64>> = Vec::new();
    for k in 0..12 {
        let (q, point) = bench.pose::<f64>();
        let seen = station.transform_point(&point);
        all.push(match things.get(k % 3) {
            Some(thing) => {
                let reading = thing.reading(false, thing.value(&seen));
                Measurement { q, state: State::at(20.0), reading }
            }
            None => CheckPoint::plain(q, seen, 20.0).into(),
        });
    }
    let [a, b, c, d, e, f] = Parameter::STATION;
    let chosen = [a, b, c, d, e, f, OFFSETS[0], OFFSETS[1]];
    let found = Reidentify::new(&was, chosen, SIGMA).run(&was, &all).unwrap();
    assert!(error(&found.parameters, &real) < 1e-7, "{found:?}");
    assert!((found.station.translation - station.translation).norm() < 1e-7);
}

/// Any number at all.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![4 => -2.0..2.0_f32, 1 => any::<f32>(), 1 => Just(0.0_f32)]
}

fn finite(found: &Reidentified<f32, 6, 8>) -> bool {
    let links = found.parameters.corrections.iter().flat_map(|c| c.to_array());
    let rest = [found.rms_before, found.rms_after];
    links.chain(found.change).chain(found.sigma).chain(rest).all(|v| v.is_finite())
}

/// A point, a direction, a number, and which kind of reading is made of them.
type AnyReading = ([f32; 3], [f32; 3], f32, u8);

/// Numbers, or an error that says why not, whatever was measured.
fn comes_out_finite(readings: Vec<AnyReading>, q: [f32; 6], sigma: f32, scale: f32, seed: u64) {
    let was = stored::<f32, 6>(ur10(), TOOL);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut all: Vec<Taken<f32>> = Vec::new();
    for (point, normal, value, kind) in readings {
        let (point, normal) = (vector(point.map(f64::from)), vector(normal.map(f64::from)));
        let plane = Plane::new(point, normal);
        let free = joints(&ur10(), &mut rng).map(|q| q as f32);
        let q = if rng.random_bool(0.1) { q } else { free };
        all.push(match (plane, kind) {
            (Ok(plane), 0) => plane.touched(q, value, 20.0),
            (Ok(plane), 1) => plane.unknown(0).touched(q, value, 20.0),
            (_, 2) => Anchor::new(point).distance(q, value, 20.0),
            (_, 3) => Anchor::new(point).unknown(0).distance(q, value, 20.0),
            _ => CheckPoint::plain(q, point, 20.0).into(),
        });
    }
    let ([a, b, c], [d, e, f]) = (Parameter::plane(0, Axis::Z), Parameter::anchor(0));
    let chosen = [a, b, c, d, e, f, OFFSETS[0], OFFSETS[1]];
    let mut task = Reidentify::new(&was, chosen, sigma);
    task.scale[6] = scale;
    match task.run(&was, &all) {
        Ok(found) => assert!(finite(&found), "{found:?}"),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    let settings = Settings { scale: task.scale, ..Settings::new(&was, chosen, sigma) };
    let Ok(mut stream) = settings.start(&was) else { return };
    for taken in &all {
        if let Err(error) = stream.push(taken) {
            assert!(!error.to_string().is_empty());
        }
    }
    for rule in [Lambda::Prior, Lambda::TwoStep] {
        if let Ok(found) = stream.identified(rule) {
            let all = found.change.into_iter().chain(found.sigma);
            let rest = [found.rms_after, found.held_out.unwrap_or(0.0)];
            assert!(all.chain(rest).all(|v| v.is_finite()), "{:?}", found);
        }
    }
}

/// All that are fitted are within what `f32` squares, and one that is held out is not.
#[test]
fn a_held_out_square_that_overflows_is_refused() {
    let none = [0.0; 3];
    let readings = vec![
        (none, [0.0, 0.0, -1.3301524], 0.0, 1),
        (none, none, 0.0, 0),
        ([5793415.5, 0.0, 0.0], none, 0.0, 3),
        ([0.0, 0.0, -6.0944777e25], none, 0.0, 0),
        (none, none, 0.0, 0),
        (none, none, -4.6261463e35, 2),
        (none, none, 0.0, 0),
        (none, none, 0.0, 3),
        (none, none, 0.0, 0),
        ([0.0, 0.0, -788844100.0], none, 0.0, 3),
        (none, none, 0.0, 0),
        (none, [0.0, 0.0, 0.79090625], 0.0, 1),
        (none, [0.0, 0.0, -1.8823688], 0.0, 1),
    ];
    let q = [0.0, 0.0, 0.0, -2.2617807e23, 0.0, 0.0];
    comes_out_finite(readings, q, 2e-5, 0.02, 8337598346185489668);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn no_nan_comes_out(
        readings in prop::collection::vec(
            (prop::array::uniform3(number()), prop::array::uniform3(number()), number(), 0..5_u8),
            8..16,
        ),
        q in prop::array::uniform6(number()),
        sigma in prop_oneof![Just(2e-5_f32), any::<f32>()],
        scale in prop_oneof![Just(0.02_f32), any::<f32>()],
        seed in any::<u64>(),
    ) {
        comes_out_finite(readings, q, sigma, scale, seed);
    }
}
