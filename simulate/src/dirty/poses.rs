//! Poses as people choose them.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use truearm::JointKind;

use crate::oracle::{self, Matrix};
use crate::{Robot, vector};

/// How poses are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Anywhere within a part of each joint's range.
    Anywhere,
    /// A grid in joint space, few values a joint.
    Grid,
    /// The corners and insides of a cube, the hand held nearly the same way.
    Cube,
    /// A few places, the hand turned about the target at each.
    Cones,
    /// One joint after another from a home pose.
    Sweeps,
}

const STYLES: [(Style, u32); 5] = [
    (Style::Anywhere, 5),
    (Style::Grid, 2),
    (Style::Cube, 3),
    (Style::Cones, 2),
    (Style::Sweeps, 1),
];

/// So many poses in a style of their own, joint values as a file writes them.
///
/// # Panics
/// Never: the styles have weights.
pub fn draw(robot: &Robot, count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let mut at = rng.random_range(0..STYLES.iter().map(|s| s.1).sum::<u32>());
    let mut style = Style::Anywhere;
    for (kind, weight) in STYLES {
        if at < weight {
            style = kind;
            break;
        }
        at -= weight;
    }
    of_style(style, robot, count, rng)
}

/// The same in a given style.
pub fn of_style(style: Style, robot: &Robot, count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let ranges = ranges(robot, rng);
    let mut out = match style {
        Style::Anywhere => anywhere(&ranges, count, rng),
        Style::Grid => grid(&ranges, count, rng),
        Style::Cube => cube(robot, &ranges, count, rng),
        Style::Cones => cones(robot, &ranges, count, rng),
        Style::Sweeps => sweeps(&ranges, count, rng),
    };
    // What a style has no room for is anywhere.
    while out.len() < count {
        out.extend(anywhere(&ranges, count - out.len(), rng));
    }
    out.truncate(count);
    for pose in &mut out {
        for (q, joint) in pose.iter_mut().zip(&robot.joints) {
            *q = match joint.kind {
                JointKind::Revolute => ((q.to_degrees() * 1e4).round() / 1e4).to_radians(),
                JointKind::Prismatic => (*q * 1e7).round() / 1e7,
            };
        }
    }
    out
}

/// The part of each joint's range that is used: from 10 degrees (or a tenth) to
/// all of it.
fn ranges(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<[f64; 2]> {
    let all = rng.random_bool(0.4);
    let part = |joint: &crate::Joint| {
        let [low, high] = joint.limits.unwrap_or([-1.0, 1.0]);
        let width = high - low;
        let least = match joint.kind {
            JointKind::Revolute => 10_f64.to_radians() / width,
            JointKind::Prismatic => 0.1,
        };
        let share = if all { 1.0 } else { least.powf(rng.random_range(0.0..1.0)) };
        let first = low + width * (1.0 - share) * rng.random_range(0.0..=1.0);
        [first, first + width * share]
    };
    robot.joints.iter().map(part).collect()
}

fn anywhere(ranges: &[[f64; 2]], count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let pose = |_| ranges.iter().map(|[low, high]| rng.random_range(*low..=*high)).collect();
    (0..count).map(pose).collect()
}

fn grid(ranges: &[[f64; 2]], count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let levels: Vec<usize> = ranges.iter().map(|_| rng.random_range(2..=5)).collect();
    let place = |[low, high]: [f64; 2], k: usize, of: usize| {
        low + (high - low) * (k as f64 + 0.5) / of as f64
    };
    let pose = |_| {
        let levels = ranges.iter().zip(&levels);
        levels.map(|(range, of)| place(*range, rng.random_range(0..*of), *of)).collect()
    };
    (0..count).map(pose).collect()
}

fn sweeps(ranges: &[[f64; 2]], count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let mut out = Vec::with_capacity(count);
    let each = (count / ranges.len() / 2).max(2);
    while out.len() < count {
        let home = anywhere(ranges, 1, rng).remove(0);
        for (joint, [low, high]) in ranges.iter().enumerate() {
            for k in 0..each {
                let mut pose = home.clone();
                pose[joint] = low + (high - low) * k as f64 / (each - 1) as f64;
                out.push(pose);
            }
        }
    }
    out
}

fn cones(robot: &Robot, ranges: &[[f64; 2]], count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let places = rng.random_range(3..=12).min(count);
    let mut out = Vec::new();
    for _ in 0..places {
        let home = anywhere(ranges, 1, rng).remove(0);
        let at = forward(robot, &home);
        let width = rng.random_range(5.0..30.0_f64).to_radians();
        for _ in 0..count.div_ceil(places) {
            let turn = Rotation3::from_scaled_axis(vector(rng).normalize() * width);
            out.extend(reach(robot, &home, &turned(&at, &turn, Vector3::zeros())));
        }
    }
    out
}

fn cube(robot: &Robot, ranges: &[[f64; 2]], count: usize, rng: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let home = anywhere(ranges, 1, rng).remove(0);
    let at = forward(robot, &home);
    let edge = rng.random_range(0.2..0.7);
    let swing = [0.0, 5.0, 20.0][rng.random_range(0..3)] * 1_f64.to_radians();
    let side = (2..).find(|side| side * side * side >= count).unwrap_or(2);
    let mut places: Vec<usize> = (0..side * side * side).collect();
    places.shuffle(rng);
    let mut out = Vec::new();
    for place in places.into_iter().take(count) {
        let index = [place % side, place / side % side, place / side / side];
        let shift = index.map(|k| edge * (k as f64 / (side - 1) as f64 - 0.5));
        let turn = Rotation3::from_scaled_axis(vector(rng) * swing);
        out.extend(reach(robot, &home, &turned(&at, &turn, Vector3::from(shift))));
    }
    out
}

fn forward(robot: &Robot, q: &[f64]) -> Matrix<f64> {
    let mut m = oracle::identity();
    for (joint, q) in robot.joints.iter().zip(q) {
        m = oracle::product(&m, &oracle::link(joint.kind, joint.link, *q));
    }
    oracle::product(&m, &oracle::translation(robot.tool.into()))
}

fn turned(at: &Matrix<f64>, turn: &Rotation3<f64>, shift: Vector3<f64>) -> Matrix<f64> {
    let mut out = *at;
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = (0..3).map(|k| turn[(i, k)] * at[k][j]).sum();
        }
        out[i][3] = at[i][3] + shift[i];
    }
    out
}

