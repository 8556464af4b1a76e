//! Paths of arms whose springs follow torques that are read.

use std::path::Path as FilePath;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::Blob;
use truearm::effects::{Effect, Term};
use truearm::{Arm, ArmParameters, Compensator, Pose, Settings, State, Task};
use truearm_host::blob::{PackOptions, notes, pack_with};
use truearm_host::error::ErrorKind;
use truearm_host::files::Wanted;
use truearm_host::model::{Model, ModelTerm, Mounting, Path, Robot};
use truearm_host::paths::{
    CompensateOptions, Compensated, Forward, Row, View, compensate, compensated_csv,
};
use truearm_simulate::robots;

const EXTRAPOLATE: CompensateOptions = CompensateOptions {
    task: Some(Task::Position),
    trust_nominal_orientation: false,
    extrapolate: true,
    single: false,
    marker: None,
    start: None,
};

const SPRINGS: [(u8, f64); 2] = [(1, 8e-6), (4, 3e-5)];

/// Six joints that nobody weighed, two of them springs.
fn model(gravity: Option<Vector3<f64>>) -> Model {
    let mut robot = Robot::parse(FilePath::new("robot.toml"), robots::ALL[0]).unwrap();
    (robot.gravity, robot.links) = (gravity, Vec::new());
    let mut model = Model::nominal(robot);
    model.corrections[2].a = 4e-4;
    model.covered = vec![Some([-4.0, 4.0]); 6];
    model.terms = SPRINGS
        .map(|(joint, coefficient)| {
            let effect = Effect::JointCompliance;
            ModelTerm::Arm(Term { effect, joint, source: 0, component: 0, order: 0.0, coefficient })
        })
        .to_vec();
    model
}

fn path(model: &Model, rows: &[([f64; 6], Option<[f64; 6]>)]) -> Path {
    let torques = rows.iter().all(|(_, torque)| torque.is_some());
    let names = |what: &str, unit: &str| -> Vec<String> {
        (1..=6).map(|j| format!("{what}{j}_{unit}")).collect()
    };
    let mut header = names("q", "deg");
    header.extend(torques.then(|| names("torque", "nm")).into_iter().flatten());
    let mut text = header.join(",") + "\n";
    for (q, torque) in rows {
        let joints = q.iter().map(|q| q.to_degrees().to_string());
        let torques = torque.iter().flatten().map(f64::to_string);
        text += &(joints.chain(torques).collect::<Vec<_>>().join(",") + "\n");
    }
    Path::parse(FilePath::new("path.csv"), &text, &model.robot, Wanted::Joints).unwrap()
}

fn drawn(seed: u64) -> Vec<([f64; 6], Option<[f64; 6]>)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut six = |most: f64| [(); 6].map(|()| rng.random_range(-most..most));
    (0..200).map(|_| (six(2.6), Some(six(120.0)))).collect()
}

fn real(model: &Model, path: &Path) -> Vec<Pose<f64>> {
    let forward = Forward::real(model, &View::default()).unwrap();
    forward.along(&path.data, model).unwrap().all(&path.data)
}

/// A spring gives way to what it is loaded with, the opposite of what the joint holds.
#[test]
fn a_joint_bends_by_what_it_is_read_to_hold() {
    let model = model(None);
    let rows = drawn(1);
    let rigid = Model { terms: Vec::new(), ..model.clone() };
    let bent: Vec<_> = rows
        .iter()
        .map(|(q, torque)| {
            let (mut q, held) = (*q, torque.unwrap());
            SPRINGS.iter().for_each(|(j, c)| q[usize::from(*j)] -= c * held[usize::from(*j)]);
            (q, None)
        })
        .collect();
    let found = real(&model, &path(&model, &rows));
    let expected = real(&rigid, &path(&rigid, &bent));
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found.translation - expected.translation).norm() < 1e-9);
    }
}

