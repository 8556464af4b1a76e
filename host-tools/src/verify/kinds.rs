//! What each kind of measurement shows of the compensated arm, in its own unit.

use std::borrow::Cow;

use nalgebra::DVector;
use schemars::JsonSchema;
use serde::Serialize;

use crate::error::{Error, ErrorKind, Result};
use crate::identify::{Conditions, Group, Predictor, State, View, groups};
use crate::model::{Commanded, Form, Measurements, Row};
use crate::observations::{KINDS, Measure, Residual, kind};

/// Coverage factor of the expanded uncertainty: about 95 %.
pub const COVERAGE_FACTOR: f64 = 2.0;

/// Errors of one kind, or of its lengths and angles each: measured less what an arm that
/// stands as commanded shows; of all components of a row together.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct KindVerified {
    /// Its name, as in the column `kind`.
    pub kind: &'static str,
    /// `mm`, `deg` or `px`.
    pub unit: &'static str,
    /// Rows of it.
    pub rows: usize,
    /// Mean.
    pub mean: f64,
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub max: f64,
    /// Of the error of one component, k = 2: measurement, frame, and the places of what
    /// the row refers to where they were found with the arm.
    pub expanded_uncertainty: f64,
    /// Components of a row that an error is of.
    pub components: usize,
    /// RMS that the model predicts without compensation; `None` where points were commanded.
    pub predicted_without_compensation_rms: Option<f64>,
}

/// Rows as they can be judged: of a pose whose marker sits in a way that nobody knows the
/// point; and what to remark on that.
///
/// # Errors
/// Rows that refer to what neither the model nor instruments.toml knows, and kinds that
/// hang on joints where points were commanded.
pub fn judgeable(commanded: &Commanded) -> Result<(Cow<'_, Commanded>, Vec<String>)> {
    let mut out = Cow::Borrowed(commanded);
    let mut loose = 0;
    let (data, file) = (&commanded.data, commanded.data.path.display());
    for (i, row) in data.rows.iter().enumerate() {
        let own = kind(row);
        let mut places = row.refers.iter().map(|k| &data.instruments[*k]);
        let unknown = places.find(|place| !place.unknowns().is_empty());
        let of_points = !commanded.points.is_empty();
        if own.point(row).is_some() {
            if !row.refers.is_empty() && (unknown.is_some() || of_points) {
                loose += 1;
                out.to_mut().data.rows[i].make_point();
            }
        } else if of_points {
            return Err(Error::data(
                ErrorKind::Usage,
                format!(
                    "{file}:{}: a row of kind {} beside commanded points",
                    row.line,
                    own.name()
                ),
                "give commanded joints, cmd1_deg..: a point does not say how the arm then stands",
            ));
        } else if let Some(unknown) = unknown {
            let (what, label) = (unknown.form.name(), &unknown.label);
            return Err(Error::data(
                ErrorKind::UnknownMarker,
                format!("{file}:{}: nobody knows where {what} \"{label}\" is", row.line),
                "identify with rows of it, then the model knows, or state its place in \
                 instruments.toml beside this file: fitted to these rows it would hide their errors",
            ));
        }
    }
    let remark = || {
        format!(
            "{file}: of {loose} poses the points are judged and not the turns: how their marker sits \
             is not known; identify from poses, or state [[markers]] in instruments.toml"
        )
    };
    let warnings = if loose > 0 { vec![remark()] } else { Vec::new() };
    Ok((out, warnings))
}

/// A file and what it is judged by.
pub struct Judged<'a> {
    /// The rows.
    pub data: &'a Measurements,
    /// An arm that stands as commanded.
    pub aim: &'a State,
    /// What terms depend on, row by row.
    pub conditions: &'a Conditions,
    /// Variance of the frame along a direction, m^2.
    pub frame: f64,
}

impl Judged<'_> {
    /// Of every kind, from what was measured beyond what was commanded, and from what the
    /// model predicts of it without compensation.
    #[must_use]
    pub fn kinds(&self, left: &[Residual], before: Option<&[Residual]>) -> Vec<KindVerified> {
        let of = |group: Group| {
            let sizes = self.sizes(group, left);
            let count = sizes.len().max(1) as f64;
            let components = |row: &Row| group.components(row).count();
            KindVerified {
                kind: KINDS[usize::from(group.kind.0)].name(),
                unit: group.measure.unit(),
                rows: sizes.len(),
                mean: sizes.iter().sum::<f64>() / count,
                rms: rms(&sizes),
                max: sizes.iter().copied().fold(0.0, f64::max),
                expanded_uncertainty: group.measure.to_file(self.uncertainty(group)),
                components: self.data.rows.iter().map(components).max().unwrap_or(0),
                predicted_without_compensation_rms: before.map(|all| rms(&self.sizes(group, all))),
            }
        };
        groups(self.data).into_iter().map(of).collect()
    }

    /// Of the points of the file, k = 2, m.
    #[must_use]
    pub fn of_points(&self) -> f64 {
        let pointed = |group: &Group| {
            let row = self.data.rows.iter().find(|row| row.kind == group.kind);
            group.measure == Measure::Length && row.is_some_and(|r| kind(r).point(r).is_some())
        };
        let all = groups(self.data).into_iter().filter(pointed);
        all.map(|group| self.uncertainty(group)).fold(0.0, f64::max)
    }

    /// How far off each row is, in the unit of files.
    fn sizes(&self, group: Group, left: &[Residual]) -> Vec<f64> {
        let size = |(row, left): (&Row, &Residual)| {
            let own: Vec<f64> = group.components(row).map(|c| left[c]).collect();
            let square: f64 = own.iter().map(|v| v * v).sum();
            (!own.is_empty()).then(|| group.measure.to_file(square.sqrt()))
        };
        self.data.rows.iter().zip(left).filter_map(size).collect()
    }

    /// Of the error of one component, k = 2, SI; over all rows of the group.
    fn uncertainty(&self, group: Group) -> f64 {
        let predictor = Predictor::new(self.aim);
        let view = View { model: &predictor, data: self.data, conditions: self.conditions };
        let (mut sum, mut count) = (0.0, 0);
        for (index, row) in self.data.rows.iter().enumerate() {
            let sigmas = kind(row).sigmas(row);
            for c in group.components(row) {
                sum += sigmas[c].powi(2) + self.of_places(index, c, &view);
                count += 1;
            }
        }
        COVERAGE_FACTOR * (sum / f64::from(count.max(1))).sqrt()
    }

    /// Variance of a component by where stations and instruments stand, SI. A frame turns
    /// by what it is shifted by at 1 m.
    fn of_places(&self, index: usize, component: usize, view: &View) -> f64 {
        let row = &self.data.rows[index];
        if kind(row).point(row).is_some() && row.refers.is_empty() {
            return self.frame;
        }
        let partials = kind(row).partials(index, view);
        let mut with_frame: DVector<f64> = DVector::zeros(6);
        for part in &partials.arm {
            part.pull.row(component).iter().enumerate().for_each(|(k, pull)| with_frame[k] += pull);
        }
        // How a marker sits on the arm is what is commanded, as its point is.
        let places = partials.instruments.iter().map(|(instrument, pull)| {
            match &self.data.instruments[*instrument] {
                marker if marker.form == Form::Turn => 0.0,
                place => place.variance(&pull.row(component).transpose()),
            }
        });
        self.frame * with_frame.norm_squared() + places.sum::<f64>()
    }
}

fn rms(sizes: &[f64]) -> f64 {
    (sizes.iter().map(|x| x * x).sum::<f64>() / sizes.len().max(1) as f64).sqrt()
}
