/// Counts of residuals in stated sigmas, by size: bins of one per cent.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Histogram(pub Vec<u64>);

/// Logarithm of the lower edge of the first bin that has one, and of the width of all.
const FIRST: f64 = -9.0;
const WIDTH: f64 = 0.01;
/// Bins: up to 1e8 sigmas.
pub(super) const BINS: usize = 2743;

impl Default for Histogram {
    fn default() -> Self {
        Self(vec![0; BINS])
    }
}

impl Histogram {
    /// One more residual, in sigmas.
    pub fn add(&mut self, residual: f64) {
        let bin = (residual.abs().ln() - FIRST) / WIDTH;
        // Also of 0, whose logarithm is minus infinity, and of what is no number.
        self.0[bin.clamp(0.0, (BINS - 1) as f64) as usize] += 1;
    }

    /// Both together.
    pub fn plus(mut self, other: &Self) -> Self {
        self.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a = a.saturating_add(*b));
        self
    }

    /// How many.
    pub fn count(&self) -> u64 {
        self.0.iter().fold(0, |sum, count| sum.saturating_add(*count))
    }

    /// Robust standard deviation of residuals about zero; 0 of none.
    pub fn scale(&self) -> f64 {
        let half = self.count() as f64 / 2.0;
        let mut below = 0.0;
        for (bin, count) in self.0.iter().enumerate().filter(|(_, count)| **count > 0) {
            let count = *count as f64;
            if below + count >= half {
                let within = (half - below) / count;
                return 1.4826 * (FIRST + WIDTH * (bin as f64 + within)).exp();
            }
            below += count;
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::mad_scale;

    #[test]
    fn as_the_median_has_it() {
        for scale in [1e-2, 1.0, 37.0] {
            let values: Vec<f64> =
                (0..4001).map(|k| scale * (f64::from(k) * 0.618).fract().powi(2)).collect();
            let mut found = Histogram::default();
            values.iter().for_each(|v| found.add(*v));
            let ratio = found.scale() / mad_scale(&values);
            assert!((ratio - 1.0).abs() < 0.006, "{scale}: {ratio}");
        }
        assert_eq!(Histogram::default().scale(), 0.0);
        let mut odd = Histogram::default();
        [0.0, f64::NAN, f64::INFINITY, 1e300].iter().for_each(|v| odd.add(*v));
        assert_eq!(odd.count(), 4);
    }
}
