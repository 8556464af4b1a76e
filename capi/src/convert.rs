//! The structures of the header to those of the crate and back.

use truearm::compensate::Status;
use truearm::{Approach, Pose, Settings, State, Task, Tick};

use crate::Result;
use crate::types::{
    TRUEARM_JOINTS, TruearmApproach, TruearmError, TruearmPose, TruearmSettings, TruearmState,
    TruearmStatus, TruearmTask, TruearmTick,
};

fn task_of(task: u8) -> Result<Task> {
    [(TruearmTask::Position, Task::Position), (TruearmTask::Pose, Task::Pose)]
        .into_iter()
        .find_map(|(c, rust)| (c as u8 == task).then_some(rust))
        .ok_or(TruearmError::BadSetting)
}

/// What is neither 0 nor 1 was not set.
fn flag(byte: u8) -> Option<bool> {
    match byte {
        0 => Some(false),
        1 => Some(true),
        _ => None,
    }
}

pub fn settings_of(c: &TruearmSettings) -> Result<Settings<f32, TRUEARM_JOINTS>> {
    Ok(Settings {
        task: task_of(c.task)?,
        trust_nominal_orientation: flag(c.trust_nominal_orientation)
            .ok_or(TruearmError::BadSetting)?,
        refinements: c.refinements,
        max_correction: c.max_correction,
        max_change: c.max_change,
        ramp_ticks: c.ramp_ticks,
        rotation_length: c.rotation_length_m,
        singular: c.singular_m,
    })
}

pub fn usual(task: u8) -> Result<TruearmSettings> {
    let usual = Settings::<f32, TRUEARM_JOINTS>::new(task_of(task)?);
    Ok(TruearmSettings {
        task,
        trust_nominal_orientation: u8::from(usual.trust_nominal_orientation),
        refinements: usual.refinements,
        ramp_ticks: usual.ramp_ticks,
        rotation_length_m: usual.rotation_length,
        singular_m: usual.singular,
        max_correction: usual.max_correction,
        max_change: usual.max_change,
    })
}

pub fn state_of(c: &TruearmState) -> Result<State<f32, TRUEARM_JOINTS>> {
    const NEGATIVE: i8 = TruearmApproach::Negative as i8;
    const UNKNOWN: i8 = TruearmApproach::Unknown as i8;
    const POSITIVE: i8 = TruearmApproach::Positive as i8;
    let mut approach = [Approach::Unknown; TRUEARM_JOINTS];
    for (rust, c) in approach.iter_mut().zip(&c.approach) {
        *rust = match *c {
            NEGATIVE => Approach::Negative,
            UNKNOWN => Approach::Unknown,
            POSITIVE => Approach::Positive,
            _ => return Err(TruearmError::BadApproach),
        };
    }
    let read = flag(c.has_torque).ok_or(TruearmError::BadState)?;
    let torque = read.then_some(c.torque);
    Ok(State { approach, payload: c.payload_kg, temperature: c.temperature_c, torque })
}

/// The other way.
pub fn state_from(state: &State<f32, TRUEARM_JOINTS>) -> TruearmState {
    let approach = state.approach.map(|approach| match approach {
        Approach::Negative => TruearmApproach::Negative as i8,
        Approach::Unknown => TruearmApproach::Unknown as i8,
        Approach::Positive => TruearmApproach::Positive as i8,
    });
    TruearmState {
        approach,
        payload_kg: state.payload,
        temperature_c: state.temperature,
        has_torque: u8::from(state.torque.is_some()),
        torque: state.torque.unwrap_or([0.0; TRUEARM_JOINTS]),
    }
}

impl From<&Tick<f32, TRUEARM_JOINTS>> for TruearmTick {
    fn from(tick: &Tick<f32, TRUEARM_JOINTS>) -> Self {
        use truearm::compensate::Refusal;
        Self {
            joints: tick.joints,
            status: match tick.status {
                Status::Off => TruearmStatus::Off,
                Status::Ramping => TruearmStatus::Ramping,
                Status::On => TruearmStatus::On,
                Status::Refused(Refusal::CommandNotFinite { .. }) => {
                    TruearmStatus::CommandNotFinite
                }
                Status::Refused(Refusal::StateNotFinite) => TruearmStatus::StateNotFinite,
                Status::Refused(Refusal::TorqueUnknown) => TruearmStatus::TorqueUnknown,
                _ => TruearmStatus::OutOfRange,
            },
            position_error_m: tick.left.map_or([0.0; 3], |left| left.position),
            rotation_error_rad: tick.left.map_or([0.0; 3], |left| left.rotation),
            damping_m2: tick.damping.unwrap_or(0.0),
            held_by_correction: tick.clamped.bound.0,
            held_by_change: tick.clamped.change.0,
            held_by_limit: tick.clamped.limit.0,
            complete: u8::from(tick.is_complete()),
            has_error: u8::from(tick.left.is_some()),
            covered: u8::from(tick.covered == Some(true)),
            orientation_identified: u8::from(tick.orientation_identified),
        }
    }
}

impl TruearmTick {
    /// Joints of which nothing is claimed.
    pub(crate) fn refused(joints: [f32; TRUEARM_JOINTS], status: TruearmStatus) -> Self {
        Self {
            joints,
            status,
            position_error_m: [0.0; 3],
            rotation_error_rad: [0.0; 3],
            damping_m2: 0.0,
            held_by_correction: 0,
            held_by_change: 0,
            held_by_limit: 0,
            complete: 0,
            has_error: 0,
            covered: 0,
            orientation_identified: 0,
        }
    }
}

impl TruearmPose {
    pub(crate) fn new(pose: &Pose<f32>, covered: bool) -> Self {
        let Pose { rotation: r, translation: t } = pose;
        let matrix = [
            [r[(0, 0)], r[(0, 1)], r[(0, 2)], t[0]],
            [r[(1, 0)], r[(1, 1)], r[(1, 2)], t[1]],
            [r[(2, 0)], r[(2, 1)], r[(2, 2)], t[2]],
        ];
        Self { matrix, covered: u8::from(covered) }
    }
}
