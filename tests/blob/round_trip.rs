//! The parameter blob: round trip, and refusal of everything that is not one.

use crate::blobs::{self, mend, parameters, term};
use crate::common;
use proptest::prelude::*;
use truearm::blob::{
    AcceptanceError, Blob, CovarianceError, DecodeError, EncodeError, Flaw, Record, encode,
    encode_with, encoded_len, factor_len, robot_id,
};
use truearm::effects::{Effect, MAX_TERMS, Term};
use truearm::{Approach, Arm, ArmParameters, Curves, Pose, State};

fn blob() -> Vec<u8> {
    let mut bytes = vec![0; encoded_len(3, MAX_TERMS)];
    assert_eq!(encode(&parameters(), &mut bytes), Ok(bytes.len()));
    bytes
}

/// Sets four bytes and mends the checksum, as only a faulty writer would.
fn forge(offset: usize, value: &[u8]) -> Vec<u8> {
    let mut bytes = blob();
    bytes[offset..offset + value.len()].copy_from_slice(value);
    mend(&mut bytes);
    bytes
}

#[test]
fn what_is_written_is_read() {
    let bytes = blob();
    let blob = Blob::check(&bytes).unwrap();
    assert_eq!(blob.parameters::<f32, 3>(), Ok(parameters()));
    assert_eq!((blob.sequence(), blob.robot_id()), (7, robot_id("arm", "0042")));
    assert_eq!((blob.created(), blob.is_tagged()), (1_700_000_000, false));
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
    assert_eq!(refused(28, &[0x40]), unknown("flags"));
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

/// Drafts and layouts to come have errors of their own.
#[test]
fn other_layouts_are_refused_by_number() {
    let layout = |l: u16| Blob::check(&forge(4, &l.to_le_bytes())).map(drop);
    for draft in 0..3 {
        assert_eq!(layout(draft), Err(DecodeError::DraftLayout(draft)));
    }
    assert_eq!(layout(3), Ok(()));
    for newer in [4, 300, u16::MAX] {
        assert_eq!(layout(newer), Err(DecodeError::NewerLayout(newer)));
    }
    let message = DecodeError::DraftLayout(2).to_string();
    assert_eq!(message, "layout 2 was a draft and is no longer read; this version reads layout 3");
}

fn content(bytes: &[u8]) -> Vec<u8> {
    Blob::check(bytes).unwrap().content().map(|part| &bytes[part]).concat()
}

#[test]
fn sequence_and_time_are_not_content() {
    let first = blob();
    let other = |change: &dyn Fn(&mut truearm::ArmParameters<f32, 3>)| {
        let mut p = parameters();
        change(&mut p);
        let mut bytes = vec![0; encoded_len(3, MAX_TERMS)];
        encode(&p, &mut bytes).unwrap();
        content(&first) == content(&bytes)
    };
    assert!(other(&|p| (p.sequence, p.created) = (8, 9)));
    assert!(!other(&|p| p.robot_id += 1));
    assert!(!other(&|p| p.tool.x += 1e-6));
    assert!(!other(&|p| p.corrections[2].beta += 1e-6));
    assert!(!other(&|p| p.terms[23].coefficient += 1e-9));
    assert!(!other(&|p| p.masses.as_mut().unwrap().mass[1] += 1e-3));
}

/// A factor of which every number can be told from every other.
fn factor() -> Vec<f32> {
    (1..=factor_len(3, MAX_TERMS)).map(|k| 1e-6 * k as f32).collect()
}

#[test]
fn a_covariance_is_kept_and_checked() {
    let factor = factor();
    let mut bytes = vec![0; encoded_len(3, MAX_TERMS) + 4 * factor.len()];
    let size = encode_with(&parameters(), Some(&factor), &mut bytes);
    assert_eq!(size, Ok(bytes.len()));
    let blob = Blob::check(&bytes).unwrap();
    assert_eq!(blob.size(), bytes.len());
    let covariance = blob.covariance().unwrap();
    assert_eq!(covariance.parameters(), 48);
    assert!(covariance.factor().eq(factor.iter().copied()));
    let (plain, bare) = (parameters(), self::blob());
    assert_eq!(blob.parameters::<f32, 3>(), Ok(plain.clone()));
    assert!(Blob::check(&bare).unwrap().covariance().is_none());
    assert_ne!(content(&bytes), content(&bare));

    let at = encoded_len(3, MAX_TERMS) - 4;
    let refused = |number: usize, value: f32| {
        let mut bytes = bytes.clone();
        bytes[at + 4 * (number - 1)..][..4].copy_from_slice(&value.to_le_bytes());
        mend(&mut bytes);
        Blob::check(&bytes).unwrap_err().to_string()
    };
    let name = |n| format!("number {n} of covariance factor");
    assert_eq!(refused(17, f32::NAN), name(17) + " is not a finite number");
    assert_eq!(refused(1176, 10.5), name(1176) + " is outside its plausible range");
    // The first number of the second column stands on the diagonal.
    assert_eq!(refused(49, -1e-9), name(49) + " is outside its plausible range");
    let error = encode_with(&plain, Some(&factor[1..]), &mut [0; 9000]).unwrap_err();
    assert_eq!(error, EncodeError::Factor { needed: 1176, got: 1175 });
}

/// A factor with one column is one error vector: the deviation must be the
/// change of the tool point when the parameters change by it.
#[test]
fn point_sigma_is_the_change_of_the_point() {
    let bytes = blob();
    let mut plain: truearm::ArmParameters<f64, 3> =
        Blob::check(&bytes).unwrap().parameters().unwrap();
    for term in &mut plain.terms {
        // Bent little, so that first order is all there is.
        term.coefficient *= 1e-3;
    }
    let q = [0.3, 0.2, -0.7];
    let state = State {
        approach: [Approach::Positive, Approach::Negative, Approach::Positive],
        payload: 2.0,
        temperature: 30.0,
        torque: None,
    };
    let point =
        |p: &truearm::ArmParameters<f64, 3>| Arm::new(p).real_pose_in(&q, &state).translation;
    let step = 1e-6;
    for k in 0..48 {
        let mut numbers = vec![0.0; factor_len(3, MAX_TERMS)];
        // Row k of the first column; column k begins with its diagonal.
        numbers[k] = 1.0;
        let mut bytes = [0; 9000];
        encode_with(&plain, Some(&numbers), &mut bytes).unwrap();
        let blob = Blob::check(&bytes).unwrap();
        let rounded = blob.parameters::<f64, 3>().unwrap();
        let arm = Arm::new(&rounded);
        let sigma = blob.covariance().unwrap().point_sigma(&arm, &q, &state).unwrap();
        let mut moved = [rounded.clone(), rounded.clone()];
        for (p, step) in moved.iter_mut().zip([step, -step]) {
            match k {
                0..3 => p.base_translation[k] += step,
                3..6 => {
                    let mut turn = nalgebra::Vector3::zeros();
                    turn[k - 3] = step;
                    let zero = nalgebra::Vector3::zeros();
                    let left = Pose::from_rotation_vector(zero, turn);
                    let base = Pose::from_rotation_vector(zero, p.base_rotation);
                    let rotation = left.compose(&base).rotation;
                    p.base_rotation =
                        nalgebra::Rotation3::from_matrix_unchecked(rotation).scaled_axis();
                }
                6..9 => p.tool[k - 6] += step,
                9..24 => {
                    let mut c = p.corrections[(k - 9) / 5].to_array();
                    c[(k - 9) % 5] += step;
                    p.corrections[(k - 9) / 5] = truearm::MdhParameters::from_array(c);
                }
                _ => p.terms[k - 24].coefficient += step,
            }
        }
        let change = (point(&moved[0]) - point(&moved[1])) / (2.0 * step);
        for c in 0..3 {
            let (expected, close) = (change[c].abs(), 2e-3 * change.norm().max(1e-9));
            assert!((sigma[c] - expected).abs() < close, "{k}: {sigma:?}, {change}");
        }
        // Another tool is exact.
        let other = arm.with_tool(Pose::translation(0.0, 0.0, 0.3));
        let sigma = blob.covariance().unwrap().point_sigma(&other, &q, &state).unwrap();
        assert!(!(6..9).contains(&k) || sigma == [0.0; 3]);
    }
}

/// Never a number for an arm that it is not of.
#[test]
fn a_foreign_arm_is_refused_by_the_covariance() {
    let mut bytes = vec![0; 9000];
    let mut own = parameters();
    encode_with(&own, Some(&factor()), &mut bytes).unwrap();
    let covariance = Blob::check(&bytes).unwrap().covariance().unwrap();
    own = Blob::check(&bytes).unwrap().parameters().unwrap();
    let sigma = |p: &truearm::ArmParameters<f32, 3>| {
        let arm = Arm::new(p);
        covariance.point_sigma(&arm, &[0.1; 3], &arm.state()).map(drop)
    };
    let changed = |change: &dyn Fn(&mut truearm::ArmParameters<f32, 3>)| {
        let mut p = own.clone();
        change(&mut p);
        sigma(&p)
    };
    assert_eq!(sigma(&own), Ok(()));
    let robot = own.robot_id;
    let wrong = CovarianceError::WrongRobot { blob: robot, arm: robot ^ 1 };
    assert_eq!(changed(&|p| p.robot_id ^= 1), Err(wrong));
    let wrong = CovarianceError::WrongSequence { blob: 7, arm: 8 };
    assert_eq!(changed(&|p| p.sequence = 8), Err(wrong));
    let other = Err(CovarianceError::OtherParameters);
    assert_eq!(changed(&|p| p.corrections[2].beta += 1e-6), other);
    assert_eq!(changed(&|p| p.nominal[1].parameters.a += 1e-4), other);
    assert_eq!(changed(&|p| p.nominal[1].kind = truearm::JointKind::Revolute), other);
    assert_eq!(changed(&|p| p.terms[23].coefficient *= 1.5), other);
    assert_eq!(changed(&|p| p.terms.truncate(23)), other);
    // The tool is the user's to change.
    assert_eq!(changed(&|p| p.tool.x += 0.1), Ok(()));

    let mut first = truearm::ArmParameters::<f32, 1> {
        robot_id: own.robot_id,
        sequence: own.sequence,
        ..Blob::check(include_bytes!("../data/golden/layout-3-least.blob"))
            .unwrap()
            .parameters()
            .unwrap()
    };
    first.nominal[0] = own.nominal[0];
    first.corrections[0] = own.corrections[0];
    let one = Arm::new(&first);
    let refused = covariance.point_sigma(&one, &[0.1], &one.state());
    assert_eq!(refused, Err(CovarianceError::OtherParameters));
}

#[test]
fn a_last_sequence_number_is_not_written() {
    let mut p = parameters();
    p.sequence = u32::MAX;
    assert_eq!(encode(&p, &mut [0; 1024]), Err(EncodeError::LastSequence));
    p.sequence -= 1;
    assert!(encode(&p, &mut [0; 1024]).is_ok());
}

#[test]
fn errors_say_their_source() {
    use std::error::Error;
    let mut p = parameters();
    p.corrections[1].d = 0.5;
    let error = encode(&p, &mut [0; 1024]).unwrap_err();
    let source = error.source().and_then(|e| e.downcast_ref::<DecodeError>());
    assert!(matches!(source, Some(DecodeError::Field(name, _)) if name.record == Record::Joint(1)));
    let error = AcceptanceError::from(DecodeError::NotABlob);
    assert!(error.source().is_some());
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

/// Terms 1 to 11 are those of `tests/blob/golden.rs`.
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
    let next = Effect::ALL.len() as u8;
    assert_eq!(refused(1, 0, &[next]), unknown("term 1 effect"));
    // Room for effects to come.
    assert_eq!(refused(1, 0, &[0x40]), unknown("term 1 effect"));
    assert_eq!(refused(1, 0, &[0x80]), unknown("term 1 effect"));
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
    // A friction of whole coarse steps has no fine ones.
    let backlash = Effect::ALL.iter().position(|e| *e == Effect::Backlash).unwrap() as u8;
    assert_eq!(refused(8, 0, &[backlash | 0x10, 0, 64, 0]), range("term 8 order"));
    assert_eq!(refused(8, 0, &[backlash | 0x10, 0, 0, 0]), range("term 8 order"));
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
    for friction in [0.0001, -0.001, 1024.0, f32::NAN] {
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
        // Torques of joints may be read, moments may not.
        let error = refused(needy, false);
        let masses = "term 1 effect needs link masses and gravity, which are not given";
        assert_eq!(error.is_some_and(|error| error.ends_with(masses)), needy.needs_masses());
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

/// Frictions below 16 N m are held in steps of 1/4096, those above in 1/64: a step is never
/// more than a hundredth of what a wrist of 0.1 N m has. Every one that was read is written
/// as the same bytes.
#[test]
fn frictions_are_held_in_steps_of_their_size() {
    let written = |friction: f32| {
        let terms = [term(Effect::Backlash, 0, friction, 1e-5)];
        let p = ArmParameters { terms: heapless::Vec::from_iter(terms), ..parameters() };
        let mut bytes = [0; 1024];
        let len = encode(&p, &mut bytes).unwrap();
        let read = Blob::check(&bytes[..len]).unwrap().parameters::<f32, 3>().unwrap();
        assert_eq!(read.terms[0].component, 0);
        let mut again = [0; 1024];
        encode(&read, &mut again).unwrap();
        assert_eq!(again, bytes, "{friction}");
        read.terms[0].order
    };
    for steps in (1..=65_535_u16).step_by(7).chain([63, 64, 65, 65_535]) {
        let fine = f32::from(steps) / 4096.0;
        assert_eq!(written(fine), fine);
        assert_eq!(written(fine * 64.0), fine * 64.0);
    }
    assert_eq!(written(0.1), 410.0 / 4096.0);
    assert_eq!(written(15.999_9), 16.0);
    assert_eq!(written(16.01), 16.015_625);
}

#[test]
fn a_time_constant_is_in_64ths_of_a_minute_and_the_same_in_all_terms() {
    let written = |constants: [f32; 2]| {
        let terms = constants.map(|tau| term(Effect::ThermalExpansion, 1, tau, 1e-5));
        let p = ArmParameters { terms: heapless::Vec::from_iter(terms), ..parameters() };
        let mut bytes = [0; 1024];
        encode(&p, &mut bytes).map_err(|error| error.to_string())?;
        let read = Blob::check(&bytes).unwrap().parameters::<f32, 3>().unwrap();
        assert_eq!(Arm::new(&read).thermal_lag().time_constant(), read.terms[0].order);
        Ok(read.terms[1].order)
    };
    for (tau, read) in [(0.0, 0.0), (1500.0, 1500.0), (100.0, 100.3125), (61_439.0, 61_439.063)] {
        assert_eq!(written([tau; 2]), Ok::<f32, String>(read));
    }
    let range = "these parameters would be refused: term 2 order is outside its plausible range";
    assert_eq!(written([1500.0, 0.0]), Err(range.to_owned()));
    assert_eq!(written([600.0, 1500.0]), Err(range.to_owned()));
    for tau in [0.3, -1.0, 61_440.0, f32::NAN] {
        assert_eq!(written([tau; 2]), Err(range.replace('2', "1")), "{tau}");
    }
}

#[test]
fn six_joints_with_everything_fit_768_bytes() {
    let size = encoded_len(6, MAX_TERMS);
    assert!(size <= 768 && size + truearm::blob::TAG <= 800);
    assert_eq!(size, blobs::full().len());
    // The covariance and everything else fit a slot of 16 KiB.
    assert!(size + truearm::blob::TAG + 4 * factor_len(6, MAX_TERMS) <= 16 * 1024 - 64);
}

/// Why there is no binary64 in the format: what rounding every number of a UR10
/// to binary32 does to the tool point.
#[test]
fn rounding_to_binary32_moves_the_tool_by_a_tenth_of_a_micrometre() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut worst = 0_f64;
    let (mut square, mut count) = (0.0, 0.0);
    for _ in 0..10 {
        let mut small = || rng.random_range(-2e-3..2e-3);
        let exact = truearm::ArmParameters {
            nominal: common::ur10(),
            corrections: [(); 6]
                .map(|()| truearm::MdhParameters::from_array([(); 5].map(|()| small()))),
            base_translation: [(); 3].map(|()| small()).into(),
            base_rotation: [(); 3].map(|()| small()).into(),
            tool: nalgebra::Vector3::new(0.06, -0.025, 0.11),
            terms: heapless::Vec::new(),
            curves: Curves::NONE,
            masses: None,
            limits: [None; 6],
            covered: [None; 6],
            ..Blob::check(&blobs::full()).unwrap().parameters::<f64, 6>().unwrap()
        };
        let mut bytes = [0; 1024];
        encode(&exact, &mut bytes).unwrap();
        let rounded = Blob::check(&bytes).unwrap().parameters::<f64, 6>().unwrap();
        assert_ne!(rounded, exact);
        let (exact, rounded) = (Arm::new(&exact), Arm::new(&rounded));
        for _ in 0..1000 {
            let q = [(); 6].map(|()| rng.random_range(-3.2..3.2));
            let off = exact.real_pose(&q).translation - rounded.real_pose(&q).translation;
            worst = worst.max(off.norm());
            square += off.norm_squared();
            count += 1.0;
        }
    }
    println!(
        "binary32: RMS {:.3} um, worst {:.3} um",
        f64::sqrt(square / count) * 1e6,
        worst * 1e6
    );
    assert!(worst < 0.12e-6);
}

/// The check values that FORMAT.md promises.
#[test]
fn checksums_are_the_standard_ones() {
    assert_eq!(crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(b"123456789"), 0xe306_9283);
    let digest = crc::Crc::<u64>::new(&crc::CRC_64_XZ).checksum(b"arm\x000042");
    assert_eq!(robot_id("arm", "0042"), digest);
    assert_ne!(robot_id("ar", "m0042"), robot_id("arm", "0042"));
}

/// Whatever is taken is written again as the same bytes: each has a meaning or is 0.
#[test]
fn every_byte_of_a_mended_blob_means_something() {
    for whole in [blob(), include_bytes!("../data/golden/layout-3-least.blob").to_vec()] {
        let (joints, mut taken) = (usize::from(whole[6]), 0);
        for offset in 0..whole.len() - 4 {
            for value in [0x00, 0x01, 0x40, 0x80, 0xff].map(|bits| whole[offset] ^ bits) {
                let mut bytes = whole.clone();
                bytes[offset] = value;
                mend(&mut bytes);
                let Ok(blob) = Blob::check(&bytes) else { continue };
                let mut again = vec![0; bytes.len()];
                let size = match joints {
                    1 => encode(&blob.parameters::<f32, 1>().unwrap(), &mut again),
                    _ => encode(&blob.parameters::<f32, 3>().unwrap(), &mut again),
                };
                // The last number is of a set that none may follow.
                if size != Err(EncodeError::LastSequence) {
                    assert_eq!((size, &again), (Ok(bytes.len()), &bytes), "byte {offset}");
                }
                taken += 1;
            }
        }
        assert!(taken > 100);
    }
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
