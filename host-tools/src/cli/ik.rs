use std::path::PathBuf;

use clap::Args;
use truearm_host::Result;
use truearm_host::files::Wanted;
use truearm_host::model::{Model, Path};
use truearm_host::paths::{Forward, Inverse, View, inverse_csv};
use truearm_host::report::{IkReport, to_json};

use super::{End, Said, arm_file, overwrite, warn, words};

/// The joints for poses of the tool, each row from the row before, and where that
/// leads nowhere from elsewhere, within the joint limits. Exit status 3: some row
/// is not reached.
#[derive(Args)]
pub struct Ik {
    /// model.toml; a robot.toml is the nominal arm
    model: PathBuf,
    /// Poses of [tool] in [base]: x_mm, y_mm, z_mm with qx, qy, qz, qw or
    /// roll_deg, pitch_deg, yaw_deg; without orientation the position alone
    rows: PathBuf,
    /// Write the joints here; empty where a pose is not reached
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
    /// Joints to begin at, degrees (mm for prismatic joints): they choose the
    /// configuration
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true)]
    start: Option<String>,
    /// Of the nominal arm: what the controller would find
    #[arg(long)]
    nominal: bool,
    /// Write over a file that truearm did not write
    #[arg(long)]
    force: bool,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

impl Ik {
    pub fn run(self) -> Result<Said> {
        let model = Model::read_or_nominal(&self.model)?;
        let start = self.start.as_deref().map(|text| arm_file::start(text, &model)).transpose()?;
        let path = Path::read(&self.rows, &model.robot, Wanted::Poses)?;
        let view = View::default();
        let forward = if self.nominal {
            Forward::nominal(&model, &view)?
        } else {
            Forward::real(&model, &view)?.along(&path.data, &model)?
        };
        let inverse = Inverse::new(&forward, &model.robot).preferring(&model.covered);
        let found = inverse.follow(&path.data, &path.targets, start.as_deref());
        let inputs = [self.model.as_path(), &self.rows];
        let table = inverse_csv(&path, &model.robot, &found.rows)?;
        overwrite::write_like(&self.out, &table, &inputs, self.force)?;
        let mut warnings = [model.robot.warnings.clone(), path.data.warnings.clone()].concat();
        if found.chosen {
            warnings.push(arm_file::CHOSEN.to_owned());
        }
        warnings.extend(arm_file::jumps(&path, &found.jumps));
        warn(&warnings);
        let [file, out] = [&self.model, &self.out].map(|path| path.display().to_string());
        let report = IkReport::new([file, out], &path, self.nominal, &found, warnings);
        let reached = report.rows - report.not_reached.len();
        let text = if self.json {
            to_json(&report)
        } else {
            let wrote =
                format!("wrote {}: joints of {reached} of {} rows\n", report.out, report.rows);
            wrote + &words::not_reached(&report.not_reached)
        };
        let end = if report.not_reached.is_empty() { End::Good } else { End::Wrong };
        Ok(Said { end, ..text.into() })
    }
}
