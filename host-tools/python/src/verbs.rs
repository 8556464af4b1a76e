use std::path::PathBuf;

use numpy::PyArray2;
use pyo3::prelude::*;
use truearm_host::check::{self as gross, Ended, explained, remark};
use truearm_host::diagnose::{self as diagnosis, DiagnoseOptions};
use truearm_host::evaluate::{self as evaluation, Reregister};
use truearm_host::files::Gathered;
use truearm_host::identify::{self as identification, Options, allowing};
use truearm_host::model::{Commanded, Workspace};
use truearm_host::observations::by_name;
use truearm_host::plan::{self as planning, PlanOptions};
use truearm_host::report::{
    CheckReport, DiagnoseReport, EvaluateReport, IdentifyReport, PlanReport, VerifyReport, to_json,
};
use truearm_host::verify::{self as verification, Tolerances};

use crate::arrays::matrix;
use crate::measurements::Measurements;
use crate::model::Model;
use crate::refused;
use crate::robot::Robot;

/// How to go on with fewer equations than unknowns.
const ALLOW_FEW: &str = "allow_few_poses=True";

/// A model and the report that came with it.
#[pyclass(frozen, module = "truearm")]
pub struct Found {
    #[pyo3(get)]
    model: Py<Model>,
    #[pyo3(get)]
    json: String,
}

impl Found {
    /// Of a model and its report.
    pub fn new(py: Python<'_>, model: truearm_host::model::Model, json: String) -> PyResult<Self> {
        Ok(Self { model: Py::new(py, Model { inner: model })?, json })
    }
}

/// Identifies the geometry of an arm.
#[pyfunction]
#[pyo3(signature = (robot, data, allow_few_poses=false))]
pub fn identify(
    py: Python<'_>,
    robot: &Robot,
    data: &Measurements,
    allow_few_poses: bool,
) -> PyResult<Found> {
    let options = Options { allow_few_poses, ..Options::default() };
    let (robot, data) = (&robot.inner, &data.inner);
    let found = py.detach(|| {
        let found = identification::identify(robot, data, &options, &|_, _| ());
        let mut found = found.map_err(|error| explained(error, robot, data))?;
        found.figures.warnings.extend(remark(Ended::of(&found.figures), robot, data));
        Ok(found)
    });
    let found = found.map_err(|error| refused(allowing(error, ALLOW_FEW)))?;
    let json = to_json(&IdentifyReport::new(found.figures, None));
    Found::new(py, found.model, json)
}

/// Finds what geometry does not explain, names it and adds it.
#[pyfunction]
#[pyo3(signature = (robot, data, holdout=None, most_terms=None, highest_order=None, allow_few_poses=false))]
pub fn diagnose(
    py: Python<'_>,
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    most_terms: Option<usize>,
    highest_order: Option<f64>,
    allow_few_poses: bool,
) -> PyResult<Found> {
    let usual = DiagnoseOptions::default();
    let options = DiagnoseOptions {
        highest_order: highest_order.unwrap_or(usual.highest_order),
        most_terms: most_terms.unwrap_or(usual.most_terms),
        allow_few_poses,
    };
    let (robot, data, holdout) = (&robot.inner, &data.inner, holdout.map(|h| &h.inner));
    let found = py.detach(|| {
        let found = diagnosis::diagnose(robot, data, holdout, &options, &|_| ());
        let mut found = found.map_err(|error| explained(error, robot, data))?;
        let figures = &mut found.outcome.figures;
        figures.warnings.extend(remark(Ended::of(figures), robot, data));
        Ok(found)
    });
    let found = found.map_err(|error| refused(allowing(error, ALLOW_FEW)))?;
    let json = to_json(&DiagnoseReport::new(found.outcome));
    Found::new(py, found.model, json)
}

/// Looks for gross mistakes in robot and measurements: the report as JSON.
#[pyfunction]
pub fn check(py: Python<'_>, robot: &Robot, data: &Measurements) -> PyResult<String> {
    let finding = py.detach(|| gross::check(&robot.inner, &data.inner));
    let [a, b] = [&robot.inner.path, &data.inner.path].map(|path| path.display().to_string());
    let warnings = [robot.inner.warnings.clone(), data.inner.warnings.clone()].concat();
    Ok(to_json(&CheckReport::new(a, b, &finding, warnings)))
}

/// Scores a model on other measurements, in the frame of the training station: the
/// report as JSON. `reregister` takes base, or base and tool, anew.
#[pyfunction]
#[pyo3(signature = (model, data, reregister=None))]
pub fn evaluate(
    py: Python<'_>,
    model: &Model,
    data: &Measurements,
    reregister: Option<&str>,
) -> PyResult<String> {
    let frames = match reregister {
        None => Reregister::default(),
        Some("base") => Reregister::Base,
        Some("base+tool") => Reregister::BaseAndTool,
        Some(other) => {
            return Err(crate::wrong(format!("reregister={other:?}"), "give base or base+tool"));
        }
    };
    let found = py.detach(|| evaluation::evaluate(&model.inner, &data.inner, frames));
    let found = found.map_err(refused)?;
    let file = model.inner.robot.path.display().to_string();
    Ok(to_json(&EvaluateReport::new(file, found, data.inner.warnings.clone())))
}

/// Compares commanded with measured: the report as JSON.
#[pyfunction]
#[pyo3(signature = (model, path, reregister=false, tolerance_mm=None, tolerance_deg=None))]
pub fn verify(
    py: Python<'_>,
    model: &Model,
    path: PathBuf,
    reregister: bool,
    tolerance_mm: Option<f64>,
    tolerance_deg: Option<f64>,
) -> PyResult<String> {
    let data = Commanded::read(&path, &model.inner).map_err(refused)?;
    let after = py.detach(|| verification::verify(&model.inner, &data, reregister));
    let after = after.map_err(refused)?;
    let file = model.inner.robot.path.display().to_string();
    let warnings = [data.data.warnings.clone(), after.warnings.clone()].concat();
    let tolerances = Tolerances { mm: tolerance_mm, deg: tolerance_deg };
    let report = VerifyReport::new(file, None, after, tolerances, warnings).map_err(refused)?;
    Ok(to_json(&report))
}

/// Poses to measure, of which measurements of a kind determine the arm best, with the
/// instruments.toml beside the robot's file: joint values (n x joints, rad or m) and the
/// report as JSON.
#[pyfunction]
#[pyo3(signature = (robot, poses=20, candidates=3000, target_um=None, seed=1, kind="point"))]
pub fn plan<'py>(
    py: Python<'py>,
    robot: &Robot,
    poses: usize,
    candidates: usize,
    target_um: Option<f64>,
    seed: u64,
    kind: &str,
) -> PyResult<(Bound<'py, PyArray2<f64>>, String)> {
    let workspace = Workspace::new(&robot.inner, None).map_err(refused)?;
    let target = target_um.map(|um| um * 1e-6);
    let kind = by_name(kind).ok_or_else(|| {
        crate::wrong(format!("kind={kind:?}"), "give a kind of measurements.csv, such as touch")
    })?;
    let instruments = Gathered::beside(&robot.inner.path, &robot.inner).map_err(refused)?;
    let options = PlanOptions { kind, instruments, poses, workspace, candidates, target, seed };
    let found = py.detach(|| planning::plan(&robot.inner, &options, &|_, _| ()));
    let found = found.map_err(refused)?;
    let report = to_json(&PlanReport::new(&robot.inner, &found, candidates, target_um));
    Ok((matrix(py, &found.poses)?, report))
}
