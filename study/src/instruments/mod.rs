//! Kinds of measurements: what each is worth, whether its intervals hold, what
//! two of them together say.

pub mod cases;
pub mod held;
pub mod mixed;
pub mod scanner;
