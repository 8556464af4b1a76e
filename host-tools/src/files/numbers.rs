//! Lists of so many numbers, and not one more.

use std::ops::Deref;

use serde::de::{Deserialize, Deserializer, Error};

use crate::error::count;

/// So many numbers. An array takes the first of a longer list, and nobody hears of the rest:
/// of `[1,5, 0, 93]`, with a comma for a point, the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numbers<const N: usize>(pub [f64; N]);

impl<const N: usize> Deref for Numbers<N> {
    type Target = [f64; N];

    fn deref(&self) -> &[f64; N] {
        &self.0
    }
}

impl<'de, const N: usize> Deserialize<'de> for Numbers<N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let list = Vec::<f64>::deserialize(from)?;
        let many = list.len();
        let wrong = |_| {
            let comma = match many > N {
                true => "; decimals have a point, not a comma",
                false => "",
            };
            let numbers = count(many, "number");
            D::Error::custom(format!("{numbers} where {N} are expected{comma}"))
        };
        list.try_into().map(Self).map_err(wrong)
    }
}

/// The same as an array, of a file that has it plain.
pub fn exactly<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<[f64; N], D::Error> {
    Ok(Numbers::deserialize(from)?.0)
}

/// The same of what may be left out.
pub fn if_given<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> Result<Option<[f64; N]>, D::Error> {
    Ok(Some(exactly(from)?))
}
