use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truearm_host::check::{Ended, remark};
use truearm_host::evaluate::{evaluate, not_fitted};
use truearm_host::files::{Pieces, Sample};
use truearm_host::gram::{DRAWN, LARGE, identify_in_pieces, sums_tell};
use truearm_host::identify::{Identification, LambdaRule, Options, Scaling, identify};
use truearm_host::model::{Measurements, Robot};
use truearm_host::page::{Measured, Next, identified};
use truearm_host::report::IdentifyReport;

use truearm_host::{Error, ErrorKind, Result};

use super::evaluate::Frames;
use super::progress::Bar;
use super::rows::residuals;
use super::{Said, all_of, deliver, failed_or_few, overwrite, warn, words};

/// Identify base, tool and all MD-H parameters; flag gross errors.
#[derive(Args)]
pub struct Identify {
    /// The nominal arm, robot.toml
    robot: PathBuf,
    /// Measured points, poses, distances, touches..., measurements.csv
    #[arg(required_unless_present = "more")]
    data: Option<PathBuf>,
    /// More measurements of the same arm and session, of whatever kinds
    #[arg(id = "more", long = "data", value_name = "FILE")]
    more: Vec<PathBuf>,
    /// Score the model on other measurements as well
    #[arg(long, value_name = "DATA2")]
    validate: Option<PathBuf>,
    /// Fit these on the validation file itself
    #[arg(long, value_enum, requires = "validate")]
    reregister: Option<Frames>,
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
    /// Print report.json instead of the table
    #[arg(long)]
    json: bool,
    /// ml (marginal likelihood, the default), map (lambda = 1), l-curve, two-step, gcv, discrepancy,
    /// k-fold, or a number
    #[arg(long, value_name = "RULE", allow_hyphen_values = true)]
    lambda: Option<String>,
    /// What lambda weighs: deviations from nominal in tolerances against
    /// residuals in sigmas, or lambda I in metres and radians as the paper prints
    #[arg(long, value_enum, default_value_t = Mode::Prior)]
    scaling: Mode,
    /// Read the files a piece at a time, as is done with points in more than a million rows: little
    /// memory; distances and pictures are then of rows drawn by chance
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "always")]
    in_pieces: Option<Always>,
    /// Go on with fewer equations than unknowns
    #[arg(long)]
    allow_few_poses: bool,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Mode {
    Prior,
    Printed,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Always {
    Always,
    Never,
}

/// Beyond, nothing but the nominal arm is left; 1e40 was still right, at 1e308 squares overflow.
const MOST_LAMBDA: f64 = 1e30;

impl Identify {
    pub fn run(self) -> Result<Said> {
        let options = self.options()?;
        let files = self.data.iter().chain(&self.more);
        let inputs = std::iter::once(&self.robot).chain(files).chain(&self.validate);
        overwrite::folder_apart(self.out.as_deref(), &overwrite::MODEL_FOLDER, inputs)?;
        let files: Vec<&PathBuf> = self.data.iter().chain(&self.more).collect();
        let robot = Robot::read(&self.robot)?;
        overwrite::folder_ready(self.out.as_deref(), &robot, self.force)?;
        let other = self.validate.as_ref().map(|p| Measurements::read(p, &robot)).transpose()?;
        let (data, mut found) = self.found(&robot, &files, other.as_ref(), &options)?;
        let mut validation = None;
        if let Some(other) = &other {
            let frames = self.reregister.map(Into::into).unwrap_or_default();
            found.figures.warnings.extend(other.warnings.clone());
            validation = Some(evaluate(&found.model, other, frames)?);
        }
        let report = IdentifyReport::new(found.figures, validation);
        warn(&report.figures.warnings);
        let on = Measured { data: &data, rows: &found.rows, model: &found.model };
        let next = Next {
            robot: self.robot.clone(),
            data: files.into_iter().cloned().collect(),
            out: self.out.clone(),
            terms: 0,
            worse: false,
        };
        deliver(
            &report,
            || words::identification(&report),
            self.json,
            (self.out.as_deref(), self.force),
            &found.model,
            || residuals(&data, &found.rows),
            (|| identified(&report, &on, &next), self.figures),
        )
    }

    /// The rows, or some of them where they are read in pieces, and what was found.
    fn found(
        &self,
        robot: &Robot,
        files: &[&PathBuf],
        other: Option<&Measurements>,
        options: &Options,
    ) -> Result<(Measurements, Identification)> {
        let bar = Bar::new("identifying");
        if let Some((rows, sample)) = self.pieces(robot, files, options)? {
            if let Some(other) = other {
                not_fitted(&rows.names(), rows.shared(other)?, other)?;
            }
            let progress = |_, read| bar.update(read, rows.rows());
            let found = identify_in_pieces(&rows, &sample, options, &progress);
            bar.finish();
            return remarked(found, robot, sample.data);
        }
        let data = all_of(files, robot)?;
        if let Some(other) = other {
            not_fitted(&data.path.display().to_string(), data.shared(other), other)?;
        }
        let found = identify(robot, &data, options, &|done, total| bar.update(done, total));
        bar.finish();
        remarked(found, robot, data)
    }

    /// The files in pieces and rows drawn of them, where so is asked or they are large and nothing
    /// that is asked needs more.
    fn pieces<'r>(
        &self,
        robot: &'r Robot,
        files: &[&PathBuf],
        options: &Options,
    ) -> Result<Option<(Pieces<'r>, Sample)>> {
        let asked = match self.in_pieces {
            Some(Always::Never) => return Ok(None),
            Some(Always::Always) => true,
            None => false,
        };
        match sums_tell(options) {
            Err(error) if asked => return Err(error),
            Err(_) => return Ok(None),
            Ok(()) if !asked && !Pieces::more_than(LARGE, files)? => return Ok(None),
            Ok(()) => {}
        }
        let mut rows = Pieces::of(files, robot)?;
        match rows.sample(DRAWN) {
            Err(error) if !asked && error.kind() == ErrorKind::NotPoints => Ok(None),
            drawn => drawn.map(|sample| Some((rows, sample))),
        }
    }

    fn options(&self) -> Result<Options> {
        let scaling = match self.scaling {
            Mode::Prior => Scaling::Prior,
            Mode::Printed => Scaling::Printed,
        };
        let rule = match (self.lambda.as_deref(), scaling) {
            (None, Scaling::Prior) => LambdaRule::default(),
            (Some("map"), Scaling::Prior) => LambdaRule::MaximumAPosteriori,
            (Some("map"), Scaling::Printed) => {
                return Err(Error::usage(
                    "--lambda map needs --scaling prior",
                    "lambda = 1 is the maximum a posteriori estimate only where parameters count \
                     tolerances",
                ));
            }
            (None | Some("two-step"), _) => LambdaRule::TwoStep,
            (Some("l-curve"), _) => LambdaRule::LCurve,
            (Some("gcv"), _) => LambdaRule::Gcv,
            (Some("discrepancy"), _) => LambdaRule::Discrepancy,
            (Some("k-fold"), _) => LambdaRule::KFold,
            (Some("ml"), _) => LambdaRule::MaximumLikelihood,
            (Some(text), _) => match text.parse::<f64>() {
                Ok(lambda) if (0.0..=MOST_LAMBDA).contains(&lambda) => LambdaRule::Fixed(lambda),
                _ => {
                    return Err(Error::usage(
                        format!("--lambda {text}"),
                        "give map, l-curve, two-step, gcv, discrepancy, k-fold, ml, or a number from \
                         0 to 1e30",
                    ));
                }
            },
        };
        Ok(Options { rule, scaling, allow_few_poses: self.allow_few_poses })
    }
}

/// What was found, with what it looks like.
fn remarked(
    found: Result<Identification>,
    robot: &Robot,
    data: Measurements,
) -> Result<(Measurements, Identification)> {
    let mut found = found.map_err(|error| failed_or_few(error, robot, &data))?;
    found.figures.warnings.extend(remark(Ended::of(&found.figures), robot, &data));
    Ok((data, found))
}
