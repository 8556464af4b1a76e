//! What the headings of other people's tables mean: words, a number, a unit.
//!
//! Knows names only; whether the numbers under a heading agree is for
//! [`import`](crate::import) to see.

mod heading;
mod role;
mod unit;

pub use heading::Heading;
pub use role::{Named, Role, suggestion};
pub use unit::{Quantity, Unit};
