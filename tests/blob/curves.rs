//! Blobs with curves: what is written is read, and what is not a curve is refused by
//! name.

#![cfg(feature = "curves")]

use crate::blobs::{curve_bytes, curved, full, mend, parameters, tagged_curved};
use proptest::prelude::*;
use truearm::blob::{
    Blob, DecodeError, EncodeError, curve_len, encode, encode_curve, encode_curve_with,
    encode_with, encoded_len, factor_len, gaps_len,
};
use truearm::effects::{Gaps, MAX_TERMS};
use truearm::{Arm, ArmParameters, Curves};

/// Where the curves of [`curved`] begin.
const AT: usize = encoded_len(6, MAX_TERMS) - 4;

fn forge(offset: usize, value: &[u8]) -> Vec<u8> {
    let mut bytes = curved();
    bytes[AT + offset..][..value.len()].copy_from_slice(value);
    mend(&mut bytes);
    bytes
}

#[test]
fn what_is_written_is_read_and_borrowed() {
    let bytes = curved();
    let blob = Blob::check(&bytes).unwrap();
    let p: ArmParameters<f32, 6> = blob.parameters().unwrap();
    assert_eq!(p.curves.as_bytes(), curve_bytes());
    assert_eq!(p.curves.as_bytes().as_ptr(), bytes[AT..].as_ptr(), "not copied");
    assert_eq!(Arm::new(&p).curves().as_bytes().as_ptr(), bytes[AT..].as_ptr());
    let joints: Vec<(u8, usize)> =
        p.curves.iter().map(|curve| (curve.joint(), curve.nodes().len())).collect();
    assert_eq!(joints, [(1, 32), (4, 64)]);
    let mut again = vec![0; bytes.len()];
    assert_eq!(encode(&p, &mut again), Ok(bytes.len()));
    assert_eq!(again, bytes);
    let none = ArmParameters { curves: Curves::NONE, ..p };
    let mut plain = vec![0; encoded_len(6, MAX_TERMS)];
    encode(&none, &mut plain).unwrap();
    assert_eq!(plain, full(), "without curves the bytes are those of format 1.1");
}

#[test]
fn curves_stand_between_covariance_and_tag() {
    let p: ArmParameters<f32, 6> =
        Blob::check(&curved()).unwrap().parameters::<f32, 6>().map(own).unwrap();
    let factor = vec![0.5; factor_len(6, MAX_TERMS)];
    let mut bytes = vec![0; 16_384];
    let size = encode_with(&p, Some(&factor), &mut bytes).unwrap();
    let blob = Blob::check(&bytes).unwrap();
    assert_eq!(size, blob.size());
    assert!(blob.covariance().unwrap().factor().eq(factor.iter().copied()));
    assert_eq!(blob.curves(), p.curves);
    let tagged = tagged_curved();
    let blob = Blob::check(&tagged).unwrap();
    assert!(blob.is_tagged());
    assert_eq!(blob.curves(), p.curves);
}

/// The tag speaks for the curves.
#[cfg(feature = "auth")]
#[test]
fn a_tag_covers_the_curves() {
    use truearm::blob::{AcceptanceError, TAG, sign};
    let mut bytes = curved();
    bytes.resize(bytes.len() + TAG, 0);
    let size = sign(&mut bytes, &[7; 32]).unwrap();
    assert_eq!(size, bytes.len());
    assert_eq!(Blob::check(&bytes).unwrap().verify(&[7; 32]), Ok(()));
    bytes[AT + 20] ^= 1;
    mend(&mut bytes);
    let forged = Blob::check(&bytes).unwrap();
    assert_eq!(forged.verify(&[7; 32]), Err(AcceptanceError::WrongKey));
}

