//! Sessions in which an arm warms up and cools down later than the place at which its
//! temperature is read. The thermometer's course is known at every moment, not at the rows
//! only, and what the arm makes of it is its differential equation, integrated in steps of
//! seconds. Nothing here is how truearm goes from row to row.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::Robot;
use crate::body::Moment;
use crate::draw::pose;
use crate::normal;

/// Steps of the integration in the shortest time constant.
const STEPS: f64 = 100.0;

/// What an arm and its thermometer go through.
#[derive(Debug, Clone)]
pub struct Climate {
    /// s
    pub length: f64,
    /// With which the links follow the thermometer, s; 0: at once.
    pub time_constant: f64,
    /// By how much the links were warmer than it at the begin, K: nobody knows.
    pub ahead: f64,
    /// Standard deviation of a reading, K; it is read in steps of 0.1 K.
    pub noise: f64,
    cold: f64,
    /// When the motors begin to work and when they stop, s, and how much warmer they then are.
    works: Vec<([f64; 2], f64)>,
    /// With which the place of the thermometer follows its heat, s.
    housing: f64,
    /// Of the hall: size, K, period, s, phase.
    hall: [f64; 3],
}

impl Climate {
    /// A session of so many hours: an arm that works, rests and works again.
    pub fn drawn(hours: f64, time_constant: f64, rng: &mut ChaCha8Rng) -> Self {
        let length = hours * 3600.0;
        let rise = rng.random_range(6.0..18.0);
        let begin = length * rng.random_range(0.0..0.15);
        let rest = length * rng.random_range(0.4..0.6);
        let again = rest + length * rng.random_range(0.15..0.4);
        let works = vec![([begin, rest], rise), ([again, f64::INFINITY], rise * 0.6)];
        Self {
            length,
            time_constant,
            ahead: 0.0,
            noise: 0.05,
            cold: rng.random_range(17.0..23.0),
            works,
            housing: rng.random_range(240.0..1200.0),
            hall: [
                rng.random_range(0.2..0.8),
                length * rng.random_range(0.5..1.5),
                rng.random_range(0.0..TAU),
            ],
        }
    }

    /// Degrees Celsius where the thermometer is.
    pub fn thermometer(&self, time: f64) -> f64 {
        let [size, period, phase] = self.hall;
        let hall = size * ((TAU * time / period + phase).sin() - phase.sin());
        let settled = |passed: f64| 1.0 - (-passed.max(0.0) / self.housing).exp();
        let work = |([from, to], rise): &([f64; 2], f64)| {
            rise * (settled(time - from) - settled(time - to))
        };
        self.cold + hall + self.works.iter().map(work).sum::<f64>()
    }

    /// Degrees Celsius of the links at these ascending times: Runge-Kutta.
    pub fn links(&self, times: &[f64]) -> Vec<f64> {
        let tau = self.time_constant;
        if tau == 0.0 {
            return times.iter().map(|t| self.thermometer(*t)).collect();
        }
        let slope = |t: f64, w: f64| (self.thermometer(t) - w) / tau;
        let (mut t, mut w) = (0.0, self.thermometer(0.0) + self.ahead);
        let mut out = Vec::with_capacity(times.len());
        for end in times {
            let steps = ((end - t) / (tau.min(self.housing) / STEPS)).ceil().max(1.0);
            let h = (end - t) / steps;
            for _ in 0..steps as usize {
                let a = slope(t, w);
                let b = slope(t + h / 2.0, w + h / 2.0 * a);
                let c = slope(t + h / 2.0, w + h / 2.0 * b);
                let d = slope(t + h, w + h * c);
                w += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
                t += h;
            }
            t = *end;
            out.push(w);
        }
        out
    }

    /// Rows over the session, which begins with the first of them.
    pub fn moments(&self, robot: &Robot, rows: usize, rng: &mut ChaCha8Rng) -> Vec<Moment> {
        let time = |i: usize, rng: &mut ChaCha8Rng| {
            let late = if i == 0 { 0.0 } else { rng.random_range(0.0..0.8) };
            (self.length * (i as f64 + late) / rows as f64 * 10.0).round() / 10.0
        };
        let times: Vec<f64> = (0..rows).map(|i| time(i, rng)).collect();
        let mut before = pose(robot, rng);
        let mut out = Vec::with_capacity(rows);
        for (time, links) in times.iter().zip(self.links(&times)) {
            let q = pose(robot, rng);
            let read = self.thermometer(*time) + self.noise * normal(rng);
            out.push(Moment {
                directions: q.iter().map(|_| if rng.random_bool(0.5) { 1 } else { -1 }).collect(),
                before: std::mem::replace(&mut before, q.clone()),
                q,
                time: *time,
                temperature: (read * 10.0).round() / 10.0,
                links,
                payload: 0.0,
                later: false,
            });
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    /// A place that warms up exponentially has a closed form for what follows it.
    #[test]
    fn links_obey_their_equation() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut climate = Climate::drawn(4.0, 2400.0, &mut rng);
        climate.works = vec![([0.0, f64::INFINITY], 10.0)];
        climate.hall = [0.0, 1.0, 0.0];
        climate.ahead = 1.5;
        let (tau, housing) = (climate.time_constant, climate.housing);
        let times: Vec<f64> = (0..200).map(|k| f64::from(k) * 70.0).collect();
        for (t, w) in times.iter().zip(climate.links(&times)) {
            let (own, place) = ((-t / tau).exp(), (-t / housing).exp());
            let exact = climate.cold + 10.0
                - 10.0 * (tau * own - housing * place) / (tau - housing)
                + 1.5 * own;
            assert!((w - exact).abs() < 1e-9, "{t}: {w}, not {exact}");
        }
    }
}
