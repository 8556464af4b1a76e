use heapless::Vec;
use nalgebra::Vector3;

use super::check::{Blob, Reader, kind_of};
use super::covariance::Covariance;
use super::error::DecodeError;
use super::layout::{
    CREATED, FLAG_MASSES, FLAG_ORIENTATION, FLAGS, HAS_COVERED, HAS_LIMITS, LENGTH, REALS, RECORD,
    ROBOT_ID, SEQUENCE, TERM,
};
use super::term;
use crate::arm::ArmParameters;
use crate::effects::{Masses, Tables};
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

    /// Covariance of the parameters, if it carries one.
    #[must_use]
    pub fn covariance(&self) -> Option<Covariance<'_>> {
        (!self.factor.is_empty()).then_some(Covariance { blob: self })
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
        let mut reader = Reader(&self.header[REALS]);
        let zero = MdhParameters::from_array([T::ZERO; 5]);
        let mut out = ArmParameters {
            robot_id: self.robot_id(),
            sequence: self.sequence(),
            created: self.created(),
            nominal: [Link { kind: JointKind::Revolute, parameters: zero }; N],
            corrections: [zero; N],
            base_translation: vector(&mut reader),
            base_rotation: vector(&mut reader),
            tool: vector(&mut reader),
            limits: [None; N],
            covered: [None; N],
            rms_before: real(&mut reader),
            rms_after: real(&mut reader),
            terms: Vec::new(),
            tables: Tables::NONE,
            masses: None,
            reference_temperature: real(&mut reader),
            orientation_identified: flags & FLAG_ORIENTATION != 0,
        };
        let mut masses = Masses {
            gravity: vector(&mut reader),
            mass: [T::ZERO; N],
            com: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); N],
            payload_com: vector(&mut reader),
        };
        let links = out.nominal.iter_mut().zip(&mut out.corrections);
        let ranges = out.limits.iter_mut().zip(&mut out.covered);
        let loads = masses.mass.iter_mut().zip(&mut masses.com);
        let records = self.records.chunks_exact(RECORD);
        for (((link, ranges), (mass, com)), record) in links.zip(ranges).zip(loads).zip(records) {
            let mut reader = Reader(record);
            let [kind, presence, ..]: [u8; 4] = reader.take().copied().unwrap_or_default();
            link.0.kind = kind_of(kind).unwrap_or_default();
            link.0.parameters = mdh(&mut reader);
            *link.1 = mdh(&mut reader);
            for (range, bit) in [(ranges.0, HAS_LIMITS), (ranges.1, HAS_COVERED)] {
                let value = [real(&mut reader), real(&mut reader)];
                *range = (presence & bit != 0).then_some(value);
            }
            *mass = real(&mut reader);
            *com = vector(&mut reader);
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

#[inline(never)]
fn real<T: Scalar>(reader: &mut Reader) -> T {
    T::from_f32(reader.f32())
}

#[inline(never)]
fn vector<T: Scalar>(reader: &mut Reader) -> Vector3<T> {
    Vector3::new(real(reader), real(reader), real(reader))
}

#[inline(never)]
fn mdh<T: Scalar>(reader: &mut Reader) -> MdhParameters<T> {
    let mut values = [T::ZERO; 5];
    for value in &mut values {
        *value = real(reader);
    }
    MdhParameters::from_array(values)
}