fn own(p: ArmParameters<'_, f32, 6>) -> ArmParameters<'static, f32, 6> {
    let curves = Curves::of(curve_bytes().leak()).unwrap();
    let ArmParameters { terms, masses, nominal, corrections, limits, covered, .. } = p.clone();
    ArmParameters {
        robot_id: p.robot_id,
        sequence: p.sequence,
        created: p.created,
        nominal,
        corrections,
        base_translation: p.base_translation,
        base_rotation: p.base_rotation,
        tool: p.tool,
        terms,
        curves,
        masses,
        reference_temperature: p.reference_temperature,
        limits,
        covered,
        rms_before: p.rms_before,
        rms_after: p.rms_after,
        orientation_identified: p.orientation_identified,
    }
}

#[test]
fn bad_curves_are_named() {
    let refused =
        |offset: usize, value: &[u8]| Blob::check(&forge(offset, value)).unwrap_err().to_string();
    let range = |field: &str| format!("{field} is outside its plausible range");
    // The second curve is behind the first one's 32 nodes.
    let second = curve_len(32);
    assert_eq!(refused(0, &[6]), range("curve 1 joint"));
    assert_eq!(refused(second, &[1]), range("curve 2 joint"));
    assert_eq!(refused(second, &[0]), range("curve 2 joint"));
    assert_eq!(refused(second, &[255]), range("curve 2 joint"));
    for exponent in [0, 4, 10, 31, 32, 255] {
        assert_eq!(refused(1, &[exponent]), range("curve 1 nodes"), "{exponent}");
    }
    let unknown = "curve 1 reserved has a value without a meaning in this layout";
    assert_eq!(refused(2, &[2]), unknown);
    assert_eq!(refused(2, &[255]), unknown);
    assert_eq!(refused(3, &[128]), unknown);
    assert_eq!(refused(4, &f32::NAN.to_le_bytes()), "curve 1 step is not a finite number");
    assert_eq!(refused(4, &(-1e-9_f32).to_le_bytes()), range("curve 1 step"));
    assert_eq!(refused(4, &2e-6_f32.to_le_bytes()), range("curve 1 step"));
    assert_eq!(refused(second + 8, &0.06_f32.to_le_bytes()), range("curve 2 band"));
    assert_eq!(
        refused(second + 8, &f32::INFINITY.to_le_bytes()),
        "curve 2 band is not a finite number"
    );
    // Any node is one.
    assert!(Blob::check(&forge(12, &i16::MIN.to_le_bytes())).is_ok());
}

#[test]
fn curves_that_do_not_end_where_the_blob_does_are_refused() {
    let fits = curved().len();
    // The first table twice as long eats up the second, and more.
    assert_eq!(
        Blob::check(&forge(1, &[7])),
        Err(DecodeError::Length { stored: fits as u32, expected: AT + 4 + curve_len(128) })
    );
    // The second one longer than what is left.
    let longer = forge(curve_len(32) + 1, &[8]);
    let expected = AT + 4 + curve_len(32) + curve_len(256);
    assert_eq!(Blob::check(&longer), Err(DecodeError::Length { stored: fits as u32, expected }));
    // The flag without curves, and curves without the flag.
    let mut bytes = full();
    bytes[28] |= 16;
    mend(&mut bytes);
    assert!(matches!(Blob::check(&bytes), Err(DecodeError::Length { .. })));
    let mut bytes = curved();
    bytes[28] &= !16;
    mend(&mut bytes);
    let refused = Blob::check(&bytes);
    assert_eq!(refused, Err(DecodeError::Length { stored: fits as u32, expected: AT + 4 }));
}

/// Of a joint that slides, or that there is not: the arm decides.
#[test]
fn only_turning_joints_have_curves() {
    let mut bytes = vec![0; 4096];
    let mut encoded = |joint: u8| {
        let mut table = vec![0; curve_len(32)];
        encode_curve(joint, 1e-8, 0.0, &[5; 32], &mut table).unwrap();
        let p = ArmParameters { curves: Curves::of(table.leak()).unwrap(), ..parameters() };
        encode(&p, &mut bytes).map_err(|error| error.to_string())
    };
    let refused = "these parameters would be refused: curve 1 joint is outside its plausible range";
    assert!(encoded(0).is_ok() && encoded(2).is_ok());
    for joint in [1, 3, 15, 16, 255] {
        assert_eq!(encoded(joint), Err(refused.to_owned()), "joint {joint}");
    }
}

#[test]
fn what_is_no_table_is_not_written() {
    let write = |step, band, nodes: &[i16], room: usize| {
        encode_curve(0, step, band, nodes, &mut vec![0; room]).map_err(|error| error.to_string())
    };
    assert_eq!(write(1e-8, 1e-5, &[0; 256], 524), Ok(524));
    assert!(write(1e-8, 1e-5, &[0; 255], 4096).unwrap_err().contains("curve 1 nodes"));
    assert!(write(1e-8, 1e-5, &[0; 1024], 4096).unwrap_err().contains("curve 1 nodes"));
    assert!(write(1e-8, 1e-5, &[], 4096).unwrap_err().contains("curve 1 nodes"));
    assert!(write(f32::NAN, 1e-5, &[0; 32], 4096).unwrap_err().contains("curve 1 step"));
    assert!(write(1e-8, -1.0, &[0; 32], 4096).unwrap_err().contains("curve 1 band"));
    let error = encode_curve(0, 1e-8, 0.0, &[0; 64], &mut [0; 139]).unwrap_err();
    assert_eq!(error, EncodeError::NoRoom { needed: 140, got: 139 });
    assert_eq!(Curves::of(&[]), Ok(Curves::NONE));
    assert_eq!(
        Curves::of(&curve_bytes()[..50]),
        Err(DecodeError::Length { stored: 50, expected: 76 })
    );
}

/// A table of 32 nodes for joint 2 that is known where these bits say.
fn gapped(known: &[u8]) -> Result<Vec<u8>, String> {
    let mut table = vec![0; curve_len(32) + gaps_len(32)];
    let gaps = Gaps::new(3e-4, known);
    encode_curve_with(1, 1e-8, 2e-5, &[5; 32], Some(gaps), &mut table)
        .map_err(|error| error.to_string())?;
    Ok(table)
}

#[test]
fn gaps_are_written_and_read() {
    let table = gapped(&[0xff, 0x0f, 0, 0x80]).unwrap();
    let plain = curve_bytes();
    // One with and one without, in either order.
    let both = [table.clone(), plain[curve_len(32)..].to_vec()].concat();
    let curves = Curves::of(&both).unwrap();
    let gaps: Vec<bool> = curves.iter().map(|curve| curve.gaps().is_some()).collect();
    assert_eq!((gaps, curves.have_gaps()), (vec![true, false], true));
    assert!(!Curves::of(&plain).unwrap().have_gaps());
    let [second, fifth] = [1, 4].map(|joint| curves.of_joint(joint).unwrap());
    assert_eq!(second.gaps().unwrap().known(), [0xff, 0x0f, 0, 0x80]);
    // Values are those of the curve without.
    let mut known = vec![0; curve_len(32)];
    encode_curve(1, 1e-8, 2e-5, &[5; 32], &mut known).unwrap();
    let known = Curves::of(&known).unwrap().of_joint(1).unwrap();
    for k in -100..100 {
        let q = f64::from(k) * 0.1 + 0.05;
        assert_eq!(second.at(q), known.at(q));
        let turn = core::f64::consts::TAU;
        let inside = (q.rem_euclid(turn) / turn * 32.0) as usize;
        assert_eq!(second.knows(q), inside < 12 || inside == 31, "{q}");
        assert_eq!(second.knows(q as f32), second.knows(q));
        assert_eq!(second.band_at(q), if second.knows(q) { 2e-5 } else { 3e-4 });
        assert!(fifth.knows(q) && fifth.band_at(q) == fifth.band());
        assert_eq!(curves.know(&[0.0, q, 0.0, 0.0, q, 0.0]), second.knows(q));
    }
    // No angle, or one of which only turns are left; as found these were known.
    for q in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e9, -1e9, f32::MAX] {
        assert!(!second.knows(q) && second.band_at(q) == 3e-4 && fifth.knows(q), "{q}");
        assert!(f64::from(q).abs() < 1e30 || !second.knows(f64::from(q)), "{q}");
    }
    assert!(!second.knows(f64::MAX));
    for nonsense in [f64::NAN, f64::INFINITY, f64::MAX, -f64::MAX] {
        // Somewhere on the turn, whatever: an arm is not covered there by its ranges.
        let band = second.band_at(nonsense);
        assert!(band == 2e-5 || band == 3e-4, "{band}");
    }
}

