use std::path::PathBuf;

use clap::Args;
use truearm_host::Result;
use truearm_host::files::write;
use truearm_host::methods::{self, Comparison, Frames, Outcome};
use truearm_host::model::Measurements;
use truearm_host::plot::{Axis, Panel, Series, grid};
use truearm_host::report::{CompareReport, to_json};
use truearm_host::statistics::Stats;
use truearm_host::units::to_mm;

use super::check::explained;
use super::evaluate::Frames as Anew;
use super::{Said, read_both, warn, words};

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
    /// Write compare.json, errors.svg and methods.svg into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

impl Compare {
    pub fn run(self) -> Result<Said> {
        let (robot, data) = read_both(&self.robot, &self.data)?;
        let other = self.validate.as_ref().map(|p| Measurements::read(p, &robot)).transpose()?;
        let anew = self.reregister.map(Into::into).unwrap_or_default();
        let frames = if self.hold_frames { Frames::Held } else { Frames::Fitted };
        let judge = other.as_ref().map(|o| (o, anew));
        let found = methods::compare(&robot, &data, judge, frames, &methods::all())
            .map_err(|error| explained(error, &robot, &data))?;
        warn(&found.warnings);
        let json = to_json(&CompareReport::new(&found));
        let mut wrote = String::new();
        if let Some(folder) = &self.out {
            write(&folder.join("compare.json"), json.as_bytes())?;
            write(&folder.join("errors.svg"), errors(&found).as_bytes())?;
            write(&folder.join("methods.svg"), bars(&found).as_bytes())?;
            let files = folder.join("{compare.json,errors.svg,methods.svg}");
            wrote = format!("wrote {}\n", files.display());
        }
        Ok(if self.json { json.into() } else { (words::compare(&found) + &wrote).into() })
    }
}

/// Share of the judged rows against their error, a line a method.
fn errors(found: &Comparison) -> String {
    let line = |o: &Outcome| {
        let rows = if o.validation.is_some() { &o.validation_residuals } else { &o.residuals };
        let mut sorted: Vec<f64> = rows.iter().map(|r| to_mm(r.norm())).collect();
        sorted.sort_by(f64::total_cmp);
        let share = |i: usize| 100.0 * (i as f64 + 1.0) / rows.len() as f64;
        Series::line(o.name, sorted.iter().enumerate().map(|(i, e)| (*e, share(i))).collect())
    };
    Panel {
        title: "How many rows are better than an error".to_owned(),
        x: Axis::log(format!(
            "position error on {}, mm",
            found.validation.as_ref().unwrap_or(&found.data)
        )),
        y: Axis::linear("rows below, percent"),
        series: found.methods.iter().filter(|o| o.state.is_some()).map(line).collect(),
    }
    .svg()
}

/// Table 9 and the size of the corrections as bars.
fn bars(found: &Comparison) -> String {
    let solved: Vec<&Outcome> = found.methods.iter().filter(|o| o.state.is_some()).collect();
    let names: Vec<String> = solved.iter().map(|o| o.name.to_owned()).collect();
    let judged = |f: fn(&Stats) -> f64| {
        let of = |o: &&Outcome| o.validation.or(o.fitted).as_ref().map_or(f64::NAN, f);
        solved.iter().map(of).collect::<Vec<f64>>()
    };
    let norms = solved.iter().map(|o| o.correction_norm.unwrap_or(f64::NAN));
    let norms: Vec<f64> = norms.collect();
    let judged_on = if found.validation.is_some() { "validation" } else { "fitted" };
    let errors = Panel {
        title: format!("Position error, {judged_on} rows"),
        x: Axis::names(names.clone()),
        y: Axis::log("mm"),
        series: vec![
            Series::bars("Max", &judged(|s| s.max_mm)),
            Series::bars("MAE", &judged(|s| s.mean_mm)),
            Series::bars("SD", &judged(|s| s.sd_mm)),
        ],
    };
    let sizes = Panel {
        title: "Norm of the corrections".to_owned(),
        x: Axis::names(names),
        y: Axis::log("manufacturing tolerances (1 mm, 1 mrad)"),
        series: vec![Series::bars("", &norms)],
    };
    grid(&[errors, sizes], 2)
}
