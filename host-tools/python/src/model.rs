use std::path::PathBuf;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use truearm::{JointKind, Task};
use truearm_host::blob::{PackOptions, pack_with};
use truearm_host::files::{self, Wanted};
use truearm_host::model;
use truearm_host::paths::{CompensateOptions, Forward, Row, View, compensate};

use crate::arrays::{Table, each, flat, jacobians, joints, matrix, transforms};
use crate::measurements::table;
use crate::robot::Robot;
use crate::{refused, wrong};

/// An identified arm.
#[pyclass(frozen, module = "truearm")]
pub struct Model {
    pub(crate) inner: model::Model,
}

#[pymethods]
impl Model {
    /// Reads a model.toml; a robot.toml is an arm without corrections.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        Ok(Self { inner: model::Model::read_or_nominal(&path).map_err(refused)? })
    }

    /// Of the text of a model.toml.
    #[staticmethod]
    fn parse(text: &str) -> PyResult<Self> {
        Ok(Self { inner: model::Model::parse("model.toml".as_ref(), text).map_err(refused)? })
    }

    /// Pickled as its text.
    fn __reduce__(&self, py: Python<'_>) -> PyResult<(Py<PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("parse")?.unbind(), (self.inner.to_toml(),)))
    }

    /// The nominal arm.
    #[getter]
    fn robot(&self) -> Robot {
        Robot { inner: self.inner.robot.clone() }
    }

    /// Writes a model.toml.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        let text = self.inner.to_sound_toml().map_err(refused)?;
        files::write(&path, text.as_bytes()).map_err(refused)
    }

    /// The text of its model.toml.
    fn to_toml(&self) -> String {
        self.inner.to_toml()
    }

    /// The parameter blob that a controller loads. `marker` is the one that is the tool; needed
    /// where the points of several were measured, and none is without a label.
    #[pyo3(signature = (sequence=None, covariance=false, marker=None))]
    fn pack<'py>(
        &self,
        py: Python<'py>,
        sequence: Option<u32>,
        covariance: bool,
        marker: Option<&str>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let options = PackOptions { sequence, covariance, ..PackOptions::default() };
        let of_tool = marker.map(|marker| self.inner.clone().with_tool(marker));
        let of_tool = of_tool.transpose().map_err(refused)?;
        let model = of_tool.as_ref().unwrap_or(&self.inner);
        Ok(PyBytes::new(py, &pack_with(model, &options).map_err(refused)?))
    }

    /// Where the real tool is at joint values (n x joints, rad or m): n x 4 x 4, m.
    /// Play, warmth and payload are those of a robot at rest without a load. With a station,
    /// as that tracker station sees the target; with a marker, of that target, not of `[tool]`.
    /// `torques` (n x joints, N m or N) are what the joints were read to hold, which a model
    /// of springs without masses needs.
    #[pyo3(signature = (joint_values, nominal=false, station=None, marker=None, torques=None))]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        joint_values: Table,
        nominal: bool,
        station: Option<String>,
        marker: Option<String>,
        torques: Option<Table>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let q = joints(&joint_values, self.inner.robot.joints.len())?;
        let Some(first) = q.first() else { return transforms(py, &[]) };
        let view = View { station, marker };
        let of = if nominal { Forward::nominal } else { Forward::real };
        let forward = of(&self.inner, &view).map_err(refused)?;
        if !nominal && (torques.is_some() || self.inner.reads_torques()) {
            let text = self.rows(&joint_values, torques.as_ref(), Vec::new())?;
            let found = py.detach(|| {
                let path = self.path(&text)?;
                Ok(forward.along(&path.data, &self.inner)?.all(&path.data))
            });
            let poses: Vec<_> = found.map_err(refused)?.iter().map(flat).collect();
            return transforms(py, &poses);
        }
        let at_rest = model::Row::at(first.clone());
        let poses = py.detach(|| each(&q, |q| flat(&forward.pose(&at_rest, q))));
        transforms(py, &poses)
    }

    /// How point and turn of the real tool move with each joint, without the terms
    /// beyond geometry: n x 6 x joints.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        joint_values: Table,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let count = self.inner.robot.joints.len();
        let q = joints(&joint_values, count)?;
        let forward = Forward::real(&self.inner, &View::default()).map_err(refused)?;
        let all = py.detach(|| each(&q, |q| forward.jacobian(q)));
        jacobians(py, &all, count)
    }

    /// Joint values at which the real tool is where the commanded ones want it, by the
    /// controller's law. `single` has the controller's bits; rows that the identification
    /// did not cover stay as they were unless `extrapolate`. `task` is `position` or `pose`;
    /// `payload` (kg), `temperature` (degrees C) and `time` (s, which an arm that warms up late
    /// needs beside temperatures that change) are a number or one a row; `torques` as in `forward`.
    #[pyo3(signature = (
        joint_values,
        extrapolate=false,
        single=false,
        task=None,
        payload=None,
        temperature=None,
        time=None,
        torques=None
    ))]
    #[allow(clippy::too_many_arguments, reason = "keywords of Python")]
    fn compensate(
        &self,
        py: Python<'_>,
        joint_values: Table,
        extrapolate: bool,
        single: bool,
        task: Option<&str>,
        payload: Option<Bound<'_, PyAny>>,
        temperature: Option<Bound<'_, PyAny>>,
        time: Option<Bound<'_, PyAny>>,
        torques: Option<Table>,
    ) -> PyResult<Compensated> {
        let rows = joint_values.as_array().nrows();
        let mut state = Vec::new();
        let columns = [("payload_kg", payload), ("temperature_c", temperature), ("time_s", time)];
        for (name, given) in columns {
            if let Some(given) = given {
                state.push((name.to_owned(), numbers(&given, rows)?));
            }
        }
        let text = self.rows(&joint_values, torques.as_ref(), state)?;
        let task = task.map(task_named).transpose()?;
        let options = CompensateOptions { task, extrapolate, single, ..Default::default() };
        let found = py.detach(|| compensate(&self.inner, &self.path(&text)?, &options));
        Compensated::of(py, &found.map_err(refused)?.rows)
    }

    fn __repr__(&self) -> String {
        let (name, terms) = (&self.inner.robot.name, self.inner.terms.len());
        format!("Model({name:?}, {terms} terms, {} curves)", self.inner.curves.len())
    }
}

