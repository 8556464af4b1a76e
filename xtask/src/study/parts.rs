//! One run against 64 parts, and the scripts for Dask and Spark on local workers.

use std::process::Command;

use crate::python;
use crate::run::{Result, call, exists, step};

pub fn run() -> Result {
    let tester = python::installed()?;
    let mut engines = vec![("dask", "dask[distributed]")];
    match exists("java") {
        true => engines.push(("spark", "pyspark")),
        false => eprintln!("no java: Spark is left out (Debian: openjdk-17-jre-headless)"),
    }
    step("engines", || {
        let packages = engines.iter().map(|(_, package)| package);
        call(Command::new(&tester).args(python::PIP).args(packages))
    })?;
    step("parts", || {
        let script = python::directory().join("tests/parts.py");
        call(Command::new(&tester).arg(script).args(engines.iter().map(|(name, _)| name)))
    })
}
