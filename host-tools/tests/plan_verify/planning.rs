//! Planned poses: where they may be, when there are enough, and what is said where
//! none can be planned. That they keep what they promise is a study.

use std::path::Path;

use crate::judged::{SIGMAS, cell, most_probable, read};
use crate::simulated::{UR10_LIKE, robot};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;
use truearm_host::files::{Gathered, poses_csv};
use truearm_host::identify::{Options, Problem, Scaling, identify};
use truearm_host::model::arm::chain;
use truearm_host::model::{KindId, Measurements, Robot, Sight, Workspace};
use truearm_host::observations::by_name;
use truearm_host::plan::{PlanOptions, plan};
use truearm_simulate::body::apply;
use truearm_simulate::robots;

#[test]
fn poses_stay_in_limits_box_and_sight() {
    let robot = robot(robots::ALL[0]);
    let sight = Sight {
        tracker: Vector3::new(2.5, -1.0, 0.8),
        axis: Vector3::x(),
        cone: 40_f64.to_radians(),
    };
    let mut workspace = Workspace::new(&robot, None).unwrap();
    // Corners in any order.
    workspace.corners = Some([Vector3::new(0.9, 0.9, 1.2), Vector3::new(-0.9, -0.9, 0.1)]);
    workspace.sight = Some(sight);
    let options = PlanOptions {
        kind: KindId::default(),
        instruments: Gathered::default(),
        poses: 13,
        workspace,
        candidates: 500,
        target: None,
        seed: 3,
    };
    let planned = plan(&robot, &options, &|_, _| ()).unwrap();
    assert_eq!(planned.poses.len(), 13);
    let arm = chain(&robot.nominal(), Pose::identity(), robot.tool);
    for q in &planned.poses {
        for (q, joint) in q.iter().zip(&robot.joints) {
            let [low, high] = joint.limits.unwrap();
            assert!((low..=high).contains(q));
        }
        let pose = arm.pose(q);
        let p = pose.translation;
        assert!(p.x.abs() <= 0.9 && p.y.abs() <= 0.9 && (0.1..=1.2).contains(&p.z), "{p}");
        let faces = pose.rotation * Vector3::x();
        assert!(faces.angle(&(sight.tracker - p)).to_degrees() <= 40.0 + 1e-9);
    }
    // The same again, and others with another seed.
    let again = plan(&robot, &options, &|_, _| ()).unwrap();
    assert_eq!(planned.poses, again.poses);
    let other = plan(&robot, &PlanOptions { seed: 4, ..options }, &|_, _| ()).unwrap();
    assert_ne!(planned.poses, other.poses);
}

/// Poses planned for full poses: what is predicted of the tool point is what
/// simulated arms have, and points at as many planned poses are worse.
#[test]
fn poses_for_poses_keep_their_promise() {
    let robot = Robot { sigma_angle: Some(SIGMAS.angle), ..robot(robots::ALL[0]) };
    let robot = Robot { sigma: SIGMAS.length, ..robot };
    let workspace = Workspace::new(&robot, None).unwrap();
    let options = |kind: &str| PlanOptions {
        kind: by_name(kind).unwrap(),
        instruments: Gathered::default(),
        poses: 13,
        workspace: workspace.clone(),
        candidates: 600,
        target: None,
        seed: 5,
    };
    let planned = |kind: &str| plan(&robot, &options(kind), &|_, _| ()).unwrap();
    let (points, poses) = (planned("point"), planned("pose"));
    assert_eq!([points.kind, poses.kind], ["point", "pose"]);
    // The three turns of the last frame about the target, which points cannot tell.
    assert_eq!(poses.parameters, points.parameters + 3);
    assert!(poses.bound.is_none() && poses.rms < 0.95 * points.rms);
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let (mut squares, mut count) = (0.0, 0.0);
    for _ in 0..40 {
        let cell = cell(&robot, &mut rng);
        let data = read(&robot, &cell, &cell.file_at("pose", &poses.poses, &mut rng));
        let problem = Problem::new(&data, &robot, Scaling::Prior);
        let found = most_probable(&problem, &robot).unwrap().fit.state;
        let arm = chain(&found.links, found.bases[0], found.markers[0]);
        for q in workspace.sample(&robot, 50, &mut rng).unwrap() {
            let real = apply(&cell.base, &cell.target(&q));
            squares += (arm.pose(&q).translation - real).norm_squared();
            count += 1.0;
        }
    }
    let error = f64::sqrt(squares / count);
    println!(
        "rms: {:.1} um predicted, {:.1} simulated; points {:.1}",
        poses.rms * 1e6,
        error * 1e6,
        points.rms * 1e6
    );
    assert!((0.85..1.15).contains(&(error / poses.rms)));
    let error = plan(&robot, &options("touch"), &|_, _| ()).unwrap_err();
    assert!(error.to_string().contains("no surface to touch is stated"), "{error}");
}

