//! The rigid motion that best carries points onto others.

use nalgebra::{Matrix3, Vector3};
use truearm::Pose;

/// Rigid transform that carries `from` onto `to`: minimises
/// `sum w |R from + t - to|^2` (paper Eq. 17). `None` when the points lie on a
/// line or in one place, so that the rotation is undetermined.
#[must_use]
pub fn rigid_transform(
    from: &[Vector3<f64>],
    to: &[Vector3<f64>],
    weights: &[f64],
) -> Option<Pose<f64>> {
    let total: f64 = weights.iter().sum();
    let mean = |points: &[Vector3<f64>]| {
        points.iter().zip(weights).map(|(p, w)| p * *w).sum::<Vector3<f64>>() / total
    };
    let (centre_from, centre_to) = (mean(from), mean(to));
    let mut h = Matrix3::zeros();
    for ((a, b), w) in from.iter().zip(to).zip(weights) {
        h += (b - centre_to) * (a - centre_from).transpose() * *w;
    }
    turned(&h, [centre_from, centre_to])
}

/// Points that lie this near to a line, root mean square over their distance from the base,
/// say nothing to be relied on of a turn about it: one seat that was met in many postures, a
/// row of holes. What differs between the arms there would be twenty times as much elsewhere.
const NEAR_A_LINE: f64 = 0.05;

/// The frame that carries an arm's points onto the nominal arm's; none where they lie on a
/// line or nearly so, and the nominal frame is as good as any.
#[must_use]
pub fn frame_between(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> Pose<f64> {
    let mut pairs = Pairs::default();
    from.iter().zip(to).for_each(|(from, to)| pairs.add(*from, *to));
    let found =
        if pairs.on_a_line() { None } else { rigid_transform(from, to, &vec![1.0; from.len()]) };
    found.unwrap_or_else(Pose::identity)
}

/// The same question of the moments of points about their middle, and of the sum of squares
/// of their distances from the base.
#[must_use]
pub fn on_a_line(moments: &Matrix3<f64>, far: f64) -> bool {
    let s = moments.singular_values();
    s.sum() - s.max() < far * NEAR_A_LINE * NEAR_A_LINE
}

/// The same of centres and of the sum of `to from'` about them.
fn turned(h: &Matrix3<f64>, [from, to]: [Vector3<f64>; 2]) -> Option<Pose<f64>> {
    let svd = h.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let spread = svd.singular_values[1] / svd.singular_values[0];
    if spread.is_nan() || spread < 1e-9 {
        return None;
    }
    // A reflection fits planar or noisy points as well; it is no motion.
    let mut sign = Matrix3::identity();
    sign[(2, 2)] = (u * v_t).determinant().signum();
    let rotation = u * sign * v_t;
    Some(Pose { rotation, translation: to - rotation * from })
}

/// What a rigid transform needs of pairs of points, in sums.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pairs {
    /// How many they are.
    pub count: f64,
    /// Sums of either side, m.
    pub sums: [Vector3<f64>; 2],
    /// Sum of `to from'`, m^2.
    pub product: Matrix3<f64>,
}

impl Pairs {
    /// One more.
    pub fn add(&mut self, from: Vector3<f64>, to: Vector3<f64>) {
        self.count += 1.0;
        self.sums[0] += from;
        self.sums[1] += to;
        self.product += to * from.transpose();
    }

    /// Both together.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let sum = |k: usize| self.sums[k] + other.sums[k];
        Self {
            count: self.count + other.count,
            sums: [sum(0), sum(1)],
            product: self.product + other.product,
        }
    }

    /// These without some of them.
    #[must_use]
    pub fn less(&self, some: &Self) -> Self {
        let left = |k: usize| self.sums[k] - some.sums[k];
        Self {
            count: self.count - some.count,
            sums: [left(0), left(1)],
            product: self.product - some.product,
        }
    }

    /// As [`rigid_transform`] with equal weights.
    #[must_use]
    pub fn transform(&self) -> Option<Pose<f64>> {
        (self.count >= 3.0)
            .then(|| turned(&self.about(), self.sums.map(|sum| sum / self.count)))
            .flatten()
    }

    /// As [`frame_between`].
    #[must_use]
    pub fn frame(&self) -> Pose<f64> {
        let [from, to] = self.sums.map(|sum| sum / self.count);
        let found = if self.on_a_line() { None } else { turned(&self.about(), [from, to]) };
        found.unwrap_or_else(Pose::identity)
    }

    fn on_a_line(&self) -> bool {
        on_a_line(&self.about(), self.product.trace())
    }

    /// Sum of `to from'` about the centres.
    fn about(&self) -> Matrix3<f64> {
        let [from, to] = self.sums.map(|sum| sum / self.count);
        self.product - to * from.transpose() * self.count
    }
}
