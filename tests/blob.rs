//! The parameter blob: round trip, and refusal of everything that is not one.

use nalgebra::Vector3;
use proptest::prelude::*;
use truearm::blob::{Blob, DecodeError, EncodeError, Flaw, encode, encoded_len, robot_id};
use truearm::effects::{Effect, MAX_TERMS, Masses, Term};
use truearm::{ArmParameters, Link, MdhParameters};

fn term(effect: Effect, joint: u8, order: f32, coefficient: f32) -> Term<f32> {
    Term { effect, joint, source: 0, component: 0, order, coefficient }
}

/// As many as there is room for, every effect among them.
fn every_effect() -> heapless::Vec<Term<f32>, MAX_TERMS> {
    let all = Term::<f32>::ALL;
    let mut terms = heapless::Vec::from_iter([
        term(Effect::JointCompliance, 1, 0.0, 1e-5),
        Term { component: 1, ..term(Effect::BaseCompliance, 0, 0.0, -2e-6) },
        term(Effect::EncoderEccentricity, 0, 2.0, 1e-4),
        Term { component: 1, ..term(Effect::GearTransmissionError, 2, 201.25, 5e-5) },
        term(Effect::JointPeriodicError, 2, 65535.0 / 64.0, -3e-5),
        term(Effect::JointGain, 0, 0.0, 2e-4),
        Term { source: 1, ..term(Effect::JointCoupling, 2, 0.0, 1e-3) },
        term(Effect::Backlash, 0, 0.0, 2e-4),
        term(Effect::Backlash, 1, 3.5, 2e-4),
        term(Effect::ThermalExpansion, all, 0.0, 1.2e-5),
        term(Effect::ThermalExpansion, 2, 0.0, 1e-5),
    ]);
    while terms.push(term(Effect::JointPeriodicError, 1, terms.len() as f32, 1e-5)).is_ok() {}
    terms
}

fn parameters() -> ArmParameters<f32, 3> {
    let correction = |k: f32| MdhParameters::from_array([1e-3 * k, 2e-4, -3e-3, 4e-4 * k, 5e-4]);
    ArmParameters {
        robot_id: robot_id("arm", "0042"),
        sequence: 7,
        created: 1_700_000_000,
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
        terms: every_effect(),
        masses: Some(Masses {
            gravity: Vector3::new(0.5, -0.1, -9.8),
            mass: [7.0, 12.5, 0.25],
            com: [Vector3::new(0.0, 0.1, -0.2), Vector3::zeros(), Vector3::new(0.3, 0.0, 0.0)],
            payload_com: Vector3::new(0.0, 0.02, 0.15),
        }),
        reference_temperature: 21.5,
        orientation_identified: false,
    }
}

fn blob() -> Vec<u8> {
    let mut bytes = vec![0; encoded_len(3, MAX_TERMS)];
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
    assert_eq!((blob.joints(), blob.terms(), blob.size()), (3, MAX_TERMS, bytes.len()));
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
    let (joint, meaning) = (|k: usize| 104 + 76 * (k - 1), "has a value without a meaning");
    let unknown = |field: &str| format!("{field} {meaning} in this layout");
    assert_eq!(real(32, f32::NAN), "base translation x is not a finite number");
    assert_eq!(real(64, f32::INFINITY), "tool z is not a finite number");
    assert_eq!(real(76, 201.0), "reference temperature is outside its plausible range");
    assert_eq!(real(88, -21.0), "gravity z is outside its plausible range");
    assert_eq!(real(100, 11.0), "payload point z is outside its plausible range");
    assert_eq!(real(joint(1) + 8, 10.5), "joint 1 nominal a is outside its plausible range");
    assert_eq!(
        real(joint(2) + 32, 0.3),
        "joint 2 correction theta_offset is outside its plausible range"
    );
    assert_eq!(real(joint(1) + 44, 7.0), "joint 1 limits low is above its high end");
    assert_eq!(real(joint(3) + 60, -0.1), "joint 3 mass is outside its plausible range");
    assert_eq!(
        real(joint(2) + 72, 11.0),
        "joint 2 centre of mass z is outside its plausible range"
    );
    assert_eq!(refused(joint(1), &[2]), unknown("joint 1 kind"));
    assert_eq!(refused(joint(1) + 1, &[0xff]), unknown("joint 1 presence"));
    assert_eq!(refused(28, &[0x10]), unknown("flags"));
    assert_eq!(refused(31, &[1]), unknown("reserved"));
    // Without masses nothing may look like one.
    assert_eq!(refused(28, &[0]), "gravity x is outside its plausible range");
    assert_eq!(refused(4, &[9]), "layout 9 is newer than this version, which reads layout 3");
    assert_eq!(refused(0, b"JUNK"), "does not begin with TARM: not a parameter blob");
    assert_eq!(refused(6, &[17]), "17 joints where 1 to 16 are possible");
    assert_eq!(refused(7, &[25]), "25 terms where 24 are possible");
    assert_eq!(refused(6, &[2]), "the length field says 528 where the contents need 452");
    assert_eq!(refused(7, &[3]), "the length field says 528 where the contents need 360");
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
    assert_eq!(error, EncodeError::NoRoom { needed: 528, got: 100 });
}

