//! Sessions as they happen: several effects at once at the sizes real arms show,
//! noise that nobody stated rightly, poses as people choose them.

pub mod effects;
pub mod noise;
pub mod outside;
pub mod poses;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::Robot;
use crate::body::Moment;

/// Columns of a session's file beside joints and points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Columns {
    pub time: bool,
    pub temperature: bool,
    pub payload: bool,
    pub series: bool,
    pub directions: bool,
}

impl Columns {
    /// Most files have few.
    pub fn draw(rng: &mut ChaCha8Rng) -> Self {
        Self {
            time: rng.random_bool(0.6),
            temperature: rng.random_bool(0.4),
            payload: rng.random_bool(0.4),
            series: rng.random_bool(0.3),
            directions: rng.random_bool(0.5),
        }
    }
}

/// What was going on at each reading; repeats of a pose follow one another.
pub fn moments(
    robot: &Robot,
    columns: &Columns,
    rows: usize,
    repeats: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<Moment> {
    let poses = poses::draw(robot, rows.div_ceil(repeats), rng);
    let length = rows as f64 * rng.random_range(10.0..40.0);
    let change = length * rng.random_range(0.3..0.7);
    let cold = rng.random_range(17.0..24.0);
    let (rise, lag) = (rng.random_range(1.0..10.0), length * rng.random_range(0.2..0.6));
    let load = if columns.payload { rng.random_range(1.0..8.0_f64).round() } else { 0.0 };
    let mut before = poses[0].clone();
    let mut out = Vec::with_capacity(rows);
    for (i, q) in poses.iter().enumerate() {
        // The sign of the last move is how a joint came to rest.
        let directions =
            q.iter().zip(&before).map(|(q, before)| if q >= before { 1 } else { -1 }).collect();
        let payload = if columns.payload && (i / 12) % 2 == 1 { load } else { 0.0 };
        let moment = Moment {
            q: q.clone(),
            before: before.clone(),
            directions,
            time: 0.0,
            temperature: 0.0,
            links: 0.0,
            payload,
            later: false,
        };
        for _ in 0..repeats {
            let time = length * (out.len() as f64 + rng.random_range(0.0..0.8)) / rows as f64;
            let time = (time * 10.0).round() / 10.0;
            let warm = cold + rise * (1.0 - (-time / lag).exp());
            let warm = (warm * 100.0).round() / 100.0;
            out.push(Moment {
                time,
                temperature: warm,
                links: warm,
                later: columns.series && time > change,
                ..moment.clone()
            });
        }
        before = q.clone();
    }
    out.truncate(rows);
    out
}
