//! The vector file: joint angles and the hash of the poses they must give.
//! Shared by the image, the host test and xtask, so it needs no std.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | 4 bytes | `TAFK` |
//! | 4 | u32 | poses |
//! | 8 | u32 | joints |
//! | 12 | u32 | 0 |
//! | 16 | 3 u64 | expected hashes in `f32`, see [`hashes`] |
//! | 40 | 3 u64 | expected hashes in `f64` |
//! | 64 | f32 ... | poses * joints angles in rad |
//!
//! All little-endian.

#![allow(dead_code, reason = "each of its three users needs a part")]

use core::fmt;

use crc::{CRC_64_XZ, Crc, Digest};
use truearm::compensate::TaskError;
use truearm::{Approach, Arm, Compensator, Pose, Scalar, Settings, State, Task};

/// First four bytes of a vector file.
pub const MAGIC: [u8; 4] = *b"TAFK";
/// Bytes before the angles.
pub const HEADER: usize = 64;
/// Joints of the arm under test.
pub const JOINTS: usize = 6;

/// What the hashes are of.
pub const PARTS: [&str; 3] = ["poses", "jacobians", "ticks"];
/// One hash for each of [`PARTS`].
pub type Hashes = [u64; PARTS.len()];

/// One pose's joint angles, rad.
pub type Joints<T = f32> = [T; JOINTS];

static CRC64: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// A vector file in place.
#[derive(Debug, Clone, Copy)]
pub struct Vectors<'a> {
    /// What the poses must give in `f32`.
    pub single: Hashes,
    /// The same in `f64`.
    pub double: Hashes,
    angles: &'a [u8],
}

/// Why bytes are not a vector file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorError {
    /// Does not begin with `TAFK`.
    NoVectors,
    /// For arms with this many joints.
    Joints(u32),
    /// Ends before its last pose.
    Truncated,
}

impl fmt::Display for VectorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoVectors => f.write_str("does not begin with TAFK: no vector file"),
            Self::Joints(n) => write!(f, "vectors for {n} joints, the arm has {JOINTS}"),
            Self::Truncated => f.write_str("the vector file ends before its last pose"),
        }
    }
}

impl<'a> Vectors<'a> {
    /// Finds a vector file in the front of `bytes`.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, VectorError> {
        let (header, rest) = bytes.split_first_chunk::<HEADER>().ok_or(VectorError::NoVectors)?;
        let word = |index: usize| {
            let bytes = header.as_chunks::<4>().0.get(index).copied().unwrap_or_default();
            u32::from_le_bytes(bytes)
        };
        if word(0).to_le_bytes() != MAGIC {
            return Err(VectorError::NoVectors);
        }
        if word(2) as usize != JOINTS {
            return Err(VectorError::Joints(word(2)));
        }
        let angles = (word(1) as usize).checked_mul(JOINTS * 4).and_then(|size| rest.get(..size));
        let hashes = |first: usize| {
            let mut index = first;
            [0; PARTS.len()].map(|_: u64| {
                index += 2;
                u64::from(word(index - 1)) << 32 | u64::from(word(index - 2))
            })
        };
        let angles = angles.ok_or(VectorError::Truncated)?;
        Ok(Self { single: hashes(4), double: hashes(4 + 2 * PARTS.len()), angles })
    }

    /// The joint angles of each pose.
    pub fn poses<T: Scalar>(
        &self,
    ) -> impl ExactSizeIterator<Item = Joints<T>> + Clone + use<'a, T> {
        let (poses, _) = self.angles.as_chunks::<{ JOINTS * 4 }>();
        poses.iter().map(|pose| {
            let mut angles = pose.as_chunks::<4>().0.iter();
            [0; JOINTS].map(|_| {
                T::from_f32(f32::from_le_bytes(angles.next().copied().unwrap_or_default()))
            })
        })
    }
}

