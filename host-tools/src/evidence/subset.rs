//! Evidence of a subset of candidates, in closed form.
//!
//! With `D` the prior sizes of the columns of a model M and `B = I + D C_M D`,
//!
//! ```text
//! log p(y | M) = -1/2 log |B| - 1/2 (nu + N) log(1 + (s - b' D B^-1 D b) / nu) + const
//! ```
//!
//! It is the marginal likelihood of a linear model whose coefficients have a
//! normal prior in units of the noise and whose noise variance has a scaled
//! inverse chi-square prior with nu degrees of freedom about the present scale
//! (O'Hagan and Forster, Kendall's Advanced Theory of Statistics 2B, 11.43;
//! Liang et al., JASA 103 (2008) 410 on mixtures over the prior size). N counts
//! the equations less those that geometry uses up (MacKay, Neural Computation 4
//! (1992) 415): geometry is integrated out, not fitted.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::candidate::Candidate;
use super::curve::{Curve, highest, mean, rotated};
use super::noise::Noise;
use super::prior::SIZES;
use super::projected::Projected;
use super::triangular::inverse_lower;

/// Most times that the prior sizes of a model's members are chosen again; the
/// evidence rises every time, and all but a few models settle at the second.
const SWEEPS: usize = 20;
/// Size that a search starts a member at: 5 floors.
const FIRST_SIZE: usize = 2;

/// A problem ready for subsets: candidates scaled to one noise floor.
#[derive(Debug, Clone)]
pub struct Subsets {
    pub(super) candidates: Vec<Candidate>,
    pub(super) columns: Vec<Range<usize>>,
    pub(super) c: DMatrix<f64>,
    pub(super) b: DVector<f64>,
    pub(super) s: f64,
    /// Caller's columns are divided by this.
    pub(super) unit: DVector<f64>,
    pub(super) noise: Noise,
    pub(super) scale: f64,
}

/// A subset and what the data say of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Subset {
    /// Its candidates, ascending.
    pub members: Vec<usize>,
    /// Prior size of each, an index into [`SIZES`].
    pub sizes: Vec<usize>,
    /// Log of prior times evidence, the prior sizes summed over; up to a
    /// constant of the problem.
    pub log_mass: f64,
    /// What the same model's evidence is at `sizes`, without its prior.
    pub log_evidence: f64,
    pub(super) inverse: DMatrix<f64>,
    pub(super) mean: DVector<f64>,
    /// `b' D B^-1 D b`.
    pub(super) explained: f64,
    /// `log |B|`.
    pub(super) log_det: f64,
}

impl Subsets {
    /// Scales the columns of `projected`, which belong to `candidates` in turn.
    /// Effects count in noise floors: at a prior size of 1 a candidate's
    /// expected mean square over all equations is that of the noise, however
    /// many columns it has and whatever their units. The size is that of the
    /// whole effect, before anything is projected out: what geometry hides is
    /// no reason to believe that it is larger.
    #[must_use]
    pub fn new(projected: Projected, candidates: Vec<Candidate>) -> Self {
        let Projected { mut c, mut b, s, full, noise, scale } = projected;
        let mut columns = Vec::with_capacity(candidates.len());
        let mut unit = DVector::from_element(b.len(), 0.0);
        let mut first = 0;
        for candidate in &candidates {
            let k = candidate.units.len();
            for (i, own) in candidate.units.iter().enumerate() {
                let same = (0..k).filter(|j| candidate.units[*j] == *own);
                let (count, square) =
                    same.fold((0.0, 0.0), |(n, s), j| (n + 1.0, s + full[first + j]));
                let square: f64 = square / count;
                if square > 0.0 {
                    unit[first + i] = (square * k as f64 / noise.poses).sqrt();
                }
            }
            columns.push(first..first + k);
            first += k;
        }
        let inverse = unit.map(|u| if u > 0.0 { u.recip() } else { 0.0 });
        for (j, mut column) in c.column_iter_mut().enumerate() {
            column.component_mul_assign(&inverse);
            column *= inverse[j];
        }
        b.component_mul_assign(&inverse);
        Self { candidates, columns, c, b, s, unit, noise, scale }
    }

    /// Fits a subset: the prior size of every member is chosen where the
    /// evidence is highest, the others as they are, until none changes; then
    /// each is summed over. `hints` are known sizes of candidates.
    #[must_use]
    pub fn fit(&self, members: &[usize], hint: &dyn Fn(usize) -> Option<usize>) -> Subset {
        let mut members = members.to_vec();
        members.sort_unstable();
        members.dedup();
        let mut sizes: Vec<usize> =
            members.iter().map(|g| hint(*g).unwrap_or(FIRST_SIZE)).collect();
        let mut subset = self.at_sizes(&members, &sizes);
        let mut curves = self.curves(&subset);
        for _ in 0..SWEEPS {
            let wanted: Vec<usize> = curves.iter().map(highest).collect();
            if wanted == sizes {
                break;
            }
            let mut next = self.at_sizes(&members, &wanted);
            if next.log_evidence <= subset.log_evidence {
                // Members that do the same work must not shrink or grow
                // together: only the one that gains most changes.
                let gain = |i: &usize| curves[*i][wanted[*i]] - curves[*i][sizes[*i]];
                let one = (0..members.len()).max_by(|a, b| gain(a).total_cmp(&gain(b)));
                let mut single = sizes.clone();
                if let Some(i) = one {
                    single[i] = wanted[i];
                }
                next = self.at_sizes(&members, &single);
            }
            sizes.clone_from(&next.sizes);
            subset = next;
            curves = self.curves(&subset);
        }
        // At the highest evidence each term is negative.
        let summed: f64 = curves.iter().map(|c| mean(c) - c[highest(c)]).sum();
        let prior: f64 = members.iter().map(|g| self.candidates[*g].log_odds).sum();
        subset.log_mass = subset.log_evidence + summed + prior;
        subset
    }

