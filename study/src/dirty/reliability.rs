//! Stated probabilities against the share that is true.

use truearm_host::plot::{Axis, Ink, Mark, Panel, Series};

use super::score::{Claimed, Worth};

/// Borders of the bins of stated probability.
const BINS: [f64; 8] = [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.000_001];

/// Claims of about one probability.
#[derive(Debug, Clone)]
pub struct Bin {
    /// Borders.
    pub range: [f64; 2],
    pub claims: usize,
    /// Mean of what is stated.
    pub stated: f64,
    /// How many are true.
    pub right: usize,
    /// How many are named, of these true ones, and false ones that nobody could tell from
    /// what is there.
    pub named: [usize; 3],
}

impl Bin {
    /// Of so many claims the share that is true.
    pub fn share(&self) -> f64 {
        self.right as f64 / self.claims as f64
    }

    /// Where that share is with 95 % (Wilson, JASA 22 (1927) 209).
    fn interval(&self) -> (f64, f64) {
        let (n, p, z) = (self.claims as f64, self.share(), 1.96_f64);
        let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + (z / (2.0 * n)).powi(2)).sqrt();
        (middle - half, middle + half)
    }
}

/// Those that have claims.
pub fn bins(claims: &[&Claimed]) -> Vec<Bin> {
    let of = |range: &[f64]| {
        let own = claims.iter().filter(|c| (range[0]..range[1]).contains(&c.probability));
        let own: Vec<_> = own.collect();
        let count = |which: &dyn Fn(&Claimed) -> bool| own.iter().filter(|c| which(c)).count();
        let right = |c: &Claimed| c.worth == Worth::True;
        Bin {
            range: [range[0], range[1].min(1.0)],
            claims: own.len(),
            stated: own.iter().map(|c| c.probability).sum::<f64>() / own.len() as f64,
            right: count(&right),
            named: [
                count(&|c| c.named),
                count(&|c| c.named && right(c)),
                count(&|c| c.named && c.alike),
            ],
        }
    };
    BINS.windows(2).map(of).filter(|bin| bin.claims > 0).collect()
}

/// Mean difference between what is stated and what is true, over claims.
pub fn expected_error(bins: &[Bin]) -> f64 {
    let claims: usize = bins.iter().map(|bin| bin.claims).sum();
    let off = bins.iter().map(|bin| bin.claims as f64 * (bin.stated - bin.share()).abs());
    off.sum::<f64>() / claims.max(1) as f64
}

/// The diagram: a point a bin, with the interval in which its share is.
pub fn diagram(bins: &[Bin]) -> Panel {
    let note =
        |bin: &Bin| format!("{} of {} true, {:.3} stated", bin.right, bin.claims, bin.stated);
    let even = Series::line("as stated", vec![(0.0, 0.0), (1.0, 1.0)]).ink(Ink::MODEL);
    let points = bins.iter().map(|bin| (bin.stated, bin.share())).collect();
    let found = Series::new("found, with 95 % intervals", points, Mark::Intervals)
        .ends(bins.iter().map(Bin::interval).collect())
        .notes(bins.iter().map(note).collect())
        .ink(Ink::AFTER);
    let claims: usize = bins.iter().map(|bin| bin.claims).sum();
    let title = format!("Of {claims} claims, how many are true");
    let axes = ["stated probability", "share that is true"].map(Axis::linear);
    let [x, y] = axes;
    Panel { size: (560.0, 420.0), ..Panel::new(title, x, y, vec![even, found]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_stated_as_often_as_it_is_true_has_no_error() {
        let of = |probability: f64, worth: Worth| Claimed {
            place: (String::new(), Vec::new()),
            probability,
            named: false,
            doubt: None,
            worth,
            alike: false,
        };
        let claims = [of(0.75, Worth::True), of(0.75, Worth::True), of(0.75, Worth::True)];
        let claims: Vec<&Claimed> = claims.iter().collect();
        let wrong = of(0.75, Worth::False);
        assert!((expected_error(&bins(&claims)) - 0.25).abs() < 1e-12);
        assert!(expected_error(&bins(&[&claims[..], &[&wrong]].concat())) < 1e-12);
    }
}
