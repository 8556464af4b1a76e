//! Blobs to test on.

#![allow(dead_code, reason = "each test file uses a part")]

use nalgebra::Vector3;
use truearm::blob::robot_id;
use truearm::effects::{Effect, MAX_TERMS, Masses, Term};
use truearm::{ArmParameters, Link, MdhParameters};

/// Six joints, masses, 24 terms: the shipped UR10 with terms of every effect.
pub fn full() -> Vec<u8> {
    include_bytes!("../data/firmware/ur10-terms.blob").to_vec()
}

/// The same with a tag, of which the checksum knows nothing more than that it
/// is there.
pub fn tagged() -> Vec<u8> {
    let mut bytes = full();
    bytes.truncate(bytes.len() - 4);
    bytes[28] |= 8;
    bytes.extend((0..32).map(|k: u8| k.wrapping_mul(41)));
    let length = bytes.len() as u32 + 4;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes.extend([0; 4]);
    mend(&mut bytes);
    bytes
}

/// Writes the right checksum, as only a faulty writer would.
pub fn mend(bytes: &mut [u8]) {
    let body = bytes.len() - 4;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&bytes[..body]);
    bytes[body..].copy_from_slice(&crc.to_le_bytes());
}

pub fn term(effect: Effect, joint: u8, order: f32, coefficient: f32) -> Term<f32> {
    Term { effect, joint, source: 0, component: 0, order, coefficient }
}

/// As many as there is room for, every effect among them.
pub fn every_effect() -> heapless::Vec<Term<f32>, MAX_TERMS> {
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

/// Three joints, one of them prismatic, with everything.
pub fn parameters() -> ArmParameters<f32, 3> {
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
