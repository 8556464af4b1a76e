use std::path::Path;

use nalgebra::Vector3;
use serde::Deserialize;
use toml::Spanned;
use truearm::{JointKind, Link, MdhParameters};

use crate::error::{Error, Place, Result};
use crate::model::{Joint, LinkMass, Robot};

#[derive(Deserialize)]
struct RobotFile {
    name: Option<String>,
    serial: Option<String>,
    measurement_sigma_mm: Option<Spanned<f64>>,
    #[serde(rename = "repeatability_mm")]
    _repeatability_mm: Option<f64>,
    gravity_m_s2: Option<[f64; 3]>,
    reference_temperature_c: Option<f64>,
    #[serde(default)]
    joints: Vec<Spanned<JointFile>>,
    tool: Option<ToolFile>,
    #[serde(default)]
    links: Vec<LinkFile>,
    payload: Option<PayloadFile>,
}

#[derive(Deserialize)]
struct JointFile {
    kind: Option<Spanned<String>>,
    alpha_deg: Spanned<f64>,
    a_mm: Spanned<f64>,
    d_mm: Option<Spanned<f64>>,
    d_offset_mm: Option<Spanned<f64>>,
    theta_offset_deg: Spanned<f64>,
    beta_deg: Option<Spanned<f64>>,
    limits_deg: Option<Spanned<[f64; 2]>>,
    limits_mm: Option<Spanned<[f64; 2]>>,
    gear_ratio: Option<f64>,
}

#[derive(Deserialize)]
struct ToolFile {
    xyz_mm: Spanned<[f64; 3]>,
}

#[derive(Deserialize)]
struct LinkFile {
    mass_kg: f64,
    com_mm: [f64; 3],
}

#[derive(Deserialize)]
struct PayloadFile {
    com_mm: [f64; 3],
}

/// Reads a TOML file into `F`; unknown keys become warnings.
pub(super) fn parse<F: serde::de::DeserializeOwned>(
    path: &Path,
    text: &str,
    warnings: &mut Vec<String>,
) -> Result<F> {
    let fail = |e: toml::de::Error| {
        let place = e.span().map_or_else(Place::default, |s| Place::offset(text, s.start));
        Error::file(path, place, e.message().to_owned(), "see the README for the keys of this file")
    };
    let deserializer = toml::Deserializer::parse(text).map_err(fail)?;
    serde_ignored::deserialize(deserializer, |key| {
        warnings.push(format!("{}: unknown key `{key}` ignored", path.display()));
    })
    .map_err(fail)
}

pub(super) fn mm(v: [f64; 3]) -> Vector3<f64> {
    Vector3::from(v) * 1e-3
}

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
        let mut warnings = Vec::new();
        let file: RobotFile = parse(path, text, &mut warnings)?;
        let mut check = Checker { path, text, warnings };
        if file.joints.is_empty() {
            return Err(Error::file(
                path,
                Place::default(),
                "no [[joints]]",
                "add one [[joints]] table a joint: alpha_deg, a_mm, d_mm, theta_offset_deg",
            ));
        }
        if file.joints.len() > truearm::MAX_JOINTS {
            let message = format!("{} joints", file.joints.len());
            let help = format!("truearm handles up to {}", truearm::MAX_JOINTS);
            return Err(Error::file(path, Place::default(), message, help));
        }
        let sigma = match &file.measurement_sigma_mm {
            Some(value) => {
                let mm = *value.get_ref();
                if !(mm > 0.0 && mm <= 10.0) {
                    return Err(check.at(
                        value.span().start,
                        format!("measurement_sigma_mm = {mm}"),
                        "give one standard deviation of a coordinate in mm, such as 0.03",
                    ));
                }
                mm * 1e-3
            }
            None => {
                check.warn("no measurement_sigma_mm: 0.03 mm is assumed".to_owned());
                3e-5
            }
        };
        let mut joints = Vec::new();
        for joint in &file.joints {
            joints.push(check.joint(joint)?);
        }
        let tool = match &file.tool {
            Some(tool) => {
                check.finite(tool.xyz_mm.span().start, "tool.xyz_mm", tool.xyz_mm.get_ref())?;
                mm(*tool.xyz_mm.get_ref())
            }
            None => Vector3::zeros(),
        };
        if !file.links.is_empty() && file.links.len() != joints.len() {
            check.warn(format!(
                "{} [[links]] for {} joints: masses ignored",
                file.links.len(),
                joints.len()
            ));
        }
        let links = file.links.iter().map(|l| LinkMass { mass: l.mass_kg, com: mm(l.com_mm) });
        let links: Vec<_> = links.collect();
        let stem = path.file_stem().map_or("robot".into(), |s| s.to_string_lossy().into_owned());
        Ok(Self {
            path: path.to_owned(),
            name: file.name.unwrap_or(stem),
            serial: file.serial.unwrap_or_default(),
            sigma,
            gravity: file.gravity_m_s2.map(Vector3::from),
            reference_temperature: file.reference_temperature_c.unwrap_or(20.0),
            links: if links.len() == joints.len() { links } else { Vec::new() },
            joints,
            tool,
            payload: file.payload.map_or(tool, |p| mm(p.com_mm)),
            warnings: check.warnings,
        })
    }
}

