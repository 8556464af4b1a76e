//! The table `[covariance]` of a model.toml.

use std::fmt::Write;

use serde::Deserialize;
use truearm::blob::uncertain_parameters;

/// A lower triangle, a line a column; SI.
#[derive(Deserialize)]
pub(super) struct CovarianceFile {
    columns: Vec<Vec<f32>>,
}

/// The text, from the numbers column by column. Every number reads back to the
/// same bits.
pub(super) fn to_toml(factor: &[f32]) -> String {
    let size = (0..).find(|p| p * (p + 1) / 2 >= factor.len()).unwrap_or(0);
    let mut text = "\n# Covariance L L' of base translation, base rotation, tool point, corrections and terms, \
                    SI, see\n# src/blob/FORMAT.md; the lower triangle L, a line a column. For `pack --covariance`.\n\
                    [covariance]\ncolumns = [\n"
        .to_owned();
    let mut rest = factor;
    for length in (1..=size).rev() {
        let (column, behind) = rest.split_at(length.min(rest.len()));
        let numbers: Vec<String> = column.iter().map(|x| format!("{x:e}")).collect();
        let _ = writeln!(text, "  [{}],", numbers.join(", "));
        rest = behind;
    }
    text + "]\n"
}

impl CovarianceFile {
    /// The numbers; what is wrong with them, in words.
    pub fn factor(&self) -> Result<Vec<f32>, String> {
        let size = self.columns.len();
        for (j, column) in self.columns.iter().enumerate() {
            if column.len() != size - j {
                let (is, right) = (column.len(), size - j);
                return Err(format!("[covariance] column {} has {is} numbers, not {right}", j + 1));
            }
            if let Some(x) = column.iter().find(|x| !x.is_finite()) {
                return Err(format!("[covariance] column {} has {x}", j + 1));
            }
        }
        if size < uncertain_parameters(1, 0) {
            return Err(format!("[covariance] has {size} columns, too few for any arm"));
        }
        Ok(self.columns.concat())
    }
}
