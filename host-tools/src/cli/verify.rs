use std::path::{Path, PathBuf};

use clap::Args;
use truearm_host::error::count as counted;
use truearm_host::files::{csv_text, overwritable, overwritable_like, poses_csv, write_all};
use truearm_host::model::{Commanded, KindId, Measurements, Model, Row};
use truearm_host::observations::kind;
use truearm_host::page::verified;
use truearm_host::report::{VerifyReport, to_json};
use truearm_host::units::to_mm;
use truearm_host::verify::{
    Conformity, STANDARD_REPEATS, Tolerances, Verification, test_poses, verify,
};
use truearm_host::{Error, Result};

use super::page::page_files;
use super::workspace::Where;
use super::{End, Said, count, overwrite, session, warn, words};

/// Verify the compensated arm on measured points: ISO 9283 accuracy and
/// repeatability, pass or fail. Exit status 3: fail, 4: neither is proven.
#[derive(Args)]
pub struct Verify {
    /// model.toml that was packed and flashed
    model: PathBuf,
    /// Commanded joints cmd1_deg.. (or points cmd_x_mm..) and measured points,
    /// compensation on
    #[arg(required_unless_present = "test_poses")]
    data: Option<PathBuf>,
    /// The same with compensation off, for the figures before
    #[arg(long, value_name = "DATA0", requires = "data")]
    before: Option<PathBuf>,
    /// Fit each station's frame on the files themselves; takes up to six
    /// directions of the error out
    #[arg(long, value_enum, requires = "data")]
    reregister: Option<Refit>,
    /// Largest error allowed of what measured points or lengths
    #[arg(long, value_name = "MM", requires = "data", allow_hyphen_values = true)]
    tolerance_mm: Option<f64>,
    /// Largest error allowed of turns and inclinations
    #[arg(long, value_name = "DEG", requires = "data", allow_hyphen_values = true)]
    tolerance_deg: Option<f64>,
    /// Write poses to verify at into this file
    #[arg(long, alias = "check-poses", value_name = "FILE.csv")]
    test_poses: Option<PathBuf>,
    /// How many of them
    #[arg(
        long,
        value_name = "N",
        default_value_t = 20,
        requires = "test_poses",
        value_parser = count,
        allow_hyphen_values = true
    )]
    poses: usize,
    /// Measurements of the identification, to keep the test poses apart from; of several files each
    #[arg(long, value_name = "DATA", requires = "test_poses")]
    apart_from: Vec<PathBuf>,
    #[command(flatten)]
    workspace: Where,
    /// Other random test poses
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write report.json, errors.csv and report.html into this folder
    #[arg(long, value_name = "DIR", requires = "data")]
    out: Option<PathBuf>,
    /// Write each figure of report.html as SVG as well; as PNG, too, if truearm was built with
    /// the feature png
    #[arg(long, requires = "out")]
    figures: bool,
    /// Write over files that truearm did not write
    #[arg(long)]
    force: bool,
    /// Print JSON instead of the table
    #[arg(long, requires = "data")]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Refit {
    /// Each station's base
    Base,
}

/// What is written into a folder.
const FILES: [&str; 3] = ["report.json", "errors.csv", "report.html"];

