//! Between numpy arrays and rows.

use nalgebra::Vector3;
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArray3, PyArrayLike2, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use truearm::Pose;
use truearm_host::model::{self, arm::Kinematics};

use crate::wrong;

/// A numpy array, or what numpy makes one of: lists, whole numbers, the columns of a pandas table.
pub type Table<'py> = PyArrayLike2<'py, f64, AllowTypeChange>;

/// Joint values of poses, a row each: rad, m of a joint that slides.
pub fn joints(array: &Table, count: usize) -> PyResult<Vec<Vec<f64>>> {
    let rows = rows(array);
    match rows.iter().position(|q| q.len() != count || q.iter().any(|v| !v.is_finite())) {
        None => Ok(rows),
        Some(row) if rows[row].len() != count => Err(wrong(
            format!("{} columns of joint values, but the arm has {count} joints", rows[row].len()),
            "give an array of n poses x joints, radians",
        )),
        Some(row) => Err(wrong(
            format!("joint values of row {row} are not finite"),
            "delete the row or measure it again",
        )),
    }
}

/// The rows of an array.
pub fn rows(array: &Table) -> Vec<Vec<f64>> {
    array.as_array().rows().into_iter().map(|row| row.to_vec()).collect()
}

/// n x joints.
pub fn matrix<'py>(py: Python<'py>, rows: &[Vec<f64>]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let width = rows.first().map_or(0, Vec::len);
    PyArray1::from_vec(py, rows.concat()).reshape([rows.len(), width])
}

/// n x 4 x 4 of as many transforms.
pub fn transforms<'py>(
    py: Python<'py>,
    poses: &[[f64; 16]],
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    PyArray1::from_vec(py, poses.concat()).reshape([poses.len(), 4, 4])
}

/// A transform by rows.
pub fn flat(pose: &Pose<f64>) -> [f64; 16] {
    let (r, t) = (&pose.rotation, &pose.translation);
    let mut out = [0.0; 16];
    for i in 0..3 {
        for j in 0..3 {
            out[4 * i + j] = r[(i, j)];
        }
        out[4 * i + 3] = t[i];
    }
    out[15] = 1.0;
    out
}

/// n x 6 x joints: how point and turn move with each joint.
pub fn jacobians<'py>(
    py: Python<'py>,
    all: &[Vec<[Vector3<f64>; 2]>],
    count: usize,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let mut out = Vec::with_capacity(all.len() * 6 * count);
    for columns in all {
        for part in 0..6 {
            out.extend(columns.iter().map(|c| c[part / 3][part % 3]));
        }
    }
    PyArray1::from_vec(py, out).reshape([all.len(), 6, count])
}

/// Of every pose on all cores.
pub fn each<T: Send>(poses: &[Vec<f64>], of: impl Fn(&[f64]) -> T + Sync + Send) -> Vec<T> {
    poses.par_iter().with_min_len(256).map(|q| of(q)).collect()
}

/// The nominal arm with its tool, in the coordinates of the files.
pub fn nominal(robot: &model::Robot) -> Box<dyn Kinematics> {
    model::arm::chain(&robot.nominal(), robot.base.pose(), robot.tool)
}
