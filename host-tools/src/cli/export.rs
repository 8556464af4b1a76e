use std::path::{Path, PathBuf};

use clap::Args;
use truearm_host::convert::table::{mdh_csv, standard_dh, standard_dh_csv};
use truearm_host::convert::urdf::{Document, Ends, calibrated_like, urdf_text};
use truearm_host::convert::{Identified, LeftOut, left_out, ur_calibration};
use truearm_host::files::{Comment, overwritable, signed, write_all};
use truearm_host::model::Model;
use truearm_host::report::{ExportReport, to_json};
use truearm_host::units::to_mm;
use truearm_host::{Error, Result};

use super::{Said, overwrite, warn};

/// Write the identified geometry as URDF, calibration file, table or JSON.
#[derive(Args)]
#[command(group = clap::ArgGroup::new("what").required(true).multiple(true)
    .args(["urdf", "ur_calibration", "mdh", "dh", "json"]))]
pub struct Export {
    /// The identified arm, model.toml
    model: PathBuf,
    /// A URDF, its joint origins identified; its base link is the frame of
    /// truearm's coordinates, its last link the measured target
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
    /// Change the joint origins of this URDF, of which robot.toml was made, and
    /// keep everything else of it
    #[arg(long, value_name = "URDF", requires = "urdf")]
    like: Option<PathBuf>,
    /// First link of that URDF's chain
    #[arg(long, value_name = "LINK", requires = "like")]
    base_link: Option<String>,
    /// Last link of that URDF's chain
    #[arg(long, value_name = "LINK", requires = "like")]
    tip_link: Option<String>,
    /// The kinematics file (YAML) of Universal Robots' ROS packages
    #[arg(long, value_name = "FILE")]
    ur_calibration: Option<PathBuf>,
    /// The controller's own hash: `hash` of the file that ur_calibration extracted
    #[arg(long, value_name = "HASH", requires = "ur_calibration")]
    ur_hash: Option<String>,
    /// A table of modified Denavit-Hartenberg parameters and beta, CSV
    #[arg(long, value_name = "FILE")]
    mdh: Option<PathBuf>,
    /// A table of standard Denavit-Hartenberg parameters, CSV
    #[arg(long, value_name = "FILE")]
    dh: Option<PathBuf>,
    /// A report of it all; printed without a FILE
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// The measured target, if there are several
    #[arg(long, value_name = "LABEL")]
    marker: Option<String>,
    /// Overwrite files that truearm did not write or that were edited since
    #[arg(long)]
    force: bool,
}

impl Export {
    pub fn run(self) -> Result<Said> {
        let model = Model::read(&self.model)?;
        let arm = Identified::of(&model, self.marker.as_deref())?;
        let left_out = left_out(&model);
        let mut warnings = remarks(&model, &left_out);
        let mut files = self.files(&model, &arm, &mut warnings)?;
        let report = || {
            let path = self.model.display().to_string();
            to_json(&ExportReport::new(path, &model, &arm, &left_out, warnings.clone()))
        };
        let printed = self.json.as_ref().is_some_and(|path| path == Path::new("-"));
        if let Some(path) = self.json.as_ref().filter(|_| !printed) {
            files.push((path, report()));
        }
        let inputs = std::iter::once(&self.model).chain(&self.like).map(PathBuf::as_path);
        overwrite::apart(files.iter().map(|(path, _)| path.as_path()), inputs)?;
        // None is written where one may not be.
        for (path, _) in &files {
            overwritable(path, self.force)?;
        }
        let made = files.iter().map(|(path, text)| ((*path).clone(), text.clone().into_bytes()));
        write_all(&made.collect::<Vec<_>>())?;
        warn(&warnings);
        if printed {
            return Ok(report().into());
        }
        let wrote = files.iter().map(|(path, _)| format!("wrote {}\n", path.display()));
        Ok(wrote.collect::<String>().into())
    }

    /// The files that were asked for, and what their formats cannot hold.
    fn files(
        &self,
        model: &Model,
        arm: &Identified,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<(&PathBuf, String)>> {
        let mut files = Vec::new();
        if let Some(path) = &self.urdf {
            files.push((path, signed(Comment::Xml, &self.urdf_of(model, arm)?)));
        }
        if let Some(path) = &self.ur_calibration {
            let hash = self.ur_hash.as_deref();
            if hash.is_none_or(|hash| !plain(hash)) && hash.is_some() {
                return Err(Error::usage(
                    format!("--ur-hash {}", hash.unwrap_or_default()),
                    "give it as in the extracted file, such as calib_209549117540498681",
                ));
            }
            if hash.is_none() {
                warnings.push(format!(
                    "{}: without --ur-hash the driver reports, rightly, that this is not the \
                     calibration in the controller",
                    path.display()
                ));
            }
            files.push((path, signed(Comment::Hash, &ur_calibration(&model.robot, arm, hash)?)));
        }
        if let Some(path) = &self.mdh {
            files.push((path, signed(Comment::Hash, &mdh_csv(arm))));
        }
        if let Some(path) = &self.dh {
            let dh = standard_dh(model, arm);
            let straightened = &dh.described.straightened;
            if !straightened.is_empty() {
                let joints = straightened.iter().map(|(joint, angle)| {
                    format!("{} and {} ({:.4} mrad)", joint, joint + 1, angle * 1e3)
                });
                warnings.push(format!(
                    "{}: joints {} are almost parallel, which this convention cannot hold; as \
                     parallel ones the tool point is up to {:.3} mm off within the covered ranges",
                    path.display(),
                    joints.collect::<Vec<_>>().join(", "),
                    to_mm(dh.deviation)
                ));
            }
            files.push((path, signed(Comment::Hash, &standard_dh_csv(&dh))));
        }
        Ok(files)
    }

    fn urdf_of(&self, model: &Model, arm: &Identified) -> Result<String> {
        let Some(like) = &self.like else { return Ok(urdf_text(model, arm)) };
        let ends = Ends { base: self.base_link.clone(), tip: self.tip_link.clone() };
        calibrated_like(&Document::read(like)?, &ends, model, arm)
    }
}

/// Whether it may stand in a YAML file as it is.
fn plain(hash: &str) -> bool {
    !hash.is_empty() && hash.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// What geometry alone does not carry.
fn remarks(model: &Model, left_out: &[LeftOut]) -> Vec<String> {
    let mut warnings: Vec<String> = left_out
        .iter()
        .map(|left| {
            let joints: Vec<String> = left.joints.iter().map(ToString::to_string).collect();
            let what = match (left.effect, joints.as_slice()) {
                ("", _) => "all terms together".to_owned(),
                (effect, []) => effect.to_owned(),
                (effect, [joint]) => format!("{effect} of joint {joint}"),
                (effect, joints) => format!("{effect} of joints {}", joints.join(", ")),
            };
            format!(
                "left out: {what}, {:.3} mm RMS and up to {:.3} mm within the covered ranges",
                to_mm(left.rms),
                to_mm(left.largest)
            )
        })
        .collect();
    if !model.orientation_identified {
        warnings.push(
            "the data did not determine how the flange is turned: that is nominal".to_owned(),
        );
    }
    if model.changed {
        warnings.push(
            "the model was changed by hand: its stated accuracy is not this geometry's".to_owned(),
        );
    }
    warnings
}
