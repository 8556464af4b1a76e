use std::path::{Path, PathBuf};

use clap::Args;
use truearm_host::check::mend::{MENDED, mend};
use truearm_host::check::{Finding, Verdict, check};
use truearm_host::files::{foreign, read_text, write_all};
use truearm_host::identify::Figures;
use truearm_host::methods::Comparison;
use truearm_host::model::{Measurements, Robot};
use truearm_host::report::{CheckReport, to_json};
use truearm_host::units::to_mm;
use truearm_host::{Error, ErrorKind, Result};

use super::{End, Said, overwrite, warn, words};

/// Find gross mistakes between robot and measurements: senses, zeros, orders,
/// units, conventions. Exit status 3: found, 4: they disagree and nothing says why.
#[derive(Args)]
pub struct Check {
    /// The nominal arm, robot.toml
    robot: PathBuf,
    /// Measured points, measurements.csv
    data: PathBuf,
    /// Write robot.toml and measurements.csv into this folder, mended
    #[arg(long, value_name = "DIR")]
    fix: Option<PathBuf>,
    /// Write over files in DIR that truearm did not write
    #[arg(long, requires = "fix")]
    force: bool,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

/// What is written into a folder.
const FILES: [&str; 2] = ["robot.toml", "measurements.csv"];

impl Check {
    pub fn run(self) -> Result<Said> {
        overwrite::folder_apart(self.fix.as_deref(), &FILES, [&self.robot, &self.data])?;
        let texts = [read_text(&self.robot)?, read_text(&self.data)?];
        let robot = Robot::parse(&self.robot, &texts[0])?;
        let data = Measurements::of_file(&self.data, &texts[1], &robot)
            .inspect_err(|_| warn(&robot.warnings))?;
        let mut warnings = [robot.warnings.clone(), data.warnings.clone()].concat();
        // Before anything can fail: what looks wrong may be why.
        warn(&warnings);
        let finding = check(&robot, &data);
        let wrote = match &self.fix {
            Some(folder) => self.fixed(folder, (&robot, &data), &texts, &finding)?,
            None => String::new(),
        };
        if self.fix.is_some() && !robot.links.is_empty() && finding.moves_frames() {
            let masses = "[[links]] com_mm were left as they were: they are in the links' frames";
            let remark = format!("{}: {masses}", self.robot.display());
            warn(std::slice::from_ref(&remark));
            warnings.push(remark);
        }
        let [robot, data] = [&self.robot, &self.data].map(|path| path.display().to_string());
        let report = CheckReport::new(robot, data, &finding, warnings);
        let text = if self.json { to_json(&report) } else { words::checked(&report) + &wrote };
        let end = match finding.verdict {
            Verdict::Sound => End::Good,
            Verdict::Mendable => End::Wrong,
            Verdict::NotUnderstood => End::Undecided,
        };
        Ok(Said { text, end })
    }

