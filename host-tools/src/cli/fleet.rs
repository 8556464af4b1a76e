use std::path::{Path, PathBuf};

use clap::Args;
use truearm_host::error::Place;
use truearm_host::files::{Comment, overwritable, read_text, signed, with_priors, write_all};
use truearm_host::fleet::{Arm, Fleet as Learned};
use truearm_host::identify::{Figures, Identification, Options, allowing, identify};
use truearm_host::model::{Measurements, Robot};
use truearm_host::page::{Measured, Next, identified};
use truearm_host::report::{FleetReport, IdentifyReport, to_json};
use truearm_host::{Error, Result};

use super::progress::Bar;
use super::rows::residuals;
use super::{ALLOW_FEW, Said, deliver, overwrite, warn, words};

/// Identify many arms of one type: which differ, what they share, and how far off the next is.
#[derive(Args)]
pub struct Fleet {
    /// A folder of folders, one an arm, each with a measurements.csv and, where it has its own, a
    /// robot.toml; robot.toml in DIR itself serves the others
    dir: PathBuf,
    /// Write robot.toml with what was learned of the type, fleet.json, and a folder an arm with
    /// what `identify` writes, into this folder
    #[arg(long, value_name = "OUT")]
    out: Option<PathBuf>,
    /// Go on where an arm has fewer equations than unknowns
    #[arg(long)]
    allow_few_poses: bool,
    /// Write over files that truearm did not write, or of another robot
    #[arg(long)]
    force: bool,
    /// Print fleet.json instead of the tables
    #[arg(long)]
    json: bool,
}

const ROBOT: &str = "robot.toml";
const DATA: &str = "measurements.csv";
const REPORT: &str = "fleet.json";

/// What was learned of an arm and is kept: its rows are not.
type Found = std::result::Result<Figures, String>;

impl Fleet {
    pub fn run(self) -> Result<Said> {
        let folders = self.folders()?;
        self.apart(&folders)?;
        let common = self.dir.join(ROBOT);
        let common = common.is_file().then(|| Robot::read(&common)).transpose()?;
        let bar = Bar::new("identifying arms");
        let mut type_of = common.clone();
        let (mut arms, mut all): (Vec<Arm>, Vec<(String, Found)>) = (Vec::new(), Vec::new());
        for (done, folder) in folders.iter().enumerate() {
            bar.update(done, folders.len());
            let name = folder.file_name().map_or(String::new(), |n| n.to_string_lossy().into());
            let found = self.arm(folder, &name, common.as_ref(), &mut type_of);
            let found = found.and_then(|found| {
                let arm = Arm::of(&found);
                if arms.contains(&arm) {
                    return Err(Error::usage(
                        format!("{name}: the measurements are those of an arm before"),
                        "no two arms measure the same: look which folder they belong to",
                    ));
                }
                arms.push(arm);
                Ok(found.figures)
            });
            let why = |error: Error| format!("{error}; {}", error.help().replace('\n', " "));
            all.push((name, found.map_err(why)));
        }
        bar.finish();
        let Some(robot) = type_of.filter(|_| !arms.is_empty()) else {
            let first = all.into_iter().find_map(|(name, found)| Some((name, found.err()?)));
            let (name, why) = first.unwrap_or_default();
            let what = format!("{}: no arm could be identified", self.dir.display());
            return Err(Error::usage(what, format!("the first, {name}: {why}")));
        };
        let fleet = Learned::of(&arms);
        let report = FleetReport::new(robot.name.clone(), &fleet, all, robot.warnings.clone());
        warn(&report.warnings);
        let json = to_json(&report);
        let mut wrote = String::new();
        if let Some(out) = &self.out {
            let text = with_priors(&read_text(&robot.path)?, &fleet.prior_of(&robot))?;
            let text = signed(Comment::Hash, &text);
            let report = (out.join(REPORT), json.clone().into_bytes());
            write_all(&[(out.join(ROBOT), text.into_bytes()), report])?;
            wrote = format!("wrote {}\n", out.join("{robot.toml,fleet.json}").display());
            let arm = |path: &Path| path.join("model.toml").is_file();
            warn(overwrite::left_behind(out, folders.iter().map(PathBuf::as_path), arm).as_slice());
        }
        Ok(if self.json { json.into() } else { (words::fleet(&report) + &wrote).into() })
    }

