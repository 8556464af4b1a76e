//! After a crash: two joint offsets and the tool anew, from ten measured points,
//! on the controller.
//!
//! `cargo run --example reidentify`

mod tracker;

use tracker::{SIGMA, Tracker, stored};
use truearm::parameters::Parameter;
use truearm::reidentify::{Reidentify, ReidentifyError};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let stored = stored()?;
    let [x, y, z] = Parameter::TOOL;
    let [shoulder, elbow] = [1, 2].map(Parameter::JointOffset);
    let chosen = [shoulder, elbow, x, y, z];

    // The crash.
    let mut real = stored.clone();
    for (parameter, by) in [(shoulder, 4e-3), (elbow, -6e-3), (x, 2e-3)] {
        parameter.apply(&mut real, by);
    }
    let mut tracker = Tracker::before(&real);
    let points = [0; 10].map(|_| tracker.point());

    let reidentify = Reidentify::new(&stored, chosen, SIGMA);
    // Five unknowns need more than the three equations of one point.
    match reidentify.run(&stored, points.get(..1).unwrap_or(&[])) {
        Err(error @ ReidentifyError::TooFewEquations { .. }) => println!("one point: {error}"),
        other => return Err(format!("one point is too few, but: {other:?}").into()),
    }

    let found = reidentify.run(&stored, &points)?;
    for (parameter, (change, sigma)) in chosen.iter().zip(found.change.iter().zip(&found.sigma)) {
        println!("{parameter}: {change:+.6} +- {sigma:.6} {}", parameter.unit(&stored));
    }
    // What the points leave open stays near its prior: measure more, or elsewhere. Whether the
    // points agree with what was found is another question, which `run` has asked.
    assert!(found.determined.iter().all(|by_points| *by_points));
    println!("the points scatter by {:.2} times what was stated", found.misfit.times());

    let [before, after] = [&stored, &found.parameters].map(|p| tracker.error_of(p));
    println!("largest error: {:.3} mm as stored, {:.3} mm now", before * 1e3, after * 1e3);
    assert!(after < 0.02 * before);
    // To be encoded and given to the store: see the example `store`.
    assert_eq!(found.parameters.sequence, stored.sequence + 1);

    // A beam that was lost and found elsewhere, 5 mm off: every parameter would be determined,
    // to the same sigma, and wrong by far more.
    let mut points = points;
    points[7].point.x += 5e-3;
    match reidentify.run(&stored, &points) {
        Err(error @ ReidentifyError::Inconsistent { worst: 7, .. }) => println!("{error}"),
        other => return Err(format!("a point is wrong, but: {other:?}").into()),
    }
    Ok(())
}
