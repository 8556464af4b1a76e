//! Exit status (exit code) of the program: one table for all verbs.

use truearm_host::{Error, ErrorKind};

/// The table of exit statuses, the same for all verbs.
pub const TABLE: &str = "\
Exit status:
  0  done and good
  1  error
  2  wrong usage
  3  found wrong: verify, an error beyond the tolerance; check, a mistake and what undoes it;
     ik and compensate, rows that the arm does not reach or the model does not cover, or
     whose correction is held back so far that most of the miss stays
  4  cannot be decided: verify, the tolerance is within the uncertainty; check, nothing
     explains the disagreement, or there are fewer than 6 poses
     or 8 points";

/// Done and good.
pub const GOOD: u8 = 0;
const ERROR: u8 = 1;
const USAGE: u8 = 2;
/// Found wrong.
pub const WRONG: u8 = 3;
/// Cannot be decided.
pub const UNDECIDED: u8 = 4;

/// How a verb ended.
pub enum End {
    /// Done and good.
    Good,
    /// Done, but not what was asked for.
    Failed(Error),
    /// What was judged is wrong.
    Wrong,
    /// What was judged is neither proven good nor wrong.
    Undecided,
}

/// Of a verb that could not do what it was asked for.
pub fn of(error: &Error) -> u8 {
    if error.kind() == ErrorKind::Usage { USAGE } else { ERROR }
}
