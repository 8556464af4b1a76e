//! The structures of the header. All bytes are valid for those that come in.

/// Joints of the arm.
pub const TRUEARM_JOINTS: usize = 6;

/// What a function returns. 0 is success.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TruearmError {
    /// Done.
    Ok = 0,
    /// A pointer is NULL.
    Null = 1,
    /// A pointer is not aligned.
    Alignment = 2,
    /// Header and library are of different versions.
    Version = 3,
    /// Less memory than TRUEARM_MEMORY_SIZE.
    MemorySize = 4,
    /// The memory was not prepared by `truearm_init`.
    NotInitialised = 5,
    /// No parameters have been loaded.
    NotLoaded = 6,
    /// Not possible while compensation is on or being faded out.
    Active = 7,
    /// The bytes are no valid blob; `truearm inspect` says why.
    BadBlob = 8,
    /// A valid blob of another robot.
    OtherRobot = 9,
    /// A blob for another number of joints.
    OtherArm = 10,
    /// A setting makes no sense, or the joints to start at are not finite.
    BadSetting = 11,
    /// The tool is no rigid transform.
    BadTool = 12,
    /// A pose is not finite: an input is not, or is out of range.
    NotFinite = 13,
    /// An approach of the state is none of `TruearmApproach`.
    BadApproach = 14,
    /// The blob carries no covariance.
    NoCovariance = 15,
    /// `has_torque` of the state is neither 0 nor 1: was all of it set?
    BadState = 16,
}

/// What compensation has to meet.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TruearmTask {
    /// The tool point.
    Position = 0,
    /// Tool point and orientation.
    Pose = 1,
}

/// How compensation works; begin with `truearm_default_settings`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct TruearmSettings {
    /// Of `TruearmTask`.
    pub task: u8,
    /// 1: take the task of a pose although the arm's orientation was not
    /// identified, what points cannot see of it being nominal. Otherwise 0.
    pub trust_nominal_orientation: u8,
    /// How often what is left is looked at and solved for again, 1 to 4.
    pub refinements: u8,
    /// Ticks in which compensation is faded in and out, at most 2^24.
    pub ramp_ticks: u32,
    /// An orientation error of 1 rad counts as much as one of this length, m, 0.001 to 10.
    pub rotation_length_m: f32,
    /// Singular value of the Jacobian below which damping sets in, m per rad, 0.001 to 1;
    /// 0.02 to 0.1 of the arm's reach keep what the book promises.
    pub singular_m: f32,
    /// Largest correction of each joint, rad (m for a prismatic joint), above 0, at most 0.2.
    pub max_correction: [f32; TRUEARM_JOINTS],
    /// Largest change of a correction from tick to tick, rad (m), at most 0.2 and at least
    /// what sums are rounded by, 2^-19 of `max_correction`.
    pub max_change: [f32; TRUEARM_JOINTS],
}

/// How a joint came to rest, or moves.
#[repr(i8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TruearmApproach {
    /// In -q.
    Negative = -1,
    /// Not known.
    Unknown = 0,
    /// In +q.
    Positive = 1,
}

/// What the terms of an arm depend on besides the joint values; begin with
/// `truearm_default_state`. All zero is an arm at 0 degrees Celsius.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct TruearmState {
    /// Of `TruearmApproach`, for each joint.
    pub approach: [i8; TRUEARM_JOINTS],
    /// Mass at the payload point, kg.
    pub payload_kg: f32,
    /// Temperature of the arm, degrees Celsius: what `truearm_arm_temperature` makes of
    /// the readings of its thermometer.
    pub temperature_c: f32,
    /// 1 if `torque` is known; otherwise it is that of the masses of the blob, and an arm
    /// without masses whose terms need it is not compensated.
    pub has_torque: u8,
    /// What loads each joint, positive where it pulls towards +q as gravity's torque does:
    /// the opposite of what the joint holds, N m (N for a prismatic joint).
    pub torque: [f32; TRUEARM_JOINTS],
}

/// How far a tick went.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TruearmStatus {
    /// Switched off: the joints are the command.
    Off = 0,
    /// Being faded in or out.
    Ramping = 1,
    /// The whole correction, but for what was held back.
    On = 2,
    /// Refused, a command is infinite or NaN, or its pointer is bad: the joints of the last
    /// tick.
    CommandNotFinite = 3,
    /// Refused, the state is infinite or NaN, or the tick returned an error of it: fading back
    /// to the command.
    StateNotFinite = 4,
    /// Refused, no finite pose at this command: fading back to the command.
    OutOfRange = 5,
    /// Refused, terms need torques and the state has none: fading back to the command.
    TorqueUnknown = 6,
    /// Refused, there is no arm or it has no parameters: the command as it is.
    NoArm = 7,
}

/// What a tick did. Sets of joints are bits: joint 1 is bit 0.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct TruearmTick {
    /// Joints to command, rad (m): always finite, but that with TRUEARM_STATUS_NO_ARM a
    /// command that is no number leaves them as they were.
    pub joints: [f32; TRUEARM_JOINTS],
    /// How far it went.
    pub status: TruearmStatus,
    /// By how much the tool point misses its target at `joints`, m, where
    /// `has_error`.
    pub position_error_m: [f32; 3],
    /// The same of the orientation, as a rotation vector, rad; to first order in
    /// the angle.
    pub rotation_error_rad: [f32; 3],
    /// Damping near a singular pose, m^2; 0 away from them and where nothing
    /// was computed.
    pub damping_m2: f32,
    /// Joints held back by max_correction.
    pub held_by_correction: u16,
    /// Joints held back by max_change.
    pub held_by_change: u16,
    /// Joints held back by a joint limit.
    pub held_by_limit: u16,
    /// 1 if the whole error was taken back: on, not damped, nothing held back.
    pub complete: u8,
    /// 1 if the remaining errors were computed: where a correction was, but not
    /// the whole.
    pub has_error: u8,
    /// 1 within the joint ranges that the identification covered; outside of
    /// them the correction is extrapolated; 0 also where none was computed.
    pub covered: u8,
    /// 1 if the data determined the orientation of the flange; otherwise only
    /// the tool point is better than nominal.
    pub orientation_identified: u8,
}

/// A pose of the tool in the nominal base frame.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct TruearmPose {
    /// 3 rows of 4: rotation, whose columns are the axes of the tool frame,
    /// and the tool point, m.
    pub matrix: [[f32; 4]; 3],
    /// 1 within the joint ranges that the identification covered.
    pub covered: u8,
}
