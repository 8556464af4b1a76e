//! Links that follow the temperature late, from measurements to the controller's blob.

use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;
use truearm::blob::Blob;
use truearm::effects::{Effect, Term};
use truearm_host::ErrorKind;
use truearm_host::blob::{PackOptions, pack_with, unpack};
use truearm_host::diagnose::{DiagnoseOptions, Diagnosis, diagnose, late};
use truearm_host::evaluate::{Reregister, evaluate};
use truearm_host::files::Wanted;
use truearm_host::model::{Commanded, Measurements, Model, ModelTerm, Path, Robot};
use truearm_host::paths::{CompensateOptions, Row, compensate, missing_inputs};
use truearm_host::verify::verify;
use truearm_simulate::arm::Arm;
use truearm_simulate::body::{Body, Moment};
use truearm_simulate::effects::{Defect, DefectKind};
use truearm_simulate::warming::Climate;

use crate::simulated::{UR10_LIKE, robot, stated, vector};

const SIGMA: f64 = 2e-5;
const TAU: f64 = 1500.0;

/// An arm that grows, and its session.
struct Cell {
    robot: Robot,
    arm: Arm,
    climate: Climate,
    rng: ChaCha8Rng,
}

impl Cell {
    fn new(tau: f64, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let robot = robot(UR10_LIKE);
        let told = stated(&robot);
        let body = Body {
            kinds: told.joints.iter().map(|j| j.kind).collect(),
            links: told
                .joints
                .iter()
                .map(|j| {
                    let error = [vector(&mut rng), vector(&mut rng)];
                    core::array::from_fn(|k| j.link[k] + 3e-4 * error[k / 3][k % 3])
                })
                .collect(),
            gear_ratios: vec![100.0; told.joints.len()],
            masses: told.masses.clone(),
            gravity: Vector3::new(0.0, 0.0, -9.81),
            station: truearm_simulate::rigid(&vector(&mut rng), &vector(&mut rng)),
            tool: robot.tool,
        };
        let growth = Defect { kind: DefectKind::ThermalExpansion, size: 1.6e-5 };
        let climate = Climate::drawn(5.0, tau, &mut rng);
        Self { robot, arm: Arm { body, defects: vec![growth] }, climate, rng }
    }

    /// Measured rows with the columns of time and temperature that are wanted.
    fn rows(&mut self, rows: usize, prefix: &str, timed: bool) -> (String, Vec<Moment>) {
        let moments = self.climate.moments(&stated(&self.robot), rows, &mut self.rng);
        let mut text = (1..=6).map(|j| format!("{prefix}{j}_deg,")).collect::<String>();
        text += if timed {
            "x_mm,y_mm,z_mm,temperature_c,time_s\n"
        } else {
            "x_mm,y_mm,z_mm,temperature_c\n"
        };
        for m in &moments {
            let point = (self.arm.point(m) + vector(&mut self.rng) * SIGMA) * 1e3;
            m.q.iter().for_each(|q| text += &format!("{:.5},", q.to_degrees()));
            text += &format!("{:.5},{:.5},{:.5},{:.1}", point.x, point.y, point.z, m.temperature);
            text += &if timed { format!(",{:.1}\n", m.time) } else { "\n".to_owned() };
        }
        (text, moments)
    }

    fn parsed(&self, text: &str) -> Measurements {
        Measurements::parse("m.csv".as_ref(), text, &self.robot).unwrap()
    }
}

fn found(cell: &Cell, data: &Measurements, held: Option<&Measurements>) -> Diagnosis {
    diagnose(&cell.robot, data, held, &DiagnoseOptions::default(), &|_| {}).unwrap()
}

