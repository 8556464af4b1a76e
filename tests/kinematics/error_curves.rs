//! Curves against their definition, and arms that have them.

#![cfg(feature = "curves")]

use core::f64::consts::TAU;

use crate::arms;
use crate::common::{puma, scara, ur10, ur10_on_a_rail};
use crate::curves::{Smooth, bytes, of_joints, through};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::{
    Blob, curve_len, encode, encode_curve, encode_curve_with, encode_with, encoded_len, factor_len,
    gaps_len,
};
use truearm::effects::{Curve, Gaps};
use truearm::parameters::Parameter;
use truearm::reidentify::Reidentify;
use truearm::{
    Arm, ArmParameters, Compensator, Curves, JointKind, Link, Pose, Scalar, Settings, State, Task,
};

const STEP: f32 = 1e-8;

fn encoded(step: f32, nodes: &[i16]) -> Vec<u8> {
    let mut out = vec![0; curve_len(nodes.len())];
    encode_curve(0, step, 1e-5, nodes, &mut out).unwrap();
    out
}

/// The definition: B-splines by the recursion of Cox and de Boor, one a node, over
/// whole numbers as knots.
fn de_boor(degree: usize, first: f64, x: f64) -> f64 {
    if degree == 0 {
        return f64::from(u8::from(first <= x && x < first + 1.0));
    }
    let d = degree as f64;
    let (rising, falling) = ((x - first) / d, (first + d + 1.0 - x) / d);
    rising * de_boor(degree - 1, first, x) + falling * de_boor(degree - 1, first + 1.0, x)
}

fn defined(nodes: &[i16], q: f64) -> f64 {
    let n = nodes.len() as f64;
    let x = (q / TAU * n).rem_euclid(n);
    // A node stands in the middle of its spline, which is four wide.
    let weight =
        |k: usize| [-n, 0.0, n].map(|t| de_boor(3, k as f64 - 2.0 + t, x)).iter().sum::<f64>();
    let sum = |(k, node): (usize, &i16)| f64::from(*node) * weight(k);
    f64::from(STEP) * nodes.iter().enumerate().map(sum).sum::<f64>()
}

