use heapless::Vec;
use nalgebra::Vector3;

use super::check::{Blob, head_of, kind_of};
use super::covariance::Covariance;
use super::error::DecodeError;
use super::fields;
use super::layout::{
    CREATED, FLAG_MASSES, FLAG_ORIENTATION, FLAG_TORQUES, FLAGS, HAS_COVERED, HAS_LIMITS, LENGTH,
    RECORD, ROBOT_ID, SEQUENCE, TERM,
};
use super::term;
use super::values::{mdh, range, real, vector};
use crate::arm::ArmParameters;
use crate::effects::{Curves, Masses};
use crate::kinematics::{JointKind, Link, MdhParameters};
use crate::scalar::Scalar;

impl<'a> Blob<'a> {
    /// Joints of the arm.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.records.len() / RECORD
    }

    /// Terms beyond geometry.
    #[must_use]
    pub fn terms(&self) -> usize {
        self.terms.len() / TERM
    }

    /// Bytes of the blob, checksum included.
    #[must_use]
    pub fn size(&self) -> usize {
        u32::from_le_bytes(self.field(LENGTH.start)) as usize
    }

    /// Sequence number; the higher of two valid blobs is the newer.
    #[must_use]
    pub fn sequence(&self) -> u32 {
        u32::from_le_bytes(self.field(SEQUENCE.start))
    }

    /// Id of the robot, see [`super::robot_id`].
    #[must_use]
    pub fn robot_id(&self) -> u64 {
        u64::from_le_bytes(self.field(ROBOT_ID.start))
    }

    /// Creation time, Unix seconds; 0 if unknown.
    #[must_use]
    pub fn created(&self) -> u32 {
        u32::from_le_bytes(self.field(CREATED.start))
    }

    /// Whether it carries an authentication tag. Whether the tag is right only
    /// a key can tell, see [`super::Acceptance`].
    #[must_use]
    pub fn is_tagged(&self) -> bool {
        self.tag.is_some()
    }

    /// Whether terms follow torques that are read: [`State::torque`](crate::State::torque)
    /// must be given.
    #[must_use]
    pub fn reads_torques(&self) -> bool {
        self.flags() & FLAG_TORQUES != 0
    }

    /// Smooth errors of joint angles.
    #[must_use]
    pub fn curves(&self) -> Curves<'a> {
        self.curves
    }

    /// Covariance of the parameters, if it carries one.
    #[must_use]
    pub fn covariance(&self) -> Option<Covariance<'a>> {
        (!self.factor.is_empty()).then_some(Covariance { blob: *self })
    }

    pub(super) fn field<const K: usize>(&self, at: usize) -> [u8; K] {
        self.header.get(at..).and_then(<[u8]>::first_chunk).copied().unwrap_or([0; K])
    }

    pub(super) fn flags(&self) -> u8 {
        self.header[FLAGS]
    }

    /// Copies the fields into a plain struct.
    ///
    /// # Errors
    /// [`DecodeError::WrongArm`] when the blob has another number of joints.
    pub fn parameters<T: Scalar, const N: usize>(
        &self,
    ) -> Result<ArmParameters<'a, T, N>, DecodeError> {
        if self.joints() != N {
            return Err(DecodeError::WrongArm { blob: self.joints(), arm: N });
        }
        let flags = self.flags();
        let header = self.header;
        let zero = MdhParameters::from_array([T::ZERO; 5]);
        let mut out = ArmParameters {
            robot_id: self.robot_id(),
            sequence: self.sequence(),
            created: self.created(),
            nominal: [Link { kind: JointKind::Revolute, parameters: zero }; N],
            corrections: [zero; N],
            base_translation: vector(&fields::BASE_TRANSLATION, header),
            base_rotation: vector(&fields::BASE_ROTATION, header),
            tool: vector(&fields::TOOL, header),
            limits: [None; N],
            covered: [None; N],
            rms_before: real(&fields::RMS_BEFORE, header),
            rms_after: real(&fields::RMS_AFTER, header),
            terms: Vec::new(),
            curves: self.curves,
            masses: None,
            reference_temperature: real(&fields::REFERENCE_TEMPERATURE, header),
            orientation_identified: flags & FLAG_ORIENTATION != 0,
        };
        let mut masses = Masses {
            gravity: vector(&fields::GRAVITY, header),
            mass: [T::ZERO; N],
            com: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); N],
            payload_com: vector(&fields::PAYLOAD_POINT, header),
        };
        let links = out.nominal.iter_mut().zip(&mut out.corrections);
        let ranges = out.limits.iter_mut().zip(&mut out.covered);
        let loads = masses.mass.iter_mut().zip(&mut masses.com);
        let records = self.records.chunks_exact(RECORD);
        for (((link, ranges), (mass, com)), record) in links.zip(ranges).zip(loads).zip(records) {
            joint(record, link, ranges, (mass, com));
        }
        out.masses = (flags & FLAG_MASSES != 0).then_some(masses);
        for term in term::each(self.terms).filter_map(term::from_bytes) {
            // A checked blob has no more terms than there is room for.
            let _ = out.terms.push(term);
        }
        Ok(out)
    }
}

// Calls, not copies: a blob is read once.

/// Of a joint: its nominal link and the corrections, limits and covered range,
/// mass and centre of mass.
#[inline(never)]
fn joint<T: Scalar>(
    record: &[u8],
    link: (&mut Link<T>, &mut MdhParameters<T>),
    ranges: (&mut Option<[T; 2]>, &mut Option<[T; 2]>),
    load: (&mut T, &mut Vector3<T>),
) {
    let [kind, presence, ..] = head_of(record);
    link.0.kind = kind_of(kind).unwrap_or_default();
    link.0.parameters = mdh(&fields::NOMINAL, record);
    *link.1 = mdh(&fields::CORRECTION, record);
    *ranges.0 = range(&fields::LIMITS, record, presence & HAS_LIMITS != 0);
    *ranges.1 = range(&fields::COVERED, record, presence & HAS_COVERED != 0);
    *load.0 = real(&fields::MASS, record);
    *load.1 = vector(&fields::CENTRE_OF_MASS, record);
}
