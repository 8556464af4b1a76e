//! Planned poses: what they promise is what an identification from them gives.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_host::files::poses_csv;
use truearm_host::model::Workspace;
use truearm_host::plan::{Explained, discriminate};
use truearm_study::blind::sets::BlindSet;
use truearm_study::planning::Trial;
use truearm_study::simulated::parse;

/// The long form, 50 arms and 1,000 identifications: `cargo xtask study planning`.
#[test]
fn twenty_planned_poses_beat_thirty_random_ones() {
    for seed in 0..6 {
        let trial = Trial::draw(seed);
        let mut rng = ChaCha8Rng::seed_from_u64(100 + seed);
        let o = trial.simulate(200, &mut rng);
        println!(
            "{}: p {}, planned {:.1} um ({:.1} predicted), random {:.1}, bound {:.1}",
            trial.robot.name,
            trial.plan.parameters,
            o.planned * 1e6,
            trial.plan.worst * 1e6,
            o.random * 1e6,
            o.bound * 1e6
        );
        assert!(o.planned < o.random, "seed {seed}");
        assert!(o.planned < 1.35 * o.bound, "seed {seed}");
        // The prediction is what the simulation shows, to its own scatter.
        assert!((0.85..1.12).contains(&(o.planned / trial.plan.worst)), "seed {seed}");
    }
}

/// A diagnosis that cannot tell two effects apart: the planned poses, measured,
/// leave one name.
#[test]
fn planned_poses_tell_explanations_apart() {
    let set = BlindSet::tie(2_000_000);
    let (robot, data, _) = set.read();
    let options = DiagnoseOptions::default();
    let found = diagnose(&robot, &data, None, &options, &|_| ()).unwrap();
    let alternatives = &found.outcome.alternatives;
    assert!(!alternatives.is_empty());
    assert!(alternatives.iter().all(|a| a.worse_by < 9.3));
    let workspace = Workspace::new(&robot, None).unwrap();
    let flagged = &found.outcome.figures.outlier_rows;
    let kept: Vec<usize> = (0..data.rows.len()).filter(|r| !flagged.contains(&(r + 1))).collect();
    let explained = Explained {
        named: &found.state,
        alternatives: &found.alternatives,
        kept: &kept,
        lambda: found.outcome.figures.lambda,
    };
    let planned = discriminate(&robot, &data, &explained, &workspace, (6, 3000, 1)).unwrap();
    assert!(planned.separation.iter().all(|added| *added > 20.0), "{:?}", planned.separation);
    // As a user measures them: from the file.
    let text = poses_csv(&robot, "q", &planned.poses, &[]);
    let pose = |line: &str| {
        let cells = line.split(',').take(robot.joints.len());
        cells.map(|cell| cell.parse().unwrap()).collect()
    };
    let poses: Vec<Vec<f64>> = text.lines().skip(1).map(pose).collect();
    assert_eq!(poses.len(), 6);
    let more = set.measured_further(&poses);
    let after = diagnose(&robot, &parse(&robot, &more), None, &options, &|_| ()).unwrap();
    assert!(after.outcome.alternatives.is_empty(), "{:?}", after.outcome.effects);
}
