//! In the place of what reads Parquet files, where truearm was built without it.

use std::path::Path;

use crate::error::{Error, Place, Result};
use crate::files::instruments::Gathered;
use crate::model::{Measurements, Robot};

/// No file of columns can be read.
pub enum Columnar {}

impl Columnar {
    pub fn open(path: &Path) -> Result<Self> {
        let help = "write CSV, or build truearm with `--features parquet`";
        Err(Error::file(
            path,
            Place::default(),
            "a Parquet file, which this truearm does not read",
            help,
        ))
    }

    pub fn pieces(&self) -> usize {
        match *self {}
    }

    pub fn rows(&self) -> usize {
        match *self {}
    }

    pub fn whole(&self, _: &Robot, _: Gathered) -> Result<Measurements> {
        match *self {}
    }

    pub fn read(
        &self,
        _: (&Path, usize),
        _: &Robot,
        _: &Gathered,
        _: &mut dyn FnMut(Measurements) -> Result<()>,
    ) -> Result<()> {
        match *self {}
    }
}
