//! Where a positive number no longer changes when it is found anew from itself.

/// A step is taken as far as those before it lead, but no more than this times its length: what
/// a step leaves of the one before it is known roughly.
const FARTHEST: f64 = 20.0;

/// The fixed point of `next` that is reached from a number, to a share of it, in so many rounds
/// at most. A noise scale beside a prior settles by a factor of up to 0.9 a round: two steps
/// tell where all of them lead (Aitken's delta-squared process, in the logarithm).
pub fn fixed_point(from: f64, within: f64, rounds: usize, next: &mut dyn FnMut(f64) -> f64) -> f64 {
    let mut x = from.ln();
    let mut before: Option<f64> = None;
    for _ in 0..rounds {
        let step = next(x.exp()).ln() - x;
        x += step;
        if !step.is_finite() || step.abs() <= within {
            break;
        }
        match before.take() {
            Some(last) if 0.0 < step / last && step / last < 1.0 => {
                let left = step / last;
                x += step * (left / (1.0 - left)).min(FARTHEST);
            }
            _ => before = Some(step),
        }
    }
    x.exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_steps_are_run_ahead_of() {
        for left in [0.0, 0.3, 0.9, 0.95] {
            let (mut asked, to) = (0, 0.6_f64);
            let mut next = |x: f64| {
                asked += 1;
                to * (x / to).powf(left)
            };
            let found = fixed_point(75.0, 1e-3, 60, &mut next);
            assert!((found / to - 1.0).abs() < 0.01, "{left}: {found}");
            assert!(asked < 12, "{left}: {asked}");
        }
    }

    /// What leads nowhere is given up, and what turns about its end comes there.
    #[test]
    fn it_ends() {
        assert!(fixed_point(1.0, 1e-3, 60, &mut |x| 2.0 * x).is_finite());
        let found = fixed_point(9.0, 1e-3, 60, &mut |x: f64| x.powf(-0.5));
        assert!((found - 1.0).abs() < 0.01, "{found}");
        assert!(fixed_point(1.0, 1e-3, 60, &mut |_| 0.0) < 1e-9);
    }
}
