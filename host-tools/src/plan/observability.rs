use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::Serialize;

/// How well a set of poses determines the parameters: five indices of the
/// singular values `s_1 >= ... >= s_p > 0` of the identification Jacobian of
/// `m` poses. The Jacobian is that of the directions that these poses determine,
/// rows in measurement sigmas, columns in manufacturing tolerances; another
/// scaling gives other figures (Hollerbach, Khalil and Gautier, Springer
/// Handbook of Robotics, ch. 14). Larger is better for all of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Observability {
    /// `(s_1 s_2 ... s_p)^(1/p) / sqrt(m)`: Borm and Menq, Int. J. Robotics
    /// Research 10 (1991). What the exchange maximises for a given m.
    pub o1: f64,
    /// `s_p / s_1`, the inverse condition number: Driels and Pathre, J. Robotic
    /// Systems 7 (1990).
    pub o2: f64,
    /// `s_p`: Nahvi, Hollerbach and Hayward, ICRA 1994.
    pub o3: f64,
    /// `s_p^2 / s_1`, noise amplification: Nahvi and Hollerbach, ICRA 1996.
    pub o4: f64,
    /// `1 / (1/s_1 + ... + 1/s_p)`: Sun and Hollerbach, ICRA 2008.
    pub o5: f64,
}

/// Singular values below this share of the largest are a place of an instrument that no
/// pose was chosen at.
const ZERO: f64 = 1e-10;

impl Observability {
    /// Of a Jacobian and its number of poses; and how many directions they determine.
    #[must_use]
    pub fn of(jacobian: &DMatrix<f64>, poses: usize) -> (Self, usize) {
        let mut s: Vec<f64> = jacobian.singular_values().iter().copied().collect();
        let largest = s.iter().copied().fold(0.0, f64::max);
        s.retain(|s| *s > ZERO * largest);
        let smallest = s.iter().copied().fold(largest, f64::min);
        let logs: f64 = s.iter().map(|s| s.ln()).sum();
        let indices = Self {
            o1: (logs / s.len() as f64).exp() / (poses as f64).sqrt(),
            o2: smallest / largest,
            o3: smallest,
            o4: smallest * smallest / largest,
            o5: s.iter().map(|s| 1.0 / s).sum::<f64>().recip(),
        };
        (indices, s.len())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;

    #[test]
    fn by_hand() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0);
        let diagonal = DMatrix::from_diagonal(&DVector::from_vec(vec![8.0, 4.0, 1.0]));
        let jacobian = DMatrix::from_fn(3, 3, |i, j| turn[(i, j)]) * diagonal;
        let (o, told) = Observability::of(&jacobian, 4);
        assert_eq!(told, 3);
        // A place that nothing was measured at takes nothing away.
        let beside = jacobian.clone().insert_column(1, 0.0).insert_rows(3, 2, 0.0);
        assert_eq!(beside.singular_values().len(), 4);
        let (beside, told) = Observability::of(&beside, 4);
        assert_eq!(told, 3);
        assert!((beside.o1 - o.o1).abs() < 1e-12 && (beside.o5 - o.o5).abs() < 1e-12);
        let expected = [32_f64.cbrt() / 2.0, 1.0 / 8.0, 1.0, 1.0 / 8.0, 1.0 / 1.375];
        for (o, expected) in [o.o1, o.o2, o.o3, o.o4, o.o5].into_iter().zip(expected) {
            assert!((o - expected).abs() < 1e-12, "{o} {expected}");
        }
    }
}
