use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truearm::Task;
use truearm_host::blob::notes;
use truearm_host::files::Wanted;
use truearm_host::model::{Model, Path};
use truearm_host::paths::write::{Move, Template, Timing, ros2, urscript};
use truearm_host::paths::{
    CompensateOptions, Compensated, compensate, compensated_csv, missing_inputs,
};
use truearm_host::report::{CompensateReport, to_json};
use truearm_host::{Error, Result};

use super::{End, Said, arm_file, overwrite, warn, words};

/// Correct a path for a robot whose controller cannot be changed: joints at which
/// the real tool is where the path wants it. Exit status 3: rows that the model
/// does not cover, left as commanded, that the arm does not reach, or at which most
/// of the miss stays.
#[derive(Args)]
pub struct Compensate {
    /// model.toml of `identify` or `diagnose`
    model: PathBuf,
    /// Joints q1_deg.. (qN_mm for prismatic joints), or poses of [tool] in [base]:
    /// x_mm, y_mm, z_mm with qx, qy, qz, qw or roll_deg, pitch_deg, yaw_deg; and the
    /// state columns of measurements.csv
    path: PathBuf,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// What the command is, where a file has both
    #[arg(long, value_enum)]
    from: Option<Commands>,
    /// What to bring to where it is commanded; pose where the orientation was
    /// identified, for six joints and more
    #[arg(long, value_enum)]
    task: Option<Goal>,
    /// Take --task pose although points alone were measured: what they cannot see
    /// is taken as drawn
    #[arg(long)]
    trust_nominal_orientation: bool,
    /// Joints at which the inverse kinematics of poses begins, degrees (mm)
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true)]
    start: Option<String>,
    /// Correct rows outside the joint ranges of the identification as well, as a
    /// controller does
    #[arg(long)]
    extrapolate: bool,
    /// In the numbers and with the packed parameters of the controller: its bits
    #[arg(long)]
    f32: bool,
    /// The tool is this target of the identification instead of [tool]
    #[arg(long, value_name = "LABEL")]
    marker: Option<String>,
    /// What to write; by default what the ending of FILE says: .csv, .script or
    /// .urscript, .yaml or .yml
    #[arg(long, value_enum, conflicts_with = "template")]
    format: Option<Format>,
    /// Write in the language of this template, see docs/paths.md
    #[arg(long, value_name = "FILE.toml")]
    template: Option<PathBuf>,
    /// How a URScript goes from row to row; movej if not given
    #[arg(long = "move", value_enum)]
    motion: Option<Motion>,
    /// Seconds from row to row of a ROS 2 trajectory, instead of time_s
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    every: Option<f64>,
    /// Names of the joints in a ROS 2 trajectory; joint_1 and so on if not given
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    joint_names: Vec<String>,
    /// Write over a file that truearm did not write
    #[arg(long)]
    force: bool,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

/// What a row commands.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Commands {
    Joints,
    Poses,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Goal {
    Position,
    Pose,
}

/// File formats.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Format {
    /// Joints, what is left and all other columns
    Csv,
    /// A program of a Universal Robots controller
    Urscript,
    /// trajectory_msgs/msg/JointTrajectory as YAML
    Ros2,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Motion {
    Movej,
    Movel,
}

