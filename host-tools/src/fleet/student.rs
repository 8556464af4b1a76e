//! Tail of Student's t.

/// Probability that |t| with `k` degrees of freedom exceeds `t`, by the finite sums of
/// Abramowitz and Stegun 26.7.3-4.
#[must_use]
pub fn beyond(t: f64, k: usize) -> f64 {
    let k = k.max(1);
    let angle = (t.abs() / (k as f64).sqrt()).atan();
    let (sin, cos) = angle.sin_cos();
    let odd = k % 2 == 1;
    let (mut term, mut sum) = if odd { (cos, cos) } else { (1.0, 1.0) };
    let first = if odd { 3 } else { 2 };
    for i in (first..k).step_by(2) {
        let i = i as f64;
        term *= cos * cos * (i - 1.0) / i;
        sum += term;
    }
    let within = match (odd, k) {
        (true, 1) => 2.0 * angle / std::f64::consts::PI,
        (true, _) => 2.0 / std::f64::consts::PI * (angle + sin * sum),
        (false, _) => sin * sum,
    };
    (1.0 - within).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    /// Two-sided quantiles of the tables: 0.05 and 0.001.
    #[test]
    fn agrees_with_the_tables() {
        for (k, five, thousandth) in [
            (1, 12.706, 636.619),
            (2, 4.303, 31.599),
            (3, 3.182, 12.924),
            (4, 2.776, 8.610),
            (5, 2.571, 6.869),
            (10, 2.228, 4.587),
            (30, 2.042, 3.646),
        ] {
            assert!((super::beyond(five, k) - 0.05).abs() < 1e-4, "{k}");
            assert!((super::beyond(thousandth, k) - 0.001).abs() < 1e-6, "{k}");
        }
    }
}
