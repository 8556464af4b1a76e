//! Verification after flashing, on a simulated arm whose compensation is known.

use std::path::Path;

use crate::simulated;
use crate::simulated::{Truth, UR10_LIKE, robot};
use nalgebra::{Matrix3xX, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::Pose;
use truearm_host::files::poses_csv;
use truearm_host::identify::{Options, identify};
use truearm_host::model::arm::{RowInputs, chain};
use truearm_host::model::{Commanded, Measurements, Model, Workspace};
use truearm_host::verify::{
    Conformity, OfPoints, Verification, accuracy, repeatability, test_poses, verify,
};

const SIGMA: f64 = 2e-5;

struct Cell {
    truth: Truth,
    data: Measurements,
    model: Model,
}

impl Cell {
    fn new(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let truth = Truth::draw(&robot(UR10_LIKE), 1, 1, &mut rng);
        let data = truth.parse(&truth.measure(60, SIGMA, &mut rng));
        let model = identify(&truth.robot, &data, &Options::default(), &|_, _| ()).unwrap().model;
        Self { truth, data, model }
    }

    /// What a compensating controller sends to the drives: joints at which the
    /// identified tool is where the nominal one would be.
    fn corrected(&self, q: &[f64]) -> Vec<f64> {
        let model = &self.model;
        let frame = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
        let real = chain(&model.links(), frame, model.markers[0].1);
        let nominal = chain(&model.robot.nominal(), Pose::identity(), model.markers[0].1);
        let target = nominal.pose(q).translation;
        let mut q = q.to_vec();
        for _ in 0..6 {
            let d = real.derivatives(&q, &[], &RowInputs::default());
            let columns: Vec<Vector3<f64>> = d.links.iter().map(|l| l.theta).collect();
            let jacobian = Matrix3xX::from_columns(&columns);
            let step = jacobian.clone().pseudo_inverse(1e-6).unwrap() * (target - d.point);
            q.iter_mut().zip(step.iter()).for_each(|(q, s)| *q += s);
        }
        assert!((real.pose(&q).translation - target).norm() < 1e-9);
        q
    }

    /// A file of these commanded poses, each measured so often.
    fn file(&self, poses: &[Vec<f64>], repeats: usize, on: bool, rng: &mut ChaCha8Rng) -> String {
        let mut text =
            "cmd1_deg,cmd2_deg,cmd3_deg,cmd4_deg,cmd5_deg,cmd6_deg,x_mm,y_mm,z_mm,station,marker\n"
                .to_owned();
        for q in poses {
            let sent = if on { self.corrected(q) } else { q.clone() };
            for _ in 0..repeats {
                let p = (self.truth.point(&sent, 0, 0) + simulated::vector(rng) * SIGMA) * 1e3;
                let joints: Vec<String> =
                    q.iter().map(|q| format!("{:.9}", q.to_degrees())).collect();
                text += &format!("{},{:.6},{:.6},{:.6},S0,M0\n", joints.join(","), p.x, p.y, p.z);
            }
        }
        text
    }

    fn read(&self, text: &str) -> Commanded {
        Commanded::parse(Path::new("v.csv"), text, &self.model.robot).unwrap()
    }
}

fn of_points(found: &Verification) -> &OfPoints {
    found.points.as_ref().unwrap()
}

fn poses(count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    (0..count).map(|_| (0..6).map(|_| rng.random_range(-2.4..2.4)).collect()).collect()
}

#[test]
fn before_and_after() {
    let cell = Cell::new(1);
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let poses = poses(30, &mut rng);
    let on = cell.read(&cell.file(&poses, 5, true, &mut rng));
    let off = cell.read(&cell.file(&poses, 5, false, &mut rng));
    let after = verify(&cell.model, &on, false).unwrap();
    let before = verify(&cell.model, &off, false).unwrap();
    println!(
        "before {:.3} mm, after {:.4} mm RMS, AP {:.4}, RP {:.4}, U {:.4}",
        of_points(&before).errors.rms_mm,
        of_points(&after).errors.rms_mm,
        of_points(&after).accuracy.max_mm,
        of_points(&after).repeatability.unwrap().max_mm,
        of_points(&after).expanded_uncertainty_mm
    );
    assert_eq!((after.rows, after.poses, after.repeats), (150, 30, [5, 5]));
    assert!(of_points(&before).errors.rms_mm > 1.0 && of_points(&after).errors.rms_mm < 0.06);
    // What the model says of the arm without compensation is what is measured.
    for found in [&before, &after] {
        let predicted = of_points(found).predicted_without_compensation.unwrap();
        assert!((predicted.rms_mm / of_points(&before).errors.rms_mm - 1.0).abs() < 0.02);
    }
    // Noise of 20 um a coordinate: mean distance to a barycentre of five, and
    // three of its deviations.
    let rp = of_points(&after).repeatability.unwrap();
    assert_eq!(rp.poses, 30);
    assert!((0.04..0.1).contains(&rp.mean_mm), "{rp:?}");
    assert!((of_points(&after).expanded_uncertainty_mm / 0.0407 - 1.0).abs() < 0.02);

    assert_eq!(after.kinds[0].conformity(0.3), Conformity::Pass);
    assert_eq!(before.kinds[0].conformity(0.3), Conformity::Fail);
    let edge = of_points(&after).errors.max_mm;
    assert_eq!(after.kinds[0].conformity(edge + 0.01), Conformity::NotProven);
    assert_eq!(after.kinds[0].conformity(edge - 0.01), Conformity::NotProven);
    assert_eq!(after.kinds[0].conformity(edge + 0.05), Conformity::Pass);
}

#[test]
fn commanded_points_and_a_moved_tracker() {
    let cell = Cell::new(3);
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let poses = poses(20, &mut rng);
    let text = cell.file(&poses, 2, true, &mut rng);
    let joints = verify(&cell.model, &cell.read(&text), false).unwrap();
    // The same as points in the robot's frame.
    let nominal = chain(&cell.model.robot.nominal(), Pose::identity(), cell.model.markers[0].1);
    let mut points = "cmd_x_mm,cmd_y_mm,cmd_z_mm,x_mm,y_mm,z_mm,station\n".to_owned();
    for (i, line) in text.lines().skip(1).enumerate() {
        let p = nominal.pose(&poses[i / 2]).translation * 1e3;
        let cells: Vec<&str> = line.split(',').collect();
        points += &format!("{:.9},{:.9},{:.9},{},S0\n", p.x, p.y, p.z, cells[6..9].join(","));
    }
    let same = verify(&cell.model, &cell.read(&points), false).unwrap();
    assert_eq!((same.poses, same.repeats), (20, [2, 2]));
    assert!((of_points(&same).errors.rms_mm - of_points(&joints).errors.rms_mm).abs() < 1e-6);
    assert!(of_points(&same).predicted_without_compensation.is_none());

    // Another station: refused, then fitted, which is hardly worse than the truth.
    let moved = text.replace(",S0,", ",S9,");
    let moved = cell.read(&moved);
    let error = verify(&cell.model, &moved, false).unwrap_err();
    assert!(error.to_string().contains("station \"S9\" is unknown"), "{error}");
    assert!(error.help().contains("--reregister base"), "{}", error.help());
    let fitted = verify(&cell.model, &moved, true).unwrap();
    assert!(
        of_points(&fitted).errors.rms_mm <= 1.2 * of_points(&joints).errors.rms_mm
            && of_points(&fitted).errors.rms_mm > 0.02
    );
    assert!(
        of_points(&fitted).expanded_uncertainty_mm > of_points(&joints).expanded_uncertainty_mm
    );
}

/// A tracker that was moved and not registered again: what its motion leaves is what
/// registering it leaves, and the verdict stays. Errors that are the arm's have no such hint.
#[test]
fn a_moved_frame_is_told() {
    let cell = Cell::new(3);
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let poses = poses(20, &mut rng);
    let read = |on: bool, rng: &mut ChaCha8Rng| cell.read(&cell.file(&poses, 2, on, rng));
    let on = read(true, &mut rng);
    let moved_by = |turn: Vector3<f64>, shift: Vector3<f64>| {
        let motion = Pose::from_rotation_vector(shift, turn);
        let mut moved = on.clone();
        for row in &mut moved.data.rows {
            let point = motion.transform_point(&row.measured.point());
            row.measured = point.iter().copied().collect();
        }
        moved
    };
    for (turn, shift, conformity) in [
        (Vector3::new(0.0, 0.0, 0.5), Vector3::new(0.3, 0.2, 0.01), Conformity::Fail),
        (Vector3::new(0.0, 0.0, 1e-4), Vector3::new(4e-4, 2e-4, 1e-4), Conformity::Fail),
    ] {
        let moved = moved_by(turn, shift);
        let found = verify(&cell.model, &moved, false).unwrap();
        assert_eq!(found.kinds[0].conformity(0.2), conformity);
        let told = found.frame_moved.unwrap();
        let fitted = verify(&cell.model, &moved, true).unwrap();
        let errors = of_points(&fitted).errors;
        assert!((told.left_rms_mm - errors.rms_mm).abs() < 1e-9, "{told:?} {errors:?}");
        assert!((told.left_max_mm - errors.max_mm).abs() < 1e-9, "{told:?} {errors:?}");
        assert!((told.turn_deg - turn.norm().to_degrees()).abs() < 2e-3, "{told:?}");
        let remark = found.warnings.iter().find(|w| w.contains("--reregister base"));
        assert!(remark.unwrap().contains("one rigid motion of the frame"), "{remark:?}");
        assert!(fitted.frame_moved.is_none());
    }
    let mut one = on.clone();
    let point = one.data.rows[7].measured.point() + Vector3::new(0.0, 5e-3, 0.0);
    one.data.rows[7].measured = point.iter().copied().collect();
    for own in [&on, &one, &read(false, &mut rng)] {
        let found = verify(&cell.model, own, false).unwrap();
        assert!(found.frame_moved.is_none(), "{:?}", found.frame_moved);
    }
}

/// ISO 9283 by hand: four points at the corners of a square of 2 mm about a
/// barycentre that is 3, 4, 0 mm off.
#[test]
fn figures_of_the_standard() {
    let at = |x: f64, y: f64| Vector3::new(3.0 + x, 4.0 + y, 0.0) * 1e-3;
    let square = [at(1.0, 1.0), at(1.0, -1.0), at(-1.0, 1.0), at(-1.0, -1.0)];
    assert!((accuracy(&square) - 5e-3).abs() < 1e-12);
    // Every distance is the root of two: no spread.
    assert!((repeatability(&square).unwrap() - 2_f64.sqrt() * 1e-3).abs() < 1e-12);
    // Distances 1, 1, 0: mean 2/3, S = sqrt(1/3).
    let line = [at(1.0, 0.0), at(-1.0, 0.0), at(0.0, 0.0)];
    let expected = (2.0 / 3.0 + 3.0 * (1.0_f64 / 3.0).sqrt()) * 1e-3;
    assert!((repeatability(&line).unwrap() - expected).abs() < 1e-12);
    assert_eq!(repeatability(&square[..1]), None);
}

/// A row that was written thirty times was measured once: no repeatability of 0 is said of it.
#[test]
fn copies_are_no_repetitions() {
    let cell = Cell::new(1);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let text = cell.file(&poses(4, &mut rng), 1, true, &mut rng);
    let (header, rows) = text.split_once('\n').unwrap();
    let copied = format!("{header}\n{}", rows.repeat(30));
    let found = verify(&cell.model, &cell.read(&copied), false).unwrap();
    assert_eq!(found.repeats, [1, 1]);
    assert!(of_points(&found).repeatability.is_none());
    assert!(found.warnings.iter().any(|w| w.contains("116 rows of the same cells")), "{found:?}");
}

#[test]
fn test_poses_are_others() {
    let cell = Cell::new(5);
    let limits = cell.model.covered.iter().map(|c| c.unwrap()).collect();
    let region = Workspace::new(&cell.model.robot, Some(limits)).unwrap();
    let poses = test_poses(&cell.model, &region, Some(&cell.data), 25, 1).unwrap();
    assert_eq!(poses.len(), 25);
    let text = poses_csv(&cell.model.robot, "cmd", &poses, &[]);
    assert!(text.starts_with("cmd1_deg,cmd2_deg"));
    let near =
        |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs().to_degrees() <= 5.0);
    for q in &poses {
        assert!(cell.data.rows.iter().all(|r| !near(&r.q, q)));
    }
    // Where everything is near a used pose there are none.
    let narrow = cell.data.rows[0].q.iter().map(|q| [q - 0.02, q + 0.02]).collect();
    let region = Workspace::new(&cell.model.robot, Some(narrow)).unwrap();
    let error = test_poses(&cell.model, &region, Some(&cell.data), 5, 1).unwrap_err();
    assert!(error.to_string().contains("only 0 of 5 test poses"), "{error}");
}

