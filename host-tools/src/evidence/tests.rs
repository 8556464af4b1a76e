use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::prior::SIZES;
use super::*;

/// Rows of a problem without an arm: random columns.
#[derive(Clone)]
struct Rows {
    g: DMatrix<f64>,
    z: DMatrix<f64>,
    y: DVector<f64>,
    candidates: Vec<Candidate>,
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random_range(1e-12..1.0), rng.random_range(0.0..1.0));
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

impl Rows {
    /// `widths` columns a candidate; `truth` are candidates with their size in
    /// floors.
    fn new(seed: u64, n: usize, p: usize, widths: &[usize], truth: &[(usize, f64)]) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let columns = widths.iter().sum();
        let g = DMatrix::from_fn(n, p, |_, _| normal(&mut rng));
        let z = DMatrix::from_fn(n, columns, |_, _| normal(&mut rng));
        let mut y = DVector::from_fn(n, |_, _| normal(&mut rng));
        for (wanted, size) in truth {
            let first: usize = widths[..*wanted].iter().sum();
            let share = size / (widths[*wanted] as f64).sqrt();
            for j in first..first + widths[*wanted] {
                y.axpy(share, &z.column(j), 1.0);
            }
        }
        let candidate = |(name, width): (usize, &usize)| Candidate {
            name,
            place: 0,
            part: 0,
            units: (0..*width).collect(),
            common: 0,
            log_odds: prior::log_odds(1, 1),
        };
        let candidates = widths.iter().enumerate().map(candidate).collect();
        Self { g, z, y, candidates }
    }

    fn gram(&self) -> Gram {
        let mut gram = Gram::new(self.g.ncols(), self.z.ncols());
        gram.add(&self.g, &self.z, &self.y);
        gram
    }

    fn subsets(&self, precision: f64) -> Subsets {
        let precision = DVector::from_element(self.g.ncols(), precision);
        let gram = self.gram();
        let projected = gram.project(&gram.geometry(&precision, 1.0));
        Subsets::new(projected, self.candidates.clone())
    }

    fn explain(&self) -> Explanation {
        let precision = DVector::from_element(self.g.ncols(), 1e-6);
        explain(&self.gram(), &precision, &self.candidates, Effort::default(), None)
    }
}

fn claim(name: usize) -> Claim {
    Claim { name, place: 0 }
}

fn same(a: &Posterior, b: &Posterior, names: usize, tolerance: f64) {
    for name in 0..names {
        let (a, b) = (a.probability(claim(name)), b.probability(claim(name)));
        assert!((a - b).abs() < tolerance, "{name}: {a} {b}");
    }
}

/// Log of the integral over noise scale, geometry and coefficient of likelihood
/// times prior, on grids; the geometric unknown has a flat prior.
fn integrated(rows: &Rows, size: Option<f64>) -> f64 {
    let n = rows.y.len() as f64;
    let unit = (rows.z.column(0).norm_squared() / n).sqrt();
    let mut sum = 0.0;
    for step in 0..240 {
        // Log of the scale, from 0.05 to 20.
        let width = 6.0 / 240.0;
        let k = (-3.0 + (f64::from(step) + 0.5) * width).exp();
        // Scaled inverse chi-square with two degrees of freedom about 1:
        // p(k^2) = k^-4 exp(-1 / k^2); d(k^2) = 2 k^2 d(log k).
        let prior = k.powi(-4) * (-1.0 / (k * k)).exp() * 2.0 * k * k * width;
        let inner = size.map_or_else(
            || over_geometry(rows, k, 0.0, unit),
            |size| {
                let d = 16.0 * k * size / 600.0;
                let each = (0..600).map(|i| {
                    let w = -8.0 * k * size + (f64::from(i) + 0.5) * d;
                    let spread = k * size;
                    let density = (-0.5 * (w / spread).powi(2)).exp()
                        / (spread * std::f64::consts::TAU.sqrt());
                    density * d * over_geometry(rows, k, w, unit)
                });
                each.sum()
            },
        );
        sum += prior * inner;
    }
    sum.ln()
}

fn over_geometry(rows: &Rows, k: f64, w: f64, unit: f64) -> f64 {
    let rest = &rows.y - rows.z.column(0) * (w / unit);
    let g = rows.g.column(0);
    let (top, spread) = (g.dot(&rest) / g.norm_squared(), k / g.norm());
    let d = 16.0 * spread / 60.0;
    let each = (0..60).map(|i| {
        let x = top - 8.0 * spread + (f64::from(i) + 0.5) * d;
        let square = (&rest - g * x).norm_squared() / (k * k);
        (-0.5 * square - rest.len() as f64 * k.ln()).exp() * d
    });
    each.sum()
}

