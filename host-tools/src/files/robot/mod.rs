mod check;
mod draft;
mod keys;
mod nonsense;
mod plausible;
mod prior;

use std::path::Path;

use toml::Spanned;
use truearm::JointKind;

use super::columns::{SIGMAS, USUAL_SIGMA_MM};
use super::identified::{MODEL_KEYS, is_identified};
use super::source::Source;
use crate::error::Result;
use crate::model::{Joint, LinkMass, Placement, Robot};
use crate::units::{from_mm, joint_from_file};
use check::{Checker, printable};
pub use draft::RobotDraft;
use keys::{JointFile, PlacementFile, RobotFile};
use plausible::Plausible;
pub use prior::{prior_tables, with_priors};

/// What to do about a file that does not have the right keys.
pub(super) const HELP: &str = "see docs/files.md for the keys of this file";
/// What is made of a model.toml in the place of a robot.toml.
const AS_DRAWN: &str = "an identified model; its joints are taken as they were drawn, without its \
                        corrections, terms and curves";
/// Degrees or mm beyond which no joint goes.
const FARTHEST: f64 = 1e5;
/// Degrees Celsius to which nominal lengths refer where nothing is said.
const ROOM: f64 = 20.0;

impl Robot {
    /// Reads and checks a `robot.toml`.
    ///
    /// # Errors
    /// Names file, line, key and remedy.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path, &super::read(path)?)
    }

    /// Like [`Robot::read`] from a text.
    ///
    /// # Errors
    /// As for [`Robot::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let source = Source { path, text };
        source.refuse_table()?;
        let mut warnings = Vec::new();
        let file: RobotFile = source.toml(HELP, &mut warnings)?;
        if is_identified(text) {
            let own = MODEL_KEYS.map(|key| source.unknown(key));
            warnings.retain(|warning| !own.contains(warning));
            warnings.push(format!("{}: {AS_DRAWN}", path.display()));
        }
        let mut check = Checker { source, warnings, plausible: Plausible::of(&file) };
        check.count(file.joints.len())?;
        let sigma = check.sigma(file.measurement_sigma_mm.as_ref())?;
        let sigma_angle = file.measurement_sigma_deg.as_ref();
        let sigma_angle = sigma_angle.map(|s| check.sigma_angle(s)).transpose()?;
        let joints: Vec<Joint> =
            file.joints.iter().map(|j| check.joint(j)).collect::<Result<_>>()?;
        let base = check.placement("base", file.base.as_ref())?;
        let tool = check.placement("tool", file.tool.as_ref())?;
        let links = file.links.iter().map(|l| check.link(l)).collect::<Result<_>>()?;
        check.limits_in_radians(&file, &joints)?;
        check.lengths_in_metres(&joints);
        let gravity = file.gravity_m_s2.as_ref().map(|g| check.gravity(g)).transpose()?;
        let temperature =
            file.reference_temperature_c.as_ref().map(|t| check.temperature(t)).transpose()?;
        let payload = file.payload.as_ref().map(|p| check.centre("payload.com_mm", &p.com_mm));
        for (key, words) in [("name", &file.name), ("serial", &file.serial)] {
            printable(&check.source, key, words.as_deref().unwrap_or_default())?;
        }
        let stem = path.file_stem().map_or("robot".into(), |s| s.to_string_lossy().into_owned());
        Ok(Self {
            path: path.to_owned(),
            name: file.name.unwrap_or(stem),
            serial: file.serial.unwrap_or_default(),
            sigma,
            sigma_angle,
            gravity: gravity.map(|g| base.pose().rotation.tr_mul(&g)),
            reference_temperature: temperature.unwrap_or(ROOM),
            links: check.masses(links, joints.len()),
            joints,
            base,
            tool: tool.xyz,
            tool_rpy: tool.rpy,
            payload: payload.transpose()?.unwrap_or(tool.xyz),
            warnings: check.warnings,
        })
    }
}

