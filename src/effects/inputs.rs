use super::approach::Approach;
use super::statics::Load;

/// What terms depend on at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TermInputs<T, const N: usize> {
    /// Encoder readings, rad or m.
    pub q: [T; N],
    /// Gravity.
    pub load: Load<T, N>,
    /// How each joint came to rest.
    pub approach: [Approach; N],
    /// Temperature above the reference temperature, K; where the arm follows it late,
    /// as the arm has it.
    pub warmth: T,
}
