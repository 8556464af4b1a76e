//! A chain of 4x4 matrices straight from urdf-rs: nothing of truearm in it.
#![allow(dead_code, reason = "every test file uses a part")]

use nalgebra::{Matrix4, Rotation3, Translation3, Unit, Vector3};
use urdf_rs::{Joint, JointType, Robot};

/// `xyz` in m, `rpy` in rad.
pub fn frame(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Matrix4<f64> {
    let turn = |axis, angle| Rotation3::from_axis_angle(&axis, angle).to_homogeneous();
    Translation3::from(Vector3::from(xyz)).to_homogeneous()
        * turn(Vector3::z_axis(), yaw)
        * turn(Vector3::y_axis(), pitch)
        * turn(Vector3::x_axis(), roll)
}

/// The joints between two links, from the first to the last.
pub fn path<'a>(robot: &'a Robot, base: &str, tip: &str) -> Vec<&'a Joint> {
    let mut path = Vec::new();
    let mut at = tip.to_owned();
    while at != base {
        let joint = robot.joints.iter().find(|j| j.child.link == at).unwrap();
        at.clone_from(&joint.parent.link);
        path.push(joint);
    }
    path.reverse();
    path
}

pub fn moves(joint: &Joint) -> bool {
    joint.joint_type != JointType::Fixed
}

/// The last link in the first at joint values.
pub fn pose(robot: &Robot, base: &str, tip: &str, q: &[f64]) -> Matrix4<f64> {
    let mut q = q.iter();
    let mut out = Matrix4::identity();
    for joint in path(robot, base, tip) {
        out *= frame(*joint.origin.xyz, *joint.origin.rpy);
        let axis = Unit::new_normalize(Vector3::from(*joint.axis.xyz));
        out *= match joint.joint_type {
            JointType::Fixed => Matrix4::identity(),
            JointType::Prismatic => {
                Translation3::from(axis.scale(*q.next().unwrap())).to_homogeneous()
            }
            _ => Rotation3::from_axis_angle(&axis, *q.next().unwrap()).to_homogeneous(),
        };
    }
    assert!(q.next().is_none(), "a value too many");
    out
}

/// Largest difference of the entries.
pub fn apart(a: &Matrix4<f64>, b: &Matrix4<f64>) -> f64 {
    (a - b).amax()
}
