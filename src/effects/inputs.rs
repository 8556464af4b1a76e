use super::statics::Load;

/// What terms depend on at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Inputs<T, const N: usize> {
    /// Encoder readings, rad or m.
    pub q: [T; N],
    /// Gravity.
    pub load: Load<T, N>,
    /// Side from which each joint came to rest: +1, -1, or 0 if unknown.
    pub direction: [T; N],
    /// Temperature above the reference temperature, K.
    pub warmth: T,
}
