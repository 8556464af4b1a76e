//! From a blob to every tick.

use core::hint::black_box;

use truearm::blob::{Acceptance, AcceptanceError, Blob};
use truearm::{Approach, Arm, Compensator, Pose, RealPosition, Scalar, Settings, State, Task};

use super::compute;

/// Of a slot.
pub fn load_and_tick<T: Scalar>(bytes: &[u8], q: &[T; 6]) -> Result<(), AcceptanceError> {
    let mine =
        Acceptance::of(black_box(1), 6).with_key(black_box([3; 32])).not_before(black_box(2));
    let blob = mine.check(black_box(bytes))?;
    header(&blob);
    let parameters = blob.parameters::<T, 6>()?;
    let arm = Arm::new(black_box(&parameters));
    compute(black_box(&parameters).detached().is_some());
    poses(&blob, &arm, black_box(q));
    for task in [Task::Position, Task::Pose] {
        let settings = black_box(Settings::new(task));
        let state = arm.state();
        if let Ok(mut compensator) = Compensator::new(arm.clone(), settings, black_box(q)) {
            compensator.set_active(black_box(true));
            compute(compensator.tick(black_box(q), black_box(&state)));
            compute(compensator.tick_without_state(black_box(q)));
            compute(compensator.arm().terms());
            compute(compensator.correction(black_box(q), black_box(&state)).is_ok());
            compute(compensator.error(black_box(q), black_box(q), black_box(&state)));
            let arm = arm.with_tool(*black_box(arm.nominal().tool()));
            compute(compensator.set_arm(arm).is_ok());
        }
    }
    Ok(())
}

fn header(blob: &Blob<'_>) {
    compute((blob.joints(), blob.terms(), blob.size(), blob.sequence(), blob.robot_id()));
    compute((blob.created(), blob.is_tagged(), blob.content()));
}

fn poses<T: Scalar>(blob: &Blob<'_>, arm: &Arm<'_, T, 6>, q: &[T; 6]) {
    let [x, y, z, ..] = *q;
    let approach = q.map(Approach::of_motion);
    let torque = black_box(Some(*q));
    let state = State { approach, payload: x, temperature: y, torque };
    compute(arm.reads_torques());
    compute(arm.real_pose(q));
    compute(arm.real_pose_in(q, black_box(&state)));
    compute(arm.deflection(q, black_box(&state)));
    compute(arm.covers(q));
    let mut lag = black_box(arm.thermal_lag());
    compute(lag.since());
    compute((lag.step(black_box(x), black_box(y)), lag.step(black_box(y), black_box(x))));
    compute(lag.time_constant());
    let curves = arm.curves();
    compute(curves.of_joint(black_box(0)).map(|curve| (curve.at(x), curve.band_at(x))));
    compute((arm.limits(), arm.orientation_identified(), arm.reference_temperature()));
    for chain in [arm.nominal(), arm.real()] {
        compute(chain.forward(q));
        compute(chain.jacobian(q));
        compute(chain.identification_jacobian(q));
    }
    compute(RealPosition::of(arm, q, &state));
    if let Some(covariance) = blob.covariance() {
        compute((covariance.parameters(), covariance.factor().last()));
        compute(covariance.point_sigma(black_box(arm), q, &state));
        compute(RealPosition::with_sigma(black_box(arm), q, &state, &covariance));
    }
    let shift = Pose::translation(x, y, z);
    let turn = Pose::from_rotation_vector(shift.translation, shift.translation);
    compute(turn.inverse().compose(&shift).transform_point(&shift.translation));
}