impl Compensate {
    pub fn run(self) -> Result<Said> {
        let template = self.template.as_deref().map(Template::read).transpose()?;
        let format = self.format()?;
        self.without_idle(format)?;
        if let Some(every) = self.every.filter(|every| !(*every > 0.0 && every.is_finite())) {
            let help = "give the seconds from row to row, such as 0.1";
            return Err(Error::usage(format!("--every {every}"), help));
        }
        let model = Model::read(&self.model)?;
        let wanted = match self.from {
            None => Wanted::Either,
            Some(Commands::Joints) => Wanted::Joints,
            Some(Commands::Poses) => Wanted::Poses,
        };
        let path = Path::read(&self.path, &model.robot, wanted)?;
        let options = self.options(&model)?;
        let found = compensate(&model, &path, &options)?;
        let text = match (&template, format) {
            (Some(template), _) => template.fill(&model, &path, &found)?,
            (None, format) => self.written(format, (&model, &path, &found))?,
        };
        let inputs: Vec<&std::path::Path> =
            [&self.model, &self.path].into_iter().chain(&self.template).map(|p| &**p).collect();
        overwrite::write_like(&self.out, &text, &inputs, self.force)?;
        let mut warnings = [path.data.warnings.clone(), missing_inputs(&model, &path)].concat();
        if found.chosen {
            warnings.push(arm_file::CHOSEN.to_owned());
        }
        warnings.extend(arm_file::jumps(&path, &found.jumps));
        if self.f32 {
            let rounded = notes(&model).into_iter();
            warnings.extend(rounded.filter_map(|n| n.strip_prefix("warning: ").map(str::to_owned)));
        }
        warn(&warnings);
        let files = [&self.model, &self.out].map(|path| path.display().to_string());
        let report = CompensateReport::new(files, &model, &path, &found, &options, warnings);
        let text = if self.json {
            to_json(&report)
        } else {
            words::compensation(&report, path.coordinates) + &format!("wrote {}\n", report.out)
        };
        let held = !report.extrapolated && !report.not_covered.is_empty();
        let wrong = held || !(report.not_reached.is_empty() && report.mostly_left.is_empty());
        Ok(Said { end: if wrong { End::Wrong } else { End::Good }, ..text.into() })
    }

    fn options(&self, model: &Model) -> Result<CompensateOptions> {
        let start = self.start.as_deref().map(|text| arm_file::start(text, model)).transpose()?;
        Ok(CompensateOptions {
            task: self.task.map(|goal| match goal {
                Goal::Position => Task::Position,
                Goal::Pose => Task::Pose,
            }),
            trust_nominal_orientation: self.trust_nominal_orientation,
            extrapolate: self.extrapolate,
            single: self.f32,
            marker: self.marker.clone(),
            start,
        })
    }

    fn format(&self) -> Result<Format> {
        let ending = self.out.extension().map(|e| e.to_string_lossy().to_lowercase());
        match (self.format, &self.template, ending.as_deref()) {
            (Some(format), _, _) => Ok(format),
            (None, Some(_), _) | (None, None, Some("csv")) => Ok(Format::Csv),
            (None, None, Some("script" | "urscript")) => Ok(Format::Urscript),
            (None, None, Some("yaml" | "yml")) => Ok(Format::Ros2),
            (None, None, _) => Err(Error::usage(
                format!("--out {}: what is to be written?", self.out.display()),
                "end it in .csv, .script or .yaml, or give --format or --template",
            )),
        }
    }

    /// No option of a language that is not written: it would be taken for heard.
    fn without_idle(&self, format: Format) -> Result<()> {
        let format = self.template.is_none().then_some(format);
        let given = [
            ("--move", self.motion.is_some(), Format::Urscript, "a URScript"),
            ("--every", self.every.is_some(), Format::Ros2, "a ROS 2 trajectory"),
            ("--joint-names", !self.joint_names.is_empty(), Format::Ros2, "a ROS 2 trajectory"),
        ];
        match given.into_iter().find(|(_, given, of, _)| *given && format != Some(*of)) {
            None => Ok(()),
            Some((option, _, _, of)) => Err(Error::usage(
                format!("{option} is for {of}, and {} is none", self.out.display()),
                format!("leave {option} out, or write {of} by the ending of --out or by --format"),
            )),
        }
    }

    fn written(
        &self,
        format: Format,
        (model, path, found): (&Model, &Path, &Compensated),
    ) -> Result<String> {
        match format {
            Format::Csv => compensated_csv(path, &model.robot, found),
            Format::Urscript => {
                let how = match self.motion {
                    None | Some(Motion::Movej) => Move::Joints,
                    Some(Motion::Movel) => Move::Line,
                };
                urscript(model, path, found, how)
            }
            Format::Ros2 => {
                let timing = Timing { every: self.every, names: self.joint_names.clone() };
                ros2(model, path, found, &timing)
            }
        }
    }
}
