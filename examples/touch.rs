//! An arm that calibrates itself from touches of one plate: no tracker, no host. While it
//! is as it was calibrated it learns where the plate is; after a crash touches of that
//! plate say what moved.
//!
//! `cargo run --example touch`

mod tracker;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tracker::{SIGMA, Tracker, stored};
use truearm::measurement::{Measurement, MeasurementError, Plane, PlaneError};
use truearm::nalgebra::Vector3;
use truearm::parameters::{Axis, Parameter};
use truearm::reidentify::{Reidentify, ReidentifyError};
use truearm::streaming::{Lambda, Settings, StreamingError};
use truearm::{Arm6, ArmParameters6};

/// Of the ball, m; its centre is the tool point.
const RADIUS: f32 = 3e-3;
/// Where the plate is: how it leans and its offset.
const PLATE: [Parameter; 3] = Parameter::plane(0, Axis::Z);

/// The plate as it was found, and one standard deviation of its parameters.
type Learned = (Plane<f32>, [f32; 3]);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let stored = stored()?;
    let (plate, sure) = learn(&stored)?;

    // The crash, of which the controller knows nothing: joints 2 and 4 slipped.
    let [shoulder, wrist] = [1, 3].map(Parameter::JointOffset);
    let mut real = stored.clone();
    for (parameter, by) in [(shoulder, 4e-3), (wrist, -6e-3)] {
        parameter.apply(&mut real, by);
    }
    let mut probe = Probe::of(&real);

    // The plate is where it was found, as surely as it was found.
    let ([a, b, c], [d, e, f, g]) = (PLATE, [1, 2, 3, 4].map(Parameter::JointOffset));
    let mut reidentify = Reidentify::new(&stored, [a, b, c, d, e, f, g], SIGMA);
    reidentify.scale.iter_mut().zip(sure).for_each(|(scale, sigma)| *scale = sigma);
    let Reidentify { parameters: chosen, scale, .. } = reidentify;

    // One touch after the other, in memory that does not grow.
    let settings = Settings { scale, ..Settings::new(&stored, chosen, SIGMA) };
    let mut stream = settings.start(&stored)?;
    let touches = [0; 60].map(|_| probe.touch(plate));
    for (touch, count) in touches.iter().zip(1..) {
        match stream.push(touch) {
            Ok(_) => {}
            Err(error @ StreamingError::BadMeasurement(_)) => println!("touch {count}: {error}"),
            Err(error) => return Err(error.into()),
        }
    }
    let found = stream.identified(Lambda::Prior)?;
    let mut judge = Tracker::before(&real);
    let mut error_of = |p: &ArmParameters6<'static, f32>| judge.error_of(p) * 1e3;
    println!("largest error: {:.3} mm as stored", error_of(&stored));
    println!("{} touches streamed: {:.3} mm", stream.points(), error_of(&found.parameters));

    // What was linearised about the stored arm is iterated, where the touches were kept.
    let again = reidentify.run(&stored, &touches)?;
    for (parameter, (change, sigma)) in chosen.iter().zip(again.change.iter().zip(&again.sigma)) {
        println!("{parameter}: {change:+.6} +- {sigma:.6} {}", parameter.unit(&stored));
    }
    // What touches of one plate leave open would stay near its prior.
    assert_eq!(again.determined.get(3..), Some(&[true; 4][..]));
    let left = error_of(&again.parameters);
    println!("re-identified: {left:.3} mm");
    assert!(left < 0.02 * error_of(&stored));
    refused(&stored, plate)
}

/// Where the plate is, in the eyes of the calibrated arm: about where it is by three of
/// its touches, then by all of them; and how sure that is.
fn learn(stored: &ArmParameters6<'static, f32>) -> Result<Learned, Box<dyn std::error::Error>> {
    let truth = Plane::new(Vector3::new(-0.6, 0.0, 0.3), Vector3::new(0.0, 0.0, 1.0))?;
    let mut probe = Probe::of(stored);
    let joints = [0; 20].map(|_| probe.touch(truth).q);
    let arm = Arm6::new(stored);
    let [a, b, c, ..] = joints.map(|q| arm.real_pose(&q).translation);
    let about = match Plane::through([a, b, c]) {
        Err(PlaneError::PointsOnALine) => return Err("touch it farther apart".into()),
        plane => plane?.unknown(0),
    };
    let touches = joints.map(|q| about.touched(q, RADIUS, stored.reference_temperature));
    let found = Reidentify::new(stored, PLATE, SIGMA).run(stored, &touches)?;
    println!("plate found to {:.3} mm", found.sigma[2] * 1e3);
    Ok((about.found(&PLATE, &found.change).unknown(0), found.sigma))
}

/// What a controller is told where something is wrong.
fn refused(
    stored: &ArmParameters6<'static, f32>,
    plate: Plane<f32>,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut probe = Probe::of(stored);
    let touches = [0; 6].map(|_| probe.touch(plate));
    let offsets = [1, 2, 3, 4].map(Parameter::JointOffset);
    let reidentify = Reidentify::new(stored, offsets, SIGMA);
    let few = reidentify.run(stored, touches.get(..3).unwrap_or(&[]));
    assert!(matches!(few, Err(ReidentifyError::TooFewEquations { equations: 3, needed: 4 })));

    // The plate's place is unknown, and not among the parameters.
    let why = MeasurementError::PlaceNotChosen;
    let not_chosen = reidentify.run(stored, &touches);
    assert_eq!(not_chosen.err(), Some(ReidentifyError::BadMeasurement { index: 0, why }));

    // An offset of the first joint turns the arm along a plate that lies flat: the prior
    // holds it, and that is said.
    let [a, b, c] = PLATE;
    let first = Reidentify::new(stored, [a, b, c, Parameter::JointOffset(0)], SIGMA);
    let open = first.run(stored, &touches)?;
    println!("offset of joint 1, which this plate does not tell: +- {:.4} rad", open.sigma[3]);
    assert!(!open.determined[3]);
    Ok(())
}

/// A touch probe on an arm that is not quite what its controller has stored.
struct Probe {
    arm: Arm6<'static, f32>,
    rng: ChaCha8Rng,
}

impl Probe {
    fn of(real: &ArmParameters6<'static, f32>) -> Self {
        Self { arm: Arm6::new(real), rng: ChaCha8Rng::seed_from_u64(2) }
    }

    /// Comes down upon the plate, by the shoulder, until the ball touches.
    fn touch(&mut self, plate: Plane<f32>) -> Measurement<f32, 6> {
        let middle = [0.0, -1.2, 1.6, -1.2, -1.57, 0.0];
        let half = 3.0_f32.sqrt() * SIGMA;
        loop {
            let mut q = middle.map(|q| q + self.rng.random_range(-0.7..0.7));
            let trigger = RADIUS + self.rng.random_range(-half..half);
            let height = |q: &[f32; 6]| {
                let lever = self.arm.real_pose(q).translation - plate.point();
                lever.dot(plate.normal()) - trigger
            };
            for _ in 0..10 {
                let mut further = q;
                further[1] += 1e-2;
                q[1] -= 1e-2 * height(&q) / (height(&further) - height(&q));
            }
            if height(&q).abs() < 1e-6 && (q[1] - middle[1]).abs() < 1.0 {
                return plate.touched(q, RADIUS, self.arm.reference_temperature());
            }
        }
    }
}
