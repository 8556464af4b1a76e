use std::path::PathBuf;

use clap::Args;
use truearm_host::Result;
use truearm_host::evaluate::not_covered;
use truearm_host::files::Wanted;
use truearm_host::model::{Model, Path};
use truearm_host::paths::{Forward, View, forward_csv, missing_inputs};
use truearm_host::report::{FkReport, to_json};

use super::{Said, overwrite, warn, words};

/// Where the tool is at given joints: the pose of [tool] in the coordinates of
/// [base], the real arm's by default.
#[derive(Args)]
pub struct Fk {
    /// model.toml; a robot.toml is the nominal arm
    model: PathBuf,
    /// Joints q1_deg.. (qN_mm for prismatic joints) and the state columns of
    /// measurements.csv
    rows: PathBuf,
    /// Write the poses here: x_mm, y_mm, z_mm, qx, qy, qz, qw
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
    /// Of the nominal arm: what the controller believes
    #[arg(long)]
    nominal: bool,
    /// As this tracker station of the identification sees the target, to be
    /// compared with measured points
    #[arg(long, value_name = "LABEL")]
    station: Option<String>,
    /// This target of the identification instead of the point of [tool]; a
    /// station sees the only one of the model if none is named
    #[arg(long, value_name = "LABEL")]
    marker: Option<String>,
    /// Write over a file that truearm did not write
    #[arg(long)]
    force: bool,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

impl Fk {
    pub fn run(self) -> Result<Said> {
        let model = Model::read_or_nominal(&self.model)?;
        let path = Path::read(&self.rows, &model.robot, Wanted::Joints)?;
        let view = View { station: self.station, marker: self.marker };
        let forward = if self.nominal {
            Forward::nominal(&model, &view)?
        } else {
            Forward::real(&model, &view)?.along(&path.data, &model)?
        };
        let poses = forward.all(&path.data);
        let inputs = [self.model.as_path(), &self.rows];
        let table = forward_csv(&path, &model.robot, &poses)?;
        overwrite::write_like(&self.out, &table, &inputs, self.force)?;
        let mut warnings = [model.robot.warnings.clone(), path.data.warnings.clone()].concat();
        if !self.nominal {
            warnings.extend(missing_inputs(&model, &path));
            if model.covered.iter().any(Option::is_some) {
                warnings.extend(words::not_covered(&not_covered(&model, &path.data)));
            }
        }
        let others: Vec<&String> = path
            .data
            .stations
            .iter()
            .filter(|s| !s.is_empty() && Some(*s) != view.station.as_ref())
            .collect();
        if let (Some(station), false) = (&view.station, others.is_empty()) {
            warnings.push(format!(
                "{}: rows of other stations as well; all are told in the frame of \"{station}\"",
                self.rows.display()
            ));
        }
        warn(&warnings);
        let [file, rows, out] =
            [&self.model, &self.rows, &self.out].map(|path| path.display().to_string());
        let count = poses.len();
        let text = format!(
            "wrote {out}: {count} poses of {} {}\n",
            match (&view.marker, &view.station) {
                (Some(marker), _) => format!("marker \"{marker}\""),
                (None, Some(_)) => "the marker".to_owned(),
                (None, None) => "[tool]".to_owned(),
            },
            match &view.station {
                Some(station) => format!("as station \"{station}\" sees it"),
                None => "in the coordinates of [base]".to_owned(),
            }
        );
        let report = FkReport::new([file, rows, out], count, self.nominal, view, warnings);
        Ok(if self.json { to_json(&report) } else { text }.into())
    }
}
