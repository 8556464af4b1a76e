//! Where things are before anything is fitted: what rows are measured against, and where the
//! target is of each. For what may err with a place, which need not be exact.

use nalgebra::Vector3;

use super::conditions::Conditions;
use super::predictor::{Model, View};
use super::unknowns::State;
use crate::model::{Form, Instrument, Measurements};
use crate::observations::{Seen, kind};

/// Cosine from which on an axis is the normal of a plane rather than one on it.
const UPRIGHT: f64 = 0.8;

/// Where rows are measured that touch surfaces or are lengths to anchors; nothing of others.
#[derive(Debug, Clone, Default)]
pub struct Cell {
    instruments: Vec<Instrument>,
    /// The z axis of each in the frame of the arm's base.
    axes: Vec<Vector3<f64>>,
    /// Of every row, m: the target in the frame of the arm's base.
    places: Vec<Vector3<f64>>,
}

impl Cell {
    /// By a registered arm.
    #[must_use]
    pub fn about(data: &Measurements, conditions: &Conditions, start: &State) -> Self {
        let instruments = &start.instruments;
        if !instruments.iter().any(|i| is_surface(i.form) || i.form == Form::Anchor) {
            return Self::default();
        }
        let model = Model::new(start);
        let view = View { model: &model, data, conditions };
        let place = |row: usize| {
            let base = &start.bases[data.rows[row].station];
            base.inverse().transform_point(&view.point(row))
        };
        let places = (0..data.rows.len()).map(place).collect();
        let axis = |(k, own): (usize, &Instrument)| {
            let row = data.rows.iter().find(|row| row.refers.contains(&k));
            let base = &start.bases[row.map_or(0, |row| row.station)];
            base.rotation.tr_mul(&own.place.rotation.column(2))
        };
        let axes = instruments.iter().enumerate().map(axis).collect();
        Self { instruments: instruments.clone(), axes, places }
    }

    /// Whether a place along an axis of the arm's base, counted from 0, is one on a surface: of a
    /// plane along its normal all places are one.
    #[must_use]
    pub fn lies_on(&self, surface: usize, axis: usize) -> bool {
        let plane = self.instruments.get(surface).is_some_and(|own| own.form == Form::Plane);
        !plane || self.axes[surface][axis].abs() < UPRIGHT
    }

    /// Where the target of a row is in the frame of the arm's base, m.
    #[must_use]
    pub fn place(&self, row: usize) -> Option<&Vector3<f64>> {
        self.places.get(row)
    }

    /// The instruments.
    #[must_use]
    pub fn instruments(&self) -> &[Instrument] {
        &self.instruments
    }

    /// Where a target at a point of the station's frame gets farther from what touches it, or
    /// from what measures its distance.
    #[must_use]
    pub fn away(&self, instrument: usize, point: &Vector3<f64>) -> Vector3<f64> {
        let Some(own) = self.instruments.get(instrument) else { return Vector3::zeros() };
        let axis: Vector3<f64> = own.place.rotation.column(2).into();
        let from = point - own.place.translation;
        let away = match own.form {
            Form::Plane => axis,
            Form::Cylinder => from - axis * axis.dot(&from),
            _ => from,
        };
        away.try_normalize(0.0).unwrap_or_default()
    }

    /// The surface that a row touches.
    #[must_use]
    pub fn surface(&self, data: &Measurements, row: usize) -> Option<usize> {
        self.of_row(data, row, |i| is_surface(i.form))
    }

    /// The anchor that a row is the distance from.
    #[must_use]
    pub fn anchor(&self, data: &Measurements, row: usize) -> Option<usize> {
        kind(&data.rows[row]).distance(&data.rows[row])?;
        self.of_row(data, row, |i| i.form == Form::Anchor)
    }

    fn of_row(
        &self,
        data: &Measurements,
        row: usize,
        own: impl Fn(&Instrument) -> bool,
    ) -> Option<usize> {
        let first = *data.rows[row].refers.first()?;
        self.instruments.get(first).is_some_and(own).then_some(first)
    }
}

fn is_surface(form: Form) -> bool {
    matches!(form, Form::Plane | Form::Sphere | Form::Cylinder)
}
