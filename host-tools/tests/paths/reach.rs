//! What the arm reaches, `ik` reaches, wherever it begins.

use std::path::Path as FilePath;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::convert::presets::Preset;
use truearm_host::files::Wanted;
use truearm_host::model::{Model, Path, Robot};
use truearm_host::paths::{Forward, Inverse, View, forward_csv};

const ROWS: usize = 300;

/// Poses at joints anywhere within the limits, each far from the one before.
fn poses(robot: &Robot, forward: &Forward) -> Path {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let n = robot.joints.len();
    let names: Vec<String> = (1..=n).map(|j| format!("q{j}_deg")).collect();
    let mut text = names.join(",") + "\n";
    for _ in 0..ROWS {
        let q = robot.joints.iter().map(|joint| {
            let [low, high] = joint.limits.unwrap_or([-3.1, 3.1]);
            rng.random_range(low..high).to_degrees().to_string()
        });
        text += &(q.collect::<Vec<_>>().join(",") + "\n");
    }
    let at = Path::parse(FilePath::new("q.csv"), &text, robot, Wanted::Joints).unwrap();
    let there = forward_csv(&at, robot, &forward.all(&at.data)).unwrap();
    let points: String = there
        .lines()
        .map(|line| line.split(',').skip(n).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    Path::parse(FilePath::new("poses.csv"), &points, robot, Wanted::Poses).unwrap()
}

#[test]
fn what_is_reachable_is_reached() {
    for name in ["ur10", "irb-120", "lbr-iiwa-14-r820", "panda"] {
        let preset = Preset::find(name).unwrap();
        let robot = Robot::parse(FilePath::new("robot.toml"), preset.text).unwrap();
        let model = Model::nominal(robot.clone());
        let forward = Forward::nominal(&model, &View::default()).unwrap();
        let path = poses(&robot, &forward);
        let zero: Vec<f64> = robot
            .joints
            .iter()
            .map(|j| j.limits.map_or(0.0, |[low, high]| 0.0_f64.clamp(low, high)))
            .collect();
        let inverse = Inverse::new(&forward, &robot);
        let found = inverse.follow(&path.data, &path.targets, Some(&zero));
        let reached = found.rows.iter().filter(|row| row.is_reached()).count();
        println!("{name}: {reached} of {ROWS}, {} changes of configuration", found.jumps.len());
        assert!(100 * reached >= 99 * ROWS, "{name}: {reached} of {ROWS} reached");
        // They are there, within the limits, by the arm's own account.
        for ((row, target), found) in path.data.rows.iter().zip(&path.targets).zip(&found.rows) {
            let there = forward.pose(row, &found.joints);
            if found.is_reached() {
                assert!((there.translation - target.point).norm() < 1e-5, "{name}");
            }
            for (q, joint) in found.joints.iter().zip(&robot.joints) {
                let [low, high] = joint.limits.unwrap_or([f64::MIN, f64::MAX]);
                assert!(*q >= low && *q <= high, "{name}");
            }
        }
    }
}

/// A start that leads nowhere is no reason to give up, and what is really out of
/// reach is said to be.
#[test]
fn from_a_start_that_leads_nowhere() {
    let robot =
        Robot::parse(FilePath::new("robot.toml"), Preset::find("ur10").unwrap().text).unwrap();
    let model = Model::nominal(robot.clone());
    let forward = Forward::nominal(&model, &View::default()).unwrap();
    let text = "x_mm,y_mm,z_mm,qx,qy,qz,qw\n400,300,500,0,1,0,0\n0,0,9000,0,1,0,0\n-400,-300,500,0,1,0,0\n";
    let path = Path::parse(FilePath::new("p.csv"), text, &robot, Wanted::Poses).unwrap();
    let inverse = Inverse::new(&forward, &robot);
    let found = inverse.follow(&path.data, &path.targets, Some(&[0.0; 6]));
    let reached: Vec<bool> = found.rows.iter().map(|row| row.is_reached()).collect();
    assert_eq!(reached, [true, false, true]);
    assert!((found.rows[1].position - 8.0).abs() < 1.0, "{}", found.rows[1].position);
}
