//! truearm for Python: a thin layer over the host library. What it computes, and
//! every report, is the program's own.

mod arrays;
mod gram;
mod measurements;
mod model;
mod robot;
mod verbs;

use pyo3::prelude::*;
use pyo3::{create_exception, exceptions::PyValueError};

create_exception!(
    _truearm,
    TruearmError,
    PyValueError,
    "What is wrong, and in `help` what to do about it."
);

/// An error of the library with its remedy.
pub(crate) fn refused(error: truearm_host::Error) -> PyErr {
    let made = TruearmError::new_err(error.to_string());
    Python::attach(|py| {
        // An error without its remedy is better than none.
        let _ = made.value(py).setattr("help", error.help().to_string());
    });
    made
}

/// A usage error.
pub(crate) fn wrong(message: impl Into<String>, help: impl Into<String>) -> PyErr {
    refused(truearm_host::Error::usage(message, help))
}

#[pymodule]
mod _truearm {
    #[pymodule_export]
    use super::TruearmError;
    #[pymodule_export]
    use super::gram::{accumulate, merge, step};
    #[pymodule_export]
    use super::measurements::Measurements;
    #[pymodule_export]
    use super::model::{Compensated, Model};
    #[pymodule_export]
    use super::robot::Robot;
    #[pymodule_export]
    use super::verbs::{Found, check, diagnose, evaluate, identify, plan, verify};
}
