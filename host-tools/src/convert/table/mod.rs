//! Tables of Denavit-Hartenberg parameters, in and out.

mod read;
mod units;
mod write;

pub use read::{Convention, Table, robot_of_table};
pub use units::Units;
pub use write::{StandardDh, mdh_csv, standard_dh, standard_dh_csv};
