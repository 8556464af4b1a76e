//! Terms on their way from a model.toml to the controller.

use std::path::Path;

use assert_cmd::Command;
use truearm::blob::Blob;
use truearm::effects::{Effect, Term};
use truearm_host::blob::describe;
use truearm_host::blob::{notes, pack};
use truearm_host::identify::{Options, identify};
use truearm_host::model::{Clock, Measurements, Model, ModelTerm, Robot};

fn term(effect: Effect, joint: u8, order: f64) -> ModelTerm {
    let coefficient = 1.5e-5;
    ModelTerm::Arm(Term { effect, joint, source: 0, component: 0, order, coefficient })
}

/// The paper's arm with masses and terms added by hand.
fn model() -> Model {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data");
    let robot = Robot::read(&data.join("seed-table-8/robot.toml")).unwrap();
    let rows = Measurements::read(&data.join("seed-table-8/measurements.csv"), &robot).unwrap();
    let mut model = identify(&robot, &rows, &Options::default(), &|_, _| ()).unwrap().model;
    let loads = Robot::read(&data.join("ur10-ipa/robot.toml")).unwrap();
    (model.robot.gravity, model.robot.links) = (loads.gravity, loads.links);
    model.robot.reference_temperature = 22.5;
    model.terms = vec![
        term(Effect::JointCompliance, 1, 0.0),
        ModelTerm::Drift { component: 4, course: Clock::Time.goes_on(), coefficient: 1e-4 },
        term(Effect::JointPeriodicError, 2, 3.15),
        term(Effect::Backlash, 0, 2.5),
        ModelTerm::Remount { series: "2".into(), axis: 0, coefficient: 1e-4 },
        term(Effect::ThermalExpansion, Term::<f64>::ALL, 0.0),
    ];
    model
}

#[test]
fn a_model_file_keeps_its_terms() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    let written = model();
    std::fs::write(&path, written.to_toml()).unwrap();
    let read = Model::read(&path).unwrap();
    // Terms of the measurement come last.
    let (arm, other): (Vec<_>, Vec<_>) =
        written.terms.iter().cloned().partition(|t| matches!(t, ModelTerm::Arm(_)));
    assert_eq!(read.terms, [arm, other].concat());

    let text = written.to_toml().replace("unit = \"rad/Nm\"", "unit = \"deg/Nm\"");
    std::fs::write(&path, text).unwrap();
    let error = Model::read(&path).unwrap_err().to_string();
    assert!(error.contains("[[terms]] entry 1: unit \"deg/Nm\" where \"rad/Nm\""), "{error}");
}

#[test]
fn the_blob_has_the_terms_of_the_arm() {
    let model = model();
    let bytes = pack(&model, None).unwrap();
    assert_eq!(bytes.len(), 564 + 4 * 8);
    let p = Blob::check(&bytes).unwrap().parameters::<f64, 6>().unwrap();
    let effects: Vec<_> = p.terms.iter().map(|t| (t.effect, t.joint, t.order)).collect();
    assert_eq!(
        effects,
        [
            (Effect::JointCompliance, 1, 0.0),
            (Effect::JointPeriodicError, 2, 3.156_25),
            (Effect::Backlash, 0, 2.5),
            (Effect::ThermalExpansion, 255, 0.0),
        ]
    );
    assert_eq!(p.reference_temperature, 22.5);
    let masses = p.masses.unwrap();
    assert_eq!(masses.mass[1], f64::from(12.7_f32));
    assert!((masses.payload_com - model.robot.payload).norm() < 1e-8);
    assert_eq!(
        notes(&model),
        [
            "left out, of the measurement and not of the arm: measurement-drift, tool-remount",
            "warning: order of term 2 (joint-periodic-error of joint 3) rounded from 3.15 to 3.15625",
        ]
    );
    let text = describe(&Blob::check(&bytes).unwrap(), bytes.len(), false);
    for words in ["reference temp. C     22.50", "-9.81", "12.7000", "2.5 N m", "all"] {
        assert!(text.contains(words), "{words} in {text}");
    }
}