    /// Writes the two files, unless nothing is understood.
    fn fixed(
        &self,
        folder: &Path,
        (robot, data): (&Robot, &Measurements),
        texts: &[String; 2],
        finding: &Finding,
    ) -> Result<String> {
        if finding.too_few.is_some() {
            return Ok("wrote nothing: too few poses to decide\n".to_owned());
        }
        if finding.verdict == Verdict::NotUnderstood {
            return Ok("wrote nothing: what is wrong is not understood\n".to_owned());
        }
        let targets = FILES.map(|name| folder.join(name));
        let mended = mend((robot, &texts[0]), (data, &texts[1]), finding)?;
        let made = [mended.robot, mended.measurements];
        for (path, text) in targets.iter().zip(&made) {
            self.spared(path, text)?;
        }
        let made = made.map(String::into_bytes);
        write_all(&targets.into_iter().zip(made).collect::<Vec<_>>())?;
        Ok(format!("wrote {}\n", folder.join("{robot.toml,measurements.csv}").display()))
    }
}

impl Check {
    /// Mended files carry no digest, as people go on with them: what may be written
    /// over is that very text, or one that begins as a mended one does.
    fn spared(&self, path: &Path, text: &str) -> Result<()> {
        let file = std::fs::metadata(path).is_ok_and(|m| m.is_file());
        if self.force || !file {
            return Ok(());
        }
        let stood = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        let first = text.lines().next().filter(|line| line.starts_with(MENDED));
        let alike = first.is_some_and(|line| stood.starts_with(line.as_bytes()));
        if alike || stood == text.as_bytes() { Ok(()) } else { Err(foreign(path)) }
    }
}

/// Corrections beyond are no arm's own, tolerances: the norm of all of them.
const MANY_TOLERANCES: f64 = 100.0;
/// From here on it is worth a look whether a mistake is behind them: poorly made
/// arms of seven joints have 20.
const SUSPICIOUS_TOLERANCES: f64 = 40.0;
/// A single correction beyond is of the size of gross mistakes, tolerances: 2 cm, or
/// 1.1 degrees.
const LARGE_TOLERANCES: f64 = 20.0;
/// A misfit beyond makes no sense, mm.
const SENSELESS_MM: f64 = 20.0;

/// An error of a fit, with what `check` has to say of the files. Their warnings
/// come first: what looked wrong there may be why.
pub fn explained(error: Error, robot: &Robot, data: &Measurements) -> Error {
    warn(&[robot.warnings.as_slice(), &data.warnings].concat());
    let kinds = [ErrorKind::NotConverged, ErrorKind::Contradiction, ErrorKind::Singular];
    if !kinds.contains(&error.kind()) {
        return error;
    }
    match found(robot, data) {
        Some(found) => {
            let help = format!("{found}\n{}", error.help());
            Error::data(error.kind(), error.to_string(), help)
        }
        None => error,
    }
}

/// Where a fit ended.
#[derive(Clone, Copy)]
pub struct Ended {
    /// Norm of the corrections, tolerances.
    norm: f64,
    /// The largest of them.
    largest: f64,
    /// Misfit, mm.
    rms: f64,
}

impl Ended {
    pub fn of(figures: &Figures) -> Self {
        Self {
            norm: figures.correction_norm,
            largest: figures.largest_correction,
            rms: figures.identified.map_or(0.0, |stats| stats.rms_mm),
        }
    }

    /// Of the method that `identify` has; none where it broke down.
    pub fn of_methods(compared: &Comparison) -> Option<Self> {
        let method = compared.methods.iter().find(|method| method.name == "RPIM")?;
        Some(Self {
            norm: method.correction_norm?,
            largest: method.largest_correction?,
            rms: method.fitted?.rms_mm,
        })
    }
}

/// A remark where a fit ended at figures that make no sense.
pub fn remark(ended: Ended, robot: &Robot, data: &Measurements) -> Option<String> {
    let Ended { norm, largest, rms } = ended;
    if norm <= SUSPICIOUS_TOLERANCES && largest <= LARGE_TOLERANCES && rms <= SENSELESS_MM {
        return None;
    }
    let what = if rms > SENSELESS_MM {
        format!("a misfit of {rms:.0} mm RMS is left")
    } else if largest > LARGE_TOLERANCES && norm <= MANY_TOLERANCES {
        format!("the largest correction is {largest:.0} tolerances")
    } else {
        format!("the corrections are {norm:.0} tolerances")
    };
    let few = norm <= MANY_TOLERANCES && largest <= LARGE_TOLERANCES && rms <= SENSELESS_MM;
    let why = match found(robot, data) {
        Some(why) => why,
        None if few => return None,
        None => "no gross mistake explains it".to_owned(),
    };
    Some(format!("{}: {what}, more than a sound arm has: {why}", data.path.display()))
}

/// What `check` finds, in a sentence; `None` where it finds nothing.
fn found(robot: &Robot, data: &Measurements) -> Option<String> {
    let finding = check(robot, data);
    if finding.too_few.is_some() {
        return None;
    }
    let many = finding.stray.as_ref().filter(|stray| stray.many);
    let words = match finding.verdict {
        // A few rows may be wrong in a sound file.
        Verdict::Sound => {
            let stray = finding.stray.as_ref()?;
            format!("{stray}: correct what was written there, or leave it out")
        }
        Verdict::NotUnderstood if many.is_some() => {
            many.map(ToString::to_string).unwrap_or_default()
        }
        Verdict::Mendable => format!(
            "{}; with that mended {:.2} mm RMS are left: `truearm check {} {} --fix DIR` mends it",
            words::together(&finding.said),
            to_mm(finding.rms_after),
            robot.path.display(),
            data.path.display(),
        ),
        Verdict::NotUnderstood => format!(
            "robot and measurements disagree by {:.0} mm RMS and no one or two mistakes explain it: \
             are they of the same arm?",
            to_mm(finding.rms_before),
        ),
    };
    Some(words)
}
