//! truearm and the peers in Rust on one arm. Arguments: folder of the files that
//! `cargo xtask peers` wrote, and whether to check (`check`) or to time (`time`).

use std::hint::black_box;
use std::time::{Duration, Instant};

use k::nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use k::{JointType, NodeBuilder, SerialChain};
use rs_opw_kinematics::kinematic_traits::Kinematics;
use rs_opw_kinematics::kinematics_impl::OPWKinematics;
use rs_opw_kinematics::parameters::opw_kinematics::Parameters;
use truearm::{Chain, Link, Pose, Scalar};
use truearm_batch::{BatchChain, Lanes, Poses, Positions};

type Joints = [f64; 6];

fn numbers<const N: usize>(folder: &str, name: &str) -> Vec<[f64; N]> {
    let text = std::fs::read_to_string(format!("{folder}/{name}")).expect("a file of xtask");
    let all: Vec<f64> = text.split_whitespace().map(|word| word.parse().expect(word)).collect();
    all.chunks_exact(N).map(|row| row.try_into().expect("a row")).collect()
}

/// The arm by its links; the tool is what `arm.txt` has last, less the last link.
fn chain<T: Scalar>(links: &[[f64; 5]], tool: &[f64; 3]) -> Chain<T, 6> {
    let links: Vec<Link<T>> = links
        .iter()
        .map(|link| {
            let [alpha, a, theta, d, beta] = link.map(T::from_f64);
            Link::revolute(alpha, a, theta, d, beta)
        })
        .collect();
    let [x, y, z] = tool.map(T::from_f64);
    Chain::new(&links.try_into().expect("six links"), Pose::identity(), Pose::translation(x, y, z))
}

fn peer_k(arm: &[[f64; 12]]) -> SerialChain<f64> {
    let nodes: Vec<_> = arm
        .iter()
        .enumerate()
        .map(|(index, m)| {
            let turn = Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
            let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
            let origin = Isometry3::from_parts(Translation3::new(m[3], m[7], m[11]), turn);
            let joint = match index {
                6 => JointType::Fixed,
                _ => JointType::Rotational { axis: Vector3::z_axis() },
            };
            NodeBuilder::new().name(&index.to_string()).joint_type(joint).origin(origin).into_node()
        })
        .collect();
    for pair in nodes.windows(2) {
        pair[1].set_parent(&pair[0]);
    }
    SerialChain::new_unchecked(k::Chain::from_root(nodes[0].clone()))
}

/// An arm with spherical wrist: rs-opw-kinematics knows no other. By its parameters
/// and by MD-H links.
fn with_wrist() -> (OPWKinematics, Chain<f64, 6>) {
    let quarter = core::f64::consts::FRAC_PI_2;
    let [a1, a2, b, c1, c2, c3, c4] = [0.15, -0.11, 0.02, 0.45, 0.6, 0.64, 0.1];
    let offsets = [0.0; 6];
    let sign_corrections = [1; 6];
    let parameters = Parameters { a1, a2, b, c1, c2, c3, c4, offsets, sign_corrections, dof: 6 };
    let links = [
        Link::revolute(0.0, 0.0, 0.0, c1, 0.0),
        Link::revolute(-quarter, a1, -quarter, b, 0.0),
        Link::revolute(0.0, c2, quarter, 0.0, 0.0),
        Link::revolute(quarter, a2, 0.0, c3, 0.0),
        Link::revolute(-quarter, 0.0, 0.0, 0.0, 0.0),
        Link::revolute(quarter, 0.0, 0.0, c4, 0.0),
    ];
    let identity = Pose::identity();
    (OPWKinematics::new(parameters), Chain::new(&links, identity, identity))
}

fn deviation(peer: &str, points: impl Iterator<Item = [f64; 3]>, expected: &[[f64; 3]]) {
    let worst = points.zip(expected).fold(0.0, |worst: f64, (point, expected)| {
        point.iter().zip(expected).fold(worst, |worst, (a, b)| worst.max((a - b).abs()))
    });
    println!("deviation {peer} {worst:.3e}");
}

fn time(what: &str, poses: usize, mut run: impl FnMut()) {
    let (start, mut passes) = (Instant::now(), 0_u32);
    while start.elapsed() < Duration::from_millis(10) {
        run();
        passes += 1;
    }
    let passed = start.elapsed().as_secs_f64() * 1e9;
    println!("time {what} {:.9}", passed / f64::from(passes) / poses as f64);
}

