//! The parameter blob: round trip, and refusal of everything that is not one.

use nalgebra::Vector3;
use proptest::prelude::*;
use truearm::blob::{Blob, DecodeError, EncodeError, Flaw, encode, encoded_len, robot_id};
use truearm::{ArmParameters, Link, MdhParameters};

fn parameters() -> ArmParameters<f32, 3> {
    let correction = |k: f32| MdhParameters::from_array([1e-3 * k, 2e-4, -3e-3, 4e-4 * k, 5e-4]);
    ArmParameters {
        robot_id: robot_id("arm", "0042"),
        sequence: 7,
        nominal: [
            Link::revolute(0.0, 0.0, 0.0, 0.1273, 0.0),
            Link::prismatic(1.5, -0.612, 0.1, 0.02, 0.0),
            Link::revolute(-1.5, 0.3, 0.0, 0.0, 0.01),
        ],
        corrections: [correction(1.0), correction(2.0), correction(3.0)],
        base_translation: Vector3::new(1e-3, -2e-3, 3e-4),
        base_rotation: Vector3::new(1e-4, 2e-4, -3e-4),
        tool: Vector3::new(0.0, 0.01, 0.109),
        limits: [Some([-6.2, 6.2]), Some([0.0, 0.5]), None],
        covered: [Some([-1.0, 1.0]), None, Some([-2.0, 2.0])],
        rms_before: 1.1e-3,
        rms_after: 4.4e-4,
        orientation_identified: false,
    }
}

fn blob() -> Vec<u8> {
    let mut bytes = vec![0; encoded_len(3)];
    assert_eq!(encode(&parameters(), &mut bytes), Ok(bytes.len()));
    bytes
}

/// Sets four bytes and mends the checksum, as only a faulty writer would.
fn forge(offset: usize, value: &[u8]) -> Vec<u8> {
    let mut bytes = blob();
    bytes[offset..offset + value.len()].copy_from_slice(value);
    let body = bytes.len() - 4;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&bytes[..body]);
    bytes[body..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[test]
fn what_is_written_is_read() {
    let bytes = blob();
    let blob = Blob::check(&bytes).unwrap();
    assert_eq!(blob.parameters::<f32, 3>(), Ok(parameters()));
    assert_eq!((blob.sequence(), blob.robot_id()), (7, robot_id("arm", "0042")));
    assert_eq!(blob.size(), bytes.len());
    let wide = blob.parameters::<f64, 3>().unwrap();
    assert_eq!(wide.nominal[1].parameters.a, f64::from(-0.612_f32));
}

#[test]
fn a_slot_larger_than_the_blob_is_fine() {
    let mut slot = blob();
    slot.extend([0xff; 100]);
    assert!(Blob::check(&slot).is_ok());
}

#[test]
fn every_truncation_is_refused() {
    let bytes = blob();
    for length in 0..bytes.len() {
        let error = Blob::check(&bytes[..length]).unwrap_err();
        assert!(matches!(error, DecodeError::Truncated { got, .. } if got == length), "{error}");
    }
}

#[test]
fn every_single_bit_flip_is_refused() {
    let bytes = blob();
    for bit in 0..bytes.len() * 8 {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert!(Blob::check(&flipped).is_err(), "bit {bit}");
    }
}

#[test]
fn bad_values_are_named() {
    let refused =
        |offset, value: &[u8]| Blob::check(&forge(offset, value)).unwrap_err().to_string();
    let real = |offset, value: f32| refused(offset, &value.to_le_bytes());
    assert_eq!(real(24, f32::NAN), "base translation x is not a finite number");
    assert_eq!(real(56, f32::INFINITY), "tool z is not a finite number");
    assert_eq!(real(72 + 4, 10.5), "joint 1 nominal a is outside its plausible range");
    assert_eq!(
        real(72 + 60 + 20 + 8, 0.3),
        "joint 2 correction theta_offset is outside its plausible range"
    );
    assert_eq!(real(68 + 44, 7.0), "joint 1 limits low is above its high end");
    assert_eq!(refused(68, &[2]), "joint 1 kind has a value without a meaning in this layout");
    assert_eq!(
        refused(69, &[0xff]),
        "joint 1 presence has a value without a meaning in this layout"
    );
    assert_eq!(refused(7, &[2]), "flags has a value without a meaning in this layout");
    assert_eq!(refused(4, &[9]), "layout 9 is not known to this version, which reads layout 1");
    assert_eq!(refused(0, b"JUNK"), "does not begin with TARM: not a parameter blob");
    assert_eq!(refused(6, &[17]), "17 joints where 1 to 16 are possible");
    assert_eq!(refused(6, &[2]), "the length field says 252 where the joints need 192");
    assert_eq!(
        Blob::check(&blob()).unwrap().parameters::<f32, 6>(),
        Err(DecodeError::WrongArm { blob: 3, arm: 6 })
    );
}

#[test]
fn what_a_reader_would_refuse_is_not_written() {
    let mut p = parameters();
    p.corrections[1].d = 0.5;
    let mut bytes = [0; 1024];
    let error = encode(&p, &mut bytes).unwrap_err();
    assert!(matches!(error, EncodeError::Refused(DecodeError::Field(_, Flaw::Implausible))));
    assert!(error.to_string().contains("joint 2 correction d"), "{error}");
    let error = encode(&parameters(), &mut bytes[..100]).unwrap_err();
    assert_eq!(error, EncodeError::NoRoom { needed: 252, got: 100 });
}

/// The check values that FORMAT.md promises.
#[test]
fn checksums_are_the_standard_ones() {
    assert_eq!(crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(b"123456789"), 0xe306_9283);
    let digest = crc::Crc::<u64>::new(&crc::CRC_64_XZ).checksum(b"arm\x000042");
    assert_eq!(robot_id("arm", "0042"), digest);
    assert_ne!(robot_id("ar", "m0042"), robot_id("arm", "0042"));
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = Blob::check(&bytes);
    }

    /// Past the checksum as well: any byte of a mended blob.
    #[test]
    fn no_mended_blob_panics(offset in 0..244_usize, value in any::<[u8; 4]>()) {
        if let Ok(blob) = Blob::check(&forge(offset, &value)) {
            let p = blob.parameters::<f32, 3>().unwrap();
            prop_assert!(p.tool.iter().all(|x| x.is_finite()));
        }
    }
}
