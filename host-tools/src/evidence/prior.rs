//! What is believed before the data are seen. The prior of a name is split
//! over all places and variants it may take: that is the price of looking in
//! many places, and the only one.

/// Probability that an arm has an effect of this name at all. With eleven
/// names 0.88 effects are expected, fewer than real arms have (3 to 8).
pub const NAME: f64 = 0.08;

/// Sizes an effect may have, in noise floors (3-D RMS before anything is
/// projected out), each as likely as the other: 0.5 is at the edge of what 20
/// rows can show, 50 a defect.
pub const SIZES: [f64; 5] = [0.5, 1.5, 5.0, 15.0, 50.0];

/// Share of the prior of lines that whole orders have: gears, bearings and
/// magnets repeat a whole number of times a turn of some shaft.
pub const WHOLE: f64 = 0.5;

/// Log prior odds of one of `places` x `variants` ways to have an effect.
#[must_use]
pub fn log_odds(places: usize, variants: usize) -> f64 {
    of(NAME / (places.max(1) * variants.max(1)) as f64)
}

/// Log prior odds of a line of one order at one of `joints` joints, scanned
/// over `orders` orders of which `whole` are whole numbers.
#[must_use]
pub fn line_log_odds(joints: usize, orders: usize, whole: usize, is_whole: bool) -> f64 {
    let joint = NAME / joints.max(1) as f64;
    let grid = (1.0 - WHOLE) / orders.max(1) as f64;
    of(joint * if is_whole { WHOLE / whole.max(1) as f64 } else { grid })
}

fn of(probability: f64) -> f64 {
    probability.ln() - (-probability).ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_ways_together_have_the_prior_of_the_name() {
        let one = 1.0 / (1.0 + (-log_odds(6, 4)).exp());
        assert!((24.0 * one - NAME).abs() < 1e-12);
        let line = |whole| 1.0 / (1.0 + (-line_log_odds(6, 100, 40, whole)).exp());
        let all = 6.0 * (100.0 * line(false) + 40.0 * line(true));
        assert!((all - NAME).abs() < 1e-12);
    }
}