/// Joints at which the nominal arm is at `wanted`, near `from` and within limits
/// (damped least squares on difference quotients).
fn reach(robot: &Robot, from: &[f64], wanted: &Matrix<f64>) -> Option<Vec<f64>> {
    let n = from.len();
    let mut q = from.to_vec();
    for _ in 0..40 {
        let now = forward(robot, &q);
        let left = apart(&now, wanted);
        if left.norm() < 1e-6 {
            let inside = |(q, joint): (&f64, &crate::Joint)| {
                joint.limits.is_none_or(|[low, high]| (low..=high).contains(q))
            };
            return q.iter().zip(&robot.joints).all(inside).then_some(q);
        }
        let mut jacobian = DMatrix::zeros(6, n);
        for j in 0..n {
            let mut moved = q.clone();
            moved[j] += 1e-6;
            let column = (apart(&now, wanted) - apart(&forward(robot, &moved), wanted)) / 1e-6;
            jacobian.set_column(j, &column);
        }
        let square = &jacobian * jacobian.transpose() + DMatrix::identity(6, 6) * 1e-5;
        let step = jacobian.transpose() * square.cholesky()?.solve(&left);
        let most = step.amax().max(0.3);
        q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q += step * 0.3 / most);
    }
    None
}

/// Position and small rotation from one frame to another.
fn apart(a: &Matrix<f64>, b: &Matrix<f64>) -> DVector<f64> {
    let mut out = DVector::zeros(6);
    for i in 0..3 {
        out[i] = b[i][3] - a[i][3];
    }
    // Half the sum of cross products of the axes.
    for k in 0..3 {
        let axis = |m: &Matrix<f64>| Vector3::new(m[0][k], m[1][k], m[2][k]);
        let cross = axis(a).cross(&axis(b)) / 2.0;
        (0..3).for_each(|i| out[3 + i] += cross[i]);
    }
    out
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    fn robot() -> Robot {
        let joint = |link: [f64; 5]| crate::Joint {
            kind: JointKind::Revolute,
            link,
            limits: Some([-2.9, 2.9]),
            gear_ratio: None,
        };
        let half = std::f64::consts::FRAC_PI_2;
        Robot {
            joints: [
                [0.0, 0.0, 0.0, 0.35, 0.0],
                [-half, 0.07, -half, 0.0, 0.0],
                [0.0, 0.36, 0.0, 0.0, 0.0],
                [-half, 0.0, 0.0, 0.38, 0.0],
                [half, 0.0, 0.0, 0.0, 0.0],
                [-half, 0.0, 0.0, 0.065, 0.0],
            ]
            .map(joint)
            .to_vec(),
            masses: Vec::new(),
            gravity: None,
            tool: Vector3::new(0.05, 0.0, 0.1),
        }
    }

    #[test]
    fn every_style_gives_as_many_poses_within_limits() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for (style, _) in STYLES {
            for count in [20, 137] {
                let poses = of_style(style, &robot(), count, &mut rng);
                assert_eq!(poses.len(), count, "{style:?}");
                let inside = |q: &f64| (-2.9001..2.9001).contains(q);
                assert!(poses.iter().flatten().all(inside), "{style:?}");
            }
        }
    }

    #[test]
    fn the_arm_gets_to_where_it_is_sent() {
        let robot = robot();
        let from = [0.3, -0.4, 0.5, 0.2, 0.9, -0.3];
        let turn = Rotation3::from_scaled_axis(Vector3::new(0.1, -0.05, 0.2));
        let wanted = turned(&forward(&robot, &from), &turn, Vector3::new(0.05, -0.03, 0.04));
        let q = reach(&robot, &from, &wanted).expect("within reach");
        assert!(apart(&forward(&robot, &q), &wanted).norm() < 1e-6);
    }
}
