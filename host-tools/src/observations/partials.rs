//! How what a row measures moves with what it depends on.

use nalgebra::{DMatrix, Vector3};

use crate::model::{Instrument, Values};

/// What of the arm something hangs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Body {
    /// The marker of the row.
    Target,
    /// The origin of the last frame.
    Flange,
}

/// How it moves with a body of the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmPart {
    /// The row that the arm stands at.
    pub row: usize,
    /// Which body.
    pub body: Body,
    /// With its place in the station's frame, m, and, where there are six
    /// columns, with a turn about the axes of that frame, rad.
    pub pull: DMatrix<f64>,
}

/// A residual and the derivatives of what is modelled, a row a component.
#[derive(Debug, Clone, PartialEq)]
pub struct Partials {
    /// Measured minus modelled, SI.
    pub residual: Values,
    /// With the arm.
    pub arm: Vec<ArmPart>,
    /// With the six freedoms of the places of instruments and with their numbers.
    pub instruments: Vec<(usize, DMatrix<f64>)>,
}

/// A matrix as one of any size.
pub(super) fn any(m: &nalgebra::Matrix3<f64>) -> DMatrix<f64> {
    DMatrix::from_column_slice(3, 3, m.as_slice())
}

/// Of something that a target's place in the frame of an instrument says, and
/// numbers of that instrument.
pub(super) struct InFrame<'a> {
    /// The row.
    pub row: usize,
    /// Where the target is in the station's frame, m.
    pub target: Vector3<f64>,
    /// The instrument and its place in the list.
    pub instrument: (usize, &'a Instrument),
}

impl InFrame<'_> {
    /// The target in the instrument's frame, m.
    pub fn local(&self) -> Vector3<f64> {
        self.instrument.1.local(&self.target).0
    }

    /// Derivatives of what is modelled, from those with the place in the frame
    /// (a row a component, 3 columns) and with the numbers.
    pub fn partials(
        &self,
        residual: Values,
        with_place: &DMatrix<f64>,
        with_numbers: &[f64],
    ) -> Partials {
        let (index, instrument) = self.instrument;
        let (_, with_target, with_frame) = instrument.local(&self.target);
        let mut own = DMatrix::zeros(with_place.nrows(), instrument.free.len());
        own.columns_mut(0, 6).copy_from(&(with_place * with_frame));
        for (k, value) in with_numbers.iter().enumerate() {
            own.column_mut(6 + k).fill(*value);
        }
        let pull = with_place * with_target;
        Partials {
            residual,
            arm: vec![ArmPart { row: self.row, body: Body::Target, pull }],
            instruments: vec![(index, own)],
        }
    }
}
