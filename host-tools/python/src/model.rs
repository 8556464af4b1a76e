use std::path::PathBuf;

use numpy::{PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use truearm_host::blob::{PackOptions, pack_with};
use truearm_host::files::{self, Wanted};
use truearm_host::model;
use truearm_host::paths::{CompensateOptions, Forward, Row, View, compensate};

use crate::arrays::{each, flat, jacobians, joints, matrix, transforms};
use crate::measurements::table;
use crate::refused;
use crate::robot::Robot;

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

    /// Writes a model.toml.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        files::write(&path, self.inner.to_toml().as_bytes()).map_err(refused)
    }

    /// The text of its model.toml.
    fn to_toml(&self) -> String {
        self.inner.to_toml()
    }

    /// The parameter blob that a controller loads.
    #[pyo3(signature = (sequence=None, covariance=false))]
    fn pack<'py>(
        &self,
        py: Python<'py>,
        sequence: Option<u32>,
        covariance: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let options = PackOptions { sequence, covariance, ..PackOptions::default() };
        Ok(PyBytes::new(py, &pack_with(&self.inner, &options).map_err(refused)?))
    }

    /// Where the real tool is at joint values (n x joints, rad or m): n x 4 x 4, m.
    /// Play, warmth and payload are those of a robot at rest without a load. With a station,
    /// as that tracker station sees the target; with a marker, of that target, not of `[tool]`.
    #[pyo3(signature = (joint_values, nominal=false, station=None, marker=None))]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        joint_values: PyReadonlyArray2<f64>,
        nominal: bool,
        station: Option<String>,
        marker: Option<String>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let q = joints(&joint_values, self.inner.robot.joints.len())?;
        let Some(first) = q.first() else { return transforms(py, &[]) };
        let view = View { station, marker };
        let of = if nominal { Forward::nominal } else { Forward::real };
        let forward = of(&self.inner, &view).map_err(refused)?;
        let at_rest = model::Row::at(first.clone());
        let poses = py.detach(|| each(&q, |q| flat(&forward.pose(&at_rest, q))));
        transforms(py, &poses)
    }

    /// How point and turn of the real tool move with each joint, without the terms
    /// beyond geometry: n x 6 x joints.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        joint_values: PyReadonlyArray2<f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let count = self.inner.robot.joints.len();
        let q = joints(&joint_values, count)?;
        let forward = Forward::real(&self.inner, &View::default()).map_err(refused)?;
        let all = py.detach(|| each(&q, |q| forward.jacobian(q)));
        jacobians(py, &all, count)
    }

    /// Joint values at which the real tool is where the commanded ones want it, by the
    /// controller's law: (n x joints, how far it still misses in m). `single` has the
    /// controller's bits; rows that the identification did not cover stay as they were
    /// unless `extrapolate`.
    #[pyo3(signature = (joint_values, extrapolate=false, single=false))]
    fn compensate<'py>(
        &self,
        py: Python<'py>,
        joint_values: PyReadonlyArray2<f64>,
        extrapolate: bool,
        single: bool,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Vec<f64>)> {
        let robot = Robot { inner: self.inner.robot.clone() };
        let row: Vec<String> =
            (0..joint_values.as_array().nrows()).map(|k| k.to_string()).collect();
        let text = table(&robot, &joint_values, &[("row".to_owned(), row)])?;
        let options = CompensateOptions { extrapolate, single, ..CompensateOptions::default() };
        let found = py.detach(|| {
            let path = model::Path::parse("arrays".as_ref(), &text, &robot.inner, Wanted::Joints)?;
            compensate(&self.inner, &path, &options)
        });
        let found = found.map_err(refused)?;
        let mut corrected = Vec::new();
        let mut left = Vec::new();
        for row in found.rows {
            if let Row::Corrected { joints, left: [metres, _], .. } = row {
                corrected.push(joints);
                left.push(metres);
            }
        }
        Ok((matrix(py, &corrected)?, left))
    }

    fn __repr__(&self) -> String {
        let (name, terms) = (&self.inner.robot.name, self.inner.terms.len());
        format!("Model({name:?}, {terms} terms, {} curves)", self.inner.curves.len())
    }
}