/// The state of the arm at the `index`-th pose, so that every value a term
/// depends on varies: every approach of every joint, payload 0 to 10 kg,
/// temperature 10 to 40 degrees Celsius, torques of up to 48 N m or none.
pub fn state<T: Scalar>(index: usize) -> State<T, JOINTS> {
    let mut power = 1;
    State {
        approach: [0; JOINTS].map(|_| {
            let digit = index / power % 3;
            power *= 3;
            Approach::of_motion(digit as f32 - 1.0)
        }),
        payload: T::from_f32((index % 11) as f32),
        temperature: T::from_f32(10.0 + (index % 31) as f32),
        // Every fifth has read its torques.
        torque: index.is_multiple_of(5).then(|| {
            let mut torque = [T::ZERO; JOINTS];
            let sizes = (0..).map(|joint| (index * (joint + 3) % 97) as f32 - 48.0);
            torque.iter_mut().zip(sizes).for_each(|(out, size)| *out = T::from_f32(size));
            torque
        }),
    }
}

/// How the compensators work whose ticks are hashed. The poses are far apart,
/// so that corrections run into their bounds and many a pose is near singular.
pub fn settings<T: Scalar>(task: Task) -> Settings<T, JOINTS> {
    let refinements = if task == Task::Pose { 1 } else { 2 };
    let settings = Settings { refinements, ramp_ticks: 100, ..Settings::new(task) };
    settings.trusting_nominal_orientation()
}

/// From this tick on they are switched off.
pub const OFF: usize = 900;

/// CRC-64/XZ of the bits of all results, as little-endian `f64`, which holds
/// an `f32` exactly. One changed bit changes it.
///
/// * poses: of each pose first without, then with its state, three columns of
///   the rotation and the translation;
/// * jacobians: of each pose the columns, linear and angular;
/// * ticks: in the task of a pose, then of a position, of a compensator that
///   starts at rest at the first pose: of each tick the joints, the remaining
///   errors and the damping, zeros where these were not computed.
pub fn hashes<T: Scalar>(
    arm: &Arm<T, JOINTS>,
    poses: impl Iterator<Item = Joints<T>> + Clone,
) -> Hashes {
    let mut of_poses = Hash::new();
    let mut of_jacobians = Hash::new();
    for (index, q) in poses.clone().enumerate() {
        for pose in [arm.real_pose(&q), arm.real_pose_in(&q, &state(index))] {
            let Pose { rotation, translation } = pose;
            of_poses.add(rotation.iter().chain(translation.iter()));
        }
        for column in &arm.real().jacobian(&q).columns {
            of_jacobians.add(column.linear.iter().chain(column.angular.iter()));
        }
    }
    let mut of_ticks = Hash::new();
    for task in [Task::Pose, Task::Position] {
        let first = poses.clone().next().unwrap_or([T::ZERO; JOINTS]);
        let Ok(mut compensator) = Compensator::new(arm.clone(), settings(task), &first) else {
            continue;
        };
        for (index, q) in poses.clone().enumerate() {
            compensator.set_active(index < OFF);
            let tick = compensator.tick(&q, &state(index));
            of_ticks.add(&tick.joints);
            let none = TaskError { position: [T::ZERO; 3], rotation: [T::ZERO; 3] };
            let left = tick.left.unwrap_or(none);
            of_ticks.add(left.position.iter().chain(&left.rotation));
            of_ticks.add([&tick.damping.unwrap_or(T::ZERO)]);
        }
    }
    [of_poses, of_jacobians, of_ticks].map(|hash| hash.0.finalize())
}

struct Hash(Digest<'static, u64>);

impl Hash {
    fn new() -> Self {
        Self(CRC64.digest())
    }

    fn add<'a, T: Scalar>(&mut self, values: impl IntoIterator<Item = &'a T>) {
        for value in values {
            self.0.update(&value.to_f64().to_le_bytes());
        }
    }
}
