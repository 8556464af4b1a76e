//! Gravity loads on a base that stands anyhow, against sums over the links in the frame of
//! the world: what is folded at load time must be what is not.

use nalgebra::Vector3;
use proptest::array::{uniform2, uniform3, uniform6};
use proptest::prelude::*;
use truearm::effects::Masses;
use truearm::{Chain, Link, MdhParameters, Pose, Scalar};

use crate::common::{self, Matrix, identity, product, puma, scara, ur10};

/// Gravity, a base, masses, centres of mass and joints of up to six links, the length and
/// twist before the first.
#[derive(Debug, Clone)]
struct Case {
    gravity: [f64; 3],
    base: [f64; 6],
    mass: [f64; 6],
    com: [[f64; 3]; 6],
    payload: f64,
    q: [f64; 6],
    first: [f64; 2],
}

fn case() -> impl Strategy<Value = Case> {
    let stands = (uniform3(-9.0..9.0), uniform6(-1.5..1.5), uniform2(-1.0..1.0));
    let links = (uniform6(0.0..15.0), uniform6(uniform3(-0.3..0.3)), uniform6(-6.2..6.2));
    (stands, links, 0.0..9.0).prop_map(|((gravity, base, first), (mass, com, q), payload)| Case {
        gravity,
        base,
        mass,
        com,
        payload,
        q,
        first,
    })
}

fn vector<T: Scalar>(v: [f64; 3]) -> Vector3<T> {
    Vector3::from(v.map(T::from_f64))
}

fn column(m: &Matrix<f64>, k: usize) -> Vector3<f64> {
    Vector3::new(m[0][k], m[1][k], m[2][k])
}

/// The torque of every joint and the moment about the base's x and y: each mass's weight
/// times its lever.
fn unfolded<const N: usize>(
    links: &[Link<f64>; N],
    base: &Matrix<f64>,
    case: &Case,
) -> ([f64; N], [f64; 2]) {
    let mut frame = *base;
    let frames: [Matrix<f64>; N] = core::array::from_fn(|i| {
        let link = common::link(links[i].kind, links[i].parameters.to_array(), case.q[i]);
        frame = product(&frame, &link);
        frame
    });
    let place = |m: &Matrix<f64>, p: [f64; 3]| {
        (0..3).map(|k| column(m, k) * p[k]).sum::<Vector3<f64>>() + column(m, 3)
    };
    let weights: Vec<_> = (0..N)
        .map(|i| (i, case.mass[i], place(&frames[i], case.com[i])))
        .chain([(N - 1, case.payload, place(&frames[N - 1], case.com[0]))])
        .collect();
    // Stated in the frame of the base.
    let gravity = (0..3).map(|k| column(base, k) * case.gravity[k]).sum::<Vector3<f64>>();
    let about = |axis: Vector3<f64>, origin: Vector3<f64>, from: usize| -> f64 {
        let carried = weights.iter().filter(|(link, ..)| *link >= from);
        carried.map(|(_, m, p)| axis.dot(&(p - origin).cross(&(gravity * *m)))).sum()
    };
    let torque = core::array::from_fn(|i| {
        // Joint i turns about z before its link's beta: that of the frame turned back by it.
        let [.., beta] = links[i].parameters.to_array();
        let joint = product(&frames[i], &common::rotation(1, -beta));
        if links[i].kind == truearm::JointKind::Prismatic {
            let carried = weights.iter().filter(|(link, ..)| *link >= i).map(|(_, m, _)| m);
            return column(&joint, 2).dot(&gravity) * carried.sum::<f64>();
        }
        about(column(&joint, 2), column(&joint, 3), i)
    });
    (torque, [0, 1].map(|axis| about(column(base, axis), column(base, 3), 0)))
}

/// Largest error, N m or N.
fn error<T: Scalar, const N: usize>(links: &[Link<f64>; N], case: &Case) -> f64 {
    let mut links = *links;
    [links[0].parameters.alpha, links[0].parameters.a] = case.first;
    let [a, b, c, x, y, z] = case.base;
    let pose = Pose::from_rotation_vector(vector::<f64>([x, y, z]), vector([a, b, c]));
    let mut base = identity();
    for i in 0..3 {
        (0..3).for_each(|j| base[i][j] = pose.rotation[(i, j)]);
        base[i][3] = pose.translation[i];
    }
    let (torque, moment) = unfolded(&links, &base, case);
    let folded = links.map(|link| Link {
        kind: link.kind,
        parameters: MdhParameters::from_array(link.parameters.to_array().map(T::from_f64)),
    });
    let pose = Pose::from_rotation_vector(vector([x, y, z]), vector([a, b, c]));
    let masses = Masses {
        gravity: vector(case.gravity),
        mass: core::array::from_fn(|i| T::from_f64(case.mass[i])),
        com: core::array::from_fn(|i| vector(case.com[i])),
        payload_com: vector(case.com[0]),
    };
    let q = core::array::from_fn(|i| T::from_f64(case.q[i]));
    let load =
        masses.load(&Chain::new(&folded, pose, Pose::identity()), &q, T::from_f64(case.payload));
    let folded = load.torque.iter().chain(&load.moment).map(|x| x.to_f64());
    folded.zip(torque.iter().chain(&moment)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn folded_loads_are_the_sums_over_the_links(case in case()) {
        for (name, single, double) in [
            ("UR10", error::<f32, 6>(&ur10(), &case), error::<f64, 6>(&ur10(), &case)),
            ("spherical wrist", error::<f32, 6>(&puma(), &case), error::<f64, 6>(&puma(), &case)),
            ("SCARA", error::<f32, 4>(&scara(), &case), error::<f64, 4>(&scara(), &case)),
        ] {
            // Of moments up to some thousand newton metres.
            prop_assert!(double < 1e-10 * 1e3, "{name}: {double:.1e} N m in f64");
            prop_assert!(single < 3e-6 * 1e3, "{name}: {single:.1e} N m in f32");
        }
    }
}