/// Where gravity's direction is known, a file may count either way.
#[test]
fn gravity_tells_which_way_a_file_counts() {
    let model = model(Some(Vector3::new(0.0, 0.0, -9.81)));
    let weighed = model.robot.with_assumed_loads(Mounting::Upright).unwrap();
    let surroundings = truearm_host::identify::Surroundings::new(&weighed);
    let counted = |sign: f64| -> Vec<Pose<f64>> {
        let loaded = drawn(2).into_iter().map(|(q, _)| {
            let row = truearm_host::model::Row::at(q.to_vec());
            let load = surroundings.inputs(&row, &q).torque;
            (q, Some(core::array::from_fn(|j| sign * 7.0 * load[j])))
        });
        real(&model, &path(&model, &loaded.collect::<Vec<_>>()))
    };
    assert_eq!(counted(1.0), counted(-1.0));
}

#[test]
fn a_path_with_torques_is_compensated_to_the_bits_of_the_controller() {
    let model = model(None);
    let path = path(&model, &drawn(3));
    let options = EXTRAPOLATE;
    let found = compensate(&model, &path, &options).unwrap();
    let text = compensated_csv(&path, &model.robot, &found).unwrap();
    let told = Path::parse(FilePath::new("out.csv"), &text, &model.robot, Wanted::Joints).unwrap();
    // The columns are kept, so that `fk` of what was written knows them.
    let nominal = Forward::nominal(&model, &View::default()).unwrap().all(&path.data);
    let reached = real(&model, &told);
    let before = real(&model, &path);
    let (mut most, mut were) = (0.0_f64, 0.0_f64);
    for ((wanted, reached), (before, row)) in
        nominal.iter().zip(&reached).zip(before.iter().zip(&found.rows))
    {
        let Row::Corrected { clamped, .. } = row else { panic!("joints are always reached") };
        if !clamped {
            most = most.max((wanted.translation - reached.translation).norm());
            were = were.max((wanted.translation - before.translation).norm());
        }
    }
    assert!(were > 5e-4 && most < were / 50.0, "{were} -> {most}");

    let Compensated { rows, .. } =
        compensate(&model, &path, &CompensateOptions { single: true, ..options }).unwrap();
    let bytes =
        pack_with(&model, &PackOptions { sequence: Some(1), ..PackOptions::default() }).unwrap();
    let blob = Blob::check(&bytes).unwrap();
    assert!(blob.reads_torques());
    let parameters: ArmParameters<f32, 6> = blob.parameters().unwrap();
    let tool = Pose { translation: model.robot.tool.map(|x| x as f32), ..Pose::<f32>::identity() };
    let arm = Arm::new(&parameters).with_tool(tool);
    for (row, data) in rows.iter().zip(&path.data.rows) {
        let Row::Corrected { joints, .. } = row else { panic!("joints are always reached") };
        let q: [f32; 6] = core::array::from_fn(|j| data.q[j] as f32);
        let settings = Settings { ramp_ticks: 5, ..Settings::new(Task::Position) };
        let mut compensator = Compensator::new(arm.clone(), settings, &q).unwrap();
        compensator.set_active(true);
        let torque = Some(core::array::from_fn(|j| -data.torques[j] as f32));
        let state = State { torque, ..arm.state() };
        let last = (0..40).map(|_| compensator.tick(&q, &state).joints).last().unwrap();
        assert_eq!(
            last.map(|q| f64::from(q).to_bits())[..],
            *joints.iter().map(|q| q.to_bits()).collect::<Vec<_>>()
        );
    }
}

/// Not as if the arm were unloaded.
#[test]
fn a_path_without_torques_is_refused() {
    let model = model(None);
    let silent: Vec<_> = drawn(4).into_iter().map(|(q, _)| (q, None)).collect();
    let path = path(&model, &silent);
    let forward = Forward::real(&model, &View::default()).unwrap();
    let refused = forward.along(&path.data, &model).err().unwrap();
    assert_eq!(refused.kind(), ErrorKind::NoTorques, "{refused}");
    let options = EXTRAPOLATE;
    for single in [false, true] {
        let options = CompensateOptions { single, ..options.clone() };
        let refused = compensate(&model, &path, &options).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::NoTorques, "{refused}");
    }
    let said = notes(&model).join("\n");
    assert!(said.contains("the opposite of the columns torque1_nm"), "{said}");
}
