use std::path::PathBuf;

use clap::Args;
use truearm_host::Result;
use truearm_host::check::{Ended, remark};
use truearm_host::files::write_all;
use truearm_host::methods::{self, Frames};
use truearm_host::model::Measurements;
use truearm_host::observations::points_only;
use truearm_host::page::compared;
use truearm_host::report::{CompareReport, to_json};

use super::evaluate::Frames as Anew;
use super::page::page_files;
use super::{Said, failed, overwrite, read_both, warn, words};

/// The paper's methods side by side: errors, reduction, time, size of the corrections.
#[derive(Args)]
pub struct Compare {
    /// The nominal arm, robot.toml
    robot: PathBuf,
    /// Measured points, measurements.csv
    data: PathBuf,
    /// Judge on other measurements
    #[arg(long, value_name = "DATA2")]
    validate: Option<PathBuf>,
    /// Fit these on the validation file itself
    #[arg(long, value_enum, requires = "validate")]
    reregister: Option<Anew>,
    /// Classical methods identify the links only, base and tool held as registered
    #[arg(long)]
    hold_frames: bool,
    /// Write compare.json, report.html and its figures, errors.svg and methods.svg, into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write over files that truearm did not write
    #[arg(long)]
    force: bool,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

/// What is written into a folder.
const FILES: [&str; 4] = ["compare.json", "errors.svg", "methods.svg", "report.html"];

impl Compare {
    pub fn run(self) -> Result<Said> {
        let inputs = [&self.robot, &self.data].into_iter().chain(&self.validate);
        overwrite::folder_apart(self.out.as_deref(), &FILES, inputs)?;
        let (robot, data) = read_both(&self.robot, &self.data)?;
        let data = points_only(&data, "compare")?;
        let other =
            self.validate.as_ref().map(|p| points_only(&Measurements::read(p, &robot)?, "compare"));
        let other = other.transpose()?;
        let anew = self.reregister.map(Into::into).unwrap_or_default();
        let frames = if self.hold_frames { Frames::Held } else { Frames::Fitted };
        let judge = other.as_ref().map(|o| (o, anew));
        let mut found = methods::compare(&robot, &data, judge, frames, &methods::all())
            .map_err(|error| failed(error, &robot, &data))?;
        let ended = Ended::of_methods(&found);
        found.warnings.extend(ended.and_then(|ended| remark(ended, &robot, &data)));
        warn(&found.warnings);
        let json = to_json(&CompareReport::new(&found));
        let mut wrote = String::new();
        if let Some(folder) = &self.out {
            let [report, rows, methods, page] = FILES.map(|name| folder.join(name));
            overwrite::pictures(&report, &[rows, methods, page.clone()], self.force)?;
            let mut made = page_files(&page, &compared(&found), true)?;
            made.push((report, json.clone().into_bytes()));
            write_all(&made)?;
            let files = folder.join(format!("{{{}}}", FILES.join(",")));
            wrote = format!("wrote {}\n", files.display());
        }
        Ok(if self.json { json.into() } else { (words::compare(&found) + &wrote).into() })
    }
}
