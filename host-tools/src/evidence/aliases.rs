//! Orders that data cannot tell apart: where a joint stood at few levels, evenly
//! spaced, a line is known but for whole numbers of cycles between two levels.

use std::ops::RangeInclusive;

/// Values this close are one level, rad.
const LEVEL: f64 = 2e-3;
/// Sine of half a phase that no noise would show.
const SAME: f64 = 0.1;

/// What may be added to an order at a joint's values without moving anything.
#[derive(Debug, Clone, PartialEq)]
pub struct Aliases {
    shifts: Vec<f64>,
}

impl Aliases {
    /// At these joint values, rad, of orders up to `highest` cycles a turn.
    #[must_use]
    pub fn of(q: &[f64], highest: f64) -> Self {
        let mut levels = q.to_vec();
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|next, kept| *next - *kept < LEVEL);
        let same = |s: &f64| levels.iter().all(|q| (s * (q - levels[0]) / 2.0).sin().abs() < SAME);
        // A joint that stood still tells nothing of any order: no line is offered there.
        let most = if levels.len() > 1 { (2.0 * highest) as usize } else { 0 };
        Self { shifts: (1..=most).map(|s| s as f64).filter(same).collect() }
    }

    /// How many orders of a range look like this one, itself among them.
    #[must_use]
    pub fn count(&self, order: f64, range: &RangeInclusive<f64>) -> usize {
        1 + self.others(order, range).len()
    }

    /// Other orders of a range that look like this one, each once.
    #[must_use]
    pub fn others(&self, order: f64, range: &RangeInclusive<f64>) -> Vec<f64> {
        let of = |s: &f64| [order + s, order - s, s - order];
        let mut out: Vec<f64> =
            self.shifts.iter().flat_map(of).filter(|n| range.contains(n) && *n != order).collect();
        out.sort_by(f64::total_cmp);
        out.dedup();
        out
    }

    /// Whether two orders look alike, known to `within`.
    #[must_use]
    pub fn alike(&self, a: f64, b: f64, within: f64) -> bool {
        let is = |s: &f64| [(a - b).abs(), a + b].iter().any(|x| (x - s).abs() <= within);
        is(&0.0) || self.shifts.iter().any(is)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At steps of 30 degrees orders n, n + 12 k and 12 k - n are one.
    #[test]
    fn orders_are_alike_on_a_grid() {
        let grid: Vec<f64> = (0..70).map(|k| f64::from(k % 7) * 30_f64.to_radians()).collect();
        let aliases = Aliases::of(&grid, 100.0);
        let theirs = (3..=100).filter(|n| (n - 5) % 12 == 0 || (n + 5) % 12 == 0).count();
        assert_eq!(aliases.count(5.0, &(3.0..=100.0)), theirs);
        assert!(
            [17.0, 7.0].iter().all(|n| aliases.alike(5.0, *n, 0.0))
                && !aliases.alike(5.0, 8.0, 0.1)
        );
        // Waves that look alike are linear in each other at every level.
        for order in [17.0, 7.0] {
            let ratio = |q: &f64| ((order * q).cos() - (5.0 * q).cos()).abs();
            assert!(grid.iter().all(|q| ratio(q) < 1e-9));
        }
    }

    /// However many levels a grid has.
    /// Half of what is added leads back to the order itself, and the same from either side.
    #[test]
    fn each_of_them_is_one() {
        let grid: Vec<f64> = (0..40).map(|k| (2.0 * f64::from(k)).to_radians()).collect();
        let of = |order: f64| Aliases::of(&grid, 400.0).others(order, &(1.0..=400.0));
        assert_eq!(of(90.0), [270.0]);
        assert_eq!(of(180.0), [360.0]);
    }

    #[test]
    fn fine_grids_have_aliases_too() {
        let grid: Vec<f64> = (0..720).map(|k| f64::from(k % 180) * 2_f64.to_radians()).collect();
        let aliases = Aliases::of(&grid, 400.0);
        assert_eq!(aliases.count(5.0, &(3.0..=400.0)), 5, "5, 175, 185, 355, 365");
        assert_eq!(aliases.others(5.0, &(3.0..=400.0)), [175.0, 185.0, 355.0, 365.0]);
    }

    #[test]
    fn values_all_over_tell_every_order() {
        let free: Vec<f64> = (0..70).map(|k| f64::from(k * k) * 7.31e-4).collect();
        assert_eq!(Aliases::of(&free, 100.0).count(5.0, &(3.0..=100.0)), 1);
        assert_eq!(Aliases::of(&[0.3; 20], 100.0).count(5.0, &(3.0..=100.0)), 1);
        let fine: Vec<f64> = (0..200).map(|k| f64::from(k) * 1e-2).collect();
        assert_eq!(Aliases::of(&fine, 400.0).count(5.0, &(3.0..=400.0)), 1);
    }
}
