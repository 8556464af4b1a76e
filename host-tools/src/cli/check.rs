use std::path::{Path, PathBuf};

use clap::Args;
use truearm_host::check::mend::{MENDED, leaves_lengths, mend};
use truearm_host::check::{Finding, Verdict, check};
use truearm_host::files::{Gathered, foreign, read_text, write_all};
use truearm_host::model::{Measurements, Robot};
use truearm_host::report::{CheckReport, to_json};
use truearm_host::{Error, Result};

use super::{End, Said, overwrite, warn, words};

/// Find gross mistakes between robot and measurements: senses, zeros, orders,
/// units, conventions. Exit status 3: found, 4: they disagree and nothing says why.
#[derive(Args)]
pub struct Check {
    /// The nominal arm, robot.toml
    robot: PathBuf,
    /// Measured points, measurements.csv
    data: PathBuf,
    /// Write robot.toml and measurements.csv into this folder, mended, and a copy of the
    /// instruments.toml that is beside them
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
/// Copied there as it is.
const INSTRUMENTS: &str = "instruments.toml";

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
        if self.fix.is_some() && leaves_lengths(&finding) {
            let remark = format!(
                "{}: com_mm, [base], limits_mm, tolerances and measurement_sigma_mm were left as \
                 they were: look whether they are in the other unit as well",
                self.robot.display()
            );
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
        Ok(Said { end, ..text.into() })
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
        let mut all: Vec<(PathBuf, Vec<u8>)> = targets.into_iter().zip(made).collect();
        let mut names = FILES.to_vec();
        // What is stated of instruments is looked for beside the measurements.
        if let Some(book) = Gathered::place(&self.data, robot) {
            let to = folder.join(INSTRUMENTS);
            overwrite::apart([to.as_path()], [book.as_path()])?;
            let text = read_text(&book)?;
            self.spared(&to, &text)?;
            all.push((to, text.into_bytes()));
            names.push(INSTRUMENTS);
        }
        write_all(&all)?;
        Ok(format!("wrote {}\n", folder.join(format!("{{{}}}", names.join(","))).display()))
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