fn tables() -> impl Strategy<Value = Vec<i16>> {
    (5..=9_u32).prop_flat_map(|k| proptest::collection::vec(any::<i16>(), 1 << k))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn a_curve_is_the_spline_of_its_nodes(nodes in tables(), q in -7.0..7.0) {
        let bytes = encoded(STEP, &nodes);
        let curve = Curves::of(&bytes).unwrap().of_joint(0).unwrap();
        prop_assert!(curve.nodes().eq(nodes.iter().copied()));
        let most = 32_768.0 * f64::from(STEP);
        prop_assert!((curve.at(q) - defined(&nodes, q)).abs() < 1e-10 * most);
        // In f32 the angle itself is known to 2^-22 rad, which is 2e-5 of 512 nodes, and
        // a curve changes by its size from node to node at most.
        let rounded = q as f32;
        let exact = defined(&nodes, f64::from(rounded));
        prop_assert!((f64::from(curve.at(rounded)) - exact).abs() < 2e-4 * most);
        let weights = Curve::weights(nodes.len(), q);
        let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
        let along = weights.iter().map(|(k, w)| f64::from(nodes[*k]) * w).sum::<f64>();
        prop_assert!((sum - 1.0).abs() < 1e-14 && weights.iter().all(|(_, w)| *w >= -1e-15));
        prop_assert!((along * f64::from(STEP) - curve.at(q)).abs() < 1e-10 * most);
    }

    /// Every turn is the same, and over the wrap and every node it is continuous.
    #[test]
    fn turns_repeat_and_join(nodes in tables(), q in -4.0..4.0, turns in -500..500_i32, node in 0..512_usize) {
        let bytes = encoded(STEP, &nodes);
        let curve = Curves::of(&bytes).unwrap().of_joint(0).unwrap();
        let most = 32_768.0 * f64::from(STEP);
        let turned: f64 = curve.at(q + TAU * f64::from(turns));
        prop_assert!((turned - curve.at::<f64>(q)).abs() < 1e-8 * most);
        // In f32 an angle of 3,142 rad is known to 1.2e-4 rad, a hundredth of a node.
        let far = (q + TAU * f64::from(turns)) as f32;
        prop_assert!((f64::from(curve.at(far)) - defined(&nodes, f64::from(far))).abs() < 0.12 * most);
        let at = TAU * (node % nodes.len()) as f64 / nodes.len() as f64;
        for turns in [0.0, 1.0, -3.0] {
            let at = at + turns * TAU;
            prop_assert!((curve.at::<f64>(at - 1e-9) - curve.at::<f64>(at + 1e-9)).abs() < 1e-5 * most);
            let at = at as f32;
            let [before, after] = [at.next_down(), at.next_up()].map(|q| f64::from(curve.at(q)));
            prop_assert!((before - after).abs() < 4e-4 * most);
        }
    }

    /// A number for every number, between the smallest and the largest node.
    #[test]
    fn never_a_nan_and_never_beyond_the_nodes(nodes in tables(), wide in -1e300..1e300, near in -8192_f32..8192.0) {
        let bytes = encoded(STEP, &nodes);
        let curve = Curves::of(&bytes).unwrap().of_joint(0).unwrap();
        let step = f64::from(STEP);
        let low = f64::from(*nodes.iter().min().unwrap()) * step;
        let high = f64::from(*nodes.iter().max().unwrap()) * step;
        let slack = 1e-5 * 32_768.0 * step;
        let value = f64::from(curve.at(near));
        prop_assert!(value >= low - slack && value <= high + slack);
        prop_assert!(curve.at::<f64>(wide).is_finite());
        prop_assert!(curve.at(f64::from(near) * 1e8) >= low - slack);
        for none in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            prop_assert!(curve.at(none).is_nan());
        }
    }

    /// Rounding the nodes moves a curve by half a step at most.
    #[test]
    fn rounding_is_bounded_by_half_a_step(
        exact in proptest::collection::vec(-32_767.0..32_767.0, 64..=64),
        q in -7.0..7.0,
    ) {
        let rounded: Vec<i16> = exact.iter().map(|node: &f64| node.round() as i16).collect();
        let bytes = encoded(STEP, &rounded);
        let curve = Curves::of(&bytes).unwrap().of_joint(0).unwrap();
        let along = Curve::weights(64, q).iter().map(|(k, w)| exact[*k] * w).sum::<f64>();
        let step = f64::from(STEP);
        let value: f64 = curve.at(q);
        prop_assert!((value - along * step).abs() <= 0.500_001 * step);
    }
}

/// One way to go between nodes: weights of the nodes `k - 1` to `k + 2` at `x` of the
/// way from node `k` to the next.
type Kernel = fn(f64) -> [f64; 4];

const KERNELS: [(&str, Kernel); 3] = [
    ("lines", |x| [0.0, 1.0 - x, x, 0.0]),
    ("Catmull-Rom", |x| {
        let (x2, x3) = (x * x, x * x * x);
        [
            x2 - 0.5 * (x + x3),
            1.0 - 2.5 * x2 + 1.5 * x3,
            0.5 * x + 2.0 * x2 - 1.5 * x3,
            0.5 * (x3 - x2),
        ]
    }),
    ("B-spline", |x| {
        let weights = Curve::weights(256, (x + 5.0) / 256.0 * TAU);
        // At a node it is the end of one cubic or the beginning of the next.
        [4, 5, 6, 7].map(|k| weights.iter().filter(|w| w.0 == k).map(|w| w.1).sum())
    }),
];

/// Nodes that come nearest to a curve which is known at eight places a node.
fn least_squares(kernel: Kernel, n: usize, values: &[f64]) -> Vec<f64> {
    let (mut near, mut rhs) = ([0.0; 7], vec![0.0; n]);
    for place in 0..8 {
        let w = kernel(f64::from(place) / 8.0);
        for (a, b) in (0..4).flat_map(|a| (0..4).map(move |b| (a, b))) {
            near[3 + b - a] += w[a] * w[b];
        }
        for (k, a) in (0..n).flat_map(|k| (0..4).map(move |a| (k, a))) {
            rhs[(k + a + n - 1) % n] += w[a] * values[8 * k + place as usize];
        }
    }
    let mut nodes = vec![0.0; n];
    for _ in 0..2000 {
        for k in 0..n {
            let others: f64 = [1, 2, 3]
                .iter()
                .map(|d| near[3 + d] * (nodes[(k + d) % n] + nodes[(k + n - d) % n]))
                .sum();
            nodes[k] = (rhs[k] - others) / near[3];
        }
    }
    nodes
}

