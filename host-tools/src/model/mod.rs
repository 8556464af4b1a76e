//! What everything else is about: the nominal arm, its measured points, the
//! identified arm and its terms. SI units; nothing here reads or writes a file.

pub mod arm;
mod derivatives;
mod error_curve;
mod gram_state;
mod identified;
mod instrument;
mod measurements;
pub mod near;
mod path;
mod planned;
mod prior;
mod robot;
mod row_inputs;
mod runs;
mod term;
mod values;
mod warming;
mod workspace;

pub use error_curve::{CURVE, CurveFit, ErrorCurve, JointTables};
pub use gram_state::GramState;
pub use identified::{Model, Provenance};
pub use instrument::{Form, Instrument};
pub use measurements::{Commanded, KindId, Measurements, Row};
pub use path::{Coordinates, Path, Target};
pub use planned::PlannedRow;
pub use prior::LinkPrior;
pub use robot::{Joint, LinkMass, Mounting, Placement, Robot};
pub use runs::number_runs;
pub use term::{Clock, Course, ModelTerm, friction, friction_unit, part};
pub(crate) use term::{DRIFT, XYZ};
pub use values::Values;
pub use warming::{Warming, find_sessions};
pub use workspace::{Sight, Workspace};
