use nalgebra::{DMatrix, Rotation3, UnitQuaternion};
use truearm::{JointKind, Pose};

use super::finite::unlike_a_number;
use super::keys::*;
use super::{SCHEMA, frame_to_file, to_file};
use crate::error::{Error, Result};
use crate::files::digest::digest;
use crate::files::{covariance, model_curves, model_terms, prior_tables};
use crate::model::{GramState, Instrument, Joint, Model, Placement, Robot};
use crate::units::{End, joint_to_file_at, point_to_mm, to_mm};

/// What stands above the keys.
const HEAD: &str = "\
# An arm identified by truearm. Lengths mm, angles degrees. `corrections` add to
# the nominal `joints`; `stations` are the robot base in each tracker frame. The
# digest says that joints, corrections, terms, curves and frame are those of the RMS errors.
";

impl Model {
    /// The text of a model.toml.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let file = self.to_file();
        let body = toml::to_string(&file).unwrap_or_else(|e| unreachable!("a plain struct: {e}"));
        // A changed model must not become good by being written again.
        let digest = if self.changed { String::new() } else { digest(&body) };
        let covariance = self.covariance.as_deref().map(covariance::to_toml).unwrap_or_default();
        format!("{HEAD}digest = \"{digest}\"\n{body}{covariance}")
    }

    /// The same of a model that is to be kept: every number in it is one.
    ///
    /// # Errors
    /// The key of a number that is infinite or none.
    pub fn to_sound_toml(&self) -> Result<String> {
        let text = self.to_toml();
        let table = text.parse().unwrap_or_else(|e| unreachable!("TOML that was written: {e}"));
        match unlike_a_number(&table) {
            None => Ok(text),
            Some((key, value)) => Err(Error::not_finite(&format!("{key} of the model"), value)),
        }
    }

    fn to_file(&self) -> ModelFile {
        let robot = &self.robot;
        let base = robot.base.pose();
        let kinds: Vec<_> = robot.joints.iter().map(|j| j.link.kind).collect();
        let (terms, measurement_terms) = model_terms::to_file(&self.terms, &kinds);
        let links = robot.links.iter();
        let markers = self.markers.iter();
        ModelFile {
            schema: SCHEMA,
            name: robot.name.clone(),
            serial: robot.serial.clone(),
            robot_id: self.robot_id.map(|id| format!("{id:#018x}")),
            orientation_identified: self.orientation_identified,
            measurement_sigma_mm: to_mm(robot.sigma),
            measurement_sigma_deg: robot.sigma_angle.map(f64::to_degrees),
            gravity_m_s2: robot.gravity.map(|g| (base.rotation * g).into()),
            reference_temperature_c: robot.reference_temperature,
            unidentifiable: self.unidentifiable.clone(),
            provenance: self.provenance.clone(),
            gram: self.gram.as_ref().map(gram),
            frame: frame_to_file(&self.frame_translation, &self.frame_rotation, &base),
            base: (robot.base != Placement::default()).then(|| placement(&robot.base)),
            tool: tool(robot),
            payload: PayloadFile { com_mm: point_to_mm(&robot.payload) },
            joints: robot.joints.iter().map(joint).collect(),
            corrections: (0..robot.joints.len()).map(|i| self.correction(i)).collect(),
            terms,
            measurement_terms,
            curves: model_curves::to_file(&self.curves),
            stations: self.stations.iter().map(|s| station(s, &base)).collect(),
            markers: markers
                .map(|(label, point)| MarkerFile {
                    measured: !self.not_measured.contains(label),
                    label: label.clone(),
                    xyz_mm: point_to_mm(point),
                })
                .collect(),
            instruments: self.instruments.iter().map(instrument).collect(),
            links: links
                .map(|l| LinkFile { mass_kg: l.mass, com_mm: point_to_mm(&l.com) })
                .collect(),
        }
    }

    fn correction(&self, i: usize) -> CorrectionFile {
        let [alpha_deg, a_mm, theta_offset_deg, d_mm, beta_deg] = to_file(&self.corrections[i]);
        let sigma = self.uncertainties.get(i).map(|sigma| {
            let [alpha_deg, a_mm, theta_offset_deg, d_mm, beta_deg] = to_file(sigma);
            SigmaFile { alpha_deg, a_mm, theta_offset_deg, d_mm, beta_deg }
        });
        let [covered_deg, covered_mm] = range(self.robot.joints[i].link.kind, self.covered[i]);
        CorrectionFile {
            joint: i + 1,
            alpha_deg,
            a_mm,
            theta_offset_deg,
            d_mm,
            beta_deg,
            sigma,
            covered_deg,
            covered_mm,
        }
    }
}

