//! What several waves of one angle draw: a model of waves grows by one after the other, so it
//! is never weighed against the curve that all of them draw, and may stand where fewer waves do
//! what they do.

use rayon::prelude::*;

use super::projected::Projected;
use super::smooth::{Left, PRIORS, Prior, SIZES, SWEEPS};

/// Highest order of a few: a higher one is a line like any other.
const HIGHEST: usize = 24;

/// Log odds from which on a few waves stand in the place of others or of a curve: between the
/// angles at which a joint stood a curve errs by less where it is wrong.
const SURELY: f64 = 5.0;
/// More than these are a curve, however uneven.
const FEW: usize = 5;

/// Columns that are in the model, and the log prior odds that they are.
pub struct Wave {
    /// Among those beside the functions.
    pub columns: Vec<usize>,
    /// Of all its ways to be there but for its size.
    pub log_odds: f64,
}

/// What waves turn out to be.
#[derive(Debug, PartialEq)]
pub enum Drawn {
    /// Themselves.
    Waves,
    /// A smooth function.
    Curve,
    /// A few of these whole orders, which may be those that they have.
    Few(Vec<usize>),
}

/// What function `k` is more probably: the waves that are among what is `beside`, a curve of
/// up to `orders`, or a few waves of whole orders among them. `function` is the log prior odds
/// that there is a function at all; the orders of a few share it as `1/n`.
#[must_use]
pub fn drawn(
    projected: &Projected,
    (beside, orders): (usize, usize),
    k: usize,
    waves: &[Wave],
    function: f64,
) -> Drawn {
    let is_wave = |column: &usize| waves.iter().any(|wave| wave.columns.contains(column));
    let others: Vec<usize> = (0..beside).filter(|column| !is_wave(column)).collect();

    let own: Vec<usize> = waves.iter().flat_map(|wave| wave.columns.clone()).collect();
    let left = Left::by(projected, others.clone(), &own);
    let price: f64 = waves.iter().map(|wave| wave.log_odds).sum();
    let of_sizes = |sizes: &[f64]| {
        let variances = waves.iter().zip(sizes).flat_map(|(w, d)| vec![d * d; w.columns.len()]);
        price + left.evidence(&variances.enumerate().collect::<Vec<_>>()) + of_each(sizes)
    };
    let themselves = suited(&mut vec![SIZES[SIZES.len() / 2]; waves.len()], of_sizes);

    let first = beside + 2 * orders * k;
    let own: Vec<usize> = (first..first + 2 * orders).collect();
    let left = Left::by(projected, others, &own);
    let curve = function - (PRIORS as f64).ln() + left.best(orders).1;
    let (few, evidence) = few(&left, orders, function);
    match curve > themselves {
        _ if evidence > curve.max(themselves) + SURELY => Drawn::Few(few),
        true => Drawn::Curve,
        false => Drawn::Waves,
    }
}

/// The few whole orders that are most probable in the place of the curve that was chosen for
/// function `k`, beside those of the others, and their log odds to it.
#[must_use]
pub fn few_instead(
    projected: &Projected,
    (beside, orders): (usize, usize),
    chosen: &[Option<Prior>],
    k: usize,
    function: f64,
) -> (Vec<usize>, f64) {
    let left = Left::by_others(projected, (beside, orders), chosen, k);
    let (few, evidence) = few(&left, orders, function);
    (few, evidence - (function - (PRIORS as f64).ln() + left.best(orders).1))
}

/// Each wave is at the size that suits it, which is a price, as that of a curve is.
fn of_each(sizes: &[f64]) -> f64 {
    -(sizes.len() as f64) * (SIZES.len() as f64).ln()
}

/// Sizes one after the other as the evidence has them, and the evidence.
fn suited(sizes: &mut [f64], evidence: impl Fn(&[f64]) -> f64) -> f64 {
    let mut best = evidence(sizes);
    for _ in 0..SWEEPS {
        for wave in 0..sizes.len() {
            for size in SIZES {
                let before = std::mem::replace(&mut sizes[wave], size);
                let now = evidence(sizes);
                if now > best { best = now } else { sizes[wave] = before }
            }
        }
    }
    best
}

