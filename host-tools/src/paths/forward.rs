use nalgebra::{Matrix3, Vector3};
use truearm::effects::Term;
use truearm::{JointKind, Pose};

use crate::blob::arm_terms;
use crate::error::{Error, ErrorKind, Label, Result};
use crate::identify::{Conditions, Predictor, State, Surroundings};
use crate::model::arm::{Kinematics, chain};
use crate::model::{Measurements, Model, ModelTerm, Placement, Robot, Row};

/// What is looked at, and from where. Without either: `[tool]` in `[base]`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct View {
    /// In the frame of this tracker station of the identification, with what the
    /// model says of the measurement itself: the points are those that the tracker
    /// measures.
    pub station: Option<String>,
    /// This target of the identification in place of `[tool]`'s point. A station
    /// sees the only one of the model if none is named.
    pub marker: Option<String>,
}

/// Where an arm has its tool.
pub struct Forward {
    arm: Box<dyn Kinematics>,
    /// How the tool is turned in the last frame.
    turn: Pose<f64>,
    terms: Vec<Term<f64>>,
    kinds: Vec<JointKind>,
    surroundings: Surroundings,
    /// A state with terms of the measurement, seen from a station.
    measured: Option<State>,
}

impl Forward {
    /// The real arm: identified links, all terms.
    ///
    /// # Errors
    /// A station or marker that the model does not know.
    pub fn real(model: &Model, view: &View) -> Result<Self> {
        let (station, tool) = seen(model, view)?;
        let small = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
        let base = station.unwrap_or_else(|| model.robot.base.pose().compose(&small));
        let of_measurement = model.terms.iter().any(|t| !matches!(t, ModelTerm::Arm(_)));
        let measured = (station.is_some() && of_measurement).then(|| State {
            bases: vec![base],
            markers: vec![tool],
            instruments: Vec::new(),
            links: model.links(),
            terms: model.terms.clone(),
        });
        let arm = chain(&model.links(), base, tool);
        let surroundings = Surroundings::of_model(model);
        let terms = arm_terms(model).collect();
        Ok(Self { measured, terms, surroundings, ..Self::new(&model.robot, arm) })
    }

    /// The arm that the controller believes in.
    ///
    /// # Errors
    /// A station or marker that the model does not know.
    pub fn nominal(model: &Model, view: &View) -> Result<Self> {
        let (station, tool) = seen(model, view)?;
        let small = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
        let base = station.map_or(model.robot.base.pose(), |s| s.compose(&small.inverse()));
        Ok(Self::new(&model.robot, chain(&model.robot.nominal(), base, tool)))
    }

    /// An arm as its robot file has it, `[tool]` in `[base]`.
    #[must_use]
    pub fn of_robot(robot: &Robot) -> Self {
        Self::new(robot, chain(&robot.nominal(), robot.base.pose(), robot.tool))
    }

    /// The same in the state that a path tells: with the torques that were read along it.
    ///
    /// # Errors
    /// Springs that follow torques that are read, on a path that has none, or temperatures
    /// without times where the arm follows them late.
    pub fn along(self, data: &Measurements, model: &Model) -> Result<Self> {
        model.loaded(data)?;
        model.timed(data)?;
        let surroundings = self.surroundings.reading(data, &model.robot);
        Ok(Self { surroundings, ..self })
    }

    /// What was read of the torques of a row, as those of gravity.
    pub(super) fn torques(&self, row: &Row) -> Option<Vec<f64>> {
        self.surroundings.torques(row)
    }

    fn new(robot: &Robot, arm: Box<dyn Kinematics>) -> Self {
        let placement = Placement { xyz: Vector3::zeros(), rpy: robot.tool_rpy };
        Self {
            arm,
            turn: placement.pose(),
            terms: Vec::new(),
            kinds: robot.joints.iter().map(|j| j.link.kind).collect(),
            surroundings: Surroundings::new(robot),
            measured: None,
        }
    }

