//! Identification by parts: bytes go between machines.

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use truearm_host::gram::{self, Part};
use truearm_host::report::{GramReport, to_json};

use crate::measurements::Measurements;
use crate::model::Model;
use crate::verbs::Found;
use crate::{refused, wrong};

/// What some rows say at a state: the bytes of a .gram file.
#[pyfunction]
pub fn accumulate<'py>(
    py: Python<'py>,
    state: &Model,
    data: &Measurements,
) -> PyResult<Bound<'py, PyBytes>> {
    let part = py.detach(|| gram::accumulate(&state.inner, &data.inner)).map_err(refused)?;
    Ok(PyBytes::new(py, &part.to_bytes()))
}

/// Sums of what several parts say.
#[pyfunction]
pub fn merge(py: Python<'_>, parts: Vec<Vec<u8>>) -> PyResult<Bound<'_, PyBytes>> {
    let mut all = parts.iter().map(|bytes| read(bytes));
    let first = all.next().ok_or_else(|| wrong("no parts", "give one at least"))??;
    let sum = all.try_fold(first, |sum, part| sum.plus(&part?).map_err(refused))?;
    Ok(PyBytes::new(py, &sum.to_bytes()))
}

/// The next state, and the report as JSON.
#[pyfunction]
pub fn step(py: Python<'_>, state: &Model, sums: &[u8]) -> PyResult<Found> {
    let sums = read(sums)?;
    let next = py.detach(|| gram::step(&state.inner, &sums)).map_err(refused)?;
    let json = to_json(&GramReport::new(&next, &sums));
    Found::new(py, next.model, json)
}

fn read(bytes: &[u8]) -> PyResult<Part> {
    Part::from_bytes(bytes)
        .map_err(|e| wrong(e.to_string(), "give what accumulate or merge returned"))
}
