//! Noise with heavy tails: weights instead of cuts.
//!
//! A multivariate Student t with nu degrees of freedom is a normal whose
//! variance differs from row to row; the expected precision of a row given its
//! squared distance is its weight (Lange, Little and Taylor, JASA 84 (1989)
//! 881). Rows, geometry and candidates are multiplied by its root and the
//! normal formulas hold.

/// Degrees of freedom that are tried, heaviest first; infinity is normal noise.
pub const TAILS: [f64; 7] = [3.0, 4.0, 6.0, 10.0, 20.0, 50.0, f64::INFINITY];
/// Heavier tails than normal must be this much likelier (nats).
const WORTH: f64 = 3.0;
/// Steps of the scale for given tails.
const STEPS: usize = 30;

/// Tails and scale of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tails {
    /// Degrees of freedom; infinity for normal noise.
    pub nu: f64,
    /// Scale k of the normal core, in stated sigmas.
    pub scale: f64,
}

/// What is left of one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// Sum of the squares of its residuals over their sigmas.
    pub square: f64,
    /// Equations.
    pub equations: usize,
    /// How much it counts as a row of its own: readings of a pose that have their noise in
    /// common say one thing, however many. Three readings of a pose that is off are no tail.
    pub count: f64,
}

/// Equations of rows, as much as each counts.
fn equations(rows: &[Rest]) -> f64 {
    rows.iter().map(|r| r.equations as f64 * r.count).sum()
}

impl Tails {
    /// The likeliest of [`TAILS`]; `used` equations were used up by the fit.
    #[must_use]
    pub fn of(rows: &[Rest], used: f64) -> Self {
        Self::with_likelihood(rows, used).0
    }

    /// The same, and its logarithm of the likelihood.
    #[must_use]
    pub fn with_likelihood(rows: &[Rest], used: f64) -> (Self, f64) {
        let equations = equations(rows);
        let share = equations / (equations - used).max(1.0);
        let each = TAILS.map(|nu| {
            let tails = Self { nu, scale: 1.0 }.rescaled(rows, share);
            (tails, tails.log_likelihood(rows, share))
        });
        let normal = each[TAILS.len() - 1];
        let best = each.iter().fold(normal, |best, t| if t.1 > best.1 { *t } else { best });
        if best.1 > normal.1 + WORTH { best } else { normal }
    }

    /// Logarithm of the likelihood of rows, less what tails that are heavier than normal must be
    /// likelier by.
    #[must_use]
    pub fn log_evidence(rows: &[Rest], used: f64) -> f64 {
        let (tails, likelihood) = Self::with_likelihood(rows, used);
        if tails.nu.is_finite() { likelihood - WORTH } else { likelihood }
    }

    /// Log likelihood of these rows with their tails, less what formulas for normal noise make of
    /// rows multiplied by the roots of their weights, whose evidence does not know what the weights
    /// cost.
    #[must_use]
    pub fn beyond(&self, rows: &[Rest]) -> f64 {
        let normal = Self { nu: f64::INFINITY, ..*self };
        let weighted: Vec<Rest> =
            rows.iter().map(|r| Rest { square: self.weight(*r) * r.square, ..*r }).collect();
        self.log_likelihood(rows, 1.0) - normal.log_likelihood(&weighted, 1.0)
    }

    fn rescaled(mut self, rows: &[Rest], share: f64) -> Self {
        let equations = equations(rows).max(1.0);
        let mut square = rows.iter().map(|r| r.square * r.count).sum::<f64>() / equations * share;
        for _ in 0..STEPS {
            self.scale = square.sqrt().max(f64::MIN_POSITIVE);
            let sum: f64 = rows.iter().map(|r| self.weight(*r) * r.square * r.count).sum();
            square = sum / equations * share;
        }
        self
    }

    /// Weight of a row, 1 in the mean of its own distribution.
    #[must_use]
    pub fn weight(&self, row: Rest) -> f64 {
        if self.nu.is_infinite() {
            return 1.0;
        }
        let square = row.square / (self.scale * self.scale);
        (self.nu + row.equations as f64) / (self.nu + square)
    }

    /// Residuals are a little smaller than the noise: `share` makes up for it.
    #[must_use]
    pub fn log_likelihood(&self, rows: &[Rest], share: f64) -> f64 {
        let each = rows.iter().map(|r| {
            let m = r.equations as f64;
            let square = r.square * share / (self.scale * self.scale);
            let own = -m * self.scale.ln();
            if self.nu.is_infinite() {
                return r.count * (own - 0.5 * square - 0.5 * m * std::f64::consts::TAU.ln());
            }
            let half = (self.nu + m) / 2.0;
            let constant = libm::lgamma(half)
                - libm::lgamma(self.nu / 2.0)
                - 0.5 * m * (self.nu * std::f64::consts::PI).ln();
            r.count * (own + constant - half * (square / self.nu).ln_1p())
        });
        each.sum()
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    fn normal(rng: &mut impl rand::Rng) -> f64 {
        let (a, b): (f64, f64) = (rng.random_range(1e-12..1.0), rng.random_range(0.0..1.0));
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }

    fn rows(nu: f64, count: usize, scale: f64) -> Vec<Rest> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let row = |_| {
            let whole = if nu.is_finite() { nu as usize } else { 0 };
            let chi: f64 = (0..whole).map(|_| normal(&mut rng).powi(2)).sum();
            let core = if whole > 0 { chi / nu } else { 1.0 };
            let square: f64 = (0..3).map(|_| normal(&mut rng).powi(2)).sum();
            Rest { square: scale * scale * square / core, equations: 3, count: 1.0 }
        };
        (0..count).map(row).collect()
    }

    #[test]
    fn tails_and_scale_are_found() {
        let normal = Tails::of(&rows(f64::INFINITY, 400, 2.0), 0.0);
        assert!(normal.nu >= 20.0 && (normal.scale - 2.0).abs() < 0.1, "{normal:?}");
        let heavy = Tails::of(&rows(4.0, 400, 0.5), 0.0);
        assert!(heavy.nu <= 6.0 && (heavy.scale - 0.5).abs() < 0.05, "{heavy:?}");
    }

    #[test]
    fn a_gross_row_hardly_counts() {
        let tails = Tails { nu: 4.0, scale: 1.0 };
        assert!(tails.weight(Rest { square: 1e4, equations: 3, count: 1.0 }) < 1e-3);
        assert!(tails.weight(Rest { square: 0.0, equations: 3, count: 1.0 }) > 1.0);
    }

    /// Read three times, each reading a third: nothing is heavier than it was.
    #[test]
    fn readings_of_a_pose_say_one_thing() {
        for nu in [4.0, f64::INFINITY] {
            let once = rows(nu, 30, 1.5);
            let thrice: Vec<Rest> =
                once.iter().flat_map(|row| [Rest { count: 1.0 / 3.0, ..*row }; 3]).collect();
            let ([a, b], [c, d]) = (
                [Tails::with_likelihood(&once, 20.0), Tails::with_likelihood(&thrice, 20.0)]
                    .map(|t| t.0),
                [Tails::with_likelihood(&once, 20.0), Tails::with_likelihood(&thrice, 20.0)]
                    .map(|t| t.1),
            );
            assert_eq!(a.nu, b.nu);
            assert!((a.scale / b.scale - 1.0).abs() < 1e-9 && (c - d).abs() < 1e-6);
        }
    }
}