    /// Pose of the tool at joint values `q` (rad or m) in the state that a row
    /// tells.
    #[must_use]
    pub fn pose(&self, row: &Row, q: &[f64]) -> Pose<f64> {
        let last = if self.terms.is_empty() && !self.surroundings.has_curves() {
            self.arm.pose(q)
        } else {
            self.arm.bent(q, &self.terms, &self.surroundings.inputs(row, q))
        };
        last.compose(&self.turn)
    }

    /// How the tool moves with each joint: its point (m per rad or m) and its turn
    /// (rad per rad or m). That of the arm without its terms: good enough to solve by.
    #[must_use]
    pub fn jacobian(&self, q: &[f64]) -> Vec<[Vector3<f64>; 2]> {
        self.arm.jacobian(q)
    }

    /// Whether each joint turns or slides.
    #[must_use]
    pub fn kinds(&self) -> &[JointKind] {
        &self.kinds
    }

    /// Poses of all rows of a file with joints. A tracker's points are as
    /// `evaluate` predicts them, drift and re-seated targets included.
    #[must_use]
    pub fn all(&self, data: &Measurements) -> Vec<Pose<f64>> {
        let mut poses: Vec<_> = data.rows.iter().map(|row| self.pose(row, &row.q)).collect();
        if let Some(state) = &self.measured {
            let (conditions, predictor) = (
                Conditions { rows: self.inputs(data), ..Conditions::default() },
                Predictor::new(state),
            );
            for (i, (pose, row)) in poses.iter_mut().zip(&data.rows).enumerate() {
                let row = Row { station: 0, marker: 0, ..row.clone() };
                pose.translation = predictor.point(&row, &conditions.rows[i]);
            }
        }
        poses
    }

    fn inputs(&self, data: &Measurements) -> Vec<crate::model::arm::RowInputs> {
        data.rows.iter().map(|row| self.surroundings.inputs(row, &row.q)).collect()
    }
}

/// How far a tool is from where it is to be: the way of its point, m, and the
/// turn, rad, as vectors in the frame that both are in.
#[must_use]
pub(super) fn off(to: &Pose<f64>, from: &Pose<f64>) -> [Vector3<f64>; 2] {
    [to.translation - from.translation, turn(&to.rotation, &from.rotation)]
}

/// The rotation vector that turns one frame into the other.
pub(super) fn turn(to: &Matrix3<f64>, from: &Matrix3<f64>) -> Vector3<f64> {
    let rotation = to * from.transpose();
    Pose { rotation, translation: Vector3::zeros() }.rotation_vector()
}

/// The base in the frame of a station, if one is named, and the target.
fn seen(model: &Model, view: &View) -> Result<(Option<Pose<f64>>, Vector3<f64>)> {
    let station = view.station.as_ref().map(|s| find(model, Label::Station, s, &model.stations));
    let station = station.transpose()?.copied();
    let tool = match (&view.marker, station, &model.markers[..]) {
        (Some(label), _, markers) => *find(model, Label::Marker, label, markers)?,
        (None, Some(_), [(_, only)]) => *only,
        (None, Some(_), markers) => {
            return Err(Error::data(
                ErrorKind::UnknownMarker,
                format!("{}: the station saw {}", model.robot.path.display(), names(markers)),
                "say which of them with --marker",
            ));
        }
        (None, None, _) => model.robot.tool,
    };
    Ok((station, tool))
}

fn find<'a, T>(model: &Model, of: Label, label: &str, known: &'a [(String, T)]) -> Result<&'a T> {
    known.iter().find(|(l, _)| l == label).map(|(_, found)| found).ok_or_else(|| {
        let (file, what) = (model.robot.path.display(), of.name());
        Error::data(
            of.unknown(),
            format!(
                "{file}: {what} \"{label}\" is unknown to the model, which knows {}",
                names(known)
            ),
            format!("give the {what} of the identification, or leave --{what} away"),
        )
    })
}

fn names<T>(known: &[(String, T)]) -> String {
    match known {
        [] => "none".to_owned(),
        _ => known.iter().map(|(l, _)| format!("\"{l}\"")).collect::<Vec<_>>().join(", "),
    }
}
