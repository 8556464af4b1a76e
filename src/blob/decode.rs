use heapless::Vec;
use nalgebra::Vector3;

use super::check::{Blob, DecodeError, Reader, kind_of};
use super::layout::{FLAG_MASSES, FLAG_ORIENTATION, HAS_COVERED, HAS_LIMITS, RECORD, TERM};
use super::term;
use crate::arm::ArmParameters;
use crate::effects::Masses;
use crate::kinematics::{JointKind, Link, MdhParameters};
use crate::scalar::Scalar;

impl Blob<'_> {
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
        super::encoded_len(self.joints(), self.terms())
    }

    /// Sequence number; the higher of two valid blobs is the newer.
    #[must_use]
    pub fn sequence(&self) -> u32 {
        let [.., a, b, c, d] = self.header_bytes::<16>();
        u32::from_le_bytes([a, b, c, d])
    }

    /// Id of the robot, see [`super::robot_id`].
    #[must_use]
    pub fn robot_id(&self) -> u64 {
        let [.., a, b, c, d, e, f, g, h] = self.header_bytes::<24>();
        u64::from_le_bytes([a, b, c, d, e, f, g, h])
    }

    fn header_bytes<const K: usize>(&self) -> [u8; K] {
        self.header.first_chunk().copied().unwrap_or([0; K])
    }

    /// Copies the fields into a plain struct.
    ///
    /// # Errors
    /// [`DecodeError::WrongArm`] when the blob has another number of joints.
    pub fn parameters<T: Scalar, const N: usize>(
        &self,
    ) -> Result<ArmParameters<T, N>, DecodeError> {
        if self.joints() != N {
            return Err(DecodeError::WrongArm { blob: self.joints(), arm: N });
        }
        let [.., flags] = self.header_bytes::<25>();
        let mut reader = Reader(self.header.get(28..).unwrap_or(&[]));
        let vector = |reader: &mut Reader| {
            let [x, y, z] = [reader.f32(), reader.f32(), reader.f32()].map(T::from_f32);
            Vector3::new(x, y, z)
        };
        let zero = MdhParameters::from_array([T::ZERO; 5]);
        let mut out = ArmParameters {
            robot_id: self.robot_id(),
            sequence: self.sequence(),
            nominal: [Link { kind: JointKind::Revolute, parameters: zero }; N],
            corrections: [zero; N],
            base_translation: vector(&mut reader),
            base_rotation: vector(&mut reader),
            tool: vector(&mut reader),
            limits: [None; N],
            covered: [None; N],
            rms_before: T::from_f32(reader.f32()),
            rms_after: T::from_f32(reader.f32()),
            terms: Vec::new(),
            masses: None,
            reference_temperature: T::from_f32(reader.f32()),
            orientation_identified: flags & FLAG_ORIENTATION != 0,
        };
        let mut masses = Masses {
            gravity: vector(&mut reader),
            mass: [T::ZERO; N],
            com: [Vector3::new(T::ZERO, T::ZERO, T::ZERO); N],
            payload_com: vector(&mut reader),
        };
        let joints = out.nominal.iter_mut().zip(&mut out.corrections);
        let ranges = out.limits.iter_mut().zip(&mut out.covered);
        let loads = masses.mass.iter_mut().zip(&mut masses.com);
        let records = self.records.chunks_exact(RECORD);
        let all = joints.zip(ranges).zip(loads).zip(records);
        for ((((link, correction), (limits, covered)), (mass, com)), record) in all {
            let mut reader = Reader(record);
            let [kind, presence, ..]: [u8; 4] = reader.take().copied().unwrap_or_default();
            link.kind = kind_of(kind).unwrap_or_default();
            let mut parameters =
                || MdhParameters::from_array([0; 5].map(|_| T::from_f32(reader.f32())));
            link.parameters = parameters();
            *correction = parameters();
            for (range, bit) in [(limits, HAS_LIMITS), (covered, HAS_COVERED)] {
                let value = [reader.f32(), reader.f32()].map(T::from_f32);
                *range = (presence & bit != 0).then_some(value);
            }
            *mass = T::from_f32(reader.f32());
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
