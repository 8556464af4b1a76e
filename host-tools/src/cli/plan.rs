use std::path::{Path, PathBuf};

use clap::Args;
use truearm_host::diagnose::{Alternative, DiagnoseOptions, diagnose, instead};
use truearm_host::files::{Gathered, overwritable_like, planned_csv, poses_csv, write_all};
use truearm_host::identify::State;
use truearm_host::model::{Measurements, Robot, Workspace};
use truearm_host::observations::{KINDS, by_name};
use truearm_host::page::{Page, Planned, after_measuring, planned, separated};
use truearm_host::plan::{Explained, PlanOptions, PosePlan, discriminate, plan};
use truearm_host::report::{PlanReport, SeparatedAlternative, SeparationReport, to_json};
use truearm_host::units::MICRO;
use truearm_host::{Error, ErrorKind, Result};

use super::page::page_files;
use super::progress::Bar;
use super::workspace::Where;
use super::{End, Said, count, overwrite, warn, words};

/// Choose the poses to measure before an identification, or to tell two
/// explanations of `diagnose` apart.
#[derive(Args)]
pub struct Plan {
    /// The nominal arm, robot.toml
    robot: PathBuf,
    /// How many poses (of pairs how many pairs, of images how many images); with --target-um,
    /// at most so many
    #[arg(long, value_name = "N", value_parser = count, allow_hyphen_values = true)]
    poses: usize,
    /// What will be measured at each: a kind of measurements.csv, such as point, pose (its
    /// orientation as well), touch or plate
    #[arg(long, default_value = "point", value_name = "KIND", conflicts_with = "discriminate")]
    kind: String,
    /// Where what is measured on and with stands, or about where; else the instruments.toml
    /// beside --out or beside the robot
    #[arg(long, value_name = "FILE.toml", conflicts_with = "discriminate")]
    instruments: Option<PathBuf>,
    /// Write the joint values here, a CSV line a pose
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
    /// Write a page about the poses into this file
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
    /// Write each figure of the page as SVG beside it; as PNG, too, if truearm was built with
    /// the feature png
    #[arg(long, requires = "html")]
    figures: bool,
    #[command(flatten)]
    workspace: Where,
    /// Stop at the fewest poses whose predicted worst tool point is this good:
    /// 3-D standard deviation (1 sigma) in micrometres
    #[arg(long, value_name = "UM", conflicts_with = "discriminate", allow_hyphen_values = true)]
    target_um: Option<f64>,
    /// Diagnose these measurements and plan poses that separate what is named
    /// from its alternatives
    #[arg(long, value_name = "DATA")]
    discriminate: Option<PathBuf>,
    /// Poses drawn at random to choose from
    #[arg(
        long,
        default_value_t = 3000,
        value_name = "COUNT",
        value_parser = count,
        allow_hyphen_values = true
    )]
    candidates: usize,
    /// Other random candidates
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write over files that truearm did not write
    #[arg(long)]
    force: bool,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

impl Plan {
    pub fn run(self) -> Result<Said> {
        let robot = Robot::read(&self.robot)?;
        let workspace = self.workspace.of(&robot)?;
        if let Some(data) = &self.discriminate {
            return self.separate(&robot, data, &workspace);
        }
        let kind = by_name(&self.kind).ok_or_else(|| {
            let known = KINDS.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ");
            Error::usage(format!("--kind {}", self.kind), format!("give one of {known}"))
        })?;
        let instruments = match &self.instruments {
            Some(file) => Gathered::read(file)?,
            None => Gathered::beside(&self.out, &robot)?,
        };
        let options = PlanOptions {
            kind,
            instruments,
            poses: self.poses,
            workspace: workspace.clone(),
            candidates: self.candidates,
            target: self.target_um.map(|um| um / MICRO),
            seed: self.seed,
        };
        let bar = Bar::new("planning");
        let sweep = |poses, sweep| bar.stage(format!("exchanging {poses} poses, sweep {sweep}"));
        let found = plan(&robot, &options, &sweep);
        bar.finish();
        let found = found?;
        let report = PlanReport::new(&robot, &found, self.candidates, self.target_um);
        warn(&[&options.instruments.warnings[..], &report.warnings].concat());
        let page = || planned(&report, &self.of(&robot, &workspace, &found.poses));
        let of = KINDS[usize::from(kind.0)];
        let lines = match found.kind {
            "point" => poses_csv(&robot, "q", &found.poses, &[]),
            _ => planned_csv(&robot, of, &found.measurements),
        };
        self.write(lines, page)?;
        let text = if self.json {
            to_json(&report)
        } else {
            words::planned(&found) + &format!("wrote {}\n", self.out.display())
        };
        let end = self.end(&found);
        Ok(Said { end, ..text.into() })
    }