#[test]
fn evidence_is_the_integral() {
    for (seed, size, truth) in [(1, 0, 0.0), (2, 1, 2.0), (3, 2, 0.5)] {
        let rows = Rows::new(seed, 5, 1, &[1], &[(0, truth)]);
        let subsets = rows.subsets(1e-9);
        let own =
            subsets.at_sizes(&[0], &[size]).log_evidence - subsets.at_sizes(&[], &[]).log_evidence;
        let direct = integrated(&rows, Some(SIZES[size])) - integrated(&rows, None);
        assert!((own - direct).abs() < 2e-3, "{own} {direct}");
    }
}

/// All subsets, each at all sizes.
fn enumerated(subsets: &Subsets) -> BTreeMap<Vec<usize>, f64> {
    let count = subsets.candidates().len();
    let mut out = BTreeMap::new();
    for bits in 0..1_usize << count {
        let members: Vec<usize> = (0..count).filter(|g| bits >> g & 1 == 1).collect();
        let ways = SIZES.len().pow(members.len() as u32);
        let each = (0..ways).map(|way| {
            let digit = |i: usize| way / SIZES.len().pow(i as u32) % SIZES.len();
            let sizes: Vec<usize> = (0..members.len()).map(digit).collect();
            subsets.at_sizes(&members, &sizes).log_evidence
        });
        let each: Vec<f64> = each.collect();
        let top = each.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = each.iter().map(|e| (e - top).exp()).sum();
        let prior: f64 = members.iter().map(|g| subsets.candidates()[*g].log_odds).sum();
        out.insert(members, top + (sum / ways as f64).ln() + prior);
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Search and sum over sizes lose next to nothing.
    #[test]
    fn the_search_finds_what_enumeration_finds(seed in 0_u64..1000) {
        let widths = [1, 2, 1, 3, 1];
        let rows = Rows::new(seed, 30, 3, &widths, &[(0, 0.6), (1, 0.7), (3, 1.5)]);
        let subsets = rows.subsets(1e-6);
        let all = Posterior::new(&enumerated(&subsets), &rows.candidates);
        let search = search::Search::run(&subsets, Effort::default(), &[Vec::new()]);
        let found = Posterior::new(search.masses(), &rows.candidates);
        same(&all, &found, widths.len(), 0.02);
    }

    /// Members so nearly alike that rounding leaves the inverse no root end in no panic.
    #[test]
    fn additions_beside_members_without_a_root(seed in 0_u64..20) {
        let widths = [2, 1, 4, 2, 1];
        let rows = Rows::new(seed, 40, 3, &widths, &[(0, 2.0), (4, 1.0)]);
        let subsets = rows.subsets(1e-6);
        let mut parent = subsets.at_sizes(&[0, 4], &[2, 1]);
        parent.inverse.neg_mut();
        let additions = subsets.additions(&parent);
        prop_assert!(additions.len() == widths.len() && additions[0] == f64::NEG_INFINITY);
    }

    /// One triangular solve for all additions gives what fitting each gives.
    #[test]
    fn additions_are_fits(seed in 0_u64..1000) {
        let widths = [2, 1, 4, 2, 1];
        let rows = Rows::new(seed, 40, 3, &widths, &[(0, 2.0), (4, 1.0)]);
        let subsets = rows.subsets(1e-6);
        let parent = subsets.at_sizes(&[0, 4], &[2, 1]);
        let additions = subsets.additions(&parent);
        prop_assert_eq!(additions[0], f64::NEG_INFINITY);
        for g in 1..4 {
            let each = (0..SIZES.len()).map(|s| {
                let mut sizes = vec![2, 1];
                sizes.insert(1, s);
                subsets.at_sizes(&[0, g, 4], &sizes).log_evidence.exp()
            });
            let direct = (each.sum::<f64>() / SIZES.len() as f64).ln()
                + rows.candidates[g].log_odds;
            prop_assert!((additions[g] - direct).abs() < 1e-8);
        }
    }

    /// Members that do nearly the same work do not swing their sizes together:
    /// a model never has more mass than its sizes' highest evidence allows.
    #[test]
    fn sizes_settle_where_the_evidence_is_highest(
        seed in 0_u64..1000, apart in 0.001..0.3_f64, size in 0.3..20.0_f64,
    ) {
        let mut rows = Rows::new(seed, 40, 3, &[1, 1, 1], &[(0, size), (2, 1.0)]);
        let near = rows.z.column(0) + rows.z.column(1) * apart;
        rows.z.set_column(1, &near);
        let subsets = rows.subsets(1e-6);
        let all = enumerated(&subsets);
        for members in [vec![0, 1], vec![0, 1, 2]] {
            let fit = subsets.fit(&members, &|_| None);
            prop_assert!((fit.log_mass - all[&members]).abs() < 2.0);
            let prior: f64 = members.iter().map(|g| rows.candidates[*g].log_odds).sum();
            prop_assert!(fit.log_mass <= fit.log_evidence + prior);
        }
    }

    /// Units of columns, stated sigmas and the order of rows do not matter.
    #[test]
    fn nothing_hangs_on_units_or_order(seed in 0_u64..1000, power in -6_i32..6) {
        let widths = [1, 2, 3, 1];
        let rows = Rows::new(seed, 40, 4, &widths, &[(1, 1.0)]);
        let plain = rows.explain();
        let mut other = rows.clone();
        for (j, mut column) in other.z.column_iter_mut().enumerate() {
            column *= 10_f64.powi(if j % 2 == 0 { power } else { -power });
        }
        let scaled = other.explain();
        same(&plain.posterior, &scaled.posterior, widths.len(), 1e-6);
        let mut other = rows.clone();
        let sigma = 10_f64.powi(power.clamp(-3, 3));
        other.y /= sigma;
        other.g /= sigma;
        other.z /= sigma;
        let scaled = other.explain();
        same(&plain.posterior, &scaled.posterior, widths.len(), 1e-6);
        prop_assert!((plain.scale / sigma / scaled.scale - 1.0).abs() < 1e-6);
        for (a, b) in plain.coefficients.iter().flatten().zip(scaled.coefficients.iter().flatten()) {
            prop_assert!((a.value - b.value).abs() < 1e-6 * (1.0 + a.value.abs()));
            prop_assert!((a.sigma - b.sigma).abs() < 1e-6 * (1.0 + a.sigma));
        }
        let mut other = rows.clone();
        for i in 0..20 {
            other.y.swap_rows(i, 39 - i);
            other.g.swap_rows(i, 39 - i);
            other.z.swap_rows(i, 39 - i);
        }
        same(&plain.posterior, &other.explain().posterior, widths.len(), 1e-9);
    }

    /// A column that says nothing costs its Occam factor, no more, no less.
    #[test]
    fn an_irrelevant_column_costs_its_occam_factor(seed in 0_u64..1000, size in 0_usize..5) {
        let mut rows = Rows::new(seed, 30, 2, &[1, 1], &[(0, 2.0)]);
        // Orthogonal to everything else.
        let mut basis = DMatrix::zeros(30, 4);
        basis.columns_mut(0, 2).copy_from(&rows.g);
        basis.set_column(2, &rows.z.column(0).into_owned());
        basis.set_column(3, &rows.y);
        let q = basis.qr().q();
        let free = rows.z.column(1) - &q * q.tr_mul(&rows.z.column(1));
        rows.z.set_column(1, &free);
        let subsets = rows.subsets(1e-9);
        let without = subsets.at_sizes(&[0], &[2]).log_evidence;
        let with = subsets.at_sizes(&[0, 1], &[2, size]).log_evidence;
        let occam = 0.5 * (SIZES[size].powi(2) * 30.0).ln_1p();
        prop_assert!((without - with - occam).abs() < 1e-6);
    }

    /// Rows read several times carry the evidence of their mean.
    #[test]
    fn repeats_are_no_evidence(seed in 0_u64..1000, times in 2_usize..4) {
        let widths = [1, 2, 1, 1];
        let mut rows = Rows::new(seed, 60, 3, &widths, &[(0, 0.5), (2, 0.35)]);
        let mut rng = ChaCha8Rng::seed_from_u64(seed + 1);
        // The noise that each reading has of its own.
        let share = 0.8_f64;
        let own = ((1.0 - share) / share).sqrt();
        let mut gram = Gram::new(3, 5);
        for i in 0..60 {
            let repeat = |m: &DMatrix<f64>| {
                let mut block = DMatrix::from_fn(times, m.ncols(), |_, j| m[(i, j)]);
                poses::whiten(&mut block, times, share);
                block
            };
            let mut y = DMatrix::from_fn(times, 1, |_, _| rows.y[i] + own * normal(&mut rng));
            rows.y[i] = y.mean();
            poses::whiten(&mut y, times, share);
            gram.add(&repeat(&rows.g), &repeat(&rows.z), &y.column(0).into_owned());
            gram.add_repeats(&poses::Repeats::of(y, times, share));
        }
        let precision = DVector::from_element(3, 1e-6);
        let repeated = explain(&gram, &precision, &rows.candidates, Effort::default(), None);
        same(&rows.explain().posterior, &repeated.posterior, widths.len(), 0.02);
    }
}

#[test]
fn parts_add_up() {
    let rows = Rows::new(5, 50, 3, &[1, 2], &[(0, 1.0)]);
    let mut halves = [Gram::new(3, 3), Gram::new(3, 3)];
    for (half, gram) in halves.iter_mut().enumerate() {
        let at = |m: &DMatrix<f64>| m.rows(25 * half, 25).into_owned();
        gram.add(&at(&rows.g), &at(&rows.z), &rows.y.rows(25 * half, 25).into_owned());
    }
    let [mut first, second] = halves;
    first.join(&second);
    let precision = DVector::from_element(3, 1e-6);
    let joined = explain(&first, &precision, &rows.candidates, Effort::default(), None);
    same(&joined.posterior, &rows.explain().posterior, 2, 1e-9);
}

/// Two effects that the data cannot tell apart share the probability.
#[test]
fn shadows_share() {
    let mut rows = Rows::new(9, 60, 3, &[1, 1, 1], &[(0, 1.5)]);
    let column = rows.z.column(0).into_owned();
    rows.z.set_column(1, &(-2.0 * column));
    let found = rows.explain();
    let posterior = &found.posterior;
    assert!((posterior.probability(claim(0)) - 0.5).abs() < 0.05);
    assert_eq!(posterior.alternatives(claim(0))[0].0, claim(1));
    assert!(posterior.alternatives(claim(2)).is_empty());
    assert!(posterior.probability_of(&[0, 1]) > 0.99);
    assert_eq!(posterior.models[0].0.len(), 1);
    assert!((found.floors[0] - 1.5).abs() < 0.4, "{:?}", found.floors);
}

#[test]
fn variants_of_one_place_exclude_each_other() {
    let mut rows = Rows::new(11, 80, 3, &[2, 2, 1], &[(0, 3.0), (1, 3.0)]);
    rows.candidates[1].name = 0;
    let found = rows.explain();
    assert!(found.posterior.models.iter().all(|(m, _)| !(m.contains(&0) && m.contains(&1))));
}

/// Columns of geometry, empty columns and more unknowns than equations are
/// answered, not refused.
#[test]
fn degenerate_problems_are_answered() {
    let mut rows = Rows::new(3, 40, 4, &[1, 2, 1], &[]);
    let geometry = rows.g.column(1).into_owned();
    rows.z.set_column(0, &geometry);
    rows.z.column_mut(3).fill(0.0);
    let twin = rows.g.column(0).into_owned();
    rows.g.set_column(3, &twin);
    let found = rows.explain();
    assert!(found.posterior.probability(claim(0)) < 0.1);
    assert!(found.posterior.probability(claim(2)) < 0.1);
    let few = Rows::new(4, 3, 6, &[1, 2], &[]).explain();
    assert!(few.posterior.claims().values().all(|p| *p < 0.5));
    let none =
        explain(&Gram::new(2, 0), &DVector::from_element(2, 1.0), &[], Effort::default(), None);
    assert_eq!(none.posterior.models, vec![(vec![], 1.0)]);
}

/// The noise scale is found although the effects stand out of it tenfold.
#[test]
fn the_scale_is_that_of_what_is_left() {
    let rows = Rows::new(21, 200, 6, &[1, 1, 2, 1], &[(0, 10.0), (2, 6.0)]);
    let found = rows.explain();
    assert!((found.scale - 1.0).abs() < 0.12, "{}", found.scale);
    assert_eq!(found.best.members, vec![0, 2]);
}

/// Where the best model loses its mass, another one is the best, with its own coefficients and
/// noise; where nothing changes, nothing is other.
#[test]
fn models_are_weighed_again() {
    let rows = Rows::new(7, 300, 4, &[1, 1, 2], &[(0, 3.0), (2, 2.0)]);
    let mut gram = Gram::new(4, 4);
    gram.add(&rows.g, &rows.z, &rows.y);
    let precision = DVector::from_element(4, 1e-6);
    let found = explain(&gram, &precision, &rows.candidates, Effort::default(), None);
    assert_eq!(found.best.members, [0, 2]);
    let again = found.clone().reweighed(&gram, &precision, &rows.candidates, &|_| 0.0);
    assert_eq!(again.best, found.best);
    assert!((again.posterior.models[0].1 - found.posterior.models[0].1).abs() < 1e-12);
    let all: Vec<Vec<usize>> = found.posterior.models.iter().map(|m| m.0.clone()).collect();
    let other = all.iter().find(|members| **members != [0, 2]).unwrap();
    let loses = |members: &[usize]| if members == [0, 2] { -1e6 } else { 0.0 };
    let again = found.clone().reweighed(&gram, &precision, &rows.candidates, &loses);
    assert_eq!(again.best.members, *other);
    assert_eq!(again.coefficients.len(), other.len());
    assert_eq!(again.floors.len(), other.len());
    assert!(again.posterior.models.iter().all(|(members, _)| *members != [0, 2]));
    let all: f64 = again.posterior.models.iter().map(|m| m.1).sum();
    assert!((all - 1.0).abs() < 1e-9);
}

/// Bits do not hang on how many threads there are; columns of more than one block of products
/// and right-hand sides of more than one task.
#[test]
fn any_number_of_threads_finds_the_same() {
    let widths = [vec![2; 100], vec![1; 40]].concat();
    let rows = Rows::new(31, 400, 9, &widths, &[(3, 1.0), (77, 0.8), (120, 0.6)]);
    let precision = DVector::from_element(9, 1e-3);
    let found = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let gram = rows.gram();
            let found = explain(&gram, &precision, &rows.candidates, Effort::default(), None);
            let geometry = gram.geometry(&precision, found.scale);
            let variances = geometry.variances(DMatrix::identity(9, 9));
            let projected = gram.project(&geometry);
            let numbers = projected.c.iter().chain(&projected.b).chain(&variances).copied();
            let masses = found.posterior.models.iter().map(|(_, p)| *p);
            let bits: Vec<u64> = numbers.chain(masses).map(f64::to_bits).collect();
            (bits, found.best.members.clone())
        })
    };
    let one = found(1);
    assert!([3, 77, 120].iter().all(|m| one.1.contains(m)), "{:?}", one.1);
    for threads in [2, 3] {
        assert!(found(threads) == one, "{threads} threads");
    }
}