/// A range of joint values, as degrees or as mm; what is read again holds all of it.
fn range(kind: JointKind, range: Option<[f64; 2]>) -> [Option<[f64; 2]>; 2] {
    let range = range.map(|[low, high]| {
        [joint_to_file_at(kind, low, End::Down), joint_to_file_at(kind, high, End::Up)]
    });
    let revolute = kind == JointKind::Revolute;
    [range.filter(|_| revolute), range.filter(|_| !revolute)]
}

fn joint(joint: &Joint) -> JointFile {
    let [alpha_deg, a_mm, theta_offset_deg, d, beta_deg] = to_file(&joint.link.parameters);
    let revolute = joint.link.kind == JointKind::Revolute;
    let [limits_deg, limits_mm] = range(joint.link.kind, joint.limits);
    let [(_, tolerance), (_, expected)] = prior_tables(joint);
    JointFile {
        kind: if revolute { "revolute" } else { "prismatic" },
        alpha_deg,
        a_mm,
        d_mm: revolute.then_some(d),
        d_offset_mm: (!revolute).then_some(d),
        theta_offset_deg,
        beta_deg,
        limits_deg,
        limits_mm,
        gear_ratio: joint.gear_ratio,
        tolerance: tolerance.into_iter().collect(),
        expected: expected.into_iter().collect(),
    }
}

fn gram(state: &GramState) -> GramFile {
    GramFile {
        stage: state.stage,
        settled: state.settled,
        step_tolerances: state.step,
        k: state.k,
        weights: state.weights,
        flagged: state.flagged,
        targets_mm: state.targets.iter().map(point_to_mm).collect(),
    }
}

fn placement(placement: &Placement) -> PlacementFile {
    let Placement { xyz, rpy } = placement;
    let turned = *rpy != nalgebra::Vector3::zeros();
    PlacementFile {
        xyz_mm: point_to_mm(xyz),
        rpy_deg: turned.then(|| [rpy.x, rpy.y, rpy.z].map(f64::to_degrees)),
    }
}

fn tool(robot: &Robot) -> PlacementFile {
    placement(&Placement { xyz: robot.tool, rpy: robot.tool_rpy })
}

fn station((label, pose): &(String, Pose<f64>), base: &Pose<f64>) -> StationFile {
    let pose = if *base == Pose::identity() { *pose } else { pose.compose(&base.inverse()) };
    StationFile {
        label: label.clone(),
        xyz_mm: point_to_mm(&pose.translation),
        quaternion_xyzw: quaternion(&pose),
    }
}

fn quaternion(pose: &Pose<f64>) -> [f64; 4] {
    let rotation = Rotation3::from_matrix_unchecked(pose.rotation);
    let q = UnitQuaternion::from_rotation_matrix(&rotation);
    [q.i, q.j, q.k, q.w]
}

fn instrument(instrument: &Instrument) -> InstrumentFile {
    let lengths = instrument.form.has_lengths();
    let number = |value: &f64| if lengths { to_mm(*value) } else { *value };
    InstrumentFile {
        form: instrument.form.name().to_owned(),
        label: instrument.label.clone(),
        on_flange: instrument.on_flange,
        xyz_mm: point_to_mm(&instrument.place.translation),
        quaternion_xyzw: quaternion(&instrument.place),
        numbers: instrument.numbers.iter().map(number).collect(),
        covariance: triangle(&instrument.spread),
    }
}

/// Columns of a lower triangle.
fn triangle(factor: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let column = |j: usize| (j..factor.nrows()).map(|i| factor[(i, j)]).collect();
    (0..factor.ncols()).map(column).collect()
}