#[test]
fn what_a_controller_cannot_take_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |model: &Model| {
        let path = folder.path().join("model.toml");
        std::fs::write(&path, model.to_toml()).unwrap();
        let out = folder.path().join("params.bin");
        let mut command = Command::cargo_bin("truearm").unwrap();
        let output = command.arg("pack").arg(path).arg("--out").arg(&out).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        assert!(!out.exists());
        let text = String::from_utf8(output.stderr).unwrap().replace('│', " ");
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let mut many = model();
    many.terms = vec![term(Effect::JointGain, 0, 0.0); 25];
    let message = refused(&many);
    assert!(message.contains("25 terms of the arm where a controller takes 24"), "{message}");

    // Torques of joints may be read, moments of a base may not.
    let mut light = model();
    light.terms.insert(0, term(Effect::BaseCompliance, 0, 0.0));
    light.robot.links.clear();
    let message = refused(&light);
    assert!(message.contains("term 1 effect needs link masses and gravity"), "{message}");
    assert!(message.contains("[[links]]"), "{message}");

    let mut wild = model();
    *wild.terms[0].coefficient_mut() = 0.11;
    let message = refused(&wild);
    assert!(message.contains("term 1 coefficient is outside its plausible range"), "{message}");
}

/// What a hand changed has not the accuracy it had before; what a hand only
/// wrote otherwise has.
#[test]
fn a_changed_model_claims_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    let mut whole = model();
    whole.terms.retain(|t| t.effect_name() != "joint-compliance");
    let text = whole.to_toml();
    let read = |text: &str| {
        std::fs::write(&path, text).unwrap();
        Model::read(&path).unwrap()
    };
    let after = |model: &Model| {
        let bytes = pack(model, None).unwrap();
        let said = describe(&Blob::check(&bytes).unwrap(), bytes.len(), false);
        (Blob::check(&bytes).unwrap().parameters::<f64, 6>().unwrap().rms_after, said)
    };
    let stated = whole.provenance.cross_validated_rms_mm * 1e-3;
    assert!(stated > 0.0 && (after(&read(&text)).0 / stated - 1.0).abs() < 1e-6);

    let term = &text[text.find("[[terms]]").unwrap()..];
    let term = &term[..2 + term[2..].find("[[").unwrap()];
    let with = |table: &str, key: &str, value: &str| {
        let at = text.find(table).unwrap();
        let at = at + text[at..].find(&format!("\n{key} = ")).unwrap() + key.len() + 4;
        let end = at + text[at..].find('\n').unwrap();
        format!("{}{value}{}", &text[..at], &text[end..])
    };
    for (changed, accuracy_stands) in [
        (text.replacen(term, "", 1), false),
        (with("[[terms]]", "coefficient", "1e-6"), false),
        (with("[[corrections]]", "a_mm", "12.5"), false),
        (with("[[joints]]", "d_mm", "12.5"), false),
        (text.lines().filter(|l| !l.starts_with("digest")).collect::<Vec<_>>().join("\n"), false),
        (text.replacen("digest = ", "# seen and understood\ndigest = ", 1), true),
        (with("[[corrections]]", "covered_deg", "[-10.0, 10.0]"), true),
        (text.replacen("lambda_rule", "lambda_rule   ", 1), true),
    ] {
        assert_ne!(changed, text);
        let model = read(&changed);
        let (rms, said) = after(&model);
        assert_eq!(rms != 0.0, accuracy_stands, "{changed}");
        assert_eq!(said.contains("not known after"), !accuracy_stands, "{said}");
        assert_eq!(notes(&model).iter().any(|n| n.contains("accuracy")), !accuracy_stands);
        // Written again it is no better, and no worse.
        assert_eq!(after(&read(&model.to_toml())).0 != 0.0, accuracy_stands);
    }
}