#[test]
fn an_arm_that_is_late_is_named_judged_and_flashed() {
    let mut cell = Cell::new(TAU, 3);
    let (text, _) = cell.rows(120, "q", true);
    let data = cell.parsed(&text);
    let held = cell.rows(40, "q", true).0;
    let held = cell.parsed(&held);
    let diagnosis = found(&cell, &data, Some(&held));
    let outcome = &diagnosis.outcome;
    let [effect] = &outcome.effects[..] else { panic!("{:?}", outcome.effects) };
    assert_eq!(effect.name, Effect::ThermalExpansion.name());
    let (tau, sigma) = (effect.time_constant_s.unwrap(), effect.time_constant_sigma_s.unwrap());
    assert!((tau - TAU).abs() < 3.0 * sigma && sigma < 0.1 * TAU, "{tau} +- {sigma} s");
    assert!((effect.coefficients[0].value - 1.6e-5).abs() < 5e-7, "{effect:?}");
    assert!(late(effect).unwrap().starts_with("with the temperature as it was, 2"), "{effect:?}");
    let last = outcome.gap.last().unwrap();
    assert!(last.holdout_rms_mm.unwrap() < 2.2 * SIGMA * 1e3, "{last:?}");

    // As a file, and as a blob.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    std::fs::write(&path, diagnosis.model.to_toml()).unwrap();
    let model = Model::read(&path).unwrap();
    assert_eq!(model.terms, diagnosis.model.terms);
    let blob = pack_with(&model, &PackOptions::default()).unwrap();
    let packed = Blob::check(&blob).unwrap().parameters::<f64, 6>().unwrap();
    assert_eq!(truearm::Arm::new(&packed).thermal_lag().time_constant(), tau);
    let back = unpack(&blob, &path, None).unwrap();
    let constants = |m: &Model| m.terms.iter().find_map(ModelTerm::time_constant);
    assert_eq!(constants(&back), Some(tau));
    assert!(pack_with(&back, &PackOptions::default()).is_ok());

    rows_are_judged(&mut cell, &model, &held);
    paths_are_corrected(&mut cell, &model, tau);
}

/// Rows without times are refused, unless nothing hangs on them.
fn rows_are_judged(cell: &mut Cell, model: &Model, held: &Measurements) {
    let rms = |data: &Measurements| {
        evaluate(model, data, Reregister::Nothing).map(|v| v.stats.unwrap().rms_mm)
    };
    assert!(rms(held).unwrap() < 2.2 * SIGMA * 1e3);
    let (untimed, _) = cell.rows(30, "q", false);
    let refused = rms(&cell.parsed(&untimed)).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::NoTimes);
    let said = format!("{refused} {}", refused.help());
    assert!(said.contains("m.csv: line 2") && said.contains("column time_s"), "{said}");
    // One temperature needs no time; at none at all the reference is taken, as ever.
    let settled = |cell: &str| {
        let lines = untimed.lines().skip(1).map(|line| {
            let (rest, _) = line.rsplit_once(',').unwrap();
            format!("{rest},{cell}\n")
        });
        untimed.lines().take(1).map(|l| format!("{l}\n")).chain(lines).collect::<String>()
    };
    assert!(rms(&cell.parsed(&settled("24.5"))).is_ok());
    assert!(rms(&cell.parsed(&settled(""))).is_ok());

    let (commanded, _) = cell.rows(30, "cmd", false);
    let commanded = Commanded::parse("c.csv".as_ref(), &commanded, &cell.robot).unwrap();
    let refused = verify(model, &commanded, false).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::NoTimes, "{refused}");
    let (commanded, _) = cell.rows(30, "cmd", true);
    let commanded = Commanded::parse("c.csv".as_ref(), &commanded, &cell.robot).unwrap();
    assert!(verify(model, &commanded, false).is_ok());
}