#[test]
fn bad_files() {
    let cell = Cell::new(6);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let good = cell.file(&poses(3, &mut rng), 1, true, &mut rng);
    let points = "cmd_x_mm,cmd_y_mm,cmd_z_mm,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n";
    for (text, says) in [
        (String::new(), "v.csv: the file is empty"),
        (good.lines().next().unwrap().to_owned(), "v.csv: no data rows"),
        (good.replace("cmd", "q"), "v.csv:1: no commanded joints and no commanded points"),
        (good.replace("cmd4_deg", "cmd4"), "v.csv:1: missing column cmd4_deg"),
        (good.replace("marker", "cmd7_deg"), "v.csv:1: column cmd7_deg, but"),
        (good.replace("marker", "cmd_x_mm"), "both commanded joints and commanded points"),
        (good.replacen("S0,M0", "S0", 1), "v.csv:2: 10 cells where the header has 11"),
        (points.replace("cmd_z_mm", "z"), "v.csv:1: missing column cmd_z_mm"),
        (
            points.replace("1,2,3", "1,NaN,3"),
            "v.csv:2, column cmd_y_mm: \"NaN\" is not a coordinate",
        ),
        (points.replace("x_mm,y_mm,z_mm\n", "y_mm,z_mm,w\n"), "missing column x_mm"),
    ] {
        let error = Commanded::parse(Path::new("v.csv"), &text, &cell.model.robot).unwrap_err();
        assert!(error.to_string().contains(says), "{error}\nshould say\n{says}");
        assert!(!error.help().is_empty(), "{error}");
    }
    let marker = cell.read(&good.replace(",M0", ",M7"));
    let error = verify(&cell.model, &marker, false).unwrap_err();
    assert!(error.to_string().contains("marker \"M7\" is unknown"), "{error}");
    let error = verify(&cell.model, &cell.read(&good), true).unwrap_err();
    assert!(error.to_string().contains("3 places of station \"S0\" do not fix a frame"), "{error}");
}

