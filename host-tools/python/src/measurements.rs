use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use numpy::PyArray2;
use pyo3::prelude::*;
use truearm_host::model;
use truearm_host::units::{End, joint_column, joint_to_file_at};

use crate::arrays::{Table, joints, matrix, rows};
use crate::robot::Robot;
use crate::{refused, wrong};

/// Measured points, a row each.
#[pyclass(frozen, module = "truearm")]
pub struct Measurements {
    pub(crate) inner: model::Measurements,
}

#[pymethods]
impl Measurements {
    /// Reads the measurements.csv of a robot.
    #[staticmethod]
    fn read(path: PathBuf, robot: &Robot) -> PyResult<Self> {
        let inner = model::Measurements::read(&path, &robot.inner).map_err(refused)?;
        Ok(Self { inner })
    }

    /// Of joint values (n x joints, rad or m) and points (n x 3, m); other columns
    /// under the names of measurements.csv, in its units.
    #[staticmethod]
    #[pyo3(signature = (robot, joints, points, **columns))]
    fn from_arrays(
        robot: &Robot,
        joints: Table,
        points: Table,
        columns: Option<BTreeMap<String, Vec<Bound<'_, PyAny>>>>,
    ) -> PyResult<Self> {
        let mut others = Vec::new();
        for (name, values) in columns.unwrap_or_default() {
            let cells = values.iter().map(cell).collect::<PyResult<_>>()?;
            others.push((name, cells));
        }
        let points = rows(&points);
        if points.iter().any(|p| p.len() != 3) {
            return Err(wrong("points have other than 3 coordinates", "give n x 3, metres"));
        }
        let mm: Vec<Vec<String>> =
            (0..3).map(|k| points.iter().map(|p| number(p[k] * 1e3)).collect()).collect();
        others.extend(["x_mm", "y_mm", "z_mm"].map(str::to_owned).into_iter().zip(mm));
        let text = table(robot, &joints, &others)?;
        let read = model::Measurements::parse("arrays".as_ref(), &text, &robot.inner);
        Ok(Self { inner: read.map_err(refused)? })
    }

    /// Joint values, n x joints, rad or m.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let q: Vec<Vec<f64>> = self.inner.rows.iter().map(|row| row.q.clone()).collect();
        matrix(py, &q)
    }

    /// What was measured, n x components: of points, m in the tracker's frame.
    #[getter]
    fn measured<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values: Vec<Vec<f64>> = self.inner.rows.iter().map(|r| r.measured.to_vec()).collect();
        matrix(py, &values)
    }

    /// Remarks on the file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.inner.warnings.clone()
    }

    fn __len__(&self) -> usize {
        self.inner.rows.len()
    }

    fn __repr__(&self) -> String {
        format!("Measurements({} rows, {} poses)", self.inner.rows.len(), self.inner.poses)
    }
}

/// A value of a column as it stands in a file; what pandas calls missing is an empty cell.
fn cell(value: &Bound<'_, PyAny>) -> PyResult<String> {
    let text = value.str()?.to_string();
    let missing = value.is_none() || matches!(&*text, "nan" | "<NA>" | "NaT");
    Ok(if missing { String::new() } else { text })
}

/// A number that reads back as it is.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Joint values and other columns as a table of the files' units.
pub fn table(robot: &Robot, array: &Table, others: &[(String, Vec<String>)]) -> PyResult<String> {
    let q = joints(array, robot.inner.joints.len())?;
    if let Some((name, cells)) = others.iter().find(|(_, cells)| cells.len() != q.len()) {
        return Err(wrong(
            format!("column {name} has {} values for {} rows", cells.len(), q.len()),
            "give every row a value",
        ));
    }
    let kinds: Vec<_> = robot.inner.joints.iter().map(|joint| joint.link.kind).collect();
    let mut text = String::new();
    for (j, kind) in kinds.iter().enumerate() {
        text += &joint_column("q", j, *kind);
        text.push(',');
    }
    let names: Vec<&str> = others.iter().map(|(name, _)| name.as_str()).collect();
    text += &names.join(",");
    for (row, q) in q.iter().enumerate() {
        text.push('\n');
        for (value, kind) in q.iter().zip(&kinds) {
            let _ = write!(text, "{},", number(joint_to_file_at(*kind, *value, End::Up)));
        }
        let cells = others.iter().map(|(_, cells)| quoted(&cells[row]));
        text += &cells.collect::<Vec<_>>().join(",");
    }
    text.push('\n');
    Ok(text)
}

/// A cell of a table.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}
