//! Kinds of measurements: what each is worth, whether its intervals hold, what
//! two of them together say, whether effects are named from them.

mod bent;
pub mod cases;
pub mod held;
pub mod mixed;
pub mod named;
pub mod scanner;
pub mod worth;
