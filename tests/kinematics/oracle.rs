//! Kinematics against an independent oracle: dual numbers through Eq. 1.

use crate::common::{self, forward, puma, scara, ur10};
use nalgebra::{Matrix3, Vector3};
use num_dual::Dual64;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::{Chain, JointKind, Link, Pose};

const TOOL: [f64; 3] = [0.05, -0.03, 0.12];

fn base() -> Pose<f64> {
    Pose::from_rotation_vector(Vector3::new(0.3, -1.2, 0.4), Vector3::new(0.4, -0.7, 1.9))
}

fn rows(pose: &Pose<f64>) -> common::Matrix<f64> {
    let mut m = common::identity();
    for i in 0..3 {
        for j in 0..3 {
            m[i][j] = pose.rotation[(i, j)];
        }
        m[i][3] = pose.translation[i];
    }
    m
}

fn joints<const N: usize>(rng: &mut ChaCha8Rng, links: &[Link<f64>; N]) -> [f64; N] {
    links.map(|link| match link.kind {
        JointKind::Revolute => rng.random_range(-6.2..6.2),
        JointKind::Prismatic => rng.random_range(-0.2..0.3),
    })
}

/// Largest relative error of the analytic Jacobians over 200 poses.
fn jacobian_error<const N: usize>(links: &[Link<f64>; N]) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let chain = Chain::new(links, base(), Pose::translation(TOOL[0], TOOL[1], TOOL[2]));
    let kinds = links.map(|l| l.kind);
    let mut values: Vec<f64> = links.iter().flat_map(|l| l.parameters.to_array()).collect();
    values.extend([0.0; 6]);
    values.extend(TOOL);
    let mut worst = 0.0_f64;
    for _ in 0..200 {
        let q = joints(&mut rng, links);
        let analytic = chain.identification_jacobian(&q);
        assert_eq!(analytic, chain.identification_jacobian_with(&chain.link_turns(), &q));
        let mut columns: Vec<Vector3<f64>> = Vec::new();
        for link in &analytic.links {
            columns.extend([link.alpha, link.a, link.theta, link.d, link.beta]);
        }
        columns.extend(analytic.base_rotation);
        columns.extend(analytic.base_translation);
        columns.extend(analytic.tool);
        assert_eq!(columns.len(), values.len());
        let scale = columns.iter().map(|c| c.norm()).fold(0.0, f64::max);
        for (k, column) in columns.iter().enumerate() {
            let x: Vec<Dual64> = (0..values.len())
                .map(|j| Dual64::new(values[j], if j == k { 1.0 } else { 0.0 }))
                .collect();
            let exact = forward(&kinds, &rows(&base()), &x, &q);
            for i in 0..3 {
                worst = worst.max((exact[i][3].eps - column[i]).abs() / scale);
                worst = worst.max((exact[i][3].re - analytic.point[i]).abs() / scale);
            }
        }
        let pose = chain.forward(&q);
        let exact = forward(&kinds, &rows(&base()), &values, &q);
        for i in 0..3 {
            for j in 0..3 {
                worst = worst.max((exact[i][j] - pose.rotation[(i, j)]).abs());
            }
            worst = worst.max((exact[i][3] - pose.translation[i]).abs() / scale);
        }
    }
    worst
}

#[test]
fn identification_jacobian_agrees_with_dual_numbers() {
    for (name, error) in [
        ("UR10, parallel axes", jacobian_error(&ur10())),
        ("spherical wrist", jacobian_error(&puma())),
        ("SCARA, prismatic", jacobian_error(&scara())),
    ] {
        println!("{name}: relative error {error:.1e}");
        assert!(error < 1e-12, "{name}: {error:e}");
    }
}

#[test]
fn identification_jacobian_agrees_with_finite_differences() {
    let links = ur10();
    let tool = Pose::translation(TOOL[0], TOOL[1], TOOL[2]);
    let q = [0.3, -1.1, 0.8, 2.0, -0.4, 1.0];
    let analytic = Chain::new(&links, base(), tool).identification_jacobian(&q);
    let h = 1e-6;
    for i in 0..6 {
        for (k, parameter) in truearm::LinkParameter::ALL.into_iter().enumerate() {
            let moved = |step: f64| {
                let mut correction = [0.0; 5];
                correction[k] = step;
                let mut links = links;
                links[i] = links[i].corrected(&truearm::MdhParameters::from_array(correction));
                Chain::new(&links, base(), tool).forward(&q).translation
            };
            let difference = (moved(h) - moved(-h)) / (2.0 * h);
            let error = (difference - analytic.links[i].get(parameter)).norm();
            assert!(error < 1e-8, "joint {} {}: {error:e}", i + 1, parameter.name());
        }
    }
}

