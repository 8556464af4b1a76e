use nalgebra::Vector3;

use super::check::{Blob, DecodeError, Reader, kind_of};
use super::layout::{FLAG_ORIENTATION, HAS_COVERED, HAS_LIMITS, RECORD};
use crate::arm::ArmParameters;
use crate::kinematics::{JointKind, Link, MdhParameters};
use crate::scalar::Scalar;

impl Blob<'_> {
    /// Joints of the arm.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.records.len() / RECORD
    }

    /// Bytes of the blob, checksum included.
    #[must_use]
    pub fn size(&self) -> usize {
        super::encoded_len(self.joints())
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
        let [.., flags] = self.header_bytes::<8>();
        let mut reader = Reader(self.header.get(24..).unwrap_or(&[]));
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
            orientation_identified: flags & FLAG_ORIENTATION != 0,
        };
        let joints = out.nominal.iter_mut().zip(&mut out.corrections);
        let ranges = out.limits.iter_mut().zip(&mut out.covered);
        let records = self.records.chunks_exact(RECORD);
        for (((link, correction), (limits, covered)), record) in joints.zip(ranges).zip(records) {
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
        }
        Ok(out)
    }
}
