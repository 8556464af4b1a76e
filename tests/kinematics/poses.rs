//! What is taken for a rigid transform where matrices come from outside.

use truearm::{Arm, Pose, Scalar};

use crate::arms::{stored, vector};
use crate::common::ur10;

fn rows<T: Scalar>(pose: &Pose<T>) -> [[T; 4]; 3] {
    let (r, t) = (&pose.rotation, &pose.translation);
    [0, 1, 2].map(|i| [r[(i, 0)], r[(i, 1)], r[(i, 2)], t[i]])
}

fn turned(x: f64, y: f64, z: f64) -> Pose<f64> {
    Pose::from_rotation_vector(vector([0.1, -0.05, 0.25]), vector([x, y, z]))
}

#[test]
fn a_rotation_and_a_translation_are_taken_as_they_are() {
    for turn in [[0.0; 3], [3.1, 0.2, -0.4], [-1.0, 2.0, 0.5]] {
        let pose = turned(turn[0], turn[1], turn[2]);
        let matrix = rows(&pose);
        assert_eq!(Pose::from_rows(&matrix), Some(pose));
        let single = matrix.map(|row| row.map(|value| value as f32));
        let pose = Pose::from_rows(&single).unwrap();
        assert_eq!(rows(&pose), single);
        // Typed from a drawing.
        let typed = matrix.map(|row| row.map(|value| (value * 1e5).round() / 1e5));
        assert!(Pose::from_rows(&typed).is_some());
    }
}

#[test]
fn any_other_matrix_is_none() {
    let good = rows(&turned(0.4, -0.2, 1.1));
    for (row, column) in (0..3).flat_map(|row| (0..4).map(move |column| (row, column))) {
        for wrong in [f64::NAN, f64::INFINITY] {
            let mut bad = good;
            bad[row][column] = wrong;
            assert_eq!(Pose::from_rows(&bad), None, "{row} {column}");
        }
    }
    let of = |change: fn([f64; 4]) -> [f64; 4]| Pose::from_rows(&good.map(change));
    assert!(of(|row| row).is_some());
    assert_eq!(of(|[x, y, z, t]| [-x, y, z, t]), None, "left-handed");
    assert_eq!(of(|[x, y, z, t]| [y, x, z, t]), None, "left-handed");
    assert_eq!(of(|[x, y, z, t]| [1e3 * x, 1e3 * y, 1e3 * z, t]), None, "in mm");
    assert_eq!(of(|[x, y, z, t]| [1.001 * x, y, z, t]), None, "scaled");
    assert_eq!(of(|[x, y, z, t]| [x, y + 1e-3 * x, z, t]), None, "skew");
    assert_eq!(of(|[_, _, _, t]| [0.0, 0.0, 0.0, t]), None, "none");
}

/// Why it is asked: a tool that is left-handed is another one to an arm.
#[test]
fn a_left_handed_tool_would_be_another_one() {
    let arm = Arm::new(&stored::<f64, 6>(ur10(), [0.0; 3]));
    let mut tool = Pose::translation(0.0, 0.0, 0.15);
    assert!(tool.is_rigid());
    // A third axis that leans by 2 mrad is at a right angle to nothing.
    let mut skewed = tool;
    skewed.rotation[(0, 2)] = 2e-3;
    assert!(!skewed.is_rigid());
    tool.rotation[(2, 2)] = -1.0;
    assert!(!tool.is_rigid());
    let q = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
    let turned = arm.with_tool(tool).real_pose(&q);
    assert_eq!(turned, arm.with_tool(Pose::translation(0.0, 0.0, 0.15)).real_pose(&q));
}
