use nalgebra::{Matrix3, Vector3};
use truearm::JointKind;
use truearm::effects::Term;

use crate::error::Result;
use crate::evaluate::{Reregister, state_on};
use crate::identify::{Conditions, Predictor, RowResult, State, View};
use crate::model::arm::Derivatives;
use crate::model::{Measurements, Model, Row};
use crate::observations::{Body, Measure, kind};
use crate::statistics::median;

/// What was measured, and what a model makes of it.
#[derive(Clone, Copy)]
pub struct Measured<'a> {
    /// The rows.
    pub data: &'a Measurements,
    /// What became of each.
    pub rows: &'a [RowResult],
    /// The identified arm.
    pub model: &'a Model,
}

/// Rows that measured where their target is, or a length that tells of it, and were not
/// left out, with how the target moves.
pub struct Seen<'a> {
    /// What was measured.
    pub on: Measured<'a>,
    /// What terms depend on, row by row.
    pub conditions: Conditions,
    /// The model in the frames of the file.
    pub state: State,
    /// Places of the rows in the file.
    pub kept: Vec<usize>,
    /// How the target of each kept row moves.
    pub moves: Vec<Derivatives>,
    /// What of a motion each of them measures: all of it, or its part along a direction.
    measures: Vec<Matrix3<f64>>,
}

/// Rows that pictures are made of, evenly spread where there are more: a bin of a
/// curve then still holds hundreds, and each row takes a kilobyte.
const MOST: usize = 10_000;

/// Rows whose target moves by less than this share of the median tell nothing.
const LEVER: f64 = 0.4;

impl<'a> Seen<'a> {
    /// Those that were not flagged.
    ///
    /// # Errors
    /// A model of other stations or markers than those of the rows.
    pub fn new(on: Measured<'a>) -> Result<Self> {
        let state = state_on(on.model, on.data, Reregister::Nothing)?;
        let conditions = Conditions::of_model(on.data, on.model);
        let predictor = Predictor::new(&state);
        let rows = &on.data.rows;
        let tells = |i: &usize| !on.rows[*i].flagged && is_of_target(&rows[*i]);
        let mut kept: Vec<usize> = (0..rows.len()).filter(tells).collect();
        let step = kept.len().div_ceil(MOST).max(1);
        kept = kept.into_iter().step_by(step).collect();
        let moves = kept.iter().map(|i| predictor.derivatives(&rows[*i], &conditions.rows[*i]));
        let moves = moves.collect();
        let view = View { model: &predictor, data: on.data, conditions: &conditions };
        let measures = kept.iter().map(|i| measured(*i, &view)).collect();
        Ok(Self { on, conditions, state, kept, moves, measures })
    }

    /// What the model leaves of a kept row, m: of a point in the tracker's frame, else
    /// what is measured.
    pub fn left(&self, k: usize) -> Vector3<f64> {
        let left = &self.on.rows[self.kept[k]].identified;
        Vector3::from_fn(|c, _| left.get(c).copied().unwrap_or(0.0))
    }

    /// What a kept row measures of a motion of its target, m, in the same directions.
    pub fn measured(&self, k: usize, motion: &Vector3<f64>) -> Vector3<f64> {
        self.measures[k] * motion
    }

    /// How the target of a kept row moves with what a term deflects.
    pub fn action(&self, term: &Term<f64>, d: &Derivatives, k: usize) -> Vector3<f64> {
        let row = self.kept[k];
        let inputs = &self.conditions.rows[row];
        d.action(term, inputs, &self.on.data.rows[row].q, &self.state.links)
    }

    /// What each kept row measures of a motion of a joint, m per rad or m.
    pub fn along_joint(&self, joint: usize, kind: JointKind) -> Vec<Vector3<f64>> {
        let motions = self.moves.iter().map(|d| d.links[joint].joint(kind));
        motions.enumerate().map(|(k, motion)| self.measured(k, motion)).collect()
    }

    /// Which kept rows tell of an action: how far their targets move with it
    /// is not far below the median.
    pub fn telling(&self, action: &[Vector3<f64>]) -> Vec<usize> {
        let size = median(&action.iter().map(Vector3::norm).collect::<Vec<_>>());
        let tells = |k: &usize| action[*k].norm() > LEVER * size && size > 0.0;
        (0..action.len()).filter(tells).collect()
    }
}

/// Whether a row's lengths say where its own target is, and nothing else.
fn is_of_target(row: &Row) -> bool {
    let own = kind(row);
    let lengths = (0..own.components().len()).all(|c| own.measure(c) == Measure::Length);
    own.point(row).is_some() || (lengths && !own.turns() && own.joined_by().is_none())
}

/// How what a row measures moves with its target.
fn measured(index: usize, view: &View) -> Matrix3<f64> {
    let row = &view.data.rows[index];
    if kind(row).point(row).is_some() {
        return Matrix3::identity();
    }
    let parts = kind(row).partials(index, view).arm;
    let own = parts.iter().find(|part| part.row == index && part.body == Body::Target);
    let pull = own.map(|part| &part.pull);
    Matrix3::from_fn(|i, j| pull.and_then(|pull| pull.get((i, j))).copied().unwrap_or(0.0))
}

impl Measured<'_> {
    /// Measured points in the robot's frame with the error before and after, m;
    /// flagged rows are left out.
    #[must_use]
    pub fn in_robot_frame(&self) -> Vec<Arrow> {
        let of = |(i, row): (usize, &crate::model::Row)| {
            let result = &self.rows[i];
            let point = kind(row).point(row)?;
            let label = &self.data.stations[row.station];
            let (_, base) = self.model.stations.iter().find(|(l, _)| l == label)?;
            let frame = self.model.robot.base.pose().compose(&base.inverse());
            let turned = |v: Vector3<f64>| frame.rotation * v;
            (!result.flagged).then(|| Arrow {
                row: i + 1,
                point: frame.transform_point(&point),
                before: Some(turned(result.nominal.point())),
                after: Some(turned(result.identified.point())),
            })
        };
        self.data.rows.iter().enumerate().filter_map(of).collect()
    }
}

/// A point of the workspace with its error, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrow {
    /// Row or pose, counted from 1.
    pub row: usize,
    /// Where.
    pub point: Vector3<f64>,
    /// Error before.
    pub before: Option<Vector3<f64>>,
    /// Error after.
    pub after: Option<Vector3<f64>>,
}
