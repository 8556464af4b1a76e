use nalgebra::Vector3;
use truearm::effects::Term;

use crate::error::Result;
use crate::evaluate::{Reregister, state_on};
use crate::identify::{Conditions, Predictor, RowResult, State};
use crate::model::arm::Derivatives;
use crate::model::{Measurements, Model};
use crate::observations::kind;
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

/// Rows that measured a point and were not left out, with how the point moves.
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
        let point = |i: &usize| kind(&rows[*i]).point(&rows[*i]).is_some();
        let mut kept: Vec<usize> =
            (0..rows.len()).filter(|i| !on.rows[*i].flagged).filter(point).collect();
        let step = kept.len().div_ceil(MOST).max(1);
        kept = kept.into_iter().step_by(step).collect();
        let moves = kept.iter().map(|i| predictor.derivatives(&rows[*i], *i, &conditions).0);
        let moves = moves.collect();
        Ok(Self { on, conditions, state, kept, moves })
    }

    /// What the model leaves of a kept row, m, in the tracker's frame.
    pub fn left(&self, k: usize) -> Vector3<f64> {
        self.on.rows[self.kept[k]].identified.point()
    }

    /// How the target of a kept row moves with what a term deflects.
    pub fn action(&self, term: &Term<f64>, d: &Derivatives, k: usize) -> Vector3<f64> {
        let row = self.kept[k];
        let inputs = &self.conditions.rows[row];
        d.action(term, inputs, &self.on.data.rows[row].q, &self.state.links)
    }

    /// Which kept rows tell of an action: how far their targets move with it
    /// is not far below the median.
    pub fn telling(&self, action: &[Vector3<f64>]) -> Vec<usize> {
        let size = median(&action.iter().map(Vector3::norm).collect::<Vec<_>>());
        let tells = |k: &usize| action[*k].norm() > LEVER * size && size > 0.0;
        (0..action.len()).filter(tells).collect()
    }
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
