//! The drift watch: a check point now and then says when to re-calibrate, and
//! which group of parameters has moved.
//!
//! `cargo run --example drift`

mod tracker;

use tracker::{SIGMA, Tracker, stored};
use truearm::Arm6;
use truearm::drift::{DriftWatch, FalseAlarms, Group};
use truearm::nalgebra::Vector3;
use truearm::parameters::Parameter;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let stored = stored()?;
    let arm = Arm6::new(&stored);
    let mut tracker = Tracker::before(&stored);
    let mut watch = DriftWatch::new(SIGMA, FalseAlarms::OneIn10000)?;
    // What measured less predicted was right after calibration; not known here.
    let baseline = Vector3::zeros();

    // Nothing moves: 300 points without an alarm.
    for count in 1..=300 {
        let verdict = watch.push(&arm, &tracker.point(), &baseline)?;
        assert!(!verdict.recalibrate, "a false alarm at point {count}");
    }
    println!("300 points: all is well");

    // Joint 3 slips by a tenth of a milliradian.
    let mut slipped = stored.clone();
    Parameter::JointOffset(2).apply(&mut slipped, 1e-4);
    tracker.now_before(&slipped);
    for count in 1..=50 {
        let verdict = watch.push(&arm, &tracker.point(), &baseline)?;
        println!("point {count}: level {:.1} of {:.1}", verdict.level, verdict.threshold);
        if verdict.recalibrate {
            let suspect = watch.suspect().ok_or("an alarm without a suspect")?;
            println!("re-calibrate: {} moved by {:.6} rad", suspect.group, suspect.shift);
            assert_eq!(suspect.group, Group::JointOffset(2));
            // The example `reidentify` goes on from here; then `watch.restart()`.
            return Ok(());
        }
    }
    Err("a shift of 0.1 mrad was not noticed in 50 points".into())
}