#[test]
fn geometric_jacobian_is_the_velocity_of_the_tool() {
    fn check<const N: usize>(links: &[Link<f64>; N]) {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let tool = Pose::from_rotation_vector(Vector3::from(TOOL), Vector3::new(0.2, 0.5, -0.3));
        let chain = Chain::new(links, base(), tool);
        for _ in 0..50 {
            let q = joints(&mut rng, links);
            let jacobian = chain.jacobian(&q);
            let pose = chain.forward(&q);
            assert!((pose.translation - jacobian.pose.translation).norm() < 1e-13);
            assert!((pose.rotation - jacobian.pose.rotation).norm() < 1e-13);
            for (j, column) in jacobian.columns.iter().enumerate() {
                let h = 1e-6;
                let at = |step: f64| {
                    let mut moved = q;
                    moved[j] += step;
                    chain.forward(&moved)
                };
                let linear = (at(h).translation - at(-h).translation) / (2.0 * h);
                let spin = (at(h).rotation - at(-h).rotation) / (2.0 * h);
                let spin: Matrix3<f64> = spin * pose.rotation.transpose();
                let angular = Vector3::new(spin[(2, 1)], spin[(0, 2)], spin[(1, 0)]);
                assert!((linear - column.linear).norm() < 1e-8);
                assert!((angular - column.angular).norm() < 1e-8);
            }
        }
    }
    check(&ur10());
    check(&scara());
}

/// The paper's Eq. 2 against the product of Eq. 1: all entries agree but (3,1)
/// and (3,4), which are misprints.
#[test]
fn printed_equation_2_has_two_wrong_entries() {
    let [alpha, a, theta, d, beta] = [0.4, 0.3, 1.1, 0.2, 0.7];
    let exact = common::link(JointKind::Revolute, [alpha, a, theta, d, beta], 0.0);
    let ((sa, ca), (st, ct)) = (f64::sin_cos(alpha), f64::sin_cos(theta));
    let (sb, cb) = f64::sin_cos(beta);
    let printed = [
        [ct * cb, -st, ct * sb, a],
        [sa * sb + st * ca * cb, ct * ca, ca * sb * st - cb * sa, -d * sa],
        [sa * cb * st - ca * cb, ct * sa, sa * sb * st + cb * ca, d * sa],
    ];
    let mut wrong = Vec::new();
    for i in 0..3 {
        for j in 0..4 {
            if (printed[i][j] - exact[i][j]).abs() > 1e-12 {
                wrong.push((i + 1, j + 1));
            }
        }
    }
    assert_eq!(wrong, [(3, 1), (3, 4)]);
    assert!((exact[2][0] - (sa * cb * st - ca * sb)).abs() < 1e-15);
    assert!((exact[2][3] - d * ca).abs() < 1e-15);
}

/// 1e5 poses of a 1 m arm, and of a larger one whose joint offsets are not
/// zero: there `q + theta` is rounded as well.
#[test]
fn single_precision_stays_within_a_micrometre() {
    for (name, arm) in [("1 m arm", puma()), ("corrected UR10, 1.3 m", ur10())] {
        let exact = Chain::new(&arm, Pose::identity(), Pose::translation(0.0, 0.0, 0.05));
        let single = arm.map(|l| {
            let rounded = l.parameters.to_array().map(|x| x as f32);
            Link { kind: l.kind, parameters: truearm::MdhParameters::from_array(rounded) }
        });
        let single = Chain::new(&single, Pose::identity(), Pose::translation(0.0, 0.0, 0.05_f32));
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let (mut worst, mut sum) = (0.0_f64, 0.0);
        let poses = 100_000;
        for _ in 0..poses {
            let q: [f32; 6] = core::array::from_fn(|_| {
                rng.random_range(-core::f32::consts::TAU..core::f32::consts::TAU)
            });
            let expected = exact.forward(&q.map(f64::from)).translation;
            let error = (single.forward(&q).translation.map(f64::from) - expected).norm() * 1e6;
            worst = worst.max(error);
            sum += error;
        }
        println!("{name}: f32 forward mean {:.3} um, max {worst:.3} um", sum / f64::from(poses));
        assert!(worst < 1.0, "{name}: {worst} um");
    }
}

#[test]
fn poses_compose_and_invert() {
    let a = base();
    let b =
        Pose::from_rotation_vector(Vector3::new(0.1, 0.2, 0.3), Vector3::new(1e-3, 2e-3, -5e-3));
    let p = Vector3::new(0.4, 0.5, -0.6);
    let round = a.compose(&b).inverse().transform_point(&a.transform_point(&b.transform_point(&p)));
    assert!((round - p).norm() < 1e-15);
    let i = a.rotation * a.rotation.transpose();
    assert!((i - Matrix3::identity()).norm() < 1e-15);
    // Both branches of Rodrigues' formula meet.
    for angle in [0.0099999, 0.0100001] {
        let w = Vector3::new(0.6, 0.0, 0.8) * angle;
        let r = Pose::from_rotation_vector(p, w).rotation;
        let exact = nalgebra::Rotation3::from_scaled_axis(w).into_inner();
        assert!((r - exact).norm() < 1e-15);
    }
}
