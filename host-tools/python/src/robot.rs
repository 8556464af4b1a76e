use std::path::PathBuf;

use numpy::PyArray3;
use pyo3::prelude::*;
use truearm_host::model;

use crate::arrays::{Table, each, flat, jacobians, joints, nominal, transforms};
use crate::refused;

/// The nominal arm, as robot.toml describes it.
#[pyclass(frozen, module = "truearm")]
pub struct Robot {
    pub(crate) inner: model::Robot,
}

#[pymethods]
impl Robot {
    /// Reads a robot.toml.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        Ok(Self { inner: model::Robot::read(&path).map_err(refused)? })
    }

    /// Reads the text of a robot.toml.
    #[staticmethod]
    fn parse(text: &str) -> PyResult<Self> {
        Ok(Self { inner: model::Robot::parse("robot.toml".as_ref(), text).map_err(refused)? })
    }

    /// Name of the arm.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        self.inner.joints.len()
    }

    /// Remarks on the file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.inner.warnings.clone()
    }

    /// Where the nominal tool is at joint values (n x joints, rad or m): n x 4 x 4, m,
    /// in the coordinates of the files.
    fn forward<'py>(
        &self,
        py: Python<'py>,
        joint_values: Table,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let q = joints(&joint_values, self.joints())?;
        let target = self.inner.nominal_target();
        let poses = py.detach(|| each(&q, |q| flat(&target(q))));
        transforms(py, &poses)
    }

    /// How point and turn of the nominal tool move with each joint: n x 6 x joints.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        joint_values: Table,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let q = joints(&joint_values, self.joints())?;
        let arm = nominal(&self.inner);
        let all = py.detach(|| each(&q, |q| arm.jacobian(q)));
        jacobians(py, &all, self.joints())
    }

    fn __repr__(&self) -> String {
        format!("Robot({:?}, {} joints)", self.inner.name, self.joints())
    }
}
