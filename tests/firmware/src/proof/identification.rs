//! Measured points: the drift watch, re-identification, streaming.

use core::hint::black_box;

use truearm::blob::{Blob, DecodeError};
use truearm::check_point::CheckPoint;
use truearm::drift::{DriftWatch, FalseAlarms};
use truearm::measurement::{Anchor, Measurement, Plane, PlaneError};
use truearm::nalgebra::Vector3;
use truearm::parameters::{Axis, Parameter};
use truearm::reidentify::Reidentify;
use truearm::solve::{Memory, NormalEquations, SolveError, StreamingTikhonov, Triangle};
use truearm::streaming::{self, Lambda, StreamingError};
use truearm::{Arm, ArmParameters6, Pose, Scalar};

use super::compute;

pub fn watch_and_reidentify<T: Scalar>(bytes: &[u8], q: &[T; 6]) -> Result<(), DecodeError> {
    let parameters = Blob::check(black_box(bytes))?.parameters::<T, 6>()?;
    let arm = Arm::new(&parameters);
    let point = CheckPoint::plain(*q, Pose::translation(q[0], q[1], q[2]).translation, q[3]);
    compute((point.is_finite(), point.predicted(&arm)));
    let points = [*black_box(&point); 10];
    let [x, y, z] = Parameter::TOOL;
    let chosen = black_box([Parameter::JointOffset(1), Parameter::Term(2), x, y, z]);
    compute(Reidentify::new(&parameters, chosen, q[0]).run(&parameters, &points));
    if let Ok(all) = measurements(black_box(&point)) {
        let ([a, b, c], [d, e, f]) = (Parameter::plane(1, Axis::Z), Parameter::anchor(2));
        for frame in [Parameter::STATION, Parameter::BASE, [a, b, c, d, e, f]] {
            compute(Reidentify::new(&parameters, black_box(frame), q[0]).run(&parameters, &all));
        }
        compute(stream_points(&parameters, black_box(&point), &all, chosen));
    }
    if let Ok(mut watch) = DriftWatch::<T, 6>::new(q[1], black_box(FalseAlarms::default())) {
        compute(watch.push(&arm, black_box(&point), &point.point));
        watch.explanations().for_each(compute);
        compute(watch.suspect());
        watch.restart();
    }
    Ok(())
}

/// Of every kind, of places known and unknown.
fn measurements<T: Scalar>(at: &CheckPoint<T, 6>) -> Result<[Measurement<T, 6>; 5], PlaneError> {
    let [a, b, c, ..] = at.q;
    let plane = Plane::new(at.point, Vector3::new(a, b, c))?;
    let about = Plane::through(black_box([at.point; 3]))?.unknown(black_box(1));
    let anchor = Anchor::new(at.point).unknown(black_box(2));
    let (unknowns, change) = (black_box(Parameter::STATION), black_box([a; 6]));
    compute((about.point(), about.normal(), about.label(), about.found(&unknowns, &change)));
    compute((anchor.point(), anchor.label(), anchor.found(&unknowns, &change)));
    Ok(black_box([
        plane.touched(at.q, a, b),
        about.touched(at.q, b, c),
        Anchor::new(at.point).distance(at.q, a, b),
        anchor.distance(at.q, b, c),
        Measurement::from(*at),
    ]))
}

fn stream_points<T: Scalar>(
    parameters: &ArmParameters6<'_, T>,
    point: &CheckPoint<T, 6>,
    all: &[Measurement<T, 6>],
    chosen: [Parameter; 5],
) -> Result<(), StreamingError> {
    let mut stream =
        streaming::Settings::new(parameters, chosen, point.point.x).start(parameters)?;
    compute(stream.push(point));
    for measurement in all {
        compute((measurement.equations(), stream.push(measurement)));
    }
    compute(stream.points());
    for lambda in [Lambda::TwoStep, Lambda::LCurve, Lambda::Fixed(point.point.y)] {
        let found = stream.identified(black_box(lambda))?;
        stream.relinearise(black_box(&found));
    }
    Ok(())
}

pub fn stream<T: Scalar>(q: &[T; 6]) -> Result<(), SolveError> {
    let mut stream = StreamingTikhonov::<T, 30>::new(black_box(5), q[2])?;
    compute(stream.push(black_box(&[[q[0]; 3]; 30]), black_box(&[q[1]; 3])));
    compute(stream.push(black_box(&[[q[0]]; 30]), black_box(&[q[1]])));
    let scale = black_box([q[3]; 30]);
    compute((stream.points(), stream.choose(&scale)));
    compute(Memory::of(black_box(30), black_box(4)).total());
    triangle(&mut stream.all()?, &scale, q)?;
    let held_out = *black_box(stream.held_out());
    triangle(&mut *black_box(&mut stream.fitted()?.clone()), &scale, q)?;
    let mut normal = NormalEquations::<T, 30>::new();
    compute(normal.push(&scale, q[0]));
    compute(normal.solve(q[1], &scale));
    triangle(&mut { held_out }, &scale, q)
}

fn triangle<T: Scalar>(
    all: &mut Triangle<T, 30>,
    scale: &[T; 30],
    q: &[T; 6],
) -> Result<(), SolveError> {
    compute(all.push_weighted(black_box(&[[q[0]; 3]; 30]), black_box(&[q[1]; 3]), q[2]));
    compute(all.absorb(&all.clone()));
    all.forget(q[3]);
    let solution = all.solve(q[4], scale)?;
    compute((all.residual_square(&solution.x), all.explained_square(), all.total_square()));
    compute(all.variances(q[4], scale));
    let spectrum = all.spectrum(scale)?;
    spectrum.squares().for_each(compute);
    compute((spectrum.rank(), spectrum.solve(q[5]), spectrum.corner(), spectrum.curvature(q[5])));
    compute((spectrum.residual_square(q[5]), spectrum.norm_square(q[5])));
    compute((spectrum.largest(), spectrum.least_lambda()));
    all.clear();
    Ok(())
}
