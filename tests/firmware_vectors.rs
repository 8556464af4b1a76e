//! Host = file = target. The image computes the shipped poses under QEMU and
//! compares the bits with the hash in the vector file; here the host does.

#[path = "firmware/src/vectors.rs"]
mod vectors;

use truearm::blob::Blob;
use truearm::effects::{Effect, MAX_TERMS};
use truearm::{Arm, ArmParameters, Scalar};
use vectors::{Hashes, JOINTS, Vectors};

const BLOB: &[u8] = include_bytes!("data/firmware/ur10.blob");
const VECTORS: &[u8] = include_bytes!("data/firmware/fk.vectors");
const TERMS_BLOB: &[u8] = include_bytes!("data/firmware/ur10-terms.blob");
const TERMS_VECTORS: &[u8] = include_bytes!("data/firmware/terms.vectors");

const CURVES_BLOB: &[u8] = include_bytes!("data/firmware/ur10-curves.blob");
const CURVES_VECTORS: &[u8] = include_bytes!("data/firmware/curves.vectors");

fn parameters<T: Scalar>(blob: &[u8]) -> ArmParameters<'_, T, JOINTS> {
    Blob::check(blob).unwrap().parameters().unwrap()
}

fn hashes<T: Scalar>(parameters: &ArmParameters<T, JOINTS>, vectors: &Vectors) -> Hashes {
    vectors::hashes(&Arm::new(parameters), vectors.poses())
}

/// nalgebra's `std` feature is on in this build (see the dev-dependencies) and
/// off in the image: that the hashes agree shows that feature unification
/// changes no bit of a result.
#[test]
fn host_gives_the_bits_of_the_vector_files() {
    let files = [(BLOB, VECTORS), (TERMS_BLOB, TERMS_VECTORS), (CURVES_BLOB, CURVES_VECTORS)];
    // Without the feature the last blob is refused.
    let known = if cfg!(feature = "curves") { 3 } else { 2 };
    for (blob, vectors) in files.into_iter().take(known) {
        let vectors = Vectors::parse(vectors).unwrap();
        assert_eq!(vectors.poses::<f32>().len(), 1024);
        let hint = "if meant: cargo xtask vectors";
        assert_eq!(hashes::<f32>(&parameters(blob), &vectors), vectors.single, "{hint}");
        assert_eq!(hashes::<f64>(&parameters(blob), &vectors), vectors.double, "{hint}");
    }
}

#[test]
fn the_second_blob_has_every_effect_and_all_of_them_act() {
    let full = parameters::<f32>(TERMS_BLOB);
    assert_eq!(full.terms.len(), MAX_TERMS);
    for effect in Effect::ALL {
        assert!(full.terms.iter().any(|t| t.effect == *effect), "{}", effect.name());
    }
    let vectors = Vectors::parse(TERMS_VECTORS).unwrap();
    for i in 0..MAX_TERMS {
        let mut less = full.clone();
        less.terms[i].coefficient = 0.0;
        let [poses, jacobians, ticks] = hashes(&less, &vectors);
        assert_ne!(poses, vectors.single[0], "term {}", i + 1);
        assert_eq!(jacobians, vectors.single[1], "term {}", i + 1);
        assert_ne!(ticks, vectors.single[2], "term {}", i + 1);
    }
    // The first blob is the same arm without them: there a state changes nothing.
    let bare = parameters(BLOB);
    let arm = Arm::new(&bare);
    for (i, q) in vectors.poses().enumerate() {
        assert_eq!(arm.real_pose_in(&q, &vectors::state(i)), arm.real_pose(&q));
    }
    assert_eq!(ArmParameters { terms: bare.terms.clone(), ..full }, bare);
}

/// What a real arm has, in one blob; every curve moves poses and ticks.
#[cfg(feature = "curves")]
#[test]
fn the_third_blob_has_curves_and_all_of_them_act() {
    let full = parameters::<f32>(CURVES_BLOB);
    assert_eq!(full.terms.len(), 9);
    assert!(full.terms.iter().any(|term| term.effect == Effect::JointCompliance));
    assert!(CURVES_BLOB.len() <= 4096);
    let nodes: Vec<usize> = full.curves.iter().map(|curve| curve.nodes().len()).collect();
    assert_eq!(nodes, [256; 5]);
    let vectors = Vectors::parse(CURVES_VECTORS).unwrap();
    let table = truearm::blob::curve_len(256);
    for left_out in 0..5 {
        let mut rest = full.curves.as_bytes().to_vec();
        rest.drain(left_out * table..(left_out + 1) * table);
        let curves = truearm::Curves::of(&rest).unwrap();
        let [poses, jacobians, ticks] = hashes(&ArmParameters { curves, ..full.clone() }, &vectors);
        assert_ne!(poses, vectors.single[0]);
        assert_eq!(jacobians, vectors.single[1]);
        assert_ne!(ticks, vectors.single[2]);
    }
}

/// A hash that never differs would prove nothing.
#[test]
fn one_ulp_of_one_parameter_changes_the_hash() {
    let mut parameters = parameters::<f32>(BLOB);
    let d = &mut parameters.nominal[5].parameters.d;
    *d = d.next_up();
    let vectors = Vectors::parse(VECTORS).unwrap();
    let changed = hashes(&parameters, &vectors);
    for (part, (changed, expected)) in changed.iter().zip(&vectors.single).enumerate() {
        assert_ne!(changed, expected, "{}", vectors::PARTS[part]);
    }
}

#[test]
fn the_poses_are_finite_and_cover_two_turns() {
    let poses: Vec<vectors::Joints> = Vectors::parse(VECTORS).unwrap().poses().collect();
    for j in 0..JOINTS {
        let most = poses.iter().map(|q| q[j].abs()).fold(0.0, f32::max);
        assert!(most > 6.2 && most <= core::f32::consts::TAU, "joint {}: {most}", j + 1);
    }
}
