//! The paper's methods behind one interface.

use crate::simulated::{Truth, UR10_LIKE, rms, robot};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::evaluate::Reregister;
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Problem, Scaling, State, nominal_state};
use truearm_host::methods::{Frames, Kalman, Method, Task, all, compare};
use truearm_host::model::{Measurements, Robot};

const SIGMA: f64 = 2e-5;

fn drawn(seed: u64) -> (Robot, Measurements, Measurements) {
    let robot = robot(UR10_LIKE);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let truth = Truth::draw(&robot, 1, 1, &mut rng);
    let data = truth.parse(&truth.measure(52, SIGMA, &mut rng));
    let check = truth.parse(&truth.measure(200, 0.0, &mut rng));
    (robot, data, check)
}

fn with_task<T>(robot: &Robot, data: &Measurements, f: impl FnOnce(&Task) -> T) -> T {
    let problem = Problem::new(data, robot, Scaling::Prior);
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let first = register(data, &problem.nominal, robot.tool).unwrap();
    let start = nominal_state(&problem, &rows, &first).unwrap();
    f(&Task::new(&problem, start, &rows, Frames::Fitted))
}

/// All numbers of a state whose frames are near another's.
fn numbers(state: &State) -> Vec<f64> {
    let base = &state.bases[0];
    let links = state.links.iter().flat_map(|l| l.parameters.to_array());
    let frames = base.rotation.iter().chain(base.translation.iter());
    frames.chain(state.markers[0].iter()).copied().chain(links).collect()
}

/// The largest difference, in tolerances of 1 mm and 1 mrad.
fn apart(a: &State, b: &State) -> f64 {
    let pairs = numbers(a).into_iter().zip(numbers(b));
    pairs.map(|(a, b)| (a - b).abs() / 1e-3).fold(0.0, f64::max)
}

/// One batch solution with the filter's prior, by QR: never squared.
fn batch(task: &Task, filter: &Kalman) -> State {
    let (u, s) = task.system(task.start());
    let prior = filter.prior(task);
    let (m, n) = u.shape();
    let mut a = DMatrix::zeros(m + n, n);
    let mut b = DVector::zeros(m + n);
    a.rows_mut(0, m).copy_from(&(u / SIGMA));
    b.rows_mut(0, m).copy_from(&(s / SIGMA));
    for k in 0..n {
        a[(m + k, k)] = 1.0 / prior[k];
    }
    let qr = a.qr();
    let rhs = qr.q().tr_mul(&b);
    let step = qr.r().solve_upper_triangular(&rhs).unwrap();
    task.stepped(task.start(), &step).unwrap()
}

/// Same prior, one pass, one linearisation: the same answer. Linearised anew at
/// every point it is another one, or the test compares nothing.
#[test]
fn kalman_filter_and_batch_agree_when_they_should() {
    for seed in 0..10 {
        let (robot, data, _) = drawn(seed);
        let robot = Robot { sigma: SIGMA, ..robot };
        with_task(&robot, &data, |task| {
            let filter = Kalman { relinearise: false, ..Kalman::default() };
            let expected = batch(task, &filter);
            let same = apart(&filter.solve(task).unwrap().state, &expected);
            let other = apart(&Kalman::default().solve(task).unwrap().state, &expected);
            println!("seed {seed}: {same:.1e} tolerances apart, relinearised {other:.1e}");
            assert!(same < 1e-6, "seed {seed}: {same:e}");
            assert!(other > 1e-4, "seed {seed}: {other:e}");
        });
    }
}

#[test]
fn every_method_is_compared() {
    let (robot, data, check) = drawn(100);
    let judge = Some((&check, Reregister::Nothing));
    let found = compare(&robot, &data, judge, Frames::Fitted, &all()).unwrap();
    assert_eq!(found.methods.len(), all().len());
    assert_eq!((found.parameters, found.rank), (39, 27));
    let nc = &found.methods[0];
    assert_eq!((nc.name, nc.correction_norm), ("NC", Some(0.0)));
    for o in &found.methods {
        // What is said of the validation file is what the state does on it.
        let (Some(state), Some(stats)) = (&o.state, &o.validation) else {
            assert!(o.failure.is_some(), "{}: neither a result nor a reason", o.name);
            continue;
        };
        let own = rms(&robot, state, &check) * 1e3;
        assert!((own - stats.rms_mm).abs() <= 1e-9 * own.max(1.0), "{}", o.name);
        let reduction = 100.0 * (1.0 - stats.mean_mm / nc.validation.unwrap().mean_mm);
        assert!(o.name == "NC" || (o.mae_reduction_percent.unwrap() - reduction).abs() < 1e-9);
    }
    let mae = |name: &str| {
        let of = found.methods.iter().find(|o| o.name == name).unwrap();
        of.validation.unwrap().mean_mm
    };
    // The damped and the regularised see the same arm to the noise.
    for name in ["LM", "EKF", "RPIM-P", "RPIM"] {
        println!("{name}: {:.4} mm", mae(name));
        assert!(mae(name) < 0.03, "{name}: {}", mae(name));
    }
    assert!(mae("GD") < mae("NC"));
}

/// Held frames leave out nine unknowns, and the report says so.
#[test]
fn frames_can_be_held() {
    let (robot, data, _) = drawn(101);
    let found = compare(&robot, &data, None, Frames::Held, &all()).unwrap();
    assert_eq!((found.parameters, found.frames), (30, "held"));
    let lm = found.methods.iter().find(|o| o.name == "LM").unwrap().state.clone().unwrap();
    let nc = found.methods[0].state.clone().unwrap();
    assert_eq!(lm.bases[0], nc.bases[0]);
    assert_eq!(lm.markers, nc.markers);
}