/// What a tolerance of half a millimetre says of so many poses, each measured so often, in a
/// frame that is fitted to them: these are off by so much, mm, any way.
fn refitted(cell: &Cell, (count, times, seed): (usize, usize, u64), off: &[f64]) -> Conformity {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let text = cell.file(&poses(count, &mut rng), times, true, &mut rng);
    let ways: Vec<Vector3<f64>> =
        off.iter().map(|by| truearm_simulate::vector(&mut rng).normalize() * *by).collect();
    let mut lines = text.lines();
    let mut made = format!("{}\n", lines.next().unwrap());
    for (k, line) in lines.enumerate() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        for (cell, by) in cells[6..9].iter_mut().zip(&ways[k / times]) {
            *cell = (cell.parse::<f64>().unwrap() + by).to_string();
        }
        made += &(cells.join(",") + "\n");
    }
    verify(&cell.model, &cell.read(&made), true).unwrap().kinds[0].conformity(0.5)
}

/// An error hides in no frame that is fitted to few poses, and what is within the tolerance
/// does not fail by what it does to the frame of others.
#[test]
fn frames_that_are_fitted_to_the_file_are_no_judges() {
    let cell = Cell::new(8);
    for (count, times) in [(4, 1), (5, 4), (8, 1), (30, 2)] {
        for seed in 0..30 {
            let of = |off: &[f64]| refitted(&cell, (count, times, seed), off);
            let name = format!("{count} poses, {times} times, seed {seed}");
            let one: Vec<f64> = (0..count).map(|k| if k == 1 { 0.9 } else { 0.0 }).collect();
            assert_ne!(of(&one), Conformity::Pass, "{name}");
            assert!(count < 30 || of(&one) == Conformity::Fail, "{name}");
            // The arm is 20 um off beside, and so is the measurement.
            assert_ne!(of(&vec![0.45; count]), Conformity::Fail, "{name}");
            assert_ne!(of(&vec![0.0; count]), Conformity::Fail, "{name}");
            assert!(count < 8 || of(&vec![0.0; count]) == Conformity::Pass, "{name}");
        }
    }
}
