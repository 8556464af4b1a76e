//! Lambda from the factorised problem alone: the corner of the L-curve,
//! generalised cross-validation, discrepancy, marginal likelihood.

use super::Factorised;

impl Factorised {
    /// Lambdas worth trying: 1e-12 to 100 times the largest singular value
    /// squared, sixteen a decade.
    #[must_use]
    pub fn grid(&self) -> Vec<f64> {
        let largest = self.s.iter().copied().fold(0.0, f64::max).powi(2);
        (0..=14 * 16).map(|i| largest * 10_f64.powf(-12.0 + f64::from(i) / 16.0)).collect()
    }

    /// The lambda with the least value: of the grid, then between its neighbours
    /// by golden section. Of equal values the larger lambda.
    fn least(&self, value: impl Fn(f64) -> f64) -> Option<f64> {
        let values = self.grid().into_iter().rev().map(|l| (l, value(l)));
        let finite = values.filter(|v| v.0 > 0.0 && v.1.is_finite());
        let (best, _) = finite.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let step = 10_f64.ln() / 16.0;
        let (mut low, mut high) = (best.ln() - step, best.ln() + step);
        let golden = (5_f64.sqrt() - 1.0) / 2.0;
        while high - low > 1e-6 {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if value(a.exp()) < value(b.exp()) { high = b } else { low = a }
        }
        Some(((low + high) / 2.0).exp())
    }

    /// Directions above rounding.
    fn directions(&self) -> impl Iterator<Item = usize> {
        (0..self.s.len()).filter(|k| self.s[*k] > self.noise * self.s[0])
    }

    /// Generalised cross-validation (Golub, Heath, Wahba 1979): the least
    /// `|r|^2 / (equations - effective parameters)^2`.
    #[must_use]
    pub fn gcv(&self) -> Option<f64> {
        self.least(|lambda| {
            let used: f64 = self.directions().map(|k| self.gain(k, lambda) * self.s[k]).sum();
            let left = self.equations - used;
            if left > 0.5 { self.residual_square(lambda) / (left * left) } else { f64::NAN }
        })
    }

    /// Morozov's discrepancy principle: as much regularisation as leaves a
    /// residual of the stated noise, of this standard deviation an equation.
    /// `None` where even the plain solution leaves more.
    #[must_use]
    pub fn discrepancy(&self, sigma: f64) -> Option<f64> {
        let target = self.equations * sigma * sigma;
        self.grid().into_iter().rev().find(|l| *l > 0.0 && self.residual_square(*l) <= target)
    }

    /// Maximum of the marginal likelihood: noise and penalised unknowns both
    /// normal, of unknown standard deviations whose ratio squared is lambda; the
    /// noise is eliminated.
    #[must_use]
    pub fn maximum_likelihood(&self) -> Option<f64> {
        self.least(|lambda| self.deviance(lambda))
    }

    /// Minus twice the logarithm of the marginal likelihood of a lambda, but for what
    /// is the same of every lambda and every prior of the same equations.
    #[must_use]
    pub fn deviance(&self, lambda: f64) -> f64 {
        // In each direction beta has the variance sigma^2 (1 + s^2 / lambda);
        // in those at rounding level that of the noise.
        let share = |k: usize| 1.0 - self.gain(k, lambda) * self.s[k];
        let weighted: f64 = (0..self.s.len()).map(|k| self.beta[k].powi(2) * share(k)).sum();
        let spread: f64 = self.directions().map(|k| (1.0 + self.s[k].powi(2) / lambda).ln()).sum();
        self.equations * (self.rest + weighted).ln() + spread
    }

    /// The corner of the L-curve (paper Eq. 15-16): the lambda of greatest
    /// curvature of log residual norm against log solution norm, with exact
    /// derivatives. Points where neither axis moves by 1e-3 a decade are passed
    /// over: on a rank-deficient problem the curve stalls there. `None` when
    /// the curve has no corner.
    #[must_use]
    pub fn corner(&self) -> Option<f64> {
        let grid = self.grid().into_iter().filter(|l| *l > 0.0);
        let curved = grid.filter_map(|lambda| Some((lambda, self.curvature(lambda)?)));
        let best = curved.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (best.1 > 0.0).then_some(best.0)
    }

    /// Curvature of the L-curve at lambda, positive where it bends as an L
    /// does; `None` where the curve stands still.
    #[must_use]
    pub fn curvature(&self, lambda: f64) -> Option<f64> {
        let (rho, eta) = (self.residual_square(lambda), self.norm_square(lambda));
        // First and second derivative of eta by lambda; rho' = -lambda eta'.
        let (mut d1, mut d2) = (0.0, 0.0);
        for k in (0..self.s.len()).filter(|k| self.s[*k] > self.noise * self.s[0]) {
            let (s2, b2) = (self.s[k].powi(2), self.beta[k].powi(2));
            d1 -= 2.0 * s2 * b2 / (s2 + lambda).powi(3);
            d2 += 6.0 * s2 * b2 / (s2 + lambda).powi(4);
        }
        // By ln(lambda).
        let eta1 = lambda * d1;
        let eta2 = lambda * d1 + lambda * lambda * d2;
        let rho1 = -lambda * eta1;
        let rho2 = -lambda * (eta1 + eta2);
        let log =
            |f: f64, f1: f64, f2: f64| (f1 / (2.0 * f), f2 / (2.0 * f) - (f1 / f).powi(2) / 2.0);
        let ((u1, u2), (v1, v2)) = (log(rho, rho1, rho2), log(eta, eta1, eta2));
        let stalled = u1.abs() < 1e-3 && v1.abs() < 1e-3;
        let curvature = (u1 * v2 - v1 * u2) / (u1 * u1 + v1 * v1).powf(1.5);
        (!stalled && curvature.is_finite()).then_some(curvature)
    }
}
