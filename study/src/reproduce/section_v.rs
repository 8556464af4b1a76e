//! The simulation of section V: nine poses, 27 equations, 30 parameters.

use truearm::{Link, LinkParameter};

use super::cell::{Cell, Kind};
use truearm_host::error::Result;
use truearm_host::evaluate::residuals;
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Conditions, Problem, Scaling, State, nominal_state};
use truearm_host::methods::{Frames, Method, NoCalibration, PrintedRpim, Rpim, Task};
use truearm_host::model::Measurements;
use truearm_host::statistics::Stats;

/// Tables 2 to 5.
pub struct NinePoses {
    /// The cell.
    pub cell: Cell,
    /// Nominal points carried into the tracker's frame, m.
    pub reference: Vec<nalgebra::Vector3<f64>>,
    /// Name, state, errors of the nine points (mm), errors of others.
    pub methods: Vec<(&'static str, State, Vec<f64>, Option<Stats>)>,
}

/// Runs the simulation.
///
/// # Errors
/// When nine poses do not even fix the frames.
pub fn nine_poses(seed: u64) -> Result<NinePoses> {
    let cell = Cell::draw(seed, Kind::Geometric)?;
    let robot = &cell.arm.robot;
    let problem = Problem::new(&cell.nine, robot, Scaling::Prior);
    let rows: Vec<usize> = (0..cell.nine.rows.len()).collect();
    let first = register(&cell.nine, &problem.nominal, robot.tool)?;
    let start = nominal_state(&problem, &rows, &first)?;
    let task = Task::new(&problem, start, &rows, Frames::Held);
    let errors =
        |data: &Measurements, state: &State| residuals(data, &Conditions::new(data, robot), state);
    let reference = cell
        .nine
        .rows
        .iter()
        .zip(errors(&cell.nine, task.start()))
        .map(|(row, r)| row.measured.point() - r.point())
        .collect();
    let mut methods = Vec::new();
    let all: [&dyn Method; 3] = [&NoCalibration, &PrintedRpim, &Rpim];
    for method in all {
        let state = method.solve(&task)?.state;
        let nine = errors(&cell.nine, &state).iter().map(|r| r.norm() * 1e3).collect();
        let exact = Stats::of(errors(&cell.exact, &state));
        methods.push((method.name(), state, nine, exact));
    }
    Ok(NinePoses { reference, methods, cell })
}

/// Corrections of a state to nominal links in mm and mrad: a row a parameter.
#[must_use]
pub fn corrections(state: &State, nominal: &[Link<f64>]) -> Vec<(String, f64)> {
    let mut out = Vec::new();
    for (i, (link, nominal)) in state.links.iter().zip(nominal).enumerate() {
        let (now, then) = (link.parameters.to_array(), nominal.parameters.to_array());
        for (k, parameter) in LinkParameter::ALL.into_iter().enumerate() {
            let name = format!("{} {}", parameter.name(), i + 1);
            out.push((name, (now[k] - then[k]) * 1e3));
        }
    }
    out
}
