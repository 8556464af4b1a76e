use std::ops::{Deref, DerefMut, Div, Index, IndexMut, Mul, Sub};

use nalgebra::{DVectorView, Vector3};

/// Most numbers a row holds of its own kind.
pub const MOST: usize = 8;

/// A few numbers that belong together: what one row measured, or its residual,
/// weights or standard deviations, one a component.
#[derive(Clone, Copy, PartialEq, Default)]
pub struct Values {
    all: [f64; MOST],
    count: usize,
}

impl Values {
    /// `count` times the same.
    #[must_use]
    pub fn repeat(count: usize, value: f64) -> Self {
        Self::from_fn(count, |_| value)
    }

    /// Of each index; at most `MOST`.
    #[must_use]
    pub fn from_fn(count: usize, value: impl Fn(usize) -> f64) -> Self {
        assert!(count <= MOST, "a row has at most {MOST} numbers of its kind");
        Self { all: core::array::from_fn(|k| if k < count { value(k) } else { 0.0 }), count }
    }

    /// Each mapped.
    #[must_use]
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self::from_fn(self.count, |k| f(self.all[k]))
    }

    /// Each with its partner.
    #[must_use]
    pub fn zip_map(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self::from_fn(self.count, |k| f(self.all[k], other.all[k]))
    }

    /// Sum of squares.
    #[must_use]
    pub fn norm_squared(&self) -> f64 {
        self.iter().map(|v| v * v).sum()
    }

    /// Root of the sum of squares.
    #[must_use]
    pub fn norm(&self) -> f64 {
        self.norm_squared().sqrt()
    }

    /// Largest magnitude; 0 of nothing.
    #[must_use]
    pub fn amax(&self) -> f64 {
        self.iter().fold(0.0, |most, v| v.abs().max(most))
    }

    /// What all numbers of all of these are, if they are one.
    #[must_use]
    pub fn common(mut all: impl Iterator<Item = Self> + Clone) -> Option<f64> {
        let one = *all.clone().next()?.first()?;
        let same = |values: Self| values.iter().all(|value| *value == one);
        all.all(same).then_some(one)
    }

    /// As a column.
    #[must_use]
    pub fn column(&self) -> DVectorView<'_, f64> {
        DVectorView::from_slice(self, self.count)
    }

    /// The first three; zeros where there are fewer.
    #[must_use]
    pub fn point(&self) -> Vector3<f64> {
        Vector3::new(self.all[0], self.all[1], self.all[2])
    }
}

impl std::fmt::Debug for Values {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        (**self).fmt(f)
    }
}

impl Deref for Values {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.all[..self.count]
    }
}

impl DerefMut for Values {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.all[..self.count]
    }
}

impl Index<usize> for Values {
    type Output = f64;

    fn index(&self, k: usize) -> &f64 {
        &(**self)[k]
    }
}

impl IndexMut<usize> for Values {
    fn index_mut(&mut self, k: usize) -> &mut f64 {
        &mut (**self)[k]
    }
}

impl From<Vector3<f64>> for Values {
    fn from(v: Vector3<f64>) -> Self {
        Self::from_fn(3, |k| v[k])
    }
}

impl FromIterator<f64> for Values {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut out = Self::default();
        for value in values {
            assert!(out.count < MOST, "a row has at most {MOST} numbers of its kind");
            out.all[out.count] = value;
            out.count += 1;
        }
        out
    }
}

impl Sub for Values {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.zip_map(&other, |a, b| a - b)
    }
}

impl Mul<f64> for Values {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self.map(|v| v * factor)
    }
}

impl Div<f64> for Values {
    type Output = Self;

    fn div(self, divisor: f64) -> Self {
        self.map(|v| v / divisor)
    }
}