struct Checker<'a> {
    path: &'a Path,
    text: &'a str,
    warnings: Vec<String>,
}

impl Checker<'_> {
    fn at(&self, offset: usize, message: String, help: &str) -> Error {
        Error::file(self.path, Place::offset(self.text, offset), message, help)
    }

    fn warn(&mut self, message: String) {
        self.warnings.push(format!("{}: {message}", self.path.display()));
    }

    fn finite(&self, offset: usize, key: &str, values: &[f64]) -> Result<()> {
        match values.iter().find(|v| !v.is_finite()) {
            Some(v) => Err(self.at(offset, format!("{key} is {v}"), "give a finite number")),
            None => Ok(()),
        }
    }

    /// A length in mm, to m.
    fn length(&self, key: &str, value: &Spanned<f64>) -> Result<f64> {
        let (offset, value) = (value.span().start, *value.get_ref());
        self.finite(offset, key, &[value])?;
        if value.abs() > 10_000.0 {
            return Err(self.at(offset, format!("{key} = {value}"), "lengths are mm, up to 10 m"));
        }
        Ok(value * 1e-3)
    }

    /// An angle in degrees, to rad.
    fn angle(&mut self, key: &str, value: &Spanned<f64>) -> Result<f64> {
        let (offset, value) = (value.span().start, *value.get_ref());
        self.finite(offset, key, &[value])?;
        // As a blob holds them, which has room for a little more than a turn.
        if value.to_radians().abs() as f32 > 6.3 {
            return Err(self.at(
                offset,
                format!("{key} = {value}"),
                "angles are degrees, up to 360",
            ));
        }
        let half_turns = value.abs() / std::f64::consts::FRAC_PI_2;
        if value != 0.0 && (half_turns - half_turns.round()).abs() < 1e-3 && half_turns < 4.5 {
            let line = Place::offset(self.text, offset).line.unwrap_or(0);
            self.warn(format!(
                "line {line}: {key} = {value} looks like radians; degrees are expected"
            ));
        }
        Ok(value.to_radians())
    }

    fn joint(&mut self, joint: &Spanned<JointFile>) -> Result<Joint> {
        let j = joint.get_ref();
        let kind = match j.kind.as_ref().map(|k| k.get_ref().as_str()) {
            None | Some("revolute") => JointKind::Revolute,
            Some("prismatic") => JointKind::Prismatic,
            Some(other) => {
                let offset = j.kind.as_ref().map_or(0, |k| k.span().start);
                let message = format!("kind = \"{other}\"");
                return Err(self.at(offset, message, "use \"revolute\" or \"prismatic\""));
            }
        };
        let d = match (kind, &j.d_mm, &j.d_offset_mm) {
            (JointKind::Revolute, Some(d), None) => self.length("d_mm", d)?,
            (JointKind::Prismatic, None, Some(d)) => self.length("d_offset_mm", d)?,
            (JointKind::Prismatic, None, None) => 0.0,
            (JointKind::Revolute, None, _) => {
                return Err(self.at(joint.span().start, "joint without d_mm".into(), "add d_mm"));
            }
            (JointKind::Revolute, Some(_), Some(d)) => {
                let help = "d_offset_mm belongs to a prismatic joint; use d_mm";
                return Err(self.at(
                    d.span().start,
                    "d_offset_mm on a revolute joint".into(),
                    help,
                ));
            }
            (JointKind::Prismatic, Some(d), _) => {
                let help = "the joint value adds to d_offset_mm; use that";
                return Err(self.at(d.span().start, "d_mm on a prismatic joint".into(), help));
            }
        };
        let (limits, wrong, factor) = match kind {
            JointKind::Revolute => (&j.limits_deg, &j.limits_mm, 1_f64.to_radians()),
            JointKind::Prismatic => (&j.limits_mm, &j.limits_deg, 1e-3),
        };
        if let Some(wrong) = wrong {
            let help = "a revolute joint has limits_deg, a prismatic one limits_mm";
            return Err(self.at(wrong.span().start, "limits in the wrong unit".into(), help));
        }
        let limits = match limits {
            None => None,
            Some(value) => {
                let [low, high] = *value.get_ref();
                self.finite(value.span().start, "limits", &[low, high])?;
                if low > high {
                    let message = format!("limits [{low}, {high}]");
                    return Err(self.at(value.span().start, message, "give the lower limit first"));
                }
                if low == high {
                    let line = Place::offset(self.text, value.span().start).line.unwrap_or(0);
                    self.warn(format!(
                        "line {line}: limits [{low}, {high}] let the joint not move"
                    ));
                }
                Some([low * factor, high * factor])
            }
        };
        let parameters = MdhParameters {
            alpha: self.angle("alpha_deg", &j.alpha_deg)?,
            a: self.length("a_mm", &j.a_mm)?,
            theta: self.angle("theta_offset_deg", &j.theta_offset_deg)?,
            d,
            beta: j.beta_deg.as_ref().map_or(Ok(0.0), |b| self.angle("beta_deg", b))?,
        };
        Ok(Joint { link: Link { kind, parameters }, limits, gear_ratio: j.gear_ratio })
    }
}