    /// The formula at given prior sizes.
    #[must_use]
    pub fn at_sizes(&self, members: &[usize], sizes: &[usize]) -> Subset {
        let columns: Vec<usize> = members.iter().flat_map(|g| self.columns[*g].clone()).collect();
        let size = members.iter().zip(sizes);
        let d: Vec<f64> = size.flat_map(|(g, s)| vec![SIZES[*s]; self.columns[*g].len()]).collect();
        let n = columns.len();
        let mut a = DMatrix::from_fn(n, n, |i, j| self.c[(columns[i], columns[j])]);
        for (i, d) in d.iter().enumerate() {
            a[(i, i)] += 1.0 / (d * d);
        }
        let b = DVector::from_fn(n, |i, _| self.b[columns[i]]);
        // C is a Gram matrix and 1 / d^2 at least 4e-4: there is a factor.
        let (inverse, log_det) = match a.cholesky() {
            Some(factor) => {
                let diagonal = factor.l_dirty().diagonal();
                let pairs = diagonal.iter().zip(&d);
                let log_det = 2.0 * pairs.map(|(l, d)| (l * d).ln()).sum::<f64>();
                // A^-1 = L^-T L^-1.
                let root = inverse_lower(factor.l_dirty());
                (root.transpose() * root, log_det)
            }
            None => (DMatrix::zeros(n, n), f64::INFINITY),
        };
        let mean = &inverse * &b;
        let explained = b.dot(&mean);
        let log_evidence = -0.5 * log_det + self.noise.log_evidence(self.s - explained);
        Subset {
            members: members.to_vec(),
            sizes: sizes.to_vec(),
            log_mass: log_evidence,
            log_evidence,
            inverse,
            mean,
            explained,
            log_det,
        }
    }

    /// Log evidence of each member at every prior size, the others as they are.
    /// With the member taken out, `S` is what is left of its C and `t` of its b.
    fn curves(&self, subset: &Subset) -> Vec<Curve> {
        let mut first = 0;
        let each = subset.members.iter().zip(&subset.sizes).map(|(g, size)| {
            let k = self.columns[*g].len();
            let mean = subset.mean.rows(first, k);
            let own = subset.inverse.view((first, first), (k, k)).into_owned();
            first += k;
            let Some(own) = own.cholesky() else {
                return [subset.log_evidence; SIZES.len()];
            };
            let own = own.inverse();
            let t = &own * mean;
            let explained = subset.explained - mean.dot(&t);
            let d2 = SIZES[*size] * SIZES[*size];
            let mut s = own;
            for i in 0..k {
                s[(i, i)] -= 1.0 / d2;
            }
            let (values, t) = rotated(s, &t);
            let det: f64 = values.iter().map(|w| (d2 * w).ln_1p()).sum();
            self.curve(&values, &t, explained, subset.log_det - det)
        });
        each.collect()
    }

    /// Log evidence at every prior size of a group with eigenvalues `values` of
    /// its S and `t` in their axes, added to a model that explains so much.
    pub(super) fn curve(&self, values: &[f64], t: &[f64], explained: f64, log_det: f64) -> Curve {
        SIZES.map(|size| {
            let d2 = size * size;
            let (mut det, mut more) = (1.0, 0.0);
            for (w, t) in values.iter().zip(t) {
                let b = 1.0 + d2 * w;
                det *= b;
                more += d2 * t * t / b;
            }
            let rest = self.s - explained - more;
            -0.5 * (log_det + det.ln()) + self.noise.log_evidence(rest)
        })
    }

    /// Pairs of members whose coefficients are correlated most, at most so many.
    #[must_use]
    pub fn coupled(&self, subset: &Subset, most: usize) -> Vec<[usize; 2]> {
        let mut owner = Vec::new();
        for g in &subset.members {
            owner.extend(vec![*g; self.columns[*g].len()]);
        }
        let mut strongest: BTreeMap<[usize; 2], f64> = BTreeMap::new();
        for j in 0..owner.len() {
            for i in (0..j).filter(|i| owner[*i] != owner[j]) {
                let inverse = &subset.inverse;
                let share = inverse[(i, j)].powi(2) / (inverse[(i, i)] * inverse[(j, j)]);
                let known = strongest.entry([owner[i], owner[j]]).or_default();
                *known = known.max(share);
            }
        }
        let mut pairs: Vec<([usize; 2], f64)> = strongest.into_iter().collect();
        pairs.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        pairs.into_iter().take(most).map(|(pair, _)| pair).collect()
    }

    /// The candidates.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }
}