/// Blocks of columns give what all of them together do.
#[test]
fn products_by_blocks_are_products() {
    for columns in [1, 95, 96, 97, 192, 193] {
        let rows = Rows::new(5, 60, 4, &vec![1; columns], &[]);
        let gram = rows.gram();
        let whole = rows.z.transpose() * &rows.z;
        for i in 0..columns {
            for j in 0..columns {
                let apart = (gram.product(i, j) - whole[(i, j)]).abs();
                assert!(apart < 1e-11, "{columns} columns: {i} {j}");
            }
        }
    }
}

/// Geometry of about as many unknowns as there are equations, each as far off as its prior says,
/// in noise of 0.6 times the stated: what it is off by is no noise, and no step of the scale,
/// of which many are small, is taken for the last.
#[test]
fn geometry_off_its_nominal_is_no_noise() {
    for (equations, off) in [(39, 1.0), (60, 1.0), (60, 0.3), (300, 1.0)] {
        let mut logs = 0.0;
        for seed in 0..20 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let g = DMatrix::from_fn(equations, 27, |_, _| 40.0 * normal(&mut rng));
            let x = DVector::from_fn(27, |_, _| off * normal(&mut rng));
            let noise = DVector::from_fn(equations, |_, _| 0.6 * normal(&mut rng));
            let mut gram = Gram::new(27, 0);
            gram.add(&g, &DMatrix::zeros(equations, 0), &(&g * x + noise));
            logs += (gram.scale_of_geometry(&DVector::from_element(27, 1.0)) / 0.6).ln() / 20.0;
        }
        assert!(logs.abs() < 0.15, "{equations} equations, off by {off}: {}", logs.exp());
    }
}
