use std::path::Path;

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use truearm::{JointKind, LinkParameter, MdhParameters, Pose};

use super::covariance;
use super::digest::digest;
use super::model_file::*;
use super::model_terms;
use super::robot::{mm, parse};
use crate::error::{Error, Place, Result};
use crate::model::{Model, Robot};

/// First line of every model.toml.
const SCHEMA: &str = "truearm-model-1";

fn to_mm(v: &Vector3<f64>) -> [f64; 3] {
    [v.x * 1e3, v.y * 1e3, v.z * 1e3]
}

/// Angles in degrees, lengths in mm, in the order of [`LinkParameter::ALL`].
fn to_file(p: &MdhParameters<f64>) -> [f64; 5] {
    let mut out = p.to_array();
    for (x, parameter) in out.iter_mut().zip(LinkParameter::ALL) {
        *x = if parameter.is_length() { *x * 1e3 } else { x.to_degrees() };
    }
    out
}

fn from_file(mut values: [f64; 5]) -> MdhParameters<f64> {
    for (x, parameter) in values.iter_mut().zip(LinkParameter::ALL) {
        *x = if parameter.is_length() { *x * 1e-3 } else { x.to_radians() };
    }
    MdhParameters::from_array(values)
}

impl Model {
    /// The text of a model.toml.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let robot = &self.robot;
        let revolute = |i: usize| robot.joints[i].link.kind == JointKind::Revolute;
        let joints = robot.joints.iter().enumerate().map(|(i, joint)| {
            let [alpha_deg, a_mm, theta_offset_deg, d, beta_deg] = to_file(&joint.link.parameters);
            JointFile {
                kind: if revolute(i) { "revolute" } else { "prismatic" },
                alpha_deg,
                a_mm,
                d_mm: revolute(i).then_some(d),
                d_offset_mm: (!revolute(i)).then_some(d),
                theta_offset_deg,
                beta_deg,
                limits_deg: joint.limits.filter(|_| revolute(i)).map(|l| l.map(f64::to_degrees)),
                limits_mm: joint.limits.filter(|_| !revolute(i)).map(|l| l.map(|x| x * 1e3)),
                gear_ratio: joint.gear_ratio,
            }
        });
        let corrections = (0..robot.joints.len()).map(|i| {
            let [alpha_deg, a_mm, theta_offset_deg, d_mm, beta_deg] = to_file(&self.corrections[i]);
            let sigma = self.uncertainties.get(i).map(|sigma| {
                let [alpha_deg, a_mm, theta_offset_deg, d_mm, beta_deg] = to_file(sigma);
                SigmaFile { alpha_deg, a_mm, theta_offset_deg, d_mm, beta_deg }
            });
            let range = self.covered[i];
            CorrectionFile {
                joint: i + 1,
                alpha_deg,
                a_mm,
                theta_offset_deg,
                d_mm,
                beta_deg,
                sigma,
                covered_deg: range.filter(|_| revolute(i)).map(|r| r.map(f64::to_degrees)),
                covered_mm: range.filter(|_| !revolute(i)).map(|r| r.map(|x| x * 1e3)),
            }
        });
        let stations = self.stations.iter().map(|(label, pose)| {
            let rotation = Rotation3::from_matrix_unchecked(pose.rotation);
            let q = UnitQuaternion::from_rotation_matrix(&rotation);
            StationFile {
                label: label.clone(),
                xyz_mm: to_mm(&pose.translation),
                quaternion_xyzw: [q.i, q.j, q.k, q.w],
            }
        });
        let markers = self
            .markers
            .iter()
            .map(|(label, point)| MarkerFile { label: label.clone(), xyz_mm: to_mm(point) });
        let links = robot.links.iter().map(|l| LinkFile { mass_kg: l.mass, com_mm: to_mm(&l.com) });
        let kinds: Vec<_> = robot.joints.iter().map(|j| j.link.kind).collect();
        let (terms, measurement_terms) = model_terms::to_file(&self.terms, &kinds);
        let w = &self.frame_rotation;
        let file = ModelFile {
            schema: SCHEMA,
            name: robot.name.clone(),
            serial: robot.serial.clone(),
            robot_id: self.robot_id.map(|id| format!("{id:#018x}")),
            orientation_identified: self.orientation_identified,
            measurement_sigma_mm: robot.sigma * 1e3,
            gravity_m_s2: robot.gravity.map(Into::into),
            reference_temperature_c: robot.reference_temperature,
            unidentifiable: self.unidentifiable.clone(),
            provenance: self.provenance.clone(),
            frame: FrameFile {
                xyz_mm: to_mm(&self.frame_translation),
                rotation_vector_deg: [w.x, w.y, w.z].map(f64::to_degrees),
            },
            tool: ToolFile { xyz_mm: to_mm(&robot.tool) },
            payload: PayloadFile { com_mm: to_mm(&robot.payload) },
            joints: joints.collect(),
            corrections: corrections.collect(),
            terms,
            measurement_terms,
            stations: stations.collect(),
            markers: markers.collect(),
            links: links.collect(),
        };
        let body = toml::to_string(&file).unwrap_or_else(|e| unreachable!("a plain struct: {e}"));
        // A changed model must not become good by being written again.
        let digest = if self.changed { String::new() } else { digest(&body) };
        format!(
            "# An arm identified by truearm. Lengths mm, angles degrees. `corrections` add to\n\
             # the nominal `joints`; `stations` are the robot base in each tracker frame. The\n\
             # digest says that joints, corrections, terms and frame are those of the RMS errors.\n\
             digest = \"{digest}\"\n{body}{}",
            self.covariance.as_deref().map(covariance::to_toml).unwrap_or_default()
        )
    }

    /// Reads a model.toml.
    ///
    /// # Errors
    /// Names file, line and remedy.
    pub fn read(path: &Path) -> Result<Self> {
        let text = super::read(path)?;
        let help = "give a model.toml as written by `truearm identify`";
        let mut robot = Robot::parse(path, &text)?;
        robot.warnings.clear();
        let part: ModelPart = match parse(path, &text, &mut Vec::new()) {
            Err(Error::File { path, place, message, .. }) => {
                return Err(Error::file(&path, *place, message, help));
            }
            other => other?,
        };
        let fail = |message: String| Error::file(path, Place::default(), message, help);
        if part.schema != SCHEMA {
            return Err(fail(format!("schema {} where {SCHEMA} is read", part.schema)));
        }
        let n = robot.joints.len();
        let numbered = part.corrections.iter().enumerate().all(|(i, c)| c.joint == i + 1);
        if part.corrections.len() != n || !numbered {
            return Err(fail(format!("[[corrections]] do not match the {n} joints in order")));
        }
        let mut model = Self {
            corrections: Vec::new(),
            uncertainties: Vec::new(),
            covered: Vec::new(),
            orientation_identified: part.orientation_identified,
            robot_id: match &part.robot_id {
                Some(text) => {
                    let wrong = || fail(format!("robot_id \"{text}\" is not 0x and 16 hex digits"));
                    let digits = text.strip_prefix("0x").ok_or_else(wrong)?;
                    Some(u64::from_str_radix(digits, 16).map_err(|_| wrong())?)
                }
                None => None,
            },
            changed: part.digest != digest(&text),
            covariance: match &part.covariance {
                Some(file) => Some(file.factor().map_err(fail)?),
                None => None,
            },
            terms: Vec::new(),
            stations: Vec::new(),
            markers: part.markers.into_iter().map(|m| (m.label, mm(m.xyz_mm))).collect(),
            frame_translation: mm(part.frame.xyz_mm),
            frame_rotation: Vector3::from(part.frame.rotation_vector_deg.map(f64::to_radians)),
            provenance: part.provenance,
            unidentifiable: part.unidentifiable,
            robot,
        };
        for c in &part.corrections {
            let all = [c.alpha_deg, c.a_mm, c.theta_offset_deg, c.d_mm, c.beta_deg];
            if all.iter().any(|x| !x.is_finite()) {
                return Err(fail(format!("correction of joint {} is not finite", c.joint)));
            }
            model.corrections.push(from_file(all));
            if let Some(s) = &c.sigma {
                let all = [s.alpha_deg, s.a_mm, s.theta_offset_deg, s.d_mm, s.beta_deg];
                model.uncertainties.push(from_file(all));
            }
            model.covered.push(match (c.covered_deg, c.covered_mm) {
                (Some(range), _) => Some(range.map(f64::to_radians)),
                (None, range) => range.map(|range| range.map(|x| x * 1e-3)),
            });
        }
        if ![0, n].contains(&model.uncertainties.len()) {
            return Err(fail("some corrections have a sigma and some have none".to_owned()));
        }
        for s in part.stations {
            let [x, y, z, w] = s.quaternion_xyzw;
            let q = Quaternion::new(w, x, y, z);
            if (q.norm() - 1.0).abs() > 1e-6 {
                return Err(fail(format!("station \"{}\": not a unit quaternion", s.label)));
            }
            let rotation: Matrix3<f64> =
                UnitQuaternion::new_normalize(q).to_rotation_matrix().into_inner();
            model.stations.push((s.label, Pose { rotation, translation: mm(s.xyz_mm) }));
        }
        let kinds: Vec<_> = model.robot.joints.iter().map(|j| j.link.kind).collect();
        let wrong = |table, number, e| fail(format!("[[{table}]] entry {number}: {e}"));
        for (i, term) in part.terms.iter().enumerate() {
            let term = model_terms::arm_term(term, &kinds);
            model.terms.push(term.map_err(|e| wrong("terms", i + 1, e))?);
        }
        for (i, term) in part.measurement_terms.iter().enumerate() {
            let term = model_terms::measurement_term(term);
            model.terms.push(term.map_err(|e| wrong("measurement_terms", i + 1, e))?);
        }
        if model.markers.is_empty() {
            return Err(fail("a model needs a marker".to_owned()));
        }
        Ok(model)
    }
}