    /// Whether the goal was reached; by what it could be, if not.
    fn end(&self, found: &PosePlan) -> End {
        let (Some(false), Some(target)) = (found.reached, self.target_um) else {
            return End::Good;
        };
        let worst = found.worst * MICRO;
        let message = format!(
            "with {} poses the worst tool point is {worst:.1} um, not {target} um",
            self.poses
        );
        let help = match found.determined {
            Some(d) if d.worst * MICRO <= target => {
                "the poses are written as far as they go; what stays open needs another kind \
                 beside this one"
            }
            _ => {
                "the poses are written as far as they go; allow more --poses, a wider workspace, or \
                 measure with a smaller sigma"
            }
        };
        End::Failed(Error::data(ErrorKind::GoalMissed, message, help))
    }

    /// What the page is about.
    fn of<'p>(
        &'p self,
        robot: &'p Robot,
        workspace: &'p Workspace,
        poses: &'p [Vec<f64>],
    ) -> Planned<'p> {
        let then = after_measuring(&self.robot, &self.out, self.discriminate.as_deref());
        Planned { robot, limits: &workspace.limits, poses, file: &self.out, then }
    }

    /// The poses and, where one is asked for, the page.
    fn write(&self, poses: String, page: impl FnOnce() -> Page) -> Result<()> {
        let inputs = [&self.robot].into_iter().chain(&self.discriminate).chain(&self.instruments);
        let inputs: Vec<&Path> = inputs.map(PathBuf::as_path).collect();
        let mut made = Vec::new();
        if let Some(path) = &self.html {
            overwrite::apart([path.as_path()], inputs.iter().copied())?;
            overwrite::page_file(path, self.force)?;
            made = page_files(path, &page(), self.figures)?;
        }
        overwrite::apart([self.out.as_path()], inputs.iter().copied())?;
        overwritable_like(&self.out, &poses, self.force)?;
        made.push((self.out.clone(), poses.into_bytes()));
        write_all(&made)
    }

    fn separate(&self, robot: &Robot, path: &Path, workspace: &Workspace) -> Result<Said> {
        let data = Measurements::read(path, robot)?;
        let bar = Bar::new("diagnosing");
        let found =
            diagnose(robot, &data, None, &DiagnoseOptions::default(), &|what| bar.stage(what));
        bar.finish();
        let found = found?;
        let flagged = &found.outcome.figures.outlier_rows;
        let kept: Vec<usize> =
            (0..data.rows.len()).filter(|row| !flagged.contains(&(row + 1))).collect();
        let told = |(a, _): &(&Alternative, &State)| a.is_told_by_poses();
        let (others, states): (Vec<&Alternative>, Vec<State>) = found
            .outcome
            .alternatives
            .iter()
            .zip(&found.alternatives)
            .filter(told)
            .map(|(a, state)| (a, state.clone()))
            .unzip();
        let explained = Explained {
            named: &found.state,
            alternatives: &states,
            kept: &kept,
            lambda: found.outcome.figures.lambda,
        };
        let draw = (self.poses, self.candidates, self.seed);
        let planned = discriminate(&found.model.robot, &data, &explained, workspace, draw)?;
        let told = data.rows[0].directions.iter().any(|d| *d != 0);
        let directions = if told { planned.directions.as_slice() } else { &[] };
        let warnings = found.outcome.figures.warnings.clone();
        warn(&warnings);
        let named = [found.outcome.effects.clone(), found.outcome.suspected.clone()].concat();
        let pairs = others.into_iter().zip(&planned.separation);
        let alternatives: Vec<SeparatedAlternative> = pairs
            .map(|(a, added)| SeparatedAlternative {
                effects: a.effects.clone(),
                instead: instead(&a.effects, &named),
                worse_by_now: a.worse_by,
                worse_by_planned: *added,
            })
            .collect();
        let report = SeparationReport {
            schema: SeparationReport::SCHEMA,
            command: "plan",
            robot: robot.name.clone(),
            data: path.display().to_string(),
            poses: planned.poses.len(),
            candidates: self.candidates,
            alternatives,
            warnings,
        };
        let page = || separated(&report, &self.of(robot, workspace, &planned.poses));
        self.write(poses_csv(robot, "q", &planned.poses, directions), page)?;
        if self.json {
            return Ok(to_json(&report).into());
        }
        let mut text = words::separated(&report.alternatives, planned.poses.len());
        text += &format!("wrote {}\n", self.out.display());
        Ok(text.into())
    }
}
