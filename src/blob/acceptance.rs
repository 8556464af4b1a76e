use core::fmt;

use super::check::Blob;
use super::error::DecodeError;

/// What a controller demands of a blob besides being whole: that it is this
/// robot's and of its number of joints, no older than the one in force, and,
/// where a key is set, written by who knows the key.
///
/// ```
/// use truearm::blob::{Acceptance, AcceptanceError, robot_id};
///
/// const MINE: Acceptance = Acceptance::of(robot_id("UR10", "2019300"), 6);
/// assert!(matches!(MINE.check(&[0xff; 4096]), Err(AcceptanceError::Damaged(_))));
/// ```
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Acceptance {
    robot_id: u64,
    joints: usize,
    oldest: u32,
    #[cfg(feature = "auth")]
    key: Option<super::Key>,
}

/// Why a controller does not take a blob.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum AcceptanceError {
    /// Not a whole and plausible blob.
    Damaged(DecodeError),
    /// Another robot's parameters.
    WrongRobot {
        /// Id in the blob.
        blob: u64,
        /// Id of this robot.
        robot: u64,
    },
    /// An arm of another number of joints, whatever its id says.
    WrongJoints {
        /// Joints in the blob.
        blob: usize,
        /// Joints of this robot.
        robot: usize,
    },
    /// Its sequence number is the last there is, so that no later set could
    /// ever replace it.
    LastSequence,
    /// Older than the parameters in force.
    OldSequence {
        /// Sequence number of the blob.
        blob: u32,
        /// The lowest that is taken.
        oldest: u32,
    },
    /// A key is set and the blob carries no tag.
    NoTag,
    /// The tag is not the one that the key gives.
    WrongKey,
}

impl fmt::Display for AcceptanceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damaged(error) => error.fmt(f),
            Self::WrongRobot { blob, robot } => {
                write!(f, "robot id {blob:#018x} where this robot is {robot:#018x}")
            }
            Self::WrongJoints { blob, robot } => {
                write!(f, "{blob} joints where this robot has {robot}")
            }
            Self::LastSequence => {
                write!(f, "sequence {} is the last there is: none could follow it", u32::MAX)
            }
            Self::OldSequence { blob, oldest } => {
                write!(f, "sequence {blob} is older than {oldest}, which is in force")
            }
            Self::NoTag => f.write_str("carries no authentication tag, and a key is set"),
            Self::WrongKey => f.write_str("the authentication tag does not fit the key"),
        }
    }
}

impl core::error::Error for AcceptanceError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Damaged(error) => Some(error),
            _ => None,
        }
    }
}

impl From<DecodeError> for AcceptanceError {
    fn from(error: DecodeError) -> Self {
        Self::Damaged(error)
    }
}

impl Acceptance {
    /// Any whole blob of this robot, see [`super::robot_id`], with as many
    /// joints as it has.
    #[must_use]
    pub const fn of(robot_id: u64, joints: usize) -> Self {
        Self {
            robot_id,
            joints,
            oldest: 0,
            #[cfg(feature = "auth")]
            key: None,
        }
    }

    /// Only with a tag made with this key.
    #[cfg(feature = "auth")]
    #[must_use]
    pub const fn with_key(self, key: super::Key) -> Self {
        Self { key: Some(key), ..self }
    }

    /// Only from this sequence number on: what a store demands of a new blob.
    /// At power-up it is left out, so that the older slot can stand in for a
    /// damaged newer one; or it is a counter that is never ahead of
    /// [`Store::live`](crate::store::Store::live).
    #[must_use]
    pub const fn not_before(self, sequence: u32) -> Self {
        Self { oldest: sequence, ..self }
    }

    /// Checks every byte, then [`Acceptance::judge`]s.
    ///
    /// # Errors
    /// The first reason to refuse the blob.
    pub fn check<'a>(&self, bytes: &'a [u8]) -> Result<Blob<'a>, AcceptanceError> {
        let blob = Blob::check(bytes)?;
        self.judge(&blob)?;
        Ok(blob)
    }

    /// Joints of the robot.
    #[must_use]
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Bytes of the shortest blob it can take.
    pub(crate) const fn shortest(&self) -> usize {
        #[cfg(feature = "auth")]
        let tag = if self.key.is_some() { super::TAG } else { 0 };
        #[cfg(not(feature = "auth"))]
        let tag = 0;
        super::encoded_len(self.joints, 0) + tag
    }

    /// Robot, then joints, then key, then sequence number of a whole blob.
    ///
    /// # Errors
    /// The first reason to refuse it.
    pub fn judge(&self, blob: &Blob) -> Result<(), AcceptanceError> {
        if blob.robot_id() != self.robot_id {
            return Err(AcceptanceError::WrongRobot {
                blob: blob.robot_id(),
                robot: self.robot_id,
            });
        }
        if blob.joints() != self.joints {
            return Err(AcceptanceError::WrongJoints { blob: blob.joints(), robot: self.joints });
        }
        #[cfg(feature = "auth")]
        if let Some(key) = &self.key {
            blob.verify(key)?;
        }
        if blob.sequence() == u32::MAX {
            return Err(AcceptanceError::LastSequence);
        }
        if blob.sequence() < self.oldest {
            return Err(AcceptanceError::OldSequence {
                blob: blob.sequence(),
                oldest: self.oldest,
            });
        }
        Ok(())
    }
}

impl fmt::Debug for Acceptance {
    /// Without the key.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("Acceptance");
        shown.field("robot_id", &self.robot_id).field("joints", &self.joints);
        shown.field("oldest", &self.oldest);
        shown.finish_non_exhaustive()
    }
}