impl Verify {
    pub fn run(self) -> Result<Said> {
        let tolerances = Tolerances { mm: self.tolerance_mm, deg: self.tolerance_deg };
        tolerances.sensible()?;
        overwrite::folder_apart(self.out.as_deref(), &FILES, self.inputs())?;
        let model = Model::read(&self.model)?;
        let mut text = match &self.test_poses {
            Some(path) => self.propose(&model, path)?,
            None => String::new(),
        };
        let Some(path) = &self.data else { return Ok(text.into()) };
        let real = |path: &Path| std::fs::canonicalize(path).ok();
        if self.before.as_deref().and_then(real).is_some_and(|before| Some(before) == real(path)) {
            let what = format!("--before {}: the same file", path.display());
            return Err(Error::usage(what, "give what was measured with the compensation off"));
        }
        let refit = self.reregister.is_some();
        let data = Commanded::read(path, &model)?;
        let after = verify(&model, &data, refit)?;
        let mut warnings = [data.data.warnings.clone(), after.warnings.clone()].concat();
        let before = self.before.as_ref().map(|path| {
            let data = Commanded::read(path, &model)?;
            verify(&model, &data, refit)
        });
        let before = before.transpose()?;
        if after.points.is_some() && after.repeats[0] < STANDARD_REPEATS {
            let repetitions = match after.repeats {
                [few, many] if few == many => counted(few, "repetition"),
                [few, many] => format!("{few} to {many} repetitions"),
            };
            warnings.push(format!(
                "{}: {repetitions} a pose, where ISO 9283 asks for {STANDARD_REPEATS}",
                after.file
            ));
        }
        let name = self.model.display().to_string();
        let report = VerifyReport::new(name, before, after, tolerances, warnings)?;
        warn(&report.warnings);
        let json = to_json(&report);
        text += &if self.json { json.clone() } else { words::verification(&report) };
        if let Some(folder) = &self.out {
            let [to_report, to_errors, to_page] = FILES.map(|name| folder.join(name));
            overwrite::page_file(&to_page, self.force)?;
            let errors = errors(&data.data, &report.after);
            overwritable(&to_report, self.force)?;
            overwritable_like(&to_errors, &errors, self.force)?;
            let page = verified(&report, &model, &data);
            let mut made = page_files(&to_page, &page, self.figures)?;
            made.extend([(to_report, json.into_bytes()), (to_errors, errors.into_bytes())]);
            write_all(&made)?;
            warn(overwrite::pictures_left_behind(folder, &made).as_slice());
        }
        let end = match report.conformity {
            None | Some(Conformity::Pass) => End::Good,
            Some(Conformity::Fail) => End::Wrong,
            Some(Conformity::NotProven) => End::Undecided,
        };
        Ok(Said { end, ..text.into() })
    }

    fn inputs(&self) -> impl Iterator<Item = &PathBuf> {
        let others = self.data.iter().chain(&self.before).chain(&self.apart_from);
        std::iter::once(&self.model).chain(others)
    }

    fn propose(&self, model: &Model, path: &Path) -> Result<String> {
        // Within what was identified, unless the user says otherwise.
        let mut robot = model.robot.clone();
        for (joint, covered) in robot.joints.iter_mut().zip(&model.covered) {
            joint.limits = covered.filter(|[low, high]| low < high).or(joint.limits);
        }
        let workspace = self.workspace.of(&robot)?;
        let used = session(&self.apart_from, &robot)?;
        let poses = test_poses(model, &workspace, used.as_ref(), self.poses, self.seed)?;
        let inputs: Vec<&Path> = self.inputs().map(PathBuf::as_path).collect();
        overwrite::write_like(path, &poses_csv(&robot, "cmd", &poses, &[]), &inputs, self.force)?;
        let said = format!("wrote {} test poses to {}\n", poses.len(), path.display());
        Ok(if self.json { String::new() } else { said })
    }
}

fn errors(data: &Measurements, found: &Verification) -> String {
    let mut header: Vec<&str> =
        "row,line,station,marker,pose,dx_mm,dy_mm,dz_mm,distance_mm".split(',').collect();
    let others = data.rows.iter().any(|row| row.kind != KindId::default());
    if others {
        header.extend(["kind", "residual"]);
    }
    let line = |(i, row): (usize, &Row)| {
        let (station, marker) = (&data.stations[row.station], &data.markers[row.marker]);
        let mut cells = vec![(i + 1).to_string(), row.line.to_string()];
        cells.extend([station.clone(), marker.clone(), (row.pose + 1).to_string()]);
        cells.extend(match found.row_errors[i] {
            Some(e) => [e.x, e.y, e.z, e.norm()].map(|x| format!("{:.5}", to_mm(x))),
            None => [(); 4].map(|()| String::new()),
        });
        if others {
            let all = found.residuals[i].in_files();
            let all: Vec<String> = all.iter().map(|x| format!("{x:.5}")).collect();
            cells.extend([kind(row).name().to_owned(), all.join(" ")]);
        }
        cells
    };
    csv_text(header, data.rows.iter().enumerate().map(line))
}