/// A path is corrected as for an arm at once that has the temperatures that the filter of the
/// crate makes of those that were read.
fn paths_are_corrected(cell: &mut Cell, model: &Model, tau: f64) {
    let mut at_once = model.clone();
    for term in &mut at_once.terms {
        if let ModelTerm::Arm(Term { effect: Effect::ThermalExpansion, order, .. }) = term {
            *order = 0.0;
        }
    }
    let (_, moments) = cell.rows(40, "q", true);
    let mut lag = truearm::ThermalLag::new(tau);
    let mut texts = [(); 3].map(|()| (1..=6).map(|j| format!("q{j}_deg,")).collect::<String>());
    texts[0] += "temperature_c,time_s\n";
    texts[1] += "temperature_c\n";
    texts[2] += "temperature_c\n";
    let mut before = 0.0;
    for m in &moments {
        let q: String = m.q.iter().map(|q| format!("{:.5},", q.to_degrees())).collect();
        let arm = lag.step(m.time - before, m.temperature);
        before = m.time;
        texts[0] += &format!("{q}{},{}\n", m.temperature, m.time);
        texts[1] += &format!("{q}{arm}\n");
        texts[2] += &format!("{q}{}\n", m.temperature);
    }
    let corrected = |model: &Model, text: &str| {
        let path = Path::parse("p.csv".as_ref(), text, &cell.robot, Wanted::Joints).unwrap();
        let options = CompensateOptions { extrapolate: true, ..CompensateOptions::default() };
        compensate(model, &path, &options).map(|done| {
            let joints = done.rows.into_iter().map(|row| match row {
                Row::Corrected { joints, left, .. } => (joints, left),
                Row::NotReached(_) => panic!("joints are reached"),
            });
            joints.collect::<Vec<_>>()
        })
    };
    let (late, known) =
        (corrected(model, &texts[0]).unwrap(), corrected(&at_once, &texts[1]).unwrap());
    for ((a, left), (b, _)) in late.iter().zip(&known) {
        let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9 && left[0] < 1e-4, "{apart} rad, {left:?}");
    }
    let other = corrected(&at_once, &texts[2]).unwrap();
    let moved = late.iter().zip(&other).map(|((a, _), (b, _))| (a[1] - b[1]).abs());
    assert!(moved.fold(0.0, f64::max) > 1e-6, "the delay does nothing");
    // Over midnight: said, for the rows are taken in the order of their times.
    let said = |text: &str| {
        let path = Path::parse("path.csv".as_ref(), text, &cell.robot, Wanted::Joints).unwrap();
        missing_inputs(model, &path).iter().any(|s| s.contains("time_s goes back at line"))
    };
    assert!(!said(&texts[0]));
    let (head, rows) = texts[0].split_once('\n').unwrap();
    let mut rows: Vec<&str> = rows.lines().collect();
    let middle = rows.len() / 2;
    rows.rotate_left(middle);
    assert!(said(&format!("{head}\n{}\n", rows.join("\n"))));
    let refused = corrected(model, &texts[2]).unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::NoTimes, "{refused}");
}

/// An arm that follows its temperature at once has no time constant, and without times none
/// is looked for, which is said.
#[test]
fn an_arm_that_is_not_late_is_not_said_to_be() {
    let mut cell = Cell::new(0.0, 4);
    let (text, _) = cell.rows(100, "q", true);
    let outcome = found(&cell, &cell.parsed(&text), None).outcome;
    let [effect] = &outcome.effects[..] else { panic!("{:?}", outcome.effects) };
    assert_eq!((effect.name, effect.time_constant_s), (Effect::ThermalExpansion.name(), None));
    let (text, _) = cell.rows(60, "q", false);
    let outcome = found(&cell, &cell.parsed(&text), None).outcome;
    let said = |line: &String| line.contains("thermal-expansion that is late: needs time_s");
    assert!(outcome.not_testable.iter().any(said), "{:?}", outcome.not_testable);
}

/// A model.toml whose terms follow the temperature in two ways fits no controller.
#[test]
fn one_arm_has_one_time_constant() {
    let mut model = Model::nominal(robot(UR10_LIKE));
    let term = |joint, order| {
        let effect = Effect::ThermalExpansion;
        ModelTerm::Arm(Term { effect, joint, source: 0, component: 0, order, coefficient: 1e-5 })
    };
    model.markers = vec![(String::new(), Vector3::zeros())];
    model.stations = vec![(String::new(), Pose::identity())];
    model.terms = vec![term(Term::<f64>::ALL, TAU), term(2, 600.0)];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    std::fs::write(&path, model.to_toml()).unwrap();
    let refused = Model::read(&path).unwrap_err().to_string();
    assert!(refused.contains("all of thermal-expansion have one time_constant_s"), "{refused}");
    model.terms = vec![term(Term::<f64>::ALL, TAU), term(2, TAU)];
    std::fs::write(&path, model.to_toml()).unwrap();
    assert_eq!(Model::read(&path).unwrap().terms, model.terms);
}