impl Checker<'_> {
    /// Standard deviation of a coordinate, m.
    fn sigma(&mut self, given: Option<&Spanned<f64>>) -> Result<f64> {
        let Some(value) = given else {
            self.warn(format!("no measurement_sigma_mm: {USUAL_SIGMA_MM} mm is assumed"));
            return Ok(from_mm(USUAL_SIGMA_MM));
        };
        let mm = *value.get_ref();
        if SIGMAS.contains(&mm) {
            return Ok(from_mm(mm));
        }
        let help = "give one standard deviation of a coordinate in mm, 1e-6 to 10, such as 0.03";
        Err(self.source.at(value.span(), format!("measurement_sigma_mm = {mm:?}"), help))
    }

    /// Standard deviation of an orientation about an axis, rad.
    fn sigma_angle(&self, given: &Spanned<f64>) -> Result<f64> {
        let degrees = *given.get_ref();
        if degrees > 0.0 && degrees <= 10.0 {
            return Ok(degrees.to_radians());
        }
        let help = "give one standard deviation of a turn about an axis in degrees, such as 0.01";
        Err(self.source.at(given.span(), format!("measurement_sigma_deg = {degrees}"), help))
    }

    fn masses(&mut self, links: Vec<LinkMass>, joints: usize) -> Vec<LinkMass> {
        if links.is_empty() || links.len() == joints {
            return links;
        }
        self.warn(format!("{} [[links]] for {joints} joints: masses ignored", links.len()));
        Vec::new()
    }

    /// `xyz_mm` and `rpy_deg` of a table; where neither is given, nothing moved.
    fn placement(&mut self, table: &str, file: Option<&PlacementFile>) -> Result<Placement> {
        let mut placement = Placement::default();
        let Some(file) = file else { return Ok(placement) };
        if let Some(xyz) = &file.xyz_mm {
            placement.xyz = self.centre(&format!("{table}.xyz_mm"), xyz)?;
        }
        if let Some(rpy) = &file.rpy_deg {
            let key = format!("{table}.rpy_deg");
            for (turn, degrees) in placement.rpy.iter_mut().zip(&**rpy.get_ref()) {
                *turn = self.angle_of(&key, rpy.span(), *degrees)?;
            }
        }
        Ok(placement)
    }

    fn joint(&mut self, joint: &Spanned<JointFile>) -> Result<Joint> {
        let j = joint.get_ref();
        let kind = match j.kind.as_ref().map(|k| (k, k.get_ref().as_str())) {
            None | Some((_, "revolute")) => JointKind::Revolute,
            Some((_, "prismatic")) => JointKind::Prismatic,
            Some((key, other)) => {
                let help = "use \"revolute\" or \"prismatic\"";
                return Err(self.source.at(key.span(), format!("kind = \"{other}\""), help));
            }
        };
        let d = self.offset(kind, joint)?;
        let limits = self.limits(kind, j)?;
        let parameters = truearm::MdhParameters {
            alpha: self.angle("alpha_deg", &j.alpha_deg)?,
            a: self.length("a_mm", &j.a_mm)?,
            theta: self.angle("theta_offset_deg", &j.theta_offset_deg)?,
            d,
            beta: j.beta_deg.as_ref().map_or(Ok(0.0), |b| self.angle("beta_deg", b))?,
        };
        let gear_ratio = j.gear_ratio.as_ref().map(|ratio| self.gear_ratio(ratio)).transpose()?;
        let prior = self.prior(kind, j.tolerance.as_ref(), j.expected.as_ref())?;
        Ok(Joint { link: truearm::Link { kind, parameters }, limits, gear_ratio, prior })
    }

    /// The length along the joint's axis that does not move, m.
    fn offset(&self, kind: JointKind, joint: &Spanned<JointFile>) -> Result<f64> {
        let j = joint.get_ref();
        match (kind, &j.d_mm, &j.d_offset_mm) {
            (JointKind::Revolute, Some(d), None) => self.length("d_mm", d),
            (JointKind::Prismatic, None, Some(d)) => self.length("d_offset_mm", d),
            (JointKind::Prismatic, None, None) => Ok(0.0),
            (JointKind::Revolute, None, _) => {
                Err(self.source.at(joint.span(), "joint without d_mm", "add d_mm"))
            }
            (JointKind::Revolute, Some(_), Some(d)) => {
                let help = "d_offset_mm belongs to a prismatic joint; use d_mm";
                Err(self.source.at(d.span(), "d_offset_mm on a revolute joint", help))
            }
            (JointKind::Prismatic, Some(d), _) => {
                let help = "the joint value adds to d_offset_mm; use that";
                Err(self.source.at(d.span(), "d_mm on a prismatic joint", help))
            }
        }
    }

    fn limits(&mut self, kind: JointKind, j: &JointFile) -> Result<Option<[f64; 2]>> {
        let (limits, wrong) = match kind {
            JointKind::Revolute => (&j.limits_deg, &j.limits_mm),
            JointKind::Prismatic => (&j.limits_mm, &j.limits_deg),
        };
        if let Some(wrong) = wrong {
            let help = "a revolute joint has limits_deg, a prismatic one limits_mm";
            return Err(self.source.at(wrong.span(), "limits in the wrong unit", help));
        }
        let Some(value) = limits else { return Ok(None) };
        let [low, high] = **value.get_ref();
        self.finite(value.span(), "limits", &[low, high])?;
        if low < -FARTHEST || high > FARTHEST {
            let message = format!("limits [{low:?}, {high:?}]");
            let help = "give degrees or mm, up to 100 000; leave limits out where there are none";
            return Err(self.source.at(value.span(), message, help));
        }
        if low > high {
            let message = format!("limits [{low}, {high}]");
            return Err(self.source.at(value.span(), message, "give the lower limit first"));
        }
        if low == high {
            let line = self.source.line(value.span().start);
            self.warn(format!("line {line}: limits [{low}, {high}] let the joint not move"));
        }
        Ok(Some([low, high].map(|limit| joint_from_file(kind, limit))))
    }
}
