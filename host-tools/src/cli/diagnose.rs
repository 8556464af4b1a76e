use std::path::PathBuf;

use clap::Args;
use truearm_host::Result;
use truearm_host::check::{Ended, remark};
use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_host::evaluate::not_covered;
use truearm_host::model::{Measurements, ModelTerm};
use truearm_host::page::{Measured, Next, diagnosed};
use truearm_host::report::DiagnoseReport;

use super::page::next_line;
use super::progress::Bar;
use super::rows::residuals;
use super::{Said, deliver, failed_or_few, overwrite, read_all, warn, words};

/// Find where model and measurement disagree, name the missing effect, add it,
/// and show the gap shrink on poses that were not fitted.
#[derive(Args)]
pub struct Diagnose {
    /// The nominal arm, robot.toml
    robot: PathBuf,
    /// Measured points, distances, touches..., measurements.csv
    #[arg(required_unless_present = "more")]
    data: Option<PathBuf>,
    /// More measurements of the same arm and session, of whatever kinds
    #[arg(id = "more", long = "data", value_name = "FILE")]
    more: Vec<PathBuf>,
    /// Poses that are only used to show the gap
    #[arg(long, value_name = "FILE")]
    holdout: Option<PathBuf>,
    /// Write model.toml, report.json, residuals.csv and report.html into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write each figure of report.html as SVG as well; as PNG, too, if truearm was built with
    /// the feature png
    #[arg(long, requires = "out")]
    figures: bool,
    /// Write over files that truearm did not write, or of another robot
    #[arg(long)]
    force: bool,
    /// Print report.json instead of the summary
    #[arg(long)]
    json: bool,
    /// Highest order of a periodic error to look for, cycles a turn
    #[arg(
        long,
        default_value_t = DiagnoseOptions::default().highest_order,
        value_name = "CYCLES",
        allow_hyphen_values = true
    )]
    highest_order: f64,
    /// Most terms of the model; a controller takes 24
    #[arg(long, default_value_t = DiagnoseOptions::default().most_terms, value_name = "TERMS")]
    most_terms: usize,
    /// Go on with fewer equations than unknowns
    #[arg(long)]
    allow_few_poses: bool,
}

impl Diagnose {
    pub fn run(self) -> Result<Said> {
        let options = DiagnoseOptions {
            highest_order: self.highest_order,
            most_terms: self.most_terms,
            allow_few_poses: self.allow_few_poses,
        };
        options.sensible()?;
        let files: Vec<&PathBuf> = self.data.iter().chain(&self.more).collect();
        let inputs = std::iter::once(&self.robot).chain(files.iter().copied()).chain(&self.holdout);
        overwrite::folder_apart(self.out.as_deref(), &overwrite::MODEL_FOLDER, inputs)?;
        let (robot, data) = read_all(&self.robot, &files)?;
        overwrite::folder_ready(self.out.as_deref(), &robot, self.force)?;
        let holdout = self.holdout.as_ref().map(|p| Measurements::read(p, &robot)).transpose()?;
        let bar = Bar::new("diagnosing");
        let found = diagnose(&robot, &data, holdout.as_ref(), &options, &|stage| bar.stage(stage));
        bar.finish();
        let mut found = found.map_err(|error| failed_or_few(error, &robot, &data))?;
        let figures = &mut found.outcome.figures;
        figures.warnings.extend(remark(Ended::of(figures), &robot, &data));
        if let Some(holdout) = &holdout {
            let outside = words::not_covered(&not_covered(&found.model, holdout));
            let file = holdout.path.display();
            figures.warnings.extend(outside.map(|line| format!("{file}: {line}")));
        }
        let report = DiagnoseReport::new(found.outcome);
        warn(&report.outcome.figures.warnings);
        let on = Measured { data: &data, rows: &found.rows, model: &found.model };
        let arm = found.model.terms.iter().filter(|t| matches!(t, ModelTerm::Arm(_)));
        let next = Next {
            robot: self.robot.clone(),
            data: files.into_iter().cloned().collect(),
            out: self.out.clone(),
            terms: arm.count(),
            worse: report.outcome.is_worse_elsewhere(),
        };
        let mut said = deliver(
            &report,
            || words::diagnosis(&report.outcome),
            self.json,
            (self.out.as_deref(), self.force),
            &found.model,
            || residuals(&data, &found.rows),
            (|| diagnosed(&report, &on, &next), self.figures),
        )?;
        if !self.json {
            said.text += &next_line("diagnose", &next, &report.outcome.alternatives);
        }
        Ok(said)
    }
}
