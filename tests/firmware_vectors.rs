//! Host = file = target. The image computes the shipped poses under QEMU and
//! compares the bits with the hash in the vector file; here the host does.

#[path = "firmware/src/vectors.rs"]
mod vectors;

use truearm::Arm;
use truearm::blob::Blob;
use vectors::{JOINTS, Vectors};

const BLOB: &[u8] = include_bytes!("data/firmware/ur10.blob");
const VECTORS: &[u8] = include_bytes!("data/firmware/fk.vectors");

/// nalgebra's `std` feature is on in this build (see the dev-dependencies) and
/// off in the image: that the hashes agree shows that feature unification
/// changes no bit of a result.
#[test]
fn host_gives_the_bits_of_the_vector_file() {
    let parameters = Blob::check(BLOB).unwrap().parameters::<f32, JOINTS>().unwrap();
    let vectors = Vectors::parse(VECTORS).unwrap();
    assert_eq!(vectors.poses().len(), 1024);
    let hash = vectors::hash(&Arm::new(&parameters), vectors.poses());
    assert_eq!(hash, vectors.expected, "{hash:016x}; if meant: cargo xtask vectors BLOB");
}

/// A hash that never differs would prove nothing.
#[test]
fn one_ulp_of_one_parameter_changes_the_hash() {
    let mut parameters = Blob::check(BLOB).unwrap().parameters::<f32, JOINTS>().unwrap();
    let d = &mut parameters.nominal[5].parameters.d;
    *d = d.next_up();
    let vectors = Vectors::parse(VECTORS).unwrap();
    assert_ne!(vectors::hash(&Arm::new(&parameters), vectors.poses()), vectors.expected);
}

#[test]
fn the_poses_are_finite_and_cover_two_turns() {
    let poses: Vec<_> = Vectors::parse(VECTORS).unwrap().poses().collect();
    for j in 0..JOINTS {
        let most = poses.iter().map(|q| q[j].abs()).fold(0.0, f32::max);
        assert!(most > 6.2 && most <= core::f32::consts::TAU, "joint {}: {most}", j + 1);
    }
}