#[test]
fn it_stops_at_the_target_with_few_poses() {
    let robot = robot(robots::ALL[1]);
    let workspace = Workspace::new(&robot, None).unwrap();
    let target = 1.1 * robot.sigma;
    let options = PlanOptions {
        kind: KindId::default(),
        instruments: Gathered::default(),
        poses: 80,
        workspace,
        candidates: 1000,
        target: Some(target),
        seed: 1,
    };
    let planned = plan(&robot, &options, &|_, _| ()).unwrap();
    let count = planned.poses.len();
    println!(
        "{count} poses: worst {:.1} um, bound {:.1} um",
        planned.worst * 1e6,
        planned.bound.unwrap() * 1e6
    );
    assert_eq!(planned.reached, Some(true));
    assert!(planned.worst <= target && count < 80);
    // No set of less than bound = target can; a plan needs little more.
    let least = planned.parameters as f64 * (robot.sigma / target).powi(2);
    assert!((count as f64) < 1.5 * least, "{count} {least}");
    let fewer = PlanOptions { poses: count - 8, ..options };
    assert_eq!(plan(&robot, &fewer, &|_, _| ()).unwrap().reached, Some(false));
}

/// The smallest plan of every arm is a file that `identify` takes, and no smaller one is made,
/// with a target or without: points do not determine all that it counts.
#[test]
fn what_is_planned_is_taken() {
    for (text, least) in [(robots::ALL[0], 13), (robots::ALL[4], 15), (robots::ALL[5], 15)] {
        let robot = robot(text);
        let options = PlanOptions {
            kind: KindId::default(),
            instruments: Gathered::default(),
            poses: 60,
            workspace: Workspace::new(&robot, None).unwrap(),
            candidates: 300,
            target: Some(1.0),
            seed: 1,
        };
        let planned = plan(&robot, &options, &|_, _| ()).unwrap();
        assert_eq!((planned.poses.len(), planned.reached), (least, Some(true)));
        let error = plan(&robot, &PlanOptions { poses: least - 1, ..options }, &|_, _| ());
        let help = format!("plan at least {least} points");
        assert!(error.unwrap_err().help().contains(&help), "{help}");
        let file = poses_csv(&robot, "q", &planned.poses, &[]).replace("nominal_", "");
        let taken = |rows: usize| {
            let text: String = file.lines().take(rows + 1).map(|l| format!("{l}\n")).collect();
            let data = Measurements::parse(Path::new("p.csv"), &text, &robot).unwrap();
            identify(&robot, &data, &Options::default(), &|_, _| ())
        };
        taken(least).unwrap();
        let error = taken(least - 1).unwrap_err();
        assert!(error.help().contains(&format!("measure at least {least} poses")), "{error}");
    }
}

/// Joints that are all held are one pose, of which nothing is identified.
#[test]
fn one_pose_is_no_plan() {
    let robot = robot(robots::ALL[0]);
    let options = PlanOptions {
        kind: KindId::default(),
        instruments: Gathered::default(),
        poses: 20,
        workspace: Workspace::new(&robot, Some(vec![[0.2, 0.2]; 6])).unwrap(),
        candidates: 300,
        target: None,
        seed: 1,
    };
    let error = plan(&robot, &options, &|_, _| ()).unwrap_err();
    assert!(error.to_string().contains("leave a single pose"), "{error}");
}

#[test]
fn what_cannot_be_planned_is_said() {
    let robot = robot(robots::ALL[0]);
    let workspace = Workspace::new(&robot, None).unwrap();
    let options = |poses, candidates, workspace: &Workspace| PlanOptions {
        kind: KindId::default(),
        instruments: Gathered::default(),
        poses,
        workspace: workspace.clone(),
        candidates,
        target: None,
        seed: 1,
    };
    let mut nowhere = workspace.clone();
    nowhere.corners = Some([Vector3::repeat(4.0), Vector3::repeat(5.0)]);
    for (options, says) in [
        (
            options(12, 1000, &workspace),
            "12 points give 36 equations for 39 unknowns of `truearm identify`",
        ),
        (options(20, 30, &workspace), "20 poses out of 30 candidates"),
        (options(0, 30, &workspace), "0 poses out of 30 candidates"),
        (options(20, 1000, &nowhere), "none is in the box"),
    ] {
        let error = plan(&robot, &options, &|_, _| ()).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
        assert!(!error.help().is_empty());
    }
    let free = Robot::parse(Path::new("r.toml"), UR10_LIKE).unwrap();
    let error = Workspace::new(&free, None).unwrap_err();
    assert!(error.to_string().contains("no limits of joints 1, 2, 3, 4, 5, 6"), "{error}");
    let error = Workspace::new(&free, Some(vec![[0.0, 1.0]])).unwrap_err();
    assert!(error.to_string().contains("limits of 1 joints"), "{error}");
    let error = Workspace::new(&free, Some(vec![[1.0, 0.0]; 6])).unwrap_err();
    assert!(error.help().contains("lower limit first"), "{error}");
}