/// The table in `effects::joint_error_curve`: why a table is a cubic B-spline.
#[test]
fn a_spline_holds_a_random_curve_best() {
    const N: usize = 256;
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    let mut errors = [[0.0; 2]; 3];
    for _ in 0..8 {
        let smooth = Smooth::new(2_f64.to_radians(), &mut rng);
        let values: Vec<f64> =
            (0..8 * N).map(|i| smooth.at(TAU * i as f64 / (8 * N) as f64)).collect();
        let sampled: Vec<f64> = values.iter().step_by(8).copied().collect();
        for (error, (name, kernel)) in errors.iter_mut().zip(KERNELS) {
            let through = if name == "B-spline" { through(&sampled) } else { sampled.clone() };
            for (error, nodes) in error.iter_mut().zip([through, least_squares(kernel, N, &values)])
            {
                *error += (0..8 * N)
                    .map(|i| {
                        let w = kernel((i % 8) as f64 / 8.0);
                        let along: f64 =
                            (0..4).map(|a| w[a] * nodes[(i / 8 + a + N - 1) % N]).sum();
                        (along - values[i]).powi(2)
                    })
                    .sum::<f64>()
                    / (64 * N) as f64;
            }
        }
    }
    let errors = errors.map(|pair| pair.map(f64::sqrt));
    for ((name, _), [sampled, fitted]) in KERNELS.iter().zip(errors) {
        println!("{name}: {:.1} % sampled, {:.1} % fitted", 100.0 * sampled, 100.0 * fitted);
    }
    let [lines, _, spline] = errors;
    assert!(spline[0] < 0.015 && spline[1] < 0.0115, "{spline:?}");
    assert!(lines[0] > 4.0 * spline[0] && lines[1] > 3.0 * spline[1], "{lines:?}");
}

/// Curves of some of the joints that turn; the bytes live as long as the test.
fn some_curves<const N: usize>(links: &[Link<f64>; N], rng: &mut ChaCha8Rng) -> &'static [u8] {
    let turning = (0_u8..).zip(links).filter(|(_, link)| link.kind == JointKind::Revolute);
    let joints: Vec<u8> =
        turning.map(|(joint, _)| joint).filter(|_| rng.random_bool(0.8)).collect();
    of_joints(&joints, 256, rng).leak()
}

fn curved<T: Scalar, const N: usize>(
    links: [Link<f64>; N],
    rng: &mut ChaCha8Rng,
) -> ArmParameters<'static, T, N> {
    let curves = Curves::of(some_curves(&links, rng)).unwrap();
    ArmParameters {
        curves,
        orientation_identified: true,
        ..arms::stored(links, [0.05, -0.02, 0.1])
    }
}

/// The real arm is the rigid one with every joint moved by its curve, whatever else
/// bends it; so are all the ways to ask for it.
fn stands_where_its_curves_say<const N: usize>(links: [Link<f64>; N]) {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for round in 0..20 {
        let mut p: ArmParameters<f64, N> = curved(links, &mut rng);
        if round % 2 == 1 {
            arms::with_terms(&mut p);
        }
        let arm = Arm::new(&p);
        let plain = Arm::new(&ArmParameters { curves: Curves::NONE, ..p.clone() });
        let (q, state) = (arms::joints(&links, &mut rng), arms::state(&mut rng));
        let mut moved = plain.deflection(&q, &state);
        for curve in p.curves.iter() {
            moved.joints[usize::from(curve.joint())] += curve.at(q[usize::from(curve.joint())]);
        }
        assert_eq!(arm.deflection(&q, &state), moved);
        let pose = arm.real_pose_in(&q, &state);
        assert_eq!(pose, arm.real().forward_deflected(&q, &moved));
        assert_eq!(arm.linearised(&q, &state).point(), pose.translation);
        let tool = arm.with_tool(Pose::translation(0.0, 0.0, 0.2));
        assert_eq!(tool.deflection(&q, &state), moved);
    }
}

