//! The paper-like cells.

use std::path::PathBuf;

use truearm_host::diagnose::Verdict;
use truearm_host::evaluate::{Reregister, residuals};
use truearm_host::identify::Conditions;
use truearm_host::methods::{Frames, Method, NoCalibration, Rpim, all, compare};
use truearm_host::model::{Measurements, Robot};
use truearm_host::statistics::Stats;
use truearm_study::reproduce::cell::{Cell, Kind};
use truearm_study::reproduce::{CAUTION, cramer_rao, reproduce};

/// Errors that the model represents: as good as the noise allows.
#[test]
fn cell_a_reaches_the_cramer_rao_bound() {
    let methods: Vec<Box<dyn Method>> = vec![Box::new(NoCalibration), Box::new(Rpim)];
    let mut ratios = Vec::new();
    for seed in 1..=100 {
        let cell = Cell::draw(seed, Kind::Geometric).unwrap();
        let robot = &cell.arm.robot;
        let judge = Some((&cell.validation, Reregister::Nothing));
        let found = compare(robot, &cell.identification, judge, Frames::Fitted, &methods).unwrap();
        let [nc, ours] = &found.methods[..] else { unreachable!("two methods") };
        let both = [nc.residuals.clone(), nc.validation_residuals.clone()].concat();
        assert!((Stats::of(&both).unwrap().mean_mm / 2.533 - 1.0).abs() < 2e-3, "seed {seed}");
        assert!(cell.exact.rows.len() >= 200);
        let conditions = Conditions::new(&cell.exact, robot);
        let left = residuals(&cell.exact, &conditions, ours.state.as_ref().unwrap());
        ratios.push(Stats::of(&left).unwrap().rms_mm / (cramer_rao(&cell, found.rank) * 1e3));
    }
    let mean = ratios.iter().sum::<f64>() / 100.0;
    println!("RMS on noise-free poses over Cramer-Rao, mean of 100 seeds: {mean:.3}");
    assert!(mean <= 1.05, "{mean}");
    // A bound that were far too weak would pass as well.
    assert!(mean > 0.9, "{mean}");
}

#[test]
fn cell_b_leaves_what_the_paper_leaves_and_is_explained() {
    let done = reproduce(8, &|_, _| ()).unwrap();
    let mut right = 0;
    for trial in &done.study.trials {
        let ours = trial.beyond[0].scores.iter().find(|s| s.method == "RPIM").unwrap();
        let mae = ours.table.unwrap().mean_mm;
        assert!((mae / 0.472 - 1.0).abs() < 0.02, "seed {}: {mae}", trial.seed);
        let d = &trial.diagnosis;
        println!(
            "seed {}: {:?}, {:.3} -> {:.3} mm",
            trial.seed, d.effects, d.geometry_rms_mm, d.final_rms_mm
        );
        assert!(d.final_rms_mm < 0.3 * d.geometry_rms_mm, "seed {}", trial.seed);
        right += usize::from(d.right && d.verdict == Verdict::Explained);
        // Holding base and tool costs more than all noise.
        let held = &trial.geometric[1].scores.iter().find(|s| s.method == "RPIM-P").unwrap();
        assert!(held.exact.unwrap().rms_mm > 2.0 * trial.rms_mm, "seed {}", trial.seed);
    }
    assert!(right >= 6, "{right} of 8 diagnosed");
    let report = &done.files.iter().find(|f| f.0 == "report.md").unwrap().1;
    assert_eq!(report.lines().next(), Some(CAUTION));
    assert!(!report.contains("NaN"), "{report}");
    for (name, text) in done.files.iter().filter(|f| f.0.ends_with(".svg")) {
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"), "{name}");
        assert!(!text.contains("NaN"), "{name}");
        assert!(report.contains(&format!("]({name})")), "report.md does not show {name}");
    }
}

/// Whoever has the files of a cell finds the figures that the study has of it.
#[test]
fn the_cell_can_be_compared_from_its_files() {
    let done = reproduce(1, &|_, _| ()).unwrap();
    let file = |name: &str| {
        let path = format!("cell/{name}");
        let text = &done.files.iter().find(|f| f.0 == path).unwrap().1;
        (PathBuf::from(path), text)
    };
    let (path, text) = file("robot.toml");
    let robot = Robot::parse(&path, text).unwrap();
    let [data, check] = ["identification.csv", "validation.csv"].map(|name| {
        let (path, text) = file(name);
        Measurements::parse(&path, text, &robot).unwrap()
    });
    let judge = Some((&check, Reregister::Nothing));
    let found = compare(&robot, &data, judge, Frames::Fitted, &all()).unwrap();
    let scores = &done.study.trials[0].beyond[0].scores;
    assert_eq!(found.methods.len(), scores.len());
    for (mine, theirs) in found.methods.iter().zip(scores) {
        assert_eq!(mine.name, theirs.method);
        let close = match (mine.correction_norm, theirs.correction_norm) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-6 * b.abs(),
            (a, b) => a == b,
        };
        assert!(close, "{}: {:?}, {:?}", mine.name, mine.correction_norm, theirs.correction_norm);
    }
}
