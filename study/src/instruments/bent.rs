//! What a bent arm shows every instrument.

use nalgebra::{Matrix3, Vector3};
use truearm::Pose;
use truearm_host::identify::{State, View};
use truearm_host::model::{Instrument, Row};
use truearm_host::observations::Seen;
use truearm_simulate::arm::Arm;
use truearm_simulate::at_rest;
use truearm_simulate::oracle::Matrix;

/// A view of the rows in which the arm is moved as one that is bent is from a rigid one.
pub struct Bent<'a> {
    pub view: &'a View<'a>,
    pub state: &'a State,
    pub arm: &'a Arm,
    pub bent: &'a Arm,
}

impl Seen for Bent<'_> {
    fn row(&self, index: usize) -> &Row {
        self.view.row(index)
    }

    fn point(&self, index: usize) -> Vector3<f64> {
        self.pose(index).translation
    }

    fn pose(&self, index: usize) -> Pose<f64> {
        let moment = at_rest(&self.row(index).q);
        let [from, to] = [self.arm, self.bent].map(|arm| pose(&arm.last_frame(&moment)));
        let base = &self.state.bases[self.row(index).station];
        let moved = base.compose(&to).compose(&base.compose(&from).inverse());
        moved.compose(&self.view.pose(index))
    }

    fn marker(&self, index: usize) -> Vector3<f64> {
        self.view.marker(index)
    }

    fn instrument(&self, index: usize) -> &Instrument {
        self.view.instrument(index)
    }
}

fn pose(matrix: &Matrix<f64>) -> Pose<f64> {
    let rotation = Matrix3::from_fn(|i, j| matrix[i][j]);
    Pose { rotation, translation: Vector3::from_fn(|i, _| matrix[i][3]) }
}
