//! The file of re-identification runs: blobs of arms before an accident and
//! points measured after it. Shared by the image and xtask, so it needs no std.
//!
//! [`Records`] whose blob is followed by two joints (u32) and [`POINTS`] points.
//!
//! A point is six joint values, the tool point in the commanded frame and the
//! same as a tracker elsewhere sees it: 12 `f32`, rad and m.

#![allow(dead_code, reason = "each of its users needs a part")]

use crc::{CRC_64_XZ, Crc};
use truearm::check_point::CheckPoint;
use truearm::parameters::Parameter;
use truearm::reidentify::{Reidentified, Reidentify, ReidentifyError};
use truearm::{ArmParameters, Pose};

use crate::records::{Records, numbers};

/// First four bytes.
pub const MAGIC: [u8; 4] = *b"TARI";
/// Points of a run.
pub const POINTS: usize = 10;
/// Joints of the arm.
pub const JOINTS: usize = 6;
/// Standard deviation of a measured coordinate, m.
pub const SIGMA: f32 = 2e-5;

/// Numbers of a point.
const POINT: usize = JOINTS + 6;
/// Bytes of a run behind its blob.
pub const BEHIND: usize = 8 + POINTS * POINT * 4;

/// With the tracker where it was.
pub type Known<'t> = Reidentified<'t, f32, JOINTS, 5>;
/// With the tracker moved.
pub type Moved<'t> = Reidentified<'t, f32, JOINTS, 11>;

/// A file in place.
#[derive(Debug, Clone, Copy)]
pub struct Runs<'a>(pub Records<'a>);

/// One accident.
#[derive(Debug, Clone)]
pub struct Run<'t> {
    /// The arm before it.
    pub stored: ArmParameters<'t, f32, JOINTS>,
    /// The joints that slipped.
    pub joints: [u8; 2],
    /// Points in the commanded frame.
    pub known: [CheckPoint<f32, JOINTS>; POINTS],
    /// The same points, from the tracker elsewhere.
    pub moved: [CheckPoint<f32, JOINTS>; POINTS],
}

impl<'a> Runs<'a> {
    /// Finds the runs in the front of `bytes`; `None` if they are not whole.
    pub fn parse(bytes: &'a [u8]) -> Option<Self> {
        Records::parse(bytes, MAGIC, BEHIND).map(Self)
    }

    /// The runs; `None` for a blob that is refused.
    pub fn iter(&self) -> impl Iterator<Item = Option<Run<'a>>> + use<'a> {
        self.0.iter().map(|record| {
            let (stored, behind): (ArmParameters<f32, JOINTS>, _) = record?;
            let (joints, points) = behind.split_at_checked(8)?;
            let warmth = stored.reference_temperature;
            let point = |index: usize, moved: bool| {
                let [q @ .., x, y, z, u, v, w] = numbers::<POINT>(points, index);
                let [x, y, z] = if moved { [u, v, w] } else { [x, y, z] };
                CheckPoint::plain(q, Pose::translation(x, y, z).translation, warmth)
            };
            let mut joint = joints.as_chunks::<4>().0.iter().map(|bytes| bytes[0]);
            Some(Run {
                stored,
                joints: [joint.next()?, joint.next()?],
                known: core::array::from_fn(|index| point(index, false)),
                moved: core::array::from_fn(|index| point(index, true)),
            })
        })
    }

    /// Does all runs, shows each to `see`, and returns the CRC-64/XZ of the bits
    /// of what was found.
    pub fn hash(&self, mut see: impl FnMut(&Run, &Known, &Moved)) -> Option<u64> {
        let crc = Crc::<u64>::new(&CRC_64_XZ);
        let mut digest = crc.digest();
        for run in self.iter() {
            let run = run?;
            let (known, moved) = (run.known().ok()?, run.moved().ok()?);
            let of_known = known.change.iter().chain(&known.sigma).chain([&known.rms_after]);
            let of_moved = moved.change.iter().chain(&moved.sigma).chain([&moved.rms_after]);
            for number in of_known.chain(of_moved).chain(moved.station.translation.iter()) {
                digest.update(&number.to_le_bytes());
            }
            see(&run, &known, &moved);
        }
        Some(digest.finalize())
    }
}

impl<'t> Run<'t> {
    /// Two joint offsets and the tool: 5 unknowns.
    pub fn known(&self) -> Result<Known<'_>, ReidentifyError> {
        Reidentify::new(&self.stored, self.chosen(), SIGMA).run(&self.stored, &self.known)
    }

    /// The same with the tracker's place: 11 unknowns.
    pub fn moved(&self) -> Result<Moved<'_>, ReidentifyError> {
        let ([a, b, c, d, e, f], [g, h, i, j, k]) = (Parameter::STATION, self.chosen());
        let all = [a, b, c, d, e, f, g, h, i, j, k];
        Reidentify::new(&self.stored, all, SIGMA).run(&self.stored, &self.moved)
    }

    fn chosen(&self) -> [Parameter; 5] {
        let [first, second] = self.joints.map(Parameter::JointOffset);
        let [x, y, z] = Parameter::TOOL;
        [first, second, x, y, z]
    }
}
