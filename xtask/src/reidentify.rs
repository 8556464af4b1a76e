//! Re-identification on the controller, against a full calibration on the host:
//! simulated accidents, computed under QEMU, judged here.

#[path = "../../tests/firmware/src/runs.rs"]
mod format;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use truearm::{Arm, Pose};
use truearm_host::blob::pack;
use truearm_host::identify::{Identification, Options, identify};
use truearm_host::model::Robot;

use crate::reidentification_poses;
use crate::run::Result;
use crate::same_work::{Work, median};
use format::{BEHIND, JOINTS, Known, MAGIC, Moved, POINTS, Run, Runs, SIGMA};
use truearm_study::simulated::{Truth, UR10_LIKE, normal, parse, rms, robot, state_of};

const RUNS: u64 = 60;
/// First seed.
const SEEDS: u64 = 1000;
/// Poses of a full calibration.
const POSES: usize = 52;
/// Most that the median error after re-identification may be, in errors of a
/// full calibration.
const MOST: f64 = 1.3;

/// What is judged of one accident, all RMS over other poses, m.
struct Judged {
    crashed: f64,
    full: f64,
    known: f64,
    moved: f64,
}

/// One accident: the bytes of its run, and what to judge it by.
struct Accident {
    bytes: Vec<u8>,
    after: Truth,
    full: Identification,
    /// From the commanded frame to the tracker of the first calibration.
    commanded: Pose<f64>,
    /// Joint values to judge at.
    judged_at: String,
}

/// Simulates, runs the image, judges the median; what the image printed.
pub fn check() -> Result<String> {
    let poses = poses_after(&robot(UR10_LIKE));
    let accidents: Vec<_> =
        (SEEDS..SEEDS + RUNS).into_par_iter().map(|seed| simulate(seed, &poses)).collect();
    let accidents =
        accidents.into_iter().collect::<std::result::Result<Vec<_>, truearm_host::Error>>()?;
    let work = Work::new(MAGIC, BEHIND, accidents.iter().map(|a| &a.bytes));
    let runs = Runs::parse(&work.bytes).ok_or("the file of runs is not whole")?;
    let mut judged = Vec::new();
    let mut left = accidents.iter();
    let hash = runs.hash(|run, known, moved| {
        judged.extend(left.next().map(|accident| accident.judge(run, known, moved)));
    });
    let hash = hash.ok_or("a re-identification failed on the host")?;
    let printed = work.done_by("reidentify", hash)?;
    report(&judged)?;
    Ok(printed)
}

fn report(judged: &[Judged]) -> Result {
    let (crashed, full) = (median(judged, |j| j.crashed), median(judged, |j| j.full));
    println!(
        "{} accidents, medians of RMS: {:.3} mm after the accident, {:.4} mm after a full \
         calibration of {POSES} poses",
        judged.len(),
        crashed * 1e3,
        full * 1e3
    );
    let known = median(judged, |j| j.known / j.full);
    println!(
        "{POINTS} points, 5 unknowns: {:.4} mm, ratio {known:.3}",
        median(judged, |j| j.known) * 1e3
    );
    let moved = median(judged, |j| j.moved / j.full);
    println!(
        "tracker moved, 11 unknowns: {:.4} mm, ratio {moved:.3}",
        median(judged, |j| j.moved) * 1e3
    );
    if known <= MOST {
        Ok(())
    } else {
        Err(format!("ratio {known:.3}, at most {MOST} wanted").into())
    }
}

fn simulate(
    seed: u64,
    poses: &[[f64; JOINTS]],
) -> std::result::Result<Accident, truearm_host::Error> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let robot = robot(UR10_LIKE);
    let before = Truth::draw(&robot, 1, 1, &mut rng);
    let sigma = f64::from(SIGMA);
    let calibrate = |truth: &Truth, rng: &mut ChaCha8Rng| {
        let data = truth.parse(&truth.measure(POSES, sigma, rng));
        identify(&robot, &data, &Options::default(), &|_, _| ())
    };
    let model = calibrate(&before, &mut rng)?.model;
    let mut bytes = pack(&model, Some(1))?;
    // Any two of joints 2 to 5: the first turns the base, the last the tool.
    let first = rng.random_range(1..5_usize);
    let second = 1 + (first + rng.random_range(0..3_usize)) % 4;
    let mut after = Truth {
        robot: before.robot.clone(),
        links: before.links.clone(),
        bases: before.bases.clone(),
        tools: before.tools.clone(),
    };
    for joint in [first, second] {
        after.links[joint].parameters.theta += normal(&mut rng) * 5e-3;
        bytes.extend((joint as u32).to_le_bytes());
    }
    after.tools[0] += Vector3::from_fn(|_, _| normal(&mut rng) * 2e-3);
    let residual = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let commanded = model.stations[0].1.compose(&residual.inverse());
    let elsewhere = Pose::from_rotation_vector(
        Vector3::from_fn(|_, _| normal(&mut rng)),
        Vector3::from_fn(|_, _| normal(&mut rng)),
    );
    for q in poses {
        let noise = Vector3::from_fn(|_, _| normal(&mut rng) * sigma);
        let seen = after.point(q, 0, 0) + noise;
        let known = commanded.inverse().transform_point(&seen);
        let moved = elsewhere.transform_point(&seen);
        let numbers = q.iter().chain(known.iter()).chain(moved.iter());
        bytes.extend(numbers.flat_map(|v| (*v as f32).to_le_bytes()));
    }
    let full = calibrate(&after, &mut rng)?;
    let judged_at = after.measure(300, 0.0, &mut rng);
    Ok(Accident { bytes, after, full, commanded, judged_at })
}

/// Ten poses for every accident: for six joint offsets and the tool, of which
/// nobody knows which will slip.
fn poses_after(robot: &Robot) -> Vec<[f64; JOINTS]> {
    reidentification_poses::choose(robot, POINTS, f64::from(SIGMA), |jacobian| {
        jacobian.links.iter().map(|link| link.theta).chain(jacobian.tool).collect()
    })
}

impl Accident {
    fn judge(&self, run: &Run, known: &Known, moved: &Moved) -> Judged {
        let check = parse(&self.after.robot, &self.judged_at);
        let of = |parameters: &truearm::ArmParameters<f32, JOINTS>| {
            let arm = Arm::new(parameters);
            let square = |row: &truearm_host::model::Row| {
                let q: [f32; JOINTS] = core::array::from_fn(|k| row.q[k] as f32);
                let seen = arm.real_pose(&q).translation.map(f64::from);
                (self.commanded.transform_point(&seen) - row.measured.point()).norm_squared()
            };
            (check.rows.iter().map(square).sum::<f64>() / check.rows.len() as f64).sqrt()
        };
        Judged {
            crashed: of(&run.stored),
            full: rms(&self.after.robot, &state_of(&self.full, &check), &check),
            known: of(&known.parameters),
            moved: of(&moved.parameters),
        }
    }
}