#[test]
fn every_arm_stands_where_its_curves_say() {
    stands_where_its_curves_say(ur10());
    stands_where_its_curves_say(puma());
    stands_where_its_curves_say(scara());
    stands_where_its_curves_say(ur10_on_a_rail());
}

/// A complete tick takes curves back as it takes back geometry.
fn is_taken_back<T: Scalar, const N: usize>(links: [Link<f64>; N], task: Task, most: f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut left: Vec<f64> = Vec::new();
    let mut before = 0.0;
    for _ in 0..6 {
        let p: ArmParameters<T, N> = curved(links, &mut rng);
        let state = State::at(p.reference_temperature);
        let settings = Settings { ramp_ticks: 0, ..Settings::new(task) };
        for _ in 0..60 {
            let arm = Arm::new(&p);
            let command = arms::joints(&links, &mut rng).map(T::from_f64);
            let mut compensator = Compensator::new(arm, settings, &command).unwrap();
            compensator.set_active(true);
            // What is applied may change by 1 mrad a tick.
            let tick = (0..40).map(|_| compensator.tick(&command, &state)).last().unwrap();
            let miss = |joints: &[T; N]| {
                let error = compensator.error(&command, joints, &state).position;
                error.iter().map(|e| e.to_f64().powi(2)).sum::<f64>().sqrt()
            };
            if tick.is_complete() {
                left.push(miss(&tick.joints));
                before += miss(&command);
            }
        }
    }
    let count = left.len();
    assert!(count > 100, "{count} of 360 were complete");
    left.sort_by(f64::total_cmp);
    let (median, high, before) = (left[count / 2], left[count * 95 / 100], before / count as f64);
    println!("{N} joints: {before:.2e} m before; {median:.2e} m median, {high:.2e} m 95 %");
    assert!(before > 1e-4 && high < most, "{before} m before, {high} m left");
}

#[test]
fn ticks_take_curves_back() {
    // One look behind Newton's step leaves the curvature's share of a correction
    // squared: 1 mrad^2 times 0.4 mrad over (3 degrees)^2, some 0.1 um a metre.
    is_taken_back::<f64, 6>(ur10(), Task::Pose, 1e-6);
    is_taken_back::<f64, 6>(puma(), Task::Position, 1e-6);
    is_taken_back::<f64, 4>(scara(), Task::Position, 1e-6);
    is_taken_back::<f64, 7>(ur10_on_a_rail(), Task::Pose, 1e-6);
    // And what f32 makes of a metre.
    is_taken_back::<f32, 6>(ur10(), Task::Pose, 3e-6);
}

/// A joint that slipped is found with the curves in place, and they stay.
#[test]
fn reidentification_keeps_the_curves() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let stored: ArmParameters<f64, 6> = curved(ur10(), &mut rng);
    let mut slipped = stored.clone();
    Parameter::JointOffset(2).apply(&mut slipped, 2e-3);
    let points = arms::Tracker::<f64, 6>::new(&slipped, 0.0, 6).points(10);
    let unknowns = [1, 2, 3].map(Parameter::JointOffset);
    let found = Reidentify::new(&stored, unknowns, 20e-6).run(&stored, &points).unwrap();
    assert!((found.change[1] - 2e-3).abs() < 1e-6 && found.rms_after < 1e-6, "{found:?}");
    assert_eq!(found.parameters.curves, stored.curves);
    let without = ArmParameters { curves: Curves::NONE, ..stored.clone() };
    let missed = Reidentify::new(&without, unknowns, 20e-6).fit(&without, &points).unwrap();
    assert!(missed.rms_after > 1e-4 && missed.misfit.contradicts(), "{missed:?}");
}

