//! Tail of the chi-square distribution, and what is said of it.

/// Probability that chi-square with `k` degrees of freedom exceeds `x`, by the
/// finite sums for whole and half numbers (Abramowitz and Stegun 26.4.4-5).
#[must_use]
pub fn chi_square(x: f64, k: usize) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    // Terms by their logarithms: the first is nothing where others are not.
    let half = x / 2.0;
    let (mut term, mut sum, from) = if k.is_multiple_of(2) {
        (-half, 0.0, 2)
    } else {
        // The normal tail, twice; then terms x^(1/2), x^(3/2)/3, ...
        let density = 0.5 * (2.0 * x / std::f64::consts::PI).ln() - half;
        (density, libm::erfc(half.sqrt()), 3)
    };
    for i in (from..=k).step_by(2) {
        sum += term.exp();
        term += (x / i as f64).ln();
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

    /// By the normal distribution that it comes to (Wilson and Hilferty), at each end of what
    /// thousands of rows make.
    #[test]
    fn many_degrees_of_freedom_are_no_less_exact() {
        for k in [1_599, 1_600, 20_000, 20_001] {
            for deviations in [-3.0, 0.0, 3.0] {
                let n = 2.0 / (9.0 * k as f64);
                let x = k as f64 * (1.0 - n + deviations * f64::sqrt(n)).powi(3);
                let normal = libm::erfc(deviations / std::f64::consts::SQRT_2) / 2.0;
                let tail = super::chi_square(x, k);
                assert!((tail - normal).abs() < 1e-4, "{k}, {deviations}: {tail} {normal}");
            }
        }
    }
}
