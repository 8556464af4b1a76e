//! From a tracker's file to a compensated arm: the blob of a diagnosed model in
//! the controller's compensator, judged by the true arm.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::Blob;
use truearm::compensate::Status;
use truearm::{Approach, Arm6, Compensator, Pose, Settings, State, Task};
use truearm_host::blob::{PackOptions, pack_with};
use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_host::identify::rigid_transform;
use truearm_host::model::Measurements;
use truearm_simulate::arm::Arm as Simulated;
use truearm_simulate::at_rest;
use truearm_study::blind::sets::BlindSet;

/// RMS of the tool error, m.
#[derive(Debug)]
struct Errors {
    before: f64,
    after: f64,
    /// As the blob's covariance states it.
    predicted: f64,
    targets: u32,
}

/// Where the nominal arm has its tool, m.
fn nominal(arm: &Arm6<'_, f32>, q: &[f64; 6]) -> Vector3<f64> {
    let pose: Pose<f32> = arm.nominal().forward(&q.map(|q| q as f32));
    pose.translation.map(f64::from)
}

/// The commanded frame of the true arm, by its definition: over the poses of the
/// identification the points of its rigid geometry lie on the nominal ones as well
/// as they can.
fn commanded_frame(arm: &Arm6<'_, f32>, truth: &Simulated, data: &Measurements) -> Pose<f64> {
    let rigid = Simulated { defects: Vec::new(), ..truth.clone() };
    let pairs = data.rows.iter().map(|row| {
        let q: [f64; 6] = row.q.as_slice().try_into().unwrap();
        (rigid.point(&at_rest(&q)), nominal(arm, &q))
    });
    let (real, wanted): (Vec<_>, Vec<_>) = pairs.unzip();
    rigid_transform(&real, &wanted, &vec![1.0; real.len()]).unwrap()
}

/// Two effects hidden in an arm, diagnosed, packed, compensated in `f32`.
fn closed_loop(set: &BlindSet) -> Option<Errors> {
    let (mut robot, data, _) = set.read();
    let truth = &set.open().arm;
    if robot.joints.len() != 6 {
        return None;
    }
    // Link masses as weighed; a test of other ones is `blind.rs`.
    for (link, (mass, _)) in robot.links.iter_mut().zip(&truth.masses) {
        link.mass = *mass;
    }
    let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
    let options = PackOptions { covariance: true, ..PackOptions::default() };
    let bytes = pack_with(&found.model, &options).unwrap();
    let blob = Blob::check(&bytes).unwrap();
    let covariance = blob.covariance().unwrap();
    let parameters = blob.parameters::<f32, 6>().unwrap();
    let arm = Arm6::new(&parameters);
    let frame = commanded_frame(&arm, truth, &data);

    let settings =
        Settings { ramp_ticks: 1, max_change: [0.1; 6], ..Settings::new(Task::Position) };
    let mut compensator = Compensator::new(arm.clone(), settings, &[0.0; 6]).unwrap();
    compensator.set_active(true);
    let state = State { approach: [Approach::Positive; 6], ..State::at(20.0) };
    let mut rng = ChaCha8Rng::seed_from_u64(set.seed ^ 0x7a96);
    let mut sums = [0.0; 3];
    let mut targets = 0_u32;
    while targets < 1000 {
        let mut command = [0.0_f64; 6];
        for (q, range) in command.iter_mut().zip(&parameters.covered) {
            let [low, high] = range.unwrap();
            *q = rng.random_range(f64::from(low)..f64::from(high));
        }
        let target = nominal(&arm, &command);
        let q = command.map(|q| q as f32);
        let tick = compensator.tick(&q, &state);
        assert_eq!(tick.status, Status::On);
        assert_eq!(tick.covered, Some(true));
        if !tick.is_complete() {
            continue;
        }
        targets += 1;
        let error = |q: &[f64; 6]| -> Vector3<f64> {
            frame.transform_point(&truth.point(&at_rest(q))) - target
        };
        let sigma = covariance.point_sigma(&arm, &tick.joints, &state).unwrap();
        sums[0] += error(&command).norm_squared();
        sums[1] += error(&tick.joints.map(f64::from)).norm_squared();
        sums[2] += sigma.iter().map(|s| f64::from(*s).powi(2)).sum::<f64>();
    }
    let [before, after, predicted] = sums.map(|sum| (sum / f64::from(targets)).sqrt());
    Some(Errors { before, after, predicted, targets })
}

#[test]
fn millimetres_fall_to_what_the_identification_predicts() {
    let wanted = [("joint-compliance", [4.0, 8.0]), ("gear-transmission-error", [4.0, 8.0])];
    let sets = (500..).map(|seed| BlindSet::draw(seed, &wanted));
    let all: Vec<Errors> = sets.filter_map(|set| closed_loop(&set)).take(8).collect();
    for e in &all {
        println!(
            "{} targets: {:.3} mm -> {:.4} mm, predicted {:.4} mm, ratio {:.2}",
            e.targets,
            e.before * 1e3,
            e.after * 1e3,
            e.predicted * 1e3,
            e.after / e.predicted
        );
    }
    let mut ratios: Vec<f64> = all.iter().map(|e| e.after / e.predicted).collect();
    ratios.sort_by(f64::total_cmp);
    let mean = (ratios.iter().map(|r| r * r).sum::<f64>() / ratios.len() as f64).sqrt();
    println!("RMS ratio {mean:.3}, largest {:.3}", ratios[ratios.len() - 1]);
    assert!(all.iter().all(|e| e.before > 1e-3));
    assert!(mean <= 1.2, "{mean}");
}