/// Terms 1 to 11 are those of `every_effect`.
#[test]
fn bad_terms_are_named() {
    let refused = |number: usize, offset: usize, value: &[u8]| {
        let at = 104 + 3 * 76 + 8 * (number - 1) + offset;
        Blob::check(&forge(at, value)).unwrap_err().to_string()
    };
    let real = |number, value: f32| refused(number, 4, &value.to_le_bytes());
    let range = |field: &str| format!("{field} is outside its plausible range");
    let unknown = |field: &str| format!("{field} has a value without a meaning in this layout");
    assert_eq!(real(3, 0.051), range("term 3 coefficient"));
    assert_eq!(real(10, -1.1e-3), range("term 10 coefficient"));
    assert_eq!(real(24, f32::NAN), "term 24 coefficient is not a finite number");
    assert_eq!(refused(1, 0, &[9]), unknown("term 1 effect"));
    assert_eq!(refused(1, 0, &[0x40]), unknown("term 1 flags"));
    assert_eq!(refused(1, 0, &[0x20]), unknown("term 1 flags"));
    assert_eq!(refused(1, 0, &[0x10]), unknown("term 1 component"));
    assert_eq!(refused(1, 1, &[3]), range("term 1 joint"));
    assert_eq!(refused(2, 1, &[1]), range("term 2 joint"));
    assert_eq!(refused(10, 1, &[1]), range("term 10 joint"));
    assert_eq!(refused(1, 1, &[0x10]), range("term 1 source joint"));
    assert_eq!(refused(7, 1, &[0x32]), range("term 7 source joint"));
    assert_eq!(refused(7, 1, &[0x22]), range("term 7 source joint"));
    assert_eq!(refused(3, 2, &[192, 0]), range("term 3 order"));
    assert_eq!(refused(5, 2, &[0, 0]), range("term 5 order"));
    assert_eq!(refused(6, 2, &[1, 0]), range("term 6 order"));
}

#[test]
fn terms_that_a_blob_cannot_hold_are_not_written() {
    let refused = |mut term: Term<f32>, masses: bool| {
        term.coefficient = 1e-6;
        let mut p = parameters();
        p.terms = heapless::Vec::from_iter([term]);
        p.masses = p.masses.filter(|_| masses);
        encode(&p, &mut [0; 1024]).err().map(|error| error.to_string())
    };
    let message = |field| {
        Some(format!(
            "these parameters would be refused: term 1 {field} is outside its plausible range"
        ))
    };
    let periodic = |joint, order| term(Effect::JointPeriodicError, joint, order, 0.0);
    for order in [0.0, 0.007, -1.0, 1024.0, f32::NAN, f32::INFINITY] {
        assert_eq!(refused(periodic(0, order), true), message("order"), "{order}");
    }
    let encoder = term(Effect::EncoderEccentricity, 0, 1.5, 0.0);
    assert_eq!(refused(encoder, true), message("order"));
    for friction in [0.001, -0.001] {
        let backlash = term(Effect::Backlash, 0, friction, 0.0);
        assert_eq!(refused(backlash, true), message("order"), "{friction}");
    }
    for joint in [3, 16, 255] {
        assert_eq!(refused(periodic(joint, 1.0), true), message("joint"));
        let coupling = Term { source: joint, ..term(Effect::JointCoupling, 0, 0.0, 0.0) };
        assert_eq!(refused(coupling, true), message("source joint"));
    }
    assert_eq!(refused(Term { component: 2, ..periodic(0, 1.0) }, true), message("component"));
    for needy in [
        term(Effect::JointCompliance, 0, 0.0, 0.0),
        term(Effect::BaseCompliance, 0, 0.0, 0.0),
        term(Effect::Backlash, 0, 1.0, 0.0),
    ] {
        assert_eq!(refused(needy, true), None);
        let error = refused(needy, false).unwrap();
        assert!(
            error.ends_with("term 1 effect needs link masses and gravity, which are not given")
        );
    }
    assert_eq!(refused(term(Effect::Backlash, 0, 0.0, 0.0), false), None);
}

#[test]
fn orders_are_rounded_to_64ths() {
    let mut p = parameters();
    p.terms = heapless::Vec::from_iter([term(Effect::JointPeriodicError, 0, 3.15, 1e-5)]);
    let mut bytes = [0; 1024];
    encode(&p, &mut bytes).unwrap();
    let read = Blob::check(&bytes).unwrap().parameters::<f32, 3>().unwrap();
    assert_eq!(read.terms[0].order, 202.0 / 64.0);
}

#[test]
fn six_joints_with_everything_fit_768_bytes() {
    assert_eq!(encoded_len(6, MAX_TERMS), 756);
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
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..700)) {
        let _ = Blob::check(&bytes);
    }

    /// Past the checksum as well: any byte of a mended blob.
    #[test]
    fn no_mended_blob_panics(offset in 0..520_usize, value in any::<[u8; 4]>()) {
        if let Ok(blob) = Blob::check(&forge(offset, &value)) {
            let p = blob.parameters::<f32, 3>().unwrap();
            prop_assert!(p.tool.iter().all(|x| x.is_finite()));
            prop_assert!(p.terms.iter().all(|t| t.coefficient.is_finite() && t.order.is_finite()));
        }
    }
}