#[test]
fn gaps_that_are_none_are_refused() {
    assert!(gapped(&[0xff; 4]).unwrap_err().contains("curve 1 gaps"));
    assert!(gapped(&[0xff; 3]).unwrap_err().contains("curve 1 gaps"));
    assert!(gapped(&[0; 5]).unwrap_err().contains("curve 1 gaps"));
    let mut table = gapped(&[0, 0, 0, 1]).unwrap();
    table[curve_len(32)..][..4].copy_from_slice(&0.06_f32.to_le_bytes());
    assert!(Curves::of(&table).unwrap_err().to_string().contains("curve 1 band in gaps"));
    table[curve_len(32)..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(Curves::of(&table).unwrap_err().to_string().contains("band in gaps is not a finite"));
    let expected = curve_len(32) + gaps_len(32);
    for cut in curve_len(32)..expected {
        let refused = Curves::of(&table[..cut]);
        assert_eq!(refused, Err(DecodeError::Length { stored: cut as u32, expected }));
    }
}

/// An arm is covered where its ranges are and its curves are known.
#[test]
fn an_arm_covers_what_its_curves_know() {
    let table = gapped(&[0xff, 0xff, 0, 0xff]).unwrap();
    let p = Blob::check(&curved()).unwrap().parameters::<f32, 6>().map(own).unwrap();
    let p = ArmParameters { covered: [Some([-3.0, 3.0]); 6], ..p };
    let with = ArmParameters { curves: Curves::of(&table).unwrap(), ..p.clone() };
    let (with, without) = (Arm::new(&with), Arm::new(&p));
    for k in -320..320 {
        let q = k as f32 * 0.01;
        let joints = [0.1, q, 0.1, 0.1, 0.1, 0.1];
        // Not known: three to three and a half quarters of a turn.
        let gap = (-core::f32::consts::PI..-core::f32::consts::FRAC_PI_2).contains(&q);
        assert_eq!(without.covers(&joints), q.abs() <= 3.0);
        assert_eq!(with.covers(&joints), q.abs() <= 3.0 && !gap, "{q}");
    }
}

proptest! {
    #[test]
    fn no_bytes_of_curves_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        if let Ok(curves) = Curves::of(&bytes) {
            prop_assert!(curves.iter().all(|curve| curve.at(1.0_f32).is_finite()));
            prop_assert!(curves.iter().all(|curve| curve.band_at(1.0_f32).is_finite()));
        }
    }

    /// Past the checksum as well: whatever stands in the curves of a mended blob.
    #[test]
    fn no_mended_curves_panic(offset in 0..212_usize, value in any::<[u8; 4]>(), q in -8_f32..8.0) {
        let bytes = forge(offset, &value);
        if let Ok(blob) = Blob::check(&bytes) {
            let arm = Arm::new(&blob.parameters::<f32, 6>().unwrap());
            prop_assert!(arm.curves().iter().count() == 2);
            let pose = arm.real_pose(&[q; 6]);
            prop_assert!(pose.translation.iter().all(|x| x.is_finite()));
        }
    }
}