/// The few whole orders that the data hold most probably, and the evidence. Over a part of a
/// turn an order between two does what both do, and leads to no better: from each in turn.
fn few(left: &Left, orders: usize, function: f64) -> (Vec<usize>, f64) {
    let orders = orders.min(HIGHEST);
    let all: f64 = (1..=orders).map(|n| 1.0 / n as f64).sum();
    let evidence = |waves: &[(usize, f64)]| {
        let (orders, sizes): (Vec<usize>, Vec<f64>) = waves.iter().copied().unzip();
        // As many sequences as there are of them are one set.
        let ways: f64 = (1..=orders.len()).map(|n| (n as f64).ln()).sum();
        let price: f64 = orders.iter().map(|n| (*n as f64 * all).ln()).sum();
        let columns: Vec<(usize, f64)> =
            waves.iter().flat_map(|(n, d)| [2 * n - 2, 2 * n - 1].map(|k| (k, d * d))).collect();
        function + ways - price + of_each(&sizes) + left.evidence(&columns)
    };
    let starts = (1..=orders).into_par_iter().map(|order| climbed(order, orders, &evidence));
    let best = |a: (Vec<usize>, f64), b: (Vec<usize>, f64)| if b.1 > a.1 { b } else { a };
    starts.reduce(|| (Vec::new(), f64::NEG_INFINITY), best)
}

/// From a wave of one order: one more, or one in the place of another, as long as that has more
/// evidence.
fn climbed(
    order: usize,
    orders: usize,
    evidence: &impl Fn(&[(usize, f64)]) -> f64,
) -> (Vec<usize>, f64) {
    let mut waves = vec![(order, SIZES[SIZES.len() / 2])];
    let mut best = evidence(&waves);
    loop {
        let before = best;
        // The last place is a new one.
        for place in (0..=waves.len()).rev().filter(|place| *place < FEW) {
            let mut better = None;
            for order in (1..=orders).filter(|n| waves.iter().all(|wave| wave.0 != *n)) {
                for size in SIZES {
                    let mut other = waves.clone();
                    other.truncate(place);
                    other.push((order, size));
                    other.extend(waves.iter().skip(place + 1));
                    let now = evidence(&other);
                    if now > best {
                        (best, better) = (now, Some(other));
                    }
                }
            }
            waves = better.unwrap_or(waves);
        }
        let (orders, mut sizes): (Vec<usize>, Vec<f64>) = waves.iter().copied().unzip();
        let with = |sizes: &[f64]| -> Vec<(usize, f64)> {
            orders.iter().copied().zip(sizes.iter().copied()).collect()
        };
        best = suited(&mut sizes, |sizes| evidence(&with(sizes)));
        waves = with(&sizes);
        // No number is no better.
        if best.total_cmp(&before).is_le() || best.is_nan() {
            return (orders, best);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::evidence::Gram;
    use crate::evidence::smooth::tests::normal;
    use crate::evidence::smooth::{LENGTHS, basis, orders};

    /// What waves of these orders turn out to be, of rows in which those of `truth` are.
    fn draw(truth: &[(usize, f64)], waves: &[usize], seed: u64) -> Drawn {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (rows, noise, most) = (400, 1e-4, orders(LENGTHS[3]));
        let own = 2 * waves.len();
        let mut gram = Gram::new(1, own + 2 * most);
        let (mut z, mut y) = (DMatrix::zeros(rows, own + 2 * most), DVector::zeros(rows));
        for i in 0..rows {
            let values = basis(most, rng.random_range(-1.5..1.5));
            let at = |n: usize| &values[2 * n - 2..2 * n];
            let columns = waves.iter().flat_map(|n| at(*n)).chain(&values);
            columns.enumerate().for_each(|(j, value)| z[(i, j)] = value / noise);
            let value: f64 = truth.iter().map(|(n, a)| a * (at(*n)[0] - at(*n)[1])).sum();
            y[i] = value / noise + normal(&mut rng);
        }
        gram.add(&DMatrix::from_element(rows, 1, 1.0 / noise), &z, &y);
        let projected = gram.project(&gram.geometry(&DVector::from_element(1, 1e-6), 1.0));
        let waves: Vec<Wave> = (0..waves.len())
            .map(|k| Wave { columns: vec![2 * k, 2 * k + 1], log_odds: -8.0 })
            .collect();
        drawn(&projected, (own, most), 0, &waves, -3.0)
    }

    /// Five waves that draw what a smooth function of eight orders does are that function; two
    /// that are there, and nothing else is, are two, and stand in the place of what imitates them.
    #[test]
    fn waves_are_a_curve_or_few_or_themselves() {
        for seed in 0..5 {
            let smooth: Vec<(usize, f64)> = (1..=8).map(|n| (n, 1.5e-4 / n as f64)).collect();
            assert_eq!(draw(&smooth, &[1, 2, 3, 5, 7], 300 + seed), Drawn::Curve, "seed {seed}");
            let two = [(2, 2e-4), (7, 2e-4)];
            for waves in [&[2, 7][..], &[1, 3, 6, 8]] {
                let mut orders = match draw(&two, waves, 400 + seed) {
                    Drawn::Waves => waves.to_vec(),
                    Drawn::Few(orders) => orders,
                    Drawn::Curve => Vec::new(),
                };
                orders.sort_unstable();
                assert_eq!(orders, [2, 7], "seed {seed}: {waves:?}");
            }
        }
    }
}