fn each<R>(what: &str, poses: &[Joints], mut run: impl FnMut(&Joints) -> R) {
    time(what, poses.len(), || {
        for q in black_box(poses) {
            // By reference: large results are not to be copied.
            black_box(&run(q));
        }
    });
}

/// All poses by [`BatchChain::poses`] into `out`: x, y, z, then the rotation.
fn batch<T: Lanes>(wide: &BatchChain<T>, q: &[Vec<T>], out: &mut [Vec<T>; 12]) {
    let q: Vec<&[T]> = q.iter().map(|q| &q[..]).collect();
    let [x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz] = out.each_mut().map(|out| &mut out[..]);
    let rotation = [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]];
    let poses = Poses { positions: Positions { x, y, z }, rotation };
    wide.poses(black_box(&q), poses).expect("shapes");
}

fn batches<T: Lanes>(name: &str, chain: &Chain<T, 6>, poses: &[Joints], check: bool) {
    let wide = BatchChain::of(chain);
    let q: Vec<Vec<T>> =
        (0..6).map(|j| poses.iter().map(|q| T::from_f64(q[j])).collect()).collect();
    let mut out = [(); 12].map(|()| vec![T::ZERO; poses.len()]);
    if check {
        let single = |q: &Joints| chain.forward(&q.map(T::from_f64)).translation;
        let expected: Vec<_> = poses.iter().map(|q| single(q).data.0[0].map(T::to_f64)).collect();
        batch(&wide, &q, &mut out);
        let [x, y, z, ..] = &out;
        let points = (0..poses.len()).map(|k| [x[k].to_f64(), y[k].to_f64(), z[k].to_f64()]);
        deviation(&format!("truearm-batch-{name}"), points, &expected);
    } else {
        let what = format!("truearm batch-{name}");
        time(&what, poses.len(), || batch(&wide, &q, black_box(&mut out)));
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, folder, what] = &arguments[..] else { panic!("peers FOLDER check|time") };
    let (links, arm) = (numbers::<5>(folder, "links.txt"), numbers::<12>(folder, "arm.txt"));
    let (poses, tool) = (numbers::<6>(folder, "poses.txt"), numbers::<3>(folder, "tool.txt")[0]);
    let (double, single) = (chain::<f64>(&links, &tool), chain::<f32>(&links, &tool));
    let (peer, (opw, wrist)) = (peer_k(&arm), with_wrist());
    let by_k = |q: &Joints| {
        peer.set_joint_positions_unchecked(q);
        peer.end_transform()
    };
    let check = what == "check";
    batches("f64", &double, &poses, check);
    batches("f32", &single, &poses, check);
    if check {
        let point = |q: &Joints| double.forward(q).translation.data.0[0];
        deviation("truearm", poses.iter().map(point), &numbers(folder, "positions.txt"));
        let points = poses.iter().map(|q| by_k(q).translation.vector.data.0[0]);
        deviation("k", points, &numbers(folder, "positions.txt"));
        let expected: Vec<_> =
            poses.iter().map(|q| wrist.forward(q).translation.data.0[0]).collect();
        let points = poses.iter().map(|q| opw.forward(q).translation.to_array());
        deviation("rs-opw-kinematics", points, &expected);
        return;
    }
    let narrow: Vec<[f32; 6]> = poses.iter().map(|q| q.map(|q| q as f32)).collect();
    each("truearm forward", &poses, |q| double.forward(q));
    time("truearm forward-f32", poses.len(), || {
        for q in black_box(&narrow) {
            black_box(&single.forward(q));
        }
    });
    each("truearm jacobian", &poses, |q| double.jacobian(q));
    let turns = double.link_turns();
    each("truearm columns", &poses, |q| double.identification_jacobian_with(&turns, q));
    each("truearm wrist", &poses, |q| wrist.forward(q));
    each("k forward", &poses, by_k);
    each("k jacobian", &poses, |q| {
        peer.set_joint_positions_unchecked(q);
        k::jacobian(&peer)
    });
    each("rs-opw-kinematics wrist", &poses, |q| opw.forward(q));
}
