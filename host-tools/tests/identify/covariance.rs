//! The uncertainty that a controller states: the same as the host's, and true.

use crate::simulated::{Truth, UR10_LIKE, robot};
use nalgebra::{Matrix3xX, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::Blob;
use truearm::{Arm6, Pose, RealPosition, State};
use truearm_host::blob::{PackOptions, pack_with};
use truearm_host::identify::rigid_transform;
use truearm_host::identify::{Options, identify};
use truearm_host::model::arm::{RowInputs, chain};
use truearm_host::model::{Measurements, Model};

const SIGMA: f64 = 2e-5;

/// The commanded frame, for a true arm: its tool points are carried onto those
/// of the nominal links with the blob's tool over the poses of the
/// identification.
fn frame(truth: &Truth, data: &Measurements, tool: Vector3<f64>) -> Pose<f64> {
    let points = |links: &[truearm::Link<f64>], tool| -> Vec<Vector3<f64>> {
        let arm = chain(links, Pose::identity(), tool);
        data.rows.iter().map(|row| arm.pose(&row.q).translation).collect()
    };
    let (real, nominal) = (&truth.links, truth.robot.nominal());
    let weights = vec![1.0; data.rows.len()];
    rigid_transform(&points(real, truth.tools[0]), &points(&nominal, tool), &weights).unwrap()
}

fn packed(model: &Model) -> Vec<u8> {
    // The covariance is that of the first marker.
    let model = model.clone().with_tool(&model.markers[0].0).unwrap();
    pack_with(&model, &PackOptions { covariance: true, ..PackOptions::default() }).unwrap()
}

fn pose(rng: &mut ChaCha8Rng) -> [f64; 6] {
    [(); 6].map(|()| rng.random_range(-2.6..2.6))
}

/// From the factor of the model and the host's own derivatives.
fn host_sigma(model: &Model, q: &[f64]) -> Vector3<f64> {
    let factor = model.covariance.as_deref().unwrap();
    let base = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let arm = chain(&model.links(), base, model.markers[0].1);
    let d = arm.derivatives(q, &[], &RowInputs::default());
    let [rx, ry, rz, tx, ty, tz] = d.base;
    let mut columns = vec![tx, ty, tz, rx, ry, rz];
    columns.extend(d.tool);
    columns.extend(d.links.iter().flat_map(|link| link.to_array()));
    let j = Matrix3xX::from_columns(&columns);
    let size = columns.len();
    let mut l = nalgebra::DMatrix::zeros(size, size);
    let mut numbers = factor.iter();
    for column in 0..size {
        for row in column..size {
            l[(row, column)] = f64::from(*numbers.next().unwrap());
        }
    }
    let product = j * l;
    Vector3::from_fn(|c, _| product.row(c).norm())
}

#[test]
fn the_controller_states_what_the_host_does() {
    let robot = robot(UR10_LIKE);
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let truth = Truth::draw(&robot, 2, 2, &mut rng);
    let data = truth.parse(&truth.measure(80, SIGMA, &mut rng));
    let model = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap().model;
    let bytes = packed(&model);
    let blob = Blob::check(&bytes).unwrap();
    let covariance = blob.covariance().unwrap();
    let arm: Arm6<f64> = Arm6::new(&blob.parameters().unwrap());
    let small: Arm6<f32> = Arm6::new(&blob.parameters().unwrap());
    let (mut worst, mut seen): (f64, _) = (0.0, [0; 2]);
    for _ in 0..500 {
        let q = pose(&mut rng);
        let sigma = covariance.point_sigma(&arm, &q, &State::at(20.0)).unwrap();
        let single =
            covariance.point_sigma(&small, &q.map(|x| x as f32), &State::at(20.0)).unwrap();
        let host = host_sigma(&model, &q);
        let all = RealPosition::with_sigma(&arm, &q, &State::at(20.0), &covariance).unwrap();
        assert_eq!(all.sigma, Some(sigma));
        assert_eq!(all.pose, arm.real_pose(&q));
        assert!(!all.orientation_identified);
        seen[usize::from(all.covered)] += 1;
        for c in 0..3 {
            assert!((sigma[c] / host[c] - 1.0).abs() < 1e-5, "{sigma:?} {host}");
            worst = worst.max((f64::from(single[c]) / host[c] - 1.0).abs());
        }
    }
    println!("controller in f32 against host in f64: {worst:.1e} relative at worst");
    assert!(worst < 1e-3);
    assert!(seen[0] > 0 && seen[1] > 0, "poses in and out of the covered ranges: {seen:?}");
    let none = RealPosition::of(&arm, &pose(&mut rng), &State::at(20.0));
    assert_eq!(none.sigma, None);
}

#[test]
fn the_stated_sigma_is_true() {
    let robot = robot(UR10_LIKE);
    let mut z = Vec::new();
    let (mut marker, mut production) = (Vec::new(), Vec::new());
    for seed in 0..60 {
        let mut rng = ChaCha8Rng::seed_from_u64(7000 + seed);
        let truth = Truth::draw(&robot, 1, 1, &mut rng);
        let data = truth.parse(&truth.measure(52, SIGMA, &mut rng));
        let model = identify(&robot, &data, &Options::default(), &|_, _| ()).unwrap().model;
        let bytes = packed(&model);
        let blob = Blob::check(&bytes).unwrap();
        let covariance = blob.covariance().unwrap();
        let arm: Arm6<f64> = Arm6::new(&blob.parameters().unwrap());
        let other = Pose::translation(0.0, 0.05, 0.2);
        let (frame, real) = (frame(&truth, &data, model.markers[0].1), |tool| {
            chain(&truth.links, Pose::identity(), tool)
        });
        for _ in 0..20 {
            let q = pose(&mut rng);
            let state = State::at(20.0);
            let off = |arm: &Arm6<f64>, tool: Vector3<f64>| {
                let seen = frame.transform_point(&real(tool).pose(&q).translation);
                let sigma = covariance.point_sigma(arm, &q, &state).unwrap();
                let error = arm.real_pose(&q).translation - seen;
                [0, 1, 2].map(|c| (error[c] / sigma[c], sigma[c]))
            };
            for (ratio, sigma) in off(&arm, truth.tools[0]) {
                z.push(ratio);
                marker.push(sigma);
            }
            for (ratio, sigma) in off(&arm.with_tool(other), other.translation) {
                production.push((ratio, sigma));
            }
        }
    }
    let within = |k: f64| z.iter().filter(|z| z.abs() < k).count() as f64 / z.len() as f64;
    let chi = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
    let other = production.iter().map(|(z, _)| z * z).sum::<f64>() / production.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let wide = mean(&production.iter().map(|(_, s)| *s).collect::<Vec<_>>());
    println!(
        "{} coordinates, 60 arms: mean z^2 {chi:.3}; {:.3} within one sigma, {:.3} within two; \
         sigma {:.1} um; of a production tool: mean z^2 {other:.3}, sigma {:.1} um",
        z.len(),
        within(1.0),
        within(2.0),
        mean(&marker) * 1e6,
        wide * 1e6
    );
    assert!((0.85..1.15).contains(&chi), "{chi}");
    assert!((0.65..0.72).contains(&within(1.0)) && (0.93..0.97).contains(&within(2.0)));
    assert!((0.7..1.3).contains(&other), "{other}");
}
