//! An arm on a rail, and other arms with a joint that slides: drift watch,
//! re-identification, streaming identification and store see the joint that moved.

use crate::arms::{self, Tracker, stored};
use crate::common::{scara, ur10_on_a_rail};
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use nalgebra::Vector3;
use truearm::blob::{Acceptance, encode};
use truearm::drift::{DriftWatch, FalseAlarms, Group};
use truearm::parameters::Parameter;
use truearm::reidentify::Reidentify;
use truearm::store::{NorSlots, Store, Stored};
use truearm::streaming::{Lambda, Settings};
use truearm::{Arm, ArmParameters, Link, LinkParameter, Scalar};

const TOOL: [f64; 3] = [0.06, -0.025, 0.11];
const SIGMA: f64 = 2e-5;
/// What an encoder is off by: rad, or m of a joint that slides.
const OFF: f64 = 1e-3;

/// The same arm with the encoder of a joint off.
fn off<const N: usize>(links: [Link<f64>; N], joint: u8) -> ArmParameters<'static, f64, N> {
    let mut arm = stored(links, TOOL);
    Parameter::JointOffset(joint).apply(&mut arm, OFF);
    arm
}

/// Points it takes to see a joint that slid are blamed on that joint.
fn drift_blames<T: Scalar, const N: usize>(links: [Link<f64>; N], joint: u8) {
    let mut right = 0;
    for seed in 0..100 {
        let mut tracker = Tracker::<T, N>::new(&off(links, joint), SIGMA, seed);
        let arm = Arm::new(&stored(links, TOOL));
        let mut watch = DriftWatch::new(T::from_f64(SIGMA), FalseAlarms::OneIn1000).unwrap();
        let mut alarmed = false;
        for point in tracker.points(6) {
            let none = arms::vector([0.0; 3]);
            alarmed = watch.push(&arm, &point, &none).unwrap().recalibrate;
        }
        assert!(alarmed);
        let suspect = watch.suspect().unwrap();
        right += usize::from(suspect.group == Group::JointOffset(joint));
        let own = watch.explanations().nth(usize::from(joint)).unwrap();
        assert!((own.shift.to_f64() - OFF).abs() < 1e-4, "seed {seed}: {own:?}");
        assert!(own.explained.to_f64() > 0.98 * own.total.to_f64(), "seed {seed}: {own:?}");
        assert_eq!(own.group.to_string(), format!("joint offset of joint {}", joint + 1));
    }
    // All but some, where noise makes two more parameters of the tool or five of the base
    // worth their price.
    println!("joint {}: {right} of 100", joint + 1);
    assert!(right >= 85, "{right} of 100");
}

#[test]
fn drift_blames_the_joint_that_slid() {
    drift_blames::<f64, 7>(ur10_on_a_rail(), 0);
    drift_blames::<f32, 7>(ur10_on_a_rail(), 0);
    drift_blames::<f64, 4>(scara(), 2);
    drift_blames::<f64, 7>(ur10_on_a_rail(), 2);
}

fn is_reidentified<T: Scalar, const N: usize>(links: [Link<f64>; N], joint: u8, exact: f64) {
    let was = stored::<T, N>(links, TOOL);
    let mut tracker = Tracker::<T, N>::new(&off(links, joint), 0.0, 5);
    assert!(tracker.error(&was) > 3e-4);
    let points = tracker.points(10);
    let chosen = [Parameter::JointOffset(joint), Parameter::JointOffset(1)];
    let found = Reidentify::new(&was, chosen, T::from_f64(SIGMA)).run(&was, &points).unwrap();
    let left = tracker.error(&found.parameters);
    assert!(left < exact, "{left:e}, {found:?}");
    assert!((found.change[0].to_f64() - OFF).abs() < exact && found.determined == [true; 2]);
    assert_eq!(found.rank, 2);
    // Nothing else moved.
    let mut expected = was.clone();
    for (parameter, change) in chosen.iter().zip(found.change) {
        parameter.apply(&mut expected, change);
    }
    expected.sequence += 1;
    assert_eq!(found.parameters.sequence, 42);
    assert!(tracker.error(&expected) < exact);
}

