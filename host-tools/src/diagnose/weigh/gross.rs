//! Whether rows that stand out are gross errors or the ends of the noise's tails.

use super::weights::kept_and_flagged;
use crate::diagnose::node::Node;
use crate::evidence::tails::{Rest, Tails};
use crate::identify::{Problem, Scatterer};

/// Logarithm of the sizes, largest over smallest, that a gross error may as well have: from noise
/// to ten thousand times that.
const SIZES: f64 = 9.2;

/// The probability that the flagged rows of a fit, beside what scatters, are gross errors and not
/// the ends of tails. Both are as probable beforehand.
#[must_use]
pub fn gross(problem: &Problem, node: &Node, scattering: &[Scatterer]) -> f64 {
    let [kept, flagged] = kept_and_flagged(problem, node, scattering);
    1.0 / (1.0 + (-log_odds(&kept, &flagged, node.fit.used)).exp())
}

/// Logarithm of the odds of gross errors, of as many of the farthest flagged rows as is likeliest;
/// the others are tails. A gross error goes any way and is as likely of one size as of another;
/// k rows have one with the probability 1 / k (k + 1), and any rows.
fn log_odds(kept: &[Rest], flagged: &[Rest], used: f64) -> f64 {
    let likelihood = |rows: &[Rest]| {
        let all: f64 = rows.iter().map(|row| row.count).sum();
        Tails::log_evidence(rows, used.min(all))
    };
    let mut rows = [kept, flagged].concat();
    let n = rows.len() as f64;
    rows[kept.len()..].sort_by(|a, b| a.square.total_cmp(&b.square));
    let of_so_many = |many: usize| {
        let (tails, gross) = rows.split_at(rows.len() - many);
        let k = many as f64;
        let which = libm::lgamma(n + 1.0) - libm::lgamma(k + 1.0) - libm::lgamma(n - k + 1.0);
        let prior = which + (k * (k + 1.0)).ln();
        likelihood(tails) + gross.iter().map(anything).sum::<f64>() - prior
    };
    // Of many the likeliest number is hardly missed by a tenth.
    let step = flagged.len().div_ceil(MOST_ASKED).max(1);
    let asked = (1..=flagged.len()).rev().step_by(step);
    asked.map(of_so_many).fold(f64::NEG_INFINITY, f64::max) - likelihood(&rows)
}

/// Logarithm of the density of an error that may be anything.
fn anything(row: &Rest) -> f64 {
    let m = row.equations as f64;
    let half_sphere = 0.5 * m * std::f64::consts::PI.ln() - libm::lgamma(0.5 * m);
    let surface = std::f64::consts::LN_2 + half_sphere;
    -row.count * (surface + 0.5 * m * row.square.max(f64::MIN_POSITIVE).ln() + SIZES.ln())
}

/// So many numbers of gross errors are asked.
const MOST_ASKED: usize = 10;

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Rows of so many degrees of freedom, in standard deviations of the stated noise.
    fn rows(rng: &mut ChaCha8Rng, nu: Option<usize>, count: usize) -> Vec<Rest> {
        let mut normal = |n: usize| -> f64 {
            let one = |rng: &mut ChaCha8Rng| {
                (0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0
            };
            (0..n).map(|_| one(rng).powi(2)).sum()
        };
        let row = |_| {
            let core = nu.map_or(1.0, |nu| normal(nu) / nu as f64);
            Rest { square: normal(3) / core, equations: 3, count: 1.0 }
        };
        (0..count).map(row).collect()
    }

    /// What lies beyond eight standard deviations of tails of three and four degrees of freedom is
    /// hardly ever called gross; among normal rows all of these are.
    #[test]
    fn ends_of_tails_are_no_gross_errors() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let (mut asked, mut wrong, mut missed) = (0, 0, 0);
        for k in 0..200 {
            let count = [60, 200, 600][k % 3];
            let all = rows(&mut rng, Some(3 + k % 2), count);
            let (flagged, kept): (Vec<Rest>, Vec<Rest>) =
                all.into_iter().partition(|row| row.square > 64.0);
            asked += usize::from(!flagged.is_empty());
            wrong += usize::from(!flagged.is_empty() && log_odds(&kept, &flagged, 0.0) > 2.2);
            // One that is far beyond those is gross beside them.
            let far = Rest { square: 3e4, equations: 3, count: 1.0 };
            let flagged = [&flagged[..], &[far]].concat();
            missed += usize::from(log_odds(&kept, &flagged, 0.0) < 2.2);
        }
        assert!(missed < 20, "{missed} of 200");
        assert!(asked > 100 && wrong * 20 <= asked, "{wrong} of {asked}");
        for count in [30, 300] {
            for many in [1, 3, 10] {
                let kept = rows(&mut rng, None, count);
                let far = |k: usize| 10.0 * 1.5_f64.powi(k as i32);
                let rest = |k| Rest { square: far(k).powi(2), equations: 3, count: 1.0 };
                let flagged: Vec<Rest> = (0..many).map(rest).collect();
                let odds = log_odds(&kept, &flagged, 0.0);
                assert!(odds > 2.2, "{many} beside {count}: {odds}");
            }
        }
    }
}
