//! Torques that are read, in place of those that masses give.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::compensate::{Refusal, Settings, Status, Task};
use truearm::{Arm, ArmParameters, Compensator, Scalar, State};

use super::arms::{Terms, anywhere, parameters, rail, state};
use super::common::ur10;

/// Of an arm, those terms that masses alone can tell left out.
fn of_torques<T: Scalar, const N: usize>(
    p: &ArmParameters<'static, T, N>,
) -> ArmParameters<'static, T, N> {
    let terms = p.terms.iter().filter(|term| !term.needs_masses()).copied().collect();
    ArmParameters { terms, ..p.clone() }
}

/// What masses give, read by sensors: the same bits, with masses and without.
fn read_or_computed<T: Scalar, const N: usize>(all: &ArmParameters<'static, T, N>) {
    let weighed = of_torques(all);
    let unweighed = ArmParameters { masses: None, ..weighed.clone() };
    let masses = weighed.masses.unwrap();
    let [weighed, unweighed] = [&weighed, &unweighed].map(Arm::new);
    assert!(!weighed.reads_torques() && unweighed.reads_torques());
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut moved = 0;
    for _ in 0..200 {
        let q = anywhere(&mut rng, &weighed);
        let payload = T::from_f64(rng.random_range(0.0..8.0));
        let computed = State { payload, ..state() };
        let torque = masses.load(weighed.real(), &q, payload).torque;
        let read = State { torque: Some(torque), ..computed };
        let pose = weighed.real_pose_in(&q, &computed);
        assert_eq!(weighed.real_pose_in(&q, &read), pose);
        // Nobody asks what the payload is where torques are read.
        let heavy = State { payload: T::from_f64(f64::NAN), ..read };
        assert_eq!(unweighed.real_pose_in(&q, &heavy), pose);
        let other = State { torque: Some(torque.map(|t| t + T::ONE)), ..computed };
        moved += i32::from(weighed.real_pose_in(&q, &other) != pose);
    }
    assert!(moved > 150, "torques count: {moved} of 200");
}

#[test]
fn torques_that_are_read_count_in_place_of_computed_ones() {
    read_or_computed(&parameters::<f64, 6>(&ur10(), 5e-4, Terms::All));
    read_or_computed(&parameters::<f32, 6>(&ur10(), 5e-4, Terms::All));
    read_or_computed(&parameters::<f64, 7>(&rail(), 5e-4, Terms::All));
}

/// Not as an unloaded one.
#[test]
fn an_arm_that_reads_torques_refuses_a_state_without() {
    let p = of_torques(&parameters::<f32, 6>(&ur10(), 5e-4, Terms::All));
    let arm = Arm::new(&ArmParameters { masses: None, ..p });
    let command = [0.1, -1.2, 1.6, -1.2, -1.57, 0.0];
    assert!(arm.real_pose(&command).translation.x.is_nan());
    let settings = Settings { ramp_ticks: 0, ..Settings::new(Task::Position) };
    let mut compensator = Compensator::new(arm, settings, &command).unwrap();
    compensator.set_active(true);
    let read = |torque| State { torque, ..state() };
    let good = compensator.tick(&command, &read(Some([20.0; 6])));
    assert_eq!(good.status, Status::On);
    let tick = compensator.tick(&command, &read(None));
    assert_eq!(tick.status, Status::Refused(Refusal::TorqueUnknown));
    assert_eq!(tick.joints, command);
    assert_eq!(compensator.correction(&command, &read(None)), Err(Refusal::TorqueUnknown));
    let dead = read(Some([20.0, f32::NAN, 20.0, 20.0, 20.0, 20.0]));
    assert_eq!(compensator.correction(&command, &dead), Err(Refusal::StateNotFinite));
    assert_eq!(compensator.tick(&command, &read(Some([20.0; 6]))), good);
}
