//! The file of accidents that touches of a plate mend: blobs of arms as they were
//! calibrated, touches before and after. Shared by the image and xtask, so it needs no
//! std.
//!
//! [`Records`] whose blob is followed by where the plate is about (a point, a normal) and
//! the joint values of [`BEFORE`] and [`AFTER`] touches: `f32`, m and rad.

#![allow(dead_code, reason = "each of its users needs a part")]

use crc::{CRC_64_XZ, Crc};
use truearm::measurement::{Measurement, Plane};
use truearm::parameters::{Axis, Parameter};
use truearm::reidentify::{Reidentified, Reidentify};
use truearm::streaming::{Identified, Lambda, Settings, StreamingIdentification};
use truearm::{ArmParameters, Pose};

use crate::records::{Records, numbers};

/// First four bytes.
pub const MAGIC: [u8; 4] = *b"TATO";
/// Touches by which the calibrated arm learns where the plate is.
pub const BEFORE: usize = 20;
/// Touches after the accident.
pub const AFTER: usize = 60;
/// After so many of them the stream is linearised about what it has found.
pub const LOOK: usize = 10;
/// Joints of the arm.
pub const JOINTS: usize = 6;
/// Standard deviation of a touch, m.
pub const SIGMA: f32 = 2e-5;
/// Of the ball, m.
pub const RADIUS: f32 = 3e-3;
/// Where the plate is.
pub const PLACE: [Parameter; 3] = Parameter::plane(0, Axis::Z);
/// The plate, and what may have slipped: a flat plate does not tell how joint 1 stands, and
/// joint 6 hardly moves the tool.
pub const CHOSEN: [Parameter; 7] = {
    let [a, b, c] = PLACE;
    let offset = Parameter::JointOffset;
    [a, b, c, offset(1), offset(2), offset(3), offset(4)]
};
/// Bytes of a record behind its blob.
pub const BEHIND: usize = 4 * (6 + JOINTS * (BEFORE + AFTER));

/// One touch.
pub type Touch = Measurement<f32, JOINTS>;
/// An identification from touches.
pub type Stream<'t> = StreamingIdentification<'t, f32, JOINTS, 7>;

/// A file in place.
#[derive(Debug, Clone, Copy)]
pub struct Accidents<'a>(pub Records<'a>);

/// One accident.
#[derive(Debug, Clone)]
pub struct Accident<'t> {
    /// The arm before it.
    pub stored: ArmParameters<'t, f32, JOINTS>,
    /// About where the plate is.
    pub about: Plane<f32>,
    /// Joint values at touches before it.
    pub before: [[f32; JOINTS]; BEFORE],
    /// And after it.
    pub after: [[f32; JOINTS]; AFTER],
}

/// A plate, and how surely its parameters are known, 1 sigma.
#[derive(Debug, Clone, Copy)]
pub struct Learned {
    /// Where it was found.
    pub plate: Plane<f32>,
    /// rad, rad, m
    pub sigma: [f32; 3],
}

/// What touches made of it.
#[derive(Debug, Clone)]
pub struct Mended<'t> {
    /// Where the calibrated arm found the plate.
    pub learned: Learned,
    /// One touch after the other.
    pub streamed: Identified<'t, f32, JOINTS, 7>,
    /// All touches at once.
    pub again: Reidentified<'t, f32, JOINTS, 7>,
}

impl<'a> Accidents<'a> {
    /// Finds the accidents in the front of `bytes`; `None` if they are not whole.
    pub fn parse(bytes: &'a [u8]) -> Option<Self> {
        Records::parse(bytes, MAGIC, BEHIND).map(Self)
    }

    /// The accidents; `None` for a blob or a plate that is refused.
    pub fn iter(&self) -> impl Iterator<Item = Option<Accident<'a>>> + use<'a> {
        self.0.iter().map(|record| {
            let (stored, behind) = record?;
            let (plate, joints) = behind.split_at_checked(24)?;
            let [x, y, z, u, v, w] = numbers(plate, 0);
            let [point, normal] =
                [[x, y, z], [u, v, w]].map(|[x, y, z]| Pose::translation(x, y, z));
            Some(Accident {
                stored,
                about: Plane::new(point.translation, normal.translation).ok()?.unknown(0),
                before: core::array::from_fn(|index| numbers(joints, index)),
                after: core::array::from_fn(|index| numbers(joints, BEFORE + index)),
            })
        })
    }

    /// Mends all, shows each to `see`, and returns the CRC-64/XZ of the bits of what was
    /// found.
    pub fn hash(&self, mut see: impl FnMut(&Accident, &Mended)) -> Option<u64> {
        let crc = Crc::<u64>::new(&CRC_64_XZ);
        let mut digest = crc.digest();
        for accident in self.iter() {
            let accident = accident?;
            let mended = accident.mended()?;
            let (one, all) = (&mended.streamed, &mended.again);
            let of_one = one.change.iter().chain(&one.sigma).chain(&one.held_out);
            let of_all = all.change.iter().chain(&all.sigma).chain([&all.rms_after]);
            for number in mended.learned.plate.point().iter().chain(of_one).chain(of_all) {
                digest.update(&number.to_le_bytes());
            }
            see(&accident, &mended);
        }
        Some(digest.finalize())
    }
}

impl<'t> Accident<'t> {
    /// Touches at these joint values.
    fn touches<const M: usize>(&self, joints: [[f32; JOINTS]; M], plate: Plane<f32>) -> [Touch; M] {
        joints.map(|q| plate.touched(q, RADIUS, self.stored.reference_temperature))
    }

    /// Where the arm as it was calibrated finds the plate.
    pub fn learned(&self) -> Option<Learned> {
        let touches = self.touches(self.before, self.about);
        let found = Reidentify::new(&self.stored, PLACE, SIGMA).run(&self.stored, &touches).ok()?;
        let plate = self.about.found(&PLACE, &found.change).unknown(0);
        Some(Learned { plate, sigma: found.sigma })
    }

    /// Touches of the plate where that was found.
    pub fn touched(&self, plate: Plane<f32>) -> [Touch; AFTER] {
        self.touches(self.after, plate)
    }

    /// A stream without touches.
    pub fn stream(&self, learned: &Learned) -> Option<Stream<'t>> {
        let Reidentify { parameters, scale, sigma } = self.task(learned);
        let settings = Settings { scale, ..Settings::new(&self.stored, parameters, sigma) };
        settings.start(&self.stored).ok()
    }

    /// All touches at once.
    pub fn again(
        &self,
        learned: &Learned,
        touches: &[Touch],
    ) -> Option<Reidentified<'t, f32, JOINTS, 7>> {
        self.task(learned).run(&self.stored, touches).ok()
    }

    fn task(&self, learned: &Learned) -> Reidentify<f32, 7> {
        let mut task = Reidentify::new(&self.stored, CHOSEN, SIGMA);
        task.scale.iter_mut().zip(learned.sigma).for_each(|(scale, sigma)| *scale = sigma);
        task
    }

    fn mended(&self) -> Option<Mended<'t>> {
        let learned = self.learned()?;
        let touches = self.touched(learned.plate);
        let mut stream = self.stream(&learned)?;
        for (touch, count) in touches.iter().zip(1..) {
            stream.push(touch).ok()?;
            if count == LOOK {
                let found = stream.identified(Lambda::Prior).ok()?;
                stream.relinearise(&found);
            }
        }
        let streamed = stream.identified(Lambda::Prior).ok()?;
        let again = self.again(&learned, &touches)?;
        Some(Mended { learned, streamed, again })
    }
}
