//! How a part may go with a covariate: a few smooth functions.

use std::f64::consts::TAU;

/// Functions of a covariate that was recorded between two values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smooth {
    /// Smallest and largest value, SI.
    pub range: [f64; 2],
    /// Which functions.
    pub shape: Shape,
}

/// Which functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Cosine and sine of so many cycles a turn.
    Wave(u8),
    /// Those of one to so many.
    Waves(u8),
    /// Legendre polynomials of the first to such a degree.
    Bow(u8),
}

/// Cycles a turn that are looked for.
const WAVES: u8 = 3;

/// Degrees that are looked for.
const BOWS: [u8; 4] = [1, 3, 6, 12];

/// Turned farther than this an angle is looked at in waves, rad: half of a turn.
const TURNED: f64 = std::f64::consts::PI;

impl Shape {
    /// Those that so many different values within a range can tell.
    pub fn all(turns: bool, range: [f64; 2], levels: usize) -> Vec<Self> {
        let all: Vec<Self> = match turns && range[1] - range[0] > TURNED {
            true => (1..=WAVES).map(Self::Wave).chain([Self::Waves(WAVES)]).collect(),
            false => BOWS.map(Self::Bow).to_vec(),
        };
        // With as many values as functions any course fits; a constant is geometry's.
        all.into_iter().filter(|shape| levels > shape.count() + 1).collect()
    }

    /// A number for it.
    #[must_use]
    pub fn number(self) -> usize {
        match self {
            Self::Wave(n) => usize::from(n),
            Self::Waves(n) => 100 + usize::from(n),
            Self::Bow(n) => 200 + usize::from(n),
        }
    }

    /// How many functions.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::Wave(_) => 2,
            Self::Waves(most) => 2 * usize::from(most),
            Self::Bow(degree) => usize::from(degree),
        }
    }
}

/// Smallest and largest of some values, which are then sorted: what lies farther beyond the
/// middle 98 % than half of their width is nearer than that and no measure for the others.
/// What comes round (rad) begins behind its widest gap. Nothing of what stands still.
pub fn range(values: &mut [f64], round: bool) -> Option<[f64; 2]> {
    values.sort_by(f64::total_cmp);
    if round {
        let next = |k: usize| match values.get(k + 1) {
            Some(next) => *next,
            None => values[0] + TAU,
        };
        let gap = |k: &usize| next(*k) - values[*k];
        let widest = (0..values.len()).max_by(|a, b| gap(a).total_cmp(&gap(b)))?;
        let begin = next(widest);
        values.iter_mut().for_each(|v| *v = begin + (*v - begin).rem_euclid(TAU));
        values.sort_by(f64::total_cmp);
    }
    let last = values.len().checked_sub(1)?;
    let at = |share: f64| values[(last as f64 * share).round() as usize];
    let (low, high) = (at(0.01), at(0.99));
    let beyond = (high - low) / 2.0;
    let range = [values[0].max(low - beyond), values[last].min(high + beyond)];
    (range[0] < range[1]).then_some(range)
}

impl Smooth {
    /// The functions at a value; of one beyond the range, those at its end.
    #[must_use]
    pub fn at(&self, value: f64) -> Vec<f64> {
        let [low, high] = self.range;
        let wave = |n: u8| {
            let (sin, cos) = (f64::from(n) * value).sin_cos();
            [cos, sin]
        };
        match self.shape {
            Shape::Wave(n) => wave(n).to_vec(),
            Shape::Waves(most) => (1..=most).flat_map(wave).collect(),
            Shape::Bow(degree) => {
                let place = 2.0 * (value - low) / (high - low) - 1.0;
                legendre(place.clamp(-1.0, 1.0), degree)
            }
        }
    }
}

/// Legendre polynomials of degree 1 to `most` (Bonnet's recursion).
fn legendre(x: f64, most: u8) -> Vec<f64> {
    let (mut before, mut now) = (1.0, x);
    let mut out = Vec::with_capacity(most.into());
    for n in 1..=most {
        out.push(now);
        let n = f64::from(n);
        (before, now) = (now, ((2.0 * n + 1.0) * x * now - n * before) / (n + 1.0));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legendre_is_one_at_one_and_orthogonal() {
        assert!(legendre(1.0, 6).iter().all(|p| (p - 1.0).abs() < 1e-14));
        // Midpoints of 20,000 stretches.
        let mut products = [[0.0; 6]; 6];
        for k in 0..20_000 {
            let p = legendre((f64::from(k) + 0.5) / 1e4 - 1.0, 6);
            for i in 0..6 {
                (0..6).for_each(|j| products[i][j] += p[i] * p[j] * 1e-4);
            }
        }
        for (i, row) in products.iter().enumerate() {
            for (j, product) in row.iter().enumerate() {
                let exact = if i == j { 2.0 / (2.0 * i as f64 + 3.0) } else { 0.0 };
                assert!((product - exact).abs() < 1e-6, "{i} {j} {product}");
            }
        }
    }

    #[test]
    fn few_values_tell_few_functions() {
        let shapes = |levels| Shape::all(false, [0.0, 1.0], levels);
        assert_eq!(shapes(2), []);
        assert_eq!(shapes(3), [Shape::Bow(1)]);
        assert_eq!(shapes(5), [Shape::Bow(1), Shape::Bow(3)]);
        assert_eq!(shapes(8).len(), 3);
        assert_eq!(shapes(14).len(), 4);
        assert_eq!(Shape::all(true, [-2.0, 2.0], 100).len(), 4);
        assert_eq!(Shape::all(true, [-1.0, 1.0], 100).len(), 4);
    }
}