/// The band of a curve is an error of its joint's angle beside all others.
#[test]
fn the_band_widens_the_point() {
    let links = ur10();
    let nodes = [1e-4; 32];
    let table = [bytes(1, 3e-5, &nodes), bytes(4, 5e-5, &nodes)].concat();
    let mut p: ArmParameters<f64, 6> = arms::stored(links, [0.05, -0.02, 0.1]);
    p.curves = Curves::of(&table).unwrap();
    let mut factor = vec![0.0; factor_len(6, 0)];
    // 0.1 mm in the base's x.
    factor[0] = 1e-4;
    let mut blob = vec![0; encoded_len(6, 0) + 4 * factor.len() + table.len()];
    encode_with(&p, Some(&factor), &mut blob).unwrap();
    let blob = Blob::check(&blob).unwrap();
    let arm = Arm::new(&blob.parameters::<f64, 6>().unwrap());
    let q = [0.3, -1.1, 0.8, 2.0, -0.4, 1.0];
    let sigma = blob.covariance().unwrap().point_sigma(&arm, &q, &arm.state()).unwrap();
    let mut variance = [f64::from(1e-4_f32).powi(2), 0.0, 0.0];
    for curve in blob.curves().iter() {
        let joint = usize::from(curve.joint());
        let at = |step: f64| {
            let mut q = q;
            q[joint] += step;
            arm.real_pose(&q).translation
        };
        // Of a constant curve, whose joint turns as its encoder does.
        let lever = (at(1e-6) - at(-1e-6)) / 2e-6 * f64::from(curve.band());
        (0..3).for_each(|i| variance[i] += lever[i].powi(2));
    }
    for (sigma, variance) in sigma.iter().zip(variance) {
        assert!((sigma - f64::sqrt(variance)).abs() < 1e-10, "{sigma} {variance}");
    }
    // Where a curve is not known it is as wide as it may be there.
    let gaps = Gaps::new(3e-4, &[0, 0xff, 0xff, 0xff]);
    let mut wide = vec![0; curve_len(32) + gaps_len(32)];
    encode_curve_with(1, 1e-8, 3e-5, &[1; 32], Some(gaps), &mut wide).unwrap();
    let mut known = p.clone();
    known.curves = Curves::of(&wide).unwrap();
    let mut stored = vec![0; encoded_len(6, 0) + 4 * factor.len() + wide.len()];
    encode_with(&known, Some(&vec![0.0; factor.len()]), &mut stored).unwrap();
    let gapped = Blob::check(&stored).unwrap();
    let at = |second: f64| {
        let arm = Arm::new(&gapped.parameters::<f64, 6>().unwrap());
        let q = [0.3, second, 0.8, 2.0, -0.4, 1.0];
        gapped.covariance().unwrap().point_sigma(&arm, &q, &arm.state()).unwrap()
    };
    // Joint 2 carries the arm about the base's y: the same lever, ten times the band.
    let size = |sigma: [f64; 3]| sigma.iter().map(|s| s * s).sum::<f64>().sqrt();
    assert!((size(at(0.5)) / size(at(0.5 - 1.0)) - 10.0).abs() < 1e-5);
    // Nor is it that of an arm with other curves.
    let other = bytes(1, 3e-5, &nodes);
    let foreign = ArmParameters { curves: Curves::of(&other).unwrap(), ..p.clone() };
    let mut foreign = foreign;
    foreign.sequence = blob.sequence();
    assert!(blob.covariance().unwrap().point_sigma(&Arm::new(&foreign), &q, &arm.state()).is_err());
}

/// Five tables of 256 nodes, compliance and eight further terms: two such blobs fit two
/// slots of 4 KiB.
#[test]
fn a_real_arm_fits_four_kibibytes() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let table = of_joints(&[0, 1, 2, 3, 4], 256, &mut rng).leak();
    assert_eq!(table.len(), 2620);
    let mut p: ArmParameters<f64, 6> = arms::stored(ur10(), [0.05, -0.02, 0.1]);
    arms::with_terms(&mut p);
    p.terms.truncate(9);
    p.curves = Curves::of(table).unwrap();
    let mut bytes = [0; 4096];
    let size = encode(&p, &mut bytes).unwrap();
    assert_eq!(size, encoded_len(6, 9) + table.len());
    // A tag and the marks of a slot with pages of 32 bytes as well.
    assert!(size + 32 + 64 <= 4096);
    assert_eq!(Blob::check(&bytes).unwrap().parameters::<f64, 6>().unwrap().curves, p.curves);
}