impl Model {
    /// The text of a path: joints, what they hold, and columns of its state.
    fn rows(
        &self,
        joint_values: &Table,
        torques: Option<&Table>,
        mut state: Vec<(String, Vec<String>)>,
    ) -> PyResult<String> {
        let robot = Robot { inner: self.inner.robot.clone() };
        let rows = joint_values.as_array().nrows();
        state.insert(0, ("row".to_owned(), (0..rows).map(|k| k.to_string()).collect()));
        let kinds: Vec<_> = robot.inner.joints.iter().map(|joint| joint.link.kind).collect();
        let read = torques.map(|read| joints(read, kinds.len())).transpose()?;
        for (j, kind) in kinds.iter().enumerate().filter(|_| read.is_some()) {
            let name = match kind {
                JointKind::Revolute => format!("torque{}_nm", j + 1),
                JointKind::Prismatic => format!("force{}_n", j + 1),
            };
            let cells = read.iter().flatten().map(|row| row[j].to_string()).collect();
            state.push((name, cells));
        }
        table(&robot, joint_values, &state)
    }

    fn path(&self, text: &str) -> truearm_host::Result<model::Path> {
        model::Path::parse("arrays".as_ref(), text, &self.inner.robot, Wanted::Joints)
    }
}

/// What became of commanded joints, an entry a row.
#[pyclass(frozen, module = "truearm")]
pub struct Compensated {
    /// What to tell the controller: n x joints, rad or m.
    #[pyo3(get)]
    joints: Py<PyArray2<f64>>,
    /// How far the tool still misses, m, as the model says.
    #[pyo3(get)]
    left: Py<PyArray1<f64>>,
    /// Whether the command was within the joint ranges of the identification.
    #[pyo3(get)]
    covered: Py<PyArray1<bool>>,
    /// Whether the correction was held back: at its largest, or near a limit.
    #[pyo3(get)]
    clamped: Py<PyArray1<bool>>,
}

impl Compensated {
    fn of(py: Python<'_>, rows: &[Row]) -> PyResult<Self> {
        let mut all = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for row in rows {
            // Joints are always reached.
            if let Row::Corrected { joints, left: [metres, _], covered, clamped, .. } = row {
                all.0.push(joints.clone());
                all.1.push(*metres);
                all.2.push(*covered);
                all.3.push(*clamped);
            }
        }
        Ok(Self {
            joints: matrix(py, &all.0)?.unbind(),
            left: PyArray1::from_vec(py, all.1).unbind(),
            covered: PyArray1::from_vec(py, all.2).unbind(),
            clamped: PyArray1::from_vec(py, all.3).unbind(),
        })
    }
}

#[pymethods]
impl Compensated {
    fn __repr__(&self, py: Python<'_>) -> String {
        let count = |flags: &Py<PyArray1<bool>>, what: bool| {
            flags.bind(py).readonly().as_array().iter().filter(|flag| **flag == what).count()
        };
        let rows = self.left.bind(py).readonly().as_array().len();
        let (outside, held) = (count(&self.covered, false), count(&self.clamped, true));
        format!("Compensated({rows} rows, {outside} not covered, {held} clamped)")
    }
}

fn task_named(name: &str) -> PyResult<Task> {
    match name {
        "position" => Ok(Task::Position),
        "pose" => Ok(Task::Pose),
        _ => Err(wrong(format!("task {name:?}"), "give \"position\" or \"pose\"")),
    }
}

/// A number for every row, of one or of as many.
fn numbers(given: &Bound<'_, PyAny>, rows: usize) -> PyResult<Vec<String>> {
    let values = match given.extract::<f64>() {
        Ok(one) => vec![one; rows],
        Err(_) => given.extract::<Vec<f64>>()?,
    };
    Ok(values.iter().map(f64::to_string).collect())
}
