//! `cargo xtask bench`: times of a pose, as ratios to the scalar path of the same run.
//!
//! All ways take turns, round after round, so that a machine that others use
//! slows all of them; least and median of the rounds are printed.

use std::hint::black_box;
use std::time::{Duration, Instant};

use truearm::{Chain, Link, Pose, Scalar};
use truearm_batch::{BatchChain, Cpu, Lanes, Poses, Positions};

/// Poses a batch: what fits into a second-level cache with its results.
const POSES: usize = 1024;
const ROUNDS: usize = 25;
const ROUND: Duration = Duration::from_millis(4);

#[path = "../../../tests/common/ur10.rs"]
mod ur10;

/// The arm that is timed.
fn links<T: Scalar>() -> [Link<T>; 6] {
    ur10::UR10.map(|link| {
        let [alpha, a, theta, d, beta] = link.map(T::from_f64);
        Link::revolute(alpha, a, theta, d, beta)
    })
}

fn chain<T: Scalar>() -> Chain<T, 6> {
    let tool = Pose::translation(0.05, -0.03, 0.12).map_to::<T>();
    Chain::new(&links(), Pose::identity(), tool)
}

/// Poses of other number types.
trait MapTo {
    fn map_to<T: Scalar>(&self) -> Pose<T>;
}

impl MapTo for Pose<f64> {
    fn map_to<T: Scalar>(&self) -> Pose<T> {
        let [[x, y, z]] = self.translation.data.0;
        Pose::translation(T::from_f64(x), T::from_f64(y), T::from_f64(z))
    }
}

/// Joint values spread over a turn, without pattern: fractions of multiples of roots.
fn joints<T: Scalar>() -> Vec<[T; 6]> {
    let pose = |k: usize| {
        [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0].map(|prime| {
            T::from_f64(((k as f64 * prime.sqrt()).fract() - 0.5) * core::f64::consts::TAU)
        })
    };
    (1..=POSES).map(pose).collect()
}

/// A way to compute all poses once.
struct Way {
    name: String,
    run: Box<dyn FnMut()>,
    /// Nanoseconds a pose, a round each.
    times: Vec<f64>,
}

fn way(name: &str, run: impl FnMut() + 'static) -> Way {
    Way { name: name.to_owned(), run: Box::new(run), times: Vec::new() }
}

impl Way {
    fn round(&mut self) {
        let (start, mut passes) = (Instant::now(), 0_u32);
        while start.elapsed() < ROUND {
            (self.run)();
            passes += 1;
        }
        let passed = start.elapsed().as_secs_f64() * 1e9;
        self.times.push(passed / f64::from(passes) / POSES as f64);
    }

    /// Least and median.
    fn figures(&self) -> [f64; 2] {
        let mut times = self.times.clone();
        times.sort_by(f64::total_cmp);
        [times[0], times[times.len() / 2]]
    }
}

fn single<T: Scalar>(name: &str) -> Way {
    let (chain, q) = (chain::<T>(), joints::<T>());
    way(&format!("{name}, pose by pose"), move || {
        for q in black_box(&q) {
            black_box(&chain.forward(q));
        }
    })
}

/// Poses, or points only, of a batch.
fn batches<T: Lanes>(name: &str, cpu: Cpu) -> [Way; 2] {
    batches_at(name, cpu, joints::<T>())
}

/// The same at these joint values.
fn batches_at<T: Lanes>(name: &str, cpu: Cpu, all: Vec<[T; 6]>) -> [Way; 2] {
    let chain = BatchChain::of(&chain::<T>()).on(cpu);
    let wide = chain.clone();
    let q: [Vec<T>; 6] = core::array::from_fn(|j| all.iter().map(|q| q[j]).collect());
    let columns = q.clone();
    let mut out = [(); 12].map(|()| vec![T::ZERO; POSES]);
    let mut points = [(); 3].map(|()| vec![T::ZERO; POSES]);
    let poses = move || {
        let [x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz] = out.each_mut().map(|out| &mut out[..]);
        let rotation = [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]];
        let q = black_box(&q).each_ref().map(|q| &q[..]);
        let done = wide.poses(&q, Poses { positions: Positions { x, y, z }, rotation });
        assert!(black_box(done).is_ok());
    };
    let positions = move || {
        let [x, y, z] = points.each_mut().map(|out| &mut out[..]);
        let q = black_box(&columns).each_ref().map(|q| &q[..]);
        let done = chain.positions(&q, Positions { x, y, z });
        assert!(black_box(done).is_ok());
    };
    [
        way(&format!("{name}, batch, {cpu}"), poses),
        way(&format!("{name}, batch of points, {cpu}"), positions),
    ]
}

fn ways() -> Vec<Way> {
    let (q, columns) = (joints::<f64>(), joints::<f64>());
    let mut ways = vec![single::<f64>("f64"), single::<f32>("f32")];
    ways.push(way("f64, with Jacobian", move || {
        let chain = chain::<f64>();
        for q in black_box(&q) {
            black_box(&chain.jacobian(q));
        }
    }));
    ways.push(way("f64, all 39 parameter columns", move || {
        let chain = chain::<f64>();
        let turns = chain.link_turns();
        for q in black_box(&columns) {
            black_box(&chain.identification_jacobian_with(&turns, q));
        }
    }));
    // An angle that is a quarter turn to the last bit, as commanded ones are: the fifth
    // joint's, less what the arm adds to it.
    let mut quarter = joints::<f64>();
    let constant = chain::<f64>().walk().steps[4].theta;
    quarter.iter_mut().for_each(|q| q[4] = -core::f64::consts::FRAC_PI_2 - constant);
    ways.extend(batches_at("f64, a joint at -90 deg", Cpu::best(), quarter));
    for cpu in Cpu::all() {
        ways.extend(batches::<f64>("f64", cpu));
        ways.extend(batches::<f32>("f32", cpu));
    }
    ways
}

/// As the system names it, where it does.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let of = |key: &str| {
        let line = text.lines().find(|line| line.starts_with(key))?;
        line.split_once(':').map(|(_, value)| value.trim().to_owned())
    };
    let [family, model] = ["cpu family", "model\t"].map(|key| of(key).unwrap_or_default());
    let name = of("model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    format!("{name} (family {family}, model {model}), widest: {}", Cpu::best())
}

fn main() {
    let mut ways = ways();
    for _ in 0..ROUNDS {
        ways.iter_mut().for_each(Way::round);
    }
    println!("{}", processor());
    println!("{POSES} poses of a six-joint arm, {ROUNDS} rounds of {} ms", ROUND.as_millis());
    println!("\n{:48} {:>8} {:>8}   {:>16}", "", "ns", "ns", "times as fast");
    println!("{:48} {:>8} {:>8}   {:>7} {:>8}", "a pose", "least", "median", "least", "median");
    let scalar = ways[0].figures();
    for way in &ways {
        let [least, median] = way.figures();
        let ratios = [scalar[0] / least, scalar[1] / median];
        println!("{:48} {least:8.1} {median:8.1}   {:7.2} {:8.2}", way.name, ratios[0], ratios[1]);
    }
}
