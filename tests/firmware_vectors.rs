//! Host = file = target. The image computes the shipped poses under QEMU and
//! compares the bits with the hash in the vector file; here the host does.

mod common;
#[path = "firmware/src/vectors.rs"]
mod vectors;

use nalgebra::Vector3;
use truearm::blob::{Blob, encode, encoded_len, robot_id};
use truearm::{Arm, ArmParameters, Link, MdhParameters};
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

/// The published UR10 and the deviations of `common::ur10`, for
/// `cargo xtask vectors`.
#[test]
#[ignore = "writes ur10.blob into the target directory"]
fn write_a_golden_blob() {
    const H: f64 = core::f64::consts::FRAC_PI_2;
    let nominal = [
        [0.0, 0.0, 0.0, 0.1273, 0.0],
        [H, 0.0, 0.0, 0.0, 0.0],
        [0.0, -0.612, 0.0, 0.0, 0.0],
        [0.0, -0.5723, 0.0, 0.163_941, 0.0],
        [H, 0.0, 0.0, 0.1157, 0.0],
        [-H, 0.0, 0.0, 0.0922, 0.0],
    ];
    let real = common::ur10().map(|link| link.parameters.to_array());
    let corrections = core::array::from_fn(|i| {
        MdhParameters::from_array(core::array::from_fn(|k| real[i][k] - nominal[i][k]))
    });
    let parameters = ArmParameters {
        robot_id: robot_id("UR10", "0001"),
        sequence: 1,
        nominal: nominal.map(|[alpha, a, theta, d, beta]| Link::revolute(alpha, a, theta, d, beta)),
        corrections,
        base_translation: Vector3::new(2e-4, -3e-4, 1e-4),
        base_rotation: Vector3::new(1e-4, -2e-4, 3e-4),
        tool: Vector3::new(0.03, -0.02, 0.15),
        limits: [Some([-core::f64::consts::TAU, core::f64::consts::TAU]); JOINTS],
        covered: [Some([-3.0, 3.0]); JOINTS],
        rms_before: 1.5e-3,
        rms_after: 1e-4,
        orientation_identified: false,
    };
    let mut bytes = vec![0; encoded_len(JOINTS)];
    encode(&parameters, &mut bytes).unwrap();
    let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/ur10.blob");
    std::fs::write(path, bytes).unwrap();
    println!("{path}");
}
