//! Stated intervals hold the truth as often as they say.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_host::identify::certainty::error_bars::FACTOR;
use truearm_host::identify::{LambdaRule, Options, identify};
use truearm_study::coverage::{Cell, Noise, Tally, identified_once};
use truearm_study::simulated::{Truth, UR10_LIKE, robot};

/// The long form, 1,000 simulations a case: `cargo xtask study coverage`.
#[test]
fn intervals_hold_the_truth() {
    // Few and coarse data leave much to the tolerances: there the bias counts.
    for (poses, sigma, weak) in [(20, 2e-5, false), (14, 2e-4, true)] {
        let cell = Cell::new(poses, sigma, 1);
        let each: Vec<_> = (0..150)
            .map(|k| identified_once(&cell, true, &mut ChaCha8Rng::seed_from_u64(500 + k)))
            .collect();
        for (what, [total, noise]) in Tally::of(&each) {
            println!("{poses} poses, {what}: {total:.3} with bias, {noise:.3} from noise alone");
            assert!((0.925..0.975).contains(&total), "{what}");
            assert!(!weak || noise < total, "{what}");
        }
    }
}

/// Where the arm stood is common to the readings of a pose, however often they are taken; tails
/// are wider than the middle of their distribution says.
#[test]
fn intervals_hold_whatever_the_noise_is() {
    let noises =
        [Noise::Common(5, 0.95), Noise::Common(4, 0.0), Noise::Common(30, 0.97), Noise::Tails];
    for noise in noises {
        let cell = Cell::new(30, 3e-5, 1).noisy(noise);
        let each: Vec<_> = (0..60)
            .map(|k| identified_once(&cell, true, &mut ChaCha8Rng::seed_from_u64(900 + k)))
            .collect();
        for (what, [total, _]) in Tally::of(&each) {
            println!("{noise:?}, {what}: {total:.3}");
            assert!((0.915..0.985).contains(&total), "{noise:?}, {what}: {total}");
        }
    }
}

/// Of arms made far worse than the tolerances too: lambda says by how much.
#[test]
fn intervals_of_worse_arms_widen() {
    let cell = Cell::made(10.0, LambdaRule::default(), (20, 2e-5), 1);
    let each: Vec<_> = (0..60)
        .map(|k| identified_once(&cell, true, &mut ChaCha8Rng::seed_from_u64(700 + k)))
        .collect();
    for (what, [total, noise]) in Tally::of(&each) {
        println!("{what}: {total:.3} with bias, {noise:.3} from noise alone");
        assert!((0.92..0.98).contains(&total), "{what}");
        // That much of the parameters is bias, which the tolerances would not know.
        assert!(what != "parameters" || noise < 0.85, "{what}");
    }
}

#[test]
fn the_report_says_what_is_told_together_only() {
    let robot = robot(UR10_LIKE);
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let truth = Truth::draw(&robot, 1, 1, &mut rng);
    let data = truth.parse(&truth.measure(52, 2e-5, &mut rng));
    let report = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap().figures;
    let u = &report.uncertainty;
    assert_eq!(u.parameters.len(), 30);
    // Parallel axes: what their offsets are each, only the tolerance says.
    let bar = |name: &str| u.parameters.iter().find(|p| p.name == name).unwrap();
    let (known, unknown) = (bar("joint 3 a"), bar("joint 3 d"));
    assert!(known.half_width < 0.05 && known.noise_half_width > 0.5 * known.half_width);
    assert!(unknown.half_width > 0.5 && unknown.noise_half_width < 0.1 * unknown.half_width);
    assert!(u.tool_point.rms_mm < u.tool_point.max_mm);
    assert!(u.tool_point.noise_rms_mm <= u.tool_point.rms_mm);
    println!("{:#?}", u.correlations);

    // Hardly any motion of joint 3: its zero and that of joint 2 go together.
    let mut narrow = data.clone();
    narrow.rows.clear();
    for row in &truth.parse(&truth.measure(400, 0.0, &mut rng)).rows {
        let mut row = row.clone();
        row.q[2] = 0.8 + 0.02 * row.q[2];
        row.measured = truth.point(&row.q, 0, 0).into();
        row.pose = narrow.rows.len();
        narrow.rows.push(row);
    }
    narrow.poses = narrow.rows.len();
    let report = identify(&robot, &narrow, &Options::default(), &|_, _| ()).unwrap().figures;
    println!("{:#?}", report.uncertainty.correlations);
    assert!(
        report.uncertainty.correlations.iter().any(|c| c.contains("joint 3")),
        "{:#?}",
        report.uncertainty.correlations
    );
}

/// Where joints err by curves, what is not known of those is in the tool point's interval:
/// the same poses predicted by the diagnosed model, against where the tool was.
#[test]
fn the_tool_point_is_known_no_better_than_its_curves() {
    let robot = robot(UR10_LIKE);
    for (seed, rows) in [(31, 300), (32, 900)] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let truth = Truth::draw(&robot, 1, 1, &mut rng);
        let mut data = truth.parse(&truth.measure(rows, 0.0, &mut rng));
        let waves: Vec<[f64; 3]> = (0..3 * 40)
            .map(|k| [f64::from(k % 40 + 1), rng.random_range(0.0..std::f64::consts::TAU), 6e-5])
            .collect();
        let mut exact = Vec::new();
        for row in &mut data.rows {
            let mut bent = row.q.clone();
            for (k, [order, phase, size]) in waves.iter().enumerate() {
                let joint = k / 40;
                bent[joint] += size * (order * row.q[joint] + phase).sin();
            }
            let point = truth.point(&bent, 0, 0);
            exact.push(point);
            // Twelve uniform numbers are as good as normal.
            let normal =
                |rng: &mut ChaCha8Rng| (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
            let noise = Vector3::from_fn(|_, _| 3e-5 * normal(&mut rng));
            row.measured = (point + noise).into();
        }
        let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
        assert!(found.model.curves.len() >= 3, "{:?}", found.outcome.unnamed);
        let off = found.rows.iter().zip(&data.rows).zip(&exact).map(|((result, row), exact)| {
            let left = result.identified.values();
            let predicted = Vector3::from_fn(|k, _| row.measured[k] - left[k]);
            (predicted - exact).norm_squared() / 3.0
        });
        let off = (off.sum::<f64>() / rows as f64).sqrt() * 1e3;
        let stated = found.outcome.figures.uncertainty.tool_point.rms_mm / FACTOR;
        println!("{rows} rows: off by {off:.4} mm a coordinate, {stated:.4} stated");
        assert!((0.8..1.6).contains(&(stated / off)), "{stated} {off}");
    }
}
