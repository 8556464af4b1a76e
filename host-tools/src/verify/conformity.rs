//! Whether errors conform to a tolerance: ISO 14253-1 for whoever has to prove conformity.

use schemars::JsonSchema;
use serde::Serialize;

use super::kinds::{COVERAGE_FACTOR, KindVerified};

/// What a tolerance says of the errors, the worst last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Conformity {
    /// The largest error and its uncertainty are within the tolerance.
    Pass,
    /// The tolerance lies within the uncertainty of the largest error.
    NotProven,
    /// The largest error is beyond it by more than the uncertainty of the largest of so many.
    Fail,
}

impl KindVerified {
    /// Whether the errors conform to a tolerance in their unit. They do where the tolerance
    /// less the expanded uncertainty holds the largest; with k = 2 the guard band is that of
    /// the editions of 1998 and 2013 and wider than the 1.65 standard uncertainties of 2017.
    /// They do not where the largest is farther out than noise takes the largest of as many
    /// errors that all are at the tolerance: the more rows, the farther (Sidak, JASA 62
    /// (1967) 626), or every arm would fail that is measured often enough.
    #[must_use]
    pub fn conformity(&self, tolerance: f64) -> Conformity {
        let u = self.expanded_uncertainty / COVERAGE_FACTOR;
        if self.max + self.expanded_uncertainty <= tolerance {
            Conformity::Pass
        } else if self.max - beyond(tolerance, u, self.rows, self.components) > tolerance {
            Conformity::Fail
        } else {
            Conformity::NotProven
        }
    }
}

/// How often noise takes one error beyond k = 2 standard deviations, one way.
fn one_way() -> f64 {
    tail(COVERAGE_FACTOR)
}

/// How far beyond a tolerance the largest of so many measured errors is, with that
/// probability, where each is at the tolerance and has noise of standard deviation u in each
/// of its components.
fn beyond(tolerance: f64, u: f64, rows: usize, components: usize) -> f64 {
    if u <= 0.0 {
        return 0.0;
    }
    let all = (1.0 - one_way()).ln() / rows.max(1) as f64;
    let each = -all.exp_m1();
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match farther(tolerance / u, middle, components) > each {
            true => low = middle,
            false => high = middle,
        }
    }
    high * u
}

/// Enough for twelve digits.
const HALVINGS: usize = 50;

/// Probability that a vector of length t with noise of standard deviation 1 in each component
/// is measured longer than t + more: the tail of a non-central chi-square distribution, for
/// three components in closed form (Johnson, Kotz and Balakrishnan, Continuous Univariate
/// Distributions 2, 29.3). Of two it is smaller.
fn farther(t: f64, more: f64, components: usize) -> f64 {
    let length = t + more;
    let sides = tail(more) + tail(length + t);
    if components < 2 {
        return sides;
    }
    let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
    // (density(more) - density(length + t)) / t, and its limit.
    let slope = match t > 1e-6 {
        true => (density(more) - density(length + t)) / t,
        false => 2.0 * length * density(length),
    };
    sides + slope
}

/// Probability that a normal deviate is beyond x.
fn tail(x: f64) -> f64 {
    0.5 * libm::erfc(x / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn kind(max: f64, u: f64, rows: usize, components: usize) -> KindVerified {
        KindVerified {
            kind: "point",
            unit: "mm",
            rows,
            mean: 0.0,
            rms: 0.0,
            max,
            expanded_uncertainty: COVERAGE_FACTOR * u,
            components,
            predicted_without_compensation_rms: None,
        }
    }

    /// Of arms all of whose errors are within, however many rows are measured and however
    /// large the noise is, at most one in 44 fails; one error of 1.5 times the tolerance and
    /// six standard deviations always does.
    #[test]
    fn an_arm_within_its_tolerance_does_not_fail() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for components in [1, 2, 3] {
            for (rows, files) in [(1, 4000), (20, 1500), (500, 300)] {
                for t in [0.05, 1.0, 10.0, 1000.0] {
                    let mut failed = 0;
                    for _ in 0..files {
                        let mut normal = || {
                            let uniform = |rng: &mut ChaCha8Rng| rng.random_range(1e-16..1.0_f64);
                            let radius = (-2.0 * uniform(&mut rng).ln()).sqrt();
                            radius * (std::f64::consts::TAU * uniform(&mut rng)).cos()
                        };
                        let error = |_| {
                            let along = t + normal();
                            let across: f64 = (1..components).map(|_| normal().powi(2)).sum();
                            (along * along + across).sqrt()
                        };
                        let max = (0..rows).map(error).fold(0.0, f64::max);
                        let found = kind(max, 1.0, rows, components).conformity(t);
                        failed += u32::from(found == Conformity::Fail);
                    }
                    let most = f64::from(files) * one_way();
                    let most = most + 4.0 * most.sqrt();
                    assert!(f64::from(failed) <= most, "{components} {rows} {t}: {failed}");
                    let far = kind(1.5 * t + 6.0, 1.0, rows, components);
                    assert_eq!(far.conformity(t), Conformity::Fail);
                }
            }
        }
    }

    /// A single error is judged as the standard has it; one that is known exactly by itself.
    #[test]
    fn one_error_is_judged_as_by_the_standard() {
        for (max, found) in [
            (0.9, Conformity::Pass),
            (0.97, Conformity::NotProven),
            (1.03, Conformity::NotProven),
            (1.05, Conformity::Fail),
        ] {
            assert_eq!(kind(max, 0.02, 1, 1).conformity(1.0), found, "{max}");
        }
        assert_eq!(kind(1.0, 0.0, 9, 3).conformity(1.0), Conformity::Pass);
        assert_eq!(kind(1.0 + 1e-9, 0.0, 9, 3).conformity(1.0), Conformity::Fail);
    }
}
