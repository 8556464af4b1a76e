//! Tail of the chi-square distribution, and what is said of it.

/// Probability that chi-square with `k` degrees of freedom exceeds `x`, by the
/// finite sums for whole and half numbers (Abramowitz and Stegun 26.4.4-5).
#[must_use]
pub fn chi_square(x: f64, k: usize) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let half = x / 2.0;
    let (mut term, mut sum, from) = if k.is_multiple_of(2) {
        ((-half).exp(), (-half).exp(), 1)
    } else {
        let root = x.sqrt();
        let density = (2.0 / std::f64::consts::PI).sqrt() * (-half).exp();
        // The normal tail, twice; then terms x^(1/2), x^(3/2)/3, ...
        (density * root, libm::erfc(root / std::f64::consts::SQRT_2), 3)
    };
    if k.is_multiple_of(2) {
        for i in from..k / 2 {
            term *= half / i as f64;
            sum += term;
        }
    } else {
        for i in (from..=k).step_by(2) {
            sum += term;
            term *= x / i as f64;
        }
    }
    sum.min(1.0)
}

/// A p value in words.
pub fn chance(p: f64) -> String {
    if p < 1e-99 { "p < 1e-99".to_owned() } else { format!("p = {p:.1e}") }
}

#[cfg(test)]
mod tests {
    /// Quantiles of the tables: 0.05 and 0.001.
    #[test]
    fn agrees_with_the_tables() {
        for (k, five, thousandth) in [
            (1, 3.841, 10.828),
            (2, 5.991, 13.816),
            (3, 7.815, 16.266),
            (4, 9.488, 18.467),
            (5, 11.070, 20.515),
            (6, 12.592, 22.458),
        ] {
            assert!((super::chi_square(five, k) - 0.05).abs() < 1e-4, "{k}");
            assert!((super::chi_square(thousandth, k) - 0.001).abs() < 1e-6, "{k}");
        }
    }
}
