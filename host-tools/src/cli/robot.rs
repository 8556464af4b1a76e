use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use truearm_host::convert::TEMPLATE;
use truearm_host::convert::presets::{PRESETS, Preset};
use truearm_host::convert::table::{Convention, Units, robot_of_table};
use truearm_host::convert::urdf::{Ends, robot_of_urdf};
use truearm_host::files::{Comment, overwritable, read_text, signed, write};
use truearm_host::model::Robot;
use truearm_host::units::MILLI;
use truearm_host::{Error, ErrorKind, Result};

use super::{Said, overwrite, warn};

/// Make a robot.toml: of a URDF, a Denavit-Hartenberg table or a data sheet.
#[derive(Args)]
pub struct MakeRobot {
    #[command(flatten)]
    source: Source,
    /// First link of the chain; its frame is that of all coordinates
    #[arg(long, value_name = "LINK", conflicts_with_all = ["dh", "preset", "list", "init"])]
    base_link: Option<String>,
    /// Last link of the chain; its origin is the target
    #[arg(long, value_name = "LINK", conflicts_with_all = ["dh", "preset", "list", "init"])]
    tip_link: Option<String>,
    /// Unit of the table's lengths, if its titles do not tell
    #[arg(long, conflicts_with_all = ["urdf", "preset", "list", "init"])]
    lengths: Option<Lengths>,
    /// Unit of the table's angles, if its titles do not tell
    #[arg(long, conflicts_with_all = ["urdf", "preset", "list", "init"])]
    angles: Option<Angles>,
    /// Write it here instead of printing it
    #[arg(long, value_name = "FILE", conflicts_with = "list")]
    out: Option<PathBuf>,
    /// Overwrite a file that truearm did not write or that was edited since
    #[arg(long, requires = "out")]
    force: bool,
}

#[derive(Args)]
#[group(required = true, multiple = false)]
struct Source {
    /// A URDF, with xacro already expanded
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
    /// A CSV table with titles such as alpha_deg, a_mm, theta_offset_deg, d_mm
    #[arg(long, num_args = 2, value_names = ["standard|modified", "TABLE"])]
    dh: Option<Vec<String>>,
    /// An arm of a published data sheet, see --list
    #[arg(
        long,
        value_name = "NAME",
        ignore_case = true,
        hide_possible_values = true,
        value_parser = PossibleValuesParser::new(PRESETS.map(|preset| preset.name))
    )]
    preset: Option<String>,
    /// List the presets with their sources
    #[arg(long)]
    list: bool,
    /// A template with remarks on every key
    #[arg(long)]
    init: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Lengths {
    Mm,
    M,
}

#[derive(Clone, Copy, ValueEnum)]
enum Angles {
    Deg,
    Rad,
}

/// A text and what there is to say about it.
struct Made {
    text: String,
    said: String,
    warnings: Vec<String>,
}

impl MakeRobot {
    pub fn run(self) -> Result<Said> {
        if self.source.list {
            return Ok(Said::asked(list()));
        }
        let mut made = self.make()?;
        let name = self.out.as_deref().unwrap_or(Path::new("robot.toml"));
        // What the reader has to say belongs here; that no tracker is known is no fault.
        // No file of that name is there yet: what is wrong is what it was made of.
        let robot = Robot::parse(name, &made.text).map_err(|e| {
            let what = format!("what was read makes no robot.toml: {e}");
            Error::data(ErrorKind::File, what, e.help().to_owned())
        })?;
        made.warnings
            .extend(robot.warnings.into_iter().filter(|w| !w.contains("no measurement_sigma_mm")));
        let Some(out) = &self.out else {
            warn(&made.warnings);
            return Ok(Said::asked(made.text));
        };
        let table = self.source.dh.iter().flat_map(|dh| dh.get(1)).map(Path::new);
        overwrite::apart([out.as_path()], self.source.urdf.as_deref().into_iter().chain(table))?;
        overwritable(out, self.force)?;
        write(out, signed(Comment::Hash, &made.text).as_bytes())?;
        warn(&made.warnings);
        Ok((made.said + &format!("wrote {}\n", out.display())).into())
    }

    fn make(&self) -> Result<Made> {
        let plain =
            |text: &str| Made { text: text.to_owned(), said: String::new(), warnings: Vec::new() };
        match &self.source {
            Source { urdf: Some(path), .. } => self.of_urdf(path),
            Source { dh: Some(dh), .. } => self.of_table(dh),
            Source { preset: Some(name), .. } => {
                let preset = Preset::find(name).ok_or_else(|| {
                    Error::usage(format!("--preset {name}"), "see `truearm robot --list`")
                })?;
                let said = format!("{}\n{}\n", preset.title(), preset.source());
                Ok(Made { said, ..plain(preset.text) })
            }
            _ => Ok(plain(TEMPLATE)),
        }
    }

    fn of_urdf(&self, path: &Path) -> Result<Made> {
        let ends = Ends { base: self.base_link.clone(), tip: self.tip_link.clone() };
        let made = robot_of_urdf(path, &ends)?;
        let names = made.chain.joints.iter().enumerate();
        let names: Vec<_> = names.map(|(i, joint)| format!("q{} {}", i + 1, joint.name)).collect();
        let said = format!(
            "{} to {}: {}\nits tip is that of the URDF to {:.1e} mm\n",
            made.chain.base,
            made.chain.tip,
            names.join(", "),
            made.deviation * MILLI
        );
        Ok(Made { text: made.text, said, warnings: made.warnings })
    }

    fn of_table(&self, dh: &[String]) -> Result<Made> {
        let (convention, path) = match dh {
            [convention, path] if convention == "standard" => (Convention::Standard, path),
            [convention, path] if convention == "modified" => (Convention::Modified, path),
            _ => {
                return Err(Error::usage(
                    format!("--dh {}", dh.join(" ")),
                    "say the convention, then the file: --dh standard TABLE.csv (a and alpha lead to \
                     the next axis) or --dh modified TABLE.csv (they lead to the joint's own)",
                ));
            }
        };
        let units = Units {
            length: self.lengths.map(|unit| match unit {
                Lengths::Mm => 1e-3,
                Lengths::M => 1.0,
            }),
            angle: self.angles.map(|unit| match unit {
                Angles::Deg => 1_f64.to_radians(),
                Angles::Rad => 1.0,
            }),
        };
        let text = robot_of_table(Path::new(path), convention, &units)?;
        // Tables that truearm wrote have them in remarks, which no table holds.
        let stood = read_text(Path::new(path))?;
        let remarks = stood.lines().filter_map(|line| line.strip_prefix("# "));
        let placed =
            remarks.filter(|l| l.starts_with("base xyz_mm") || l.starts_with("tool xyz_mm"));
        let warnings = placed
            .map(|line| {
                let (name, place) = line.split_once(' ').unwrap_or((line, ""));
                format!(
                    "{path}: {name} is a remark and is not read; write it under [{name}]: {place}"
                )
            })
            .collect();
        Ok(Made { text, said: String::new(), warnings })
    }
}

fn list() -> String {
    let widest = PRESETS.iter().map(|preset| preset.name.len()).max().unwrap_or(0);
    let line = |preset: &Preset| {
        format!("{:widest$}  {}: {}\n", preset.name, preset.title(), preset.source())
    };
    PRESETS.iter().map(line).collect()
}
