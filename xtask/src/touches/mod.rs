//! An arm that mends itself from touches of one plate, computed under QEMU, judged here:
//! simulated accidents, against what the host makes of the same touches.

mod cell;
#[path = "../../../tests/firmware/src/plates.rs"]
mod format;
mod reference;

use rayon::prelude::*;
use truearm::blob::Blob;
use truearm::{Arm, ArmParameters};
use truearm_study::simulated::{UR10_LIKE, robot};

use crate::run::Result;
use crate::same_work::{Work, median};
use cell::{Accident, poses, simulate};
use format::{AFTER, Accidents, BEHIND, JOINTS, MAGIC, Mended};

const RUNS: u64 = 60;
/// First seed.
const SEEDS: u64 = 2000;
/// Most that the median error may be, in errors of the host.
const MOST: f64 = 1.3;

/// Tool errors over other poses, RMS, m.
struct Judged {
    stored: f64,
    host: f64,
    streamed: f64,
    again: f64,
}

/// Simulates, runs the image, judges the medians; what the image printed.
pub fn check() -> Result<String> {
    let poses = poses(&robot(UR10_LIKE));
    let accidents: Vec<_> =
        (SEEDS..SEEDS + RUNS).into_par_iter().map(|seed| simulate(seed, &poses)).collect();
    let accidents =
        accidents.into_iter().collect::<std::result::Result<Vec<_>, truearm_host::Error>>()?;
    let work = Work::new(MAGIC, BEHIND, accidents.iter().map(|a| &a.bytes));
    let all = Accidents::parse(&work.bytes).ok_or("the file of accidents is not whole")?;
    let mut judged = Vec::new();
    let mut left = accidents.iter();
    let hash = all.hash(|run, mended| {
        judged.extend(left.next().and_then(|accident| judge(accident, run, mended).ok()));
    });
    let hash = hash.ok_or("touches mended nothing on the host")?;
    let printed = work.done_by("touches", hash)?;
    report(&judged)?;
    Ok(printed)
}

fn report(judged: &[Judged]) -> Result {
    println!(
        "{} accidents, {AFTER} touches of one plate each, medians of RMS at other poses: {:.3} mm \
         after the accident, {:.4} mm by the host in f64",
        judged.len(),
        median(judged, |j| j.stored) * 1e3,
        median(judged, |j| j.host) * 1e3
    );
    let ratios = [
        (
            "one after the other",
            median(judged, |j| j.streamed),
            median(judged, |j| j.streamed / j.host),
        ),
        ("all at once", median(judged, |j| j.again), median(judged, |j| j.again / j.host)),
    ];
    for (how, error, ratio) in ratios {
        println!("on the controller, {how}: {:.4} mm, ratio {ratio:.3}", error * 1e3);
    }
    if ratios.iter().all(|(_, _, ratio)| *ratio <= MOST) {
        Ok(())
    } else {
        Err(format!("a ratio of at most {MOST} is wanted").into())
    }
}

fn judge(accident: &Accident, run: &format::Accident, mended: &Mended) -> Result<Judged> {
    let blob = accident.bytes.get(..accident.bytes.len() - BEHIND).unwrap_or_default();
    let host = reference::mended(&Blob::check(blob)?.parameters()?, run);
    let on_controller = |parameters: &ArmParameters<f32, JOINTS>| {
        let arm = Arm::new(parameters);
        accident.error_of(|q| {
            let q = core::array::from_fn(|k| q[k] as f32);
            arm.real_pose(&q).translation.map(f64::from)
        })
    };
    Ok(Judged {
        stored: on_controller(&run.stored),
        host: accident.error_of(|q| host.point(q, 0, 0)),
        streamed: on_controller(&mended.streamed.parameters),
        again: on_controller(&mended.again.parameters),
    })
}