#[test]
fn the_offset_of_a_joint_that_slides_is_reidentified() {
    is_reidentified::<f64, 7>(ur10_on_a_rail(), 0, 1e-8);
    is_reidentified::<f32, 7>(ur10_on_a_rail(), 0, 2e-6);
    is_reidentified::<f64, 4>(scara(), 2, 1e-8);
    is_reidentified::<f32, 4>(scara(), 2, 2e-6);
}

/// The rail's encoder, two joints and a link length from points of one after the other.
fn is_streamed<T: Scalar>(exact: f64) {
    let links = ur10_on_a_rail();
    let was = stored::<T, 7>(links, TOOL);
    let length = Parameter::Link { joint: 3, parameter: LinkParameter::A };
    let chosen =
        [Parameter::JointOffset(0), Parameter::JointOffset(2), Parameter::JointOffset(4), length];
    let mut real = off(links, 0);
    let moved = [OFF, 2e-4, -3e-4, 4e-4];
    for (parameter, by) in chosen.iter().zip(moved).skip(1) {
        parameter.apply(&mut real, by);
    }
    let mut tracker = Tracker::<T, 7>::new(&real, 0.0, 6);
    let mut stream = Settings::new(&was, chosen, T::from_f64(SIGMA)).start(&was).unwrap();
    for point in tracker.points(40) {
        stream.push(&point).unwrap();
    }
    let found = stream.identified(Lambda::Prior).unwrap();
    assert!(tracker.error(&was) > 5e-4);
    // What is left is of second order.
    assert!(tracker.error(&found.parameters) < exact, "{found:?}");
    assert_eq!((found.rank, found.determined), (4, [true; 4]));
}

#[test]
fn a_rail_is_streamed() {
    is_streamed::<f64>(1.5e-6);
    is_streamed::<f32>(2e-6);
}

/// Two sectors of NOR flash in memory.
struct Flash([u8; 4096]);

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        bytes.copy_from_slice(&self.0[offset as usize..][..bytes.len()]);
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 2048;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        for (cell, byte) in self.0[offset as usize..].iter_mut().zip(bytes) {
            *cell &= byte;
        }
        Ok(())
    }
}

#[test]
fn what_was_reidentified_is_stored_and_driven_with_after_power_up() {
    let was = stored::<f32, 7>(ur10_on_a_rail(), TOOL);
    let mut tracker = Tracker::<f32, 7>::new(&off(ur10_on_a_rail(), 0), SIGMA, 7);
    let points = tracker.points(10);
    let chosen = [Parameter::JointOffset(0)];
    let found = Reidentify::new(&was, chosen, SIGMA as f32).run(&was, &points).unwrap();
    let mut flash = Flash([0xff; 4096]);
    let mut bytes = [0; 2000];
    for parameters in [&was, &found.parameters] {
        let length = encode(parameters, &mut bytes).unwrap();
        let mut buffer = [0; 2000];
        let slots = NorSlots::new(&mut flash, [0, 2048], 2048).unwrap();
        let (mut store, _) = Store::open(slots, &mut buffer, Acceptance::of(7, 7)).unwrap();
        assert!(matches!(store.store(&bytes[..length]).unwrap(), Stored::Written(_)));
    }
    // The power was off.
    let mut buffer = [0; 2000];
    let slots = NorSlots::new(&mut flash, [0, 2048], 2048).unwrap();
    let (_, opened) = Store::open(slots, &mut buffer, Acceptance::of(7, 7)).unwrap();
    let read: ArmParameters<'_, f32, 7> = opened.blob.unwrap().parameters().unwrap();
    assert_eq!(read, found.parameters);
    assert!(tracker.error(&read) < 2e-5 && tracker.error(&was) > 3e-4);
    let moved = Arm::new(&read).real_pose(&[0.0; 7]).translation
        - Arm::new(&was).real_pose(&[0.0; 7]).translation;
    assert!((moved.norm() - OFF as f32).abs() < 2e-5 && moved != Vector3::zeros());
}
