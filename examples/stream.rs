//! Identification on the controller, one measured point at a time: memory does
//! not grow, and there are parameters of the arm whenever they are asked for.
//!
//! `cargo run --example stream`

mod tracker;

use tracker::{SIGMA, Tracker, stored};
use truearm::parameters::Parameter;
use truearm::streaming::{Lambda, Settings};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let stored = stored()?;
    let [x, y, z] = Parameter::TOOL;
    let [a, b, c] = [1, 2, 3].map(Parameter::JointOffset);
    let chosen = [a, b, c, x, y, z];

    // What nobody knows: two joints have slipped, the tool was changed.
    let mut real = stored.clone();
    for (parameter, by) in [(a, 1.0e-3), (c, -0.7e-3), (x, 0.4e-3)] {
        parameter.apply(&mut real, by);
    }
    let mut tracker = Tracker::before(&real);

    // Every fifth point is held out and only judges.
    let mut stream = Settings::new(&stored, chosen, SIGMA).start(&stored)?;
    for count in 1..=60 {
        if let Err(error) = stream.push(&tracker.point()) {
            println!("point {count} was not taken: {error}");
        }
        if count % 20 == 0 {
            let found = stream.identified(Lambda::Prior)?;
            let left = tracker.error_of(&found.parameters);
            println!("{count} points: largest error {:.3} mm", left * 1e3);
        }
    }

    let found = stream.identified(Lambda::Prior)?;
    for (parameter, (change, sigma)) in chosen.iter().zip(found.change.iter().zip(&found.sigma)) {
        println!("{parameter}: {change:+.6} +- {sigma:.6} {}", parameter.unit(&stored));
    }
    let held_out = found.held_out.ok_or("every fifth point was held out")?;
    println!("held-out points: {:.3} mm RMS", held_out * 1e3);
    assert!(found.determined.iter().all(|by_points| *by_points));
    // Three coordinates of noise, and little more.
    assert!(held_out < 2.5 * SIGMA);
    let [before, after] = [&stored, &found.parameters].map(|p| tracker.error_of(p));
    println!("largest error: {:.3} mm as stored, {:.3} mm now", before * 1e3, after * 1e3);
    assert!(after < 0.05 * before);
    Ok(())
}