    /// Folders of the arms by name.
    fn folders(&self) -> Result<Vec<PathBuf>> {
        if self.dir.is_file() {
            let what = format!("{}: a file, not a folder", self.dir.display());
            return Err(Error::usage(what, "give the folder that has a folder for each arm"));
        }
        let entries = std::fs::read_dir(&self.dir).map_err(|e| Error::io(&self.dir, e))?;
        let real = |path: &Path| std::fs::canonicalize(path).ok();
        let out = self.out.as_deref().and_then(real);
        let hidden = |path: &Path| {
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
        };
        let paths = entries.map(|entry| entry.map(|entry| entry.path()));
        let paths: Vec<PathBuf> =
            paths.collect::<std::io::Result<_>>().map_err(|e| Error::io(&self.dir, e))?;
        let mut folders: Vec<PathBuf> = paths
            .into_iter()
            .filter(|p| p.is_dir() && !hidden(p) && (out.is_none() || real(p) != out))
            .collect();
        folders.sort();
        if folders.is_empty() {
            let what = format!("{}: no folder of an arm in it", self.dir.display());
            return Err(Error::usage(
                what,
                "give a folder with a folder an arm, each with a measurements.csv",
            ));
        }
        Ok(folders)
    }

    /// Whether nothing that is read or foreign would be written over.
    fn apart(&self, folders: &[PathBuf]) -> Result<()> {
        let Some(out) = &self.out else { return Ok(()) };
        let real = |path: &Path| std::fs::canonicalize(path).ok();
        if real(out).is_some_and(|out| Some(out) == real(&self.dir)) {
            let what = format!("{}: the arms are read there", out.display());
            return Err(Error::usage(what, "write into another folder"));
        }
        let inputs: Vec<PathBuf> =
            folders.iter().flat_map(|folder| [folder.join(ROBOT), folder.join(DATA)]).collect();
        overwrite::folder_apart(Some(out), &[ROBOT, REPORT], &inputs)?;
        for name in [ROBOT, REPORT] {
            overwritable(&out.join(name), self.force)?;
        }
        Ok(())
    }

    /// Reads and identifies an arm and writes what `identify` would. The first sets the
    /// type where DIR does not.
    fn arm(
        &self,
        folder: &Path,
        name: &str,
        common: Option<&Robot>,
        type_of: &mut Option<Robot>,
    ) -> Result<Identification> {
        let (own_robot, data) = (folder.join(ROBOT), folder.join(DATA));
        let robot = match common {
            Some(common) if !own_robot.is_file() => common.clone(),
            _ => Robot::read(&own_robot)?,
        };
        if let Some(of) = type_of.as_ref() {
            same_type(&robot, of)?;
        }
        let rows = Measurements::read(&data, &robot)?;
        let options = Options { allow_few_poses: self.allow_few_poses, ..Options::default() };
        let found = identify(&robot, &rows, &options, &|_, _| ());
        let found = found.map_err(|error| allowing(error, ALLOW_FEW))?;
        type_of.get_or_insert(robot);
        if let Some(out) = &self.out {
            self.written(&out.join(name), (folder, &rows), &found)?;
        }
        Ok(found)
    }

    fn written(
        &self,
        out: &Path,
        (folder, data): (&Path, &Measurements),
        found: &Identification,
    ) -> Result<()> {
        let report = IdentifyReport::new(found.figures.clone(), None);
        let on = Measured { data, rows: &found.rows, model: &found.model };
        let next = Next {
            robot: found.model.robot.path.clone(),
            data: vec![folder.join(DATA)],
            out: Some(out.to_owned()),
            terms: 0,
            worse: false,
        };
        let page = || identified(&report, &on, &next);
        let rows = || residuals(data, &found.rows);
        let place = (Some(out), self.force);
        deliver(&report, String::new, false, place, &found.model, rows, (page, false)).map(|_| ())
    }
}

/// Corrections can only be held against each other where they are of one drawing.
fn same_type(robot: &Robot, of: &Robot) -> Result<()> {
    let other = |what: String| {
        let help = format!("give it a fleet of its own, or the joints of {}", of.path.display());
        Err(Error::file(&robot.path, Place::default(), what, help))
    };
    let (own, all) = (robot.joints.len(), of.joints.len());
    if own != all {
        return other(format!("{own} joints, the type has {all}"));
    }
    match (0..own).find(|i| robot.joints[*i].link != of.joints[*i].link) {
        Some(i) => other(format!("joint {} is not the nominal one of the type", i + 1)),
        None => Ok(()),
    }
}
