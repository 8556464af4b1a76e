//! What a row of a file measured: one interface, one file a kind.
//!
//! A kind gives, for one row, residuals and how what it measures moves with the
//! unknowns, their standard deviations, the names of its components and the
//! columns of the file that it reads. Nothing else knows how many equations a
//! row has. A new kind is a file here and a row of [`KINDS`].

mod closure;
mod column;
mod distance;
mod inclination;
mod pair;
mod partials;
pub mod pixel;
mod plate;
mod point;
mod pose;
mod range;
mod reading;
mod references;
mod residual;
#[cfg(test)]
pub(crate) mod tests;
mod touch;

use std::borrow::Cow;

use nalgebra::{DMatrix, Matrix3, Vector3};
use truearm::Pose;

use crate::model::{Form, Instrument, KindId, Measurements, Row, Values};
pub use column::{Column, Measure};
pub use partials::{ArmPart, Body, Partials};
pub use range::ray_of;
pub use reading::{by_pose, by_target, postures, repeat, visits};
pub use references::{Bound, Registry, Told, Unclear};
pub use residual::{Miss, Residual};

/// All kinds. A row's [`KindId`] is the place of its kind here.
pub static KINDS: &[&dyn Kind] = &[
    &point::Point,
    &pose::FullPose,
    &distance::Distance,
    &pair::Pair,
    &plate::Plate,
    &touch::Touch,
    &range::Range,
    &inclination::Inclination,
    &closure::Closure,
    &pixel::Pixel,
];

/// Where a model sees the targets of a file's rows.
pub trait Seen {
    /// A row of the file.
    fn row(&self, index: usize) -> &Row;
    /// Where its target is in the tracker frame, m.
    fn point(&self, index: usize) -> Vector3<f64>;
    /// The same, turned as the last frame is.
    fn pose(&self, index: usize) -> Pose<f64>;
    /// The target of a row in the last frame, m.
    fn marker(&self, index: usize) -> Vector3<f64>;
    /// What rows refer to, by its place in the list.
    fn instrument(&self, index: usize) -> &Instrument;
}

/// The same with derivatives.
pub trait Moving: Seen {
    /// Where the target of a row is, m, and how it moves with each of the
    /// unknowns asked for: 3 x any number.
    fn moved(&self, index: usize) -> (Vector3<f64>, DMatrix<f64>);
    /// How something with these partial derivatives moves with the same.
    fn block(&self, partials: &Partials) -> DMatrix<f64>;
}

/// A kind of measurement. A row has as many equations as its kind components.
pub trait Kind: Sync {
    /// As in the column `kind`.
    fn name(&self) -> &'static str;

    /// The columns of numbers that it reads, all needed: [`Row::measured`] in
    /// this order.
    fn columns(&self) -> &'static [Column];

    /// The columns of labels that it reads.
    fn labels(&self) -> &'static [&'static str] {
        &[]
    }

    /// What a row refers to beside the arm.
    ///
    /// # Errors
    /// A label that is missing or says nothing.
    fn bind(&self, _told: &Told, _book: &mut dyn Registry) -> Result<Bound, Unclear> {
        Ok(Bound::default())
    }

    /// Whether two rows, joined by a label of this column, are one measurement.
    fn joined_by(&self) -> Option<&'static str> {
        None
    }

    /// Names of the residual's components, for flags and reports.
    fn components(&self) -> &'static [&'static str];

    /// What a component is measured in.
    fn measure(&self, _component: usize) -> Measure {
        Measure::Length
    }

    /// Standard deviation of each component, SI.
    fn sigmas(&self, row: &Row) -> Values {
        let of = |c| match self.measure(c) {
            Measure::Length => row.sigma,
            Measure::Angle => row.sigma_angle,
            Measure::Pixel => row.sigma_px,
        };
        Values::from_fn(self.components().len(), of)
    }

    /// What to check of its rows, in words, where they contradict others.
    fn check(&self) -> &'static str;

    /// What the kind alone leaves undetermined, in words.
    fn leaves(&self) -> &'static str;

    /// The point that was measured, m, for first guesses of frames and for
    /// pictures; `None` of a kind that measures none.
    fn point(&self, _row: &Row) -> Option<Vector3<f64>> {
        None
    }

    /// How the marker's frame was measured to be turned in the station's.
    fn turn(&self, _row: &Row) -> Option<Matrix3<f64>> {
        None
    }

    /// A length that was measured, m.
    fn distance(&self, _row: &Row) -> Option<f64> {
        None
    }

    /// Where the target is in the frame of a plate, m.
    fn hole(&self, _row: &Row) -> Option<Vector3<f64>> {
        None
    }

    /// A corner of a board, m, and where an image has it, px.
    fn corner(&self, _row: &Row) -> Option<(Vector3<f64>, [f64; 2])> {
        None
    }

    /// Whether rows of one pose are parts of one image.
    fn is_image(&self) -> bool {
        false
    }

    /// How far the x and y of the marker's frame lean from the level, rad.
    fn lean(&self, _row: &Row) -> Option<[f64; 2]> {
        None
    }

    /// Whether what measures it may add to every value, by anchor.
    fn has_zero(&self) -> bool {
        false
    }

    /// The label of what a row measures with, of that of its marker: another where it is
    /// no target.
    fn target<'a>(&self, marker: &'a str) -> Cow<'a, str> {
        Cow::Borrowed(marker)
    }

    /// Whether what a row measures depends on the place of its marker.
    fn of_marker(&self, _row: &Row) -> bool {
        true
    }

    /// Whether it says where in the last frame its target is.
    fn of_target(&self, row: &Row) -> bool {
        self.of_marker(row)
    }

    /// Whether it depends on how the last frame is turned.
    fn turns(&self) -> bool {
        false
    }

    /// Measured minus modelled, SI, and how what is modelled moves.
    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials;

    /// Measured minus modelled, SI.
    fn residual(&self, index: usize, seen: &dyn Seen) -> Values {
        self.partials(index, seen).residual
    }

    /// The same with the derivatives of what is modelled: as many rows as
    /// components, as many columns as [`Moving::moved`] gives.
    fn linearised(&self, index: usize, seen: &dyn Moving) -> (Values, DMatrix<f64>) {
        let partials = self.partials(index, seen);
        (partials.residual, seen.block(&partials))
    }

    /// How far off noise alone makes it, root mean square, m.
    fn noise(&self, row: &Row) -> f64 {
        self.miss(&self.sigmas(row))
    }

    /// How far off a residual is, m: what statistics show. An angle counts what
    /// it moves at a distance of 1 m, unless a length is measured with it.
    fn miss(&self, residual: &[f64]) -> f64 {
        let length = |c: usize| self.measure(c) == Measure::Length;
        let lengths = (0..residual.len()).any(length);
        let counts = |(c, _): &(usize, &f64)| !lengths || length(*c);
        residual.iter().enumerate().filter(counts).map(|(_, r)| r * r).sum::<f64>().sqrt()
    }
}

/// The columns of all kinds: of numbers, and of labels.
#[must_use]
pub fn columns_of_kinds() -> (Vec<&'static str>, Vec<&'static str>) {
    let numbers = KINDS.iter().flat_map(|kind| kind.columns()).map(|column| column.name);
    (numbers.collect(), KINDS.iter().flat_map(|kind| kind.labels()).copied().collect())
}

/// Lets rows that lengths are measured in refer to what is added to these, where the
/// measurements have it: other rows of the same anchor do.
pub fn refer_to_zeros(data: &mut Measurements) {
    let zero_of = |anchor: usize| {
        let label = &data.instruments[anchor].label;
        data.instruments.iter().position(|i| i.form == Form::Zero && i.label == *label)
    };
    let zeros: Vec<Option<usize>> = (0..data.instruments.len()).map(zero_of).collect();
    for row in data.rows.iter_mut().filter(|row| of(row.kind).has_zero()) {
        if let [anchor] = row.refers[..] {
            row.refers.extend(zeros[anchor]);
        }
    }
}

/// The kind of a row.
#[must_use]
pub fn kind(row: &Row) -> &'static dyn Kind {
    of(row.kind)
}

fn of(id: KindId) -> &'static dyn Kind {
    KINDS[usize::from(id.0)]
}

/// The kind of this name.
#[must_use]
pub fn by_name(name: &str) -> Option<KindId> {
    let place = KINDS.iter().position(|kind| kind.name() == name)?;
    Some(KindId(place as u8))
}

/// How many equations a row gives: none where it is the first end of a pair.
#[must_use]
pub fn equations_of(row: &Row) -> usize {
    let kind = kind(row);
    if kind.joined_by().is_some() && row.partner.is_none() { 0 } else { kind.components().len() }
}

/// How many equations some rows give.
#[must_use]
pub fn equations(rows: &[Row], of: &[usize]) -> usize {
    of.iter().map(|row| equations_of(&rows[*row])).sum()
}

/// Rows that give equations.
#[must_use]
pub fn measuring(rows: &[Row]) -> Vec<usize> {
    (0..rows.len()).filter(|row| equations_of(&rows[*row]) > 0).collect()
}

/// Makes a row that measures a point a row of kind point, a pose without its turn; of
/// another kind, leaves it as it is and says no.
pub fn to_point(row: &mut Row) -> bool {
    if kind(row).point(row).is_none() {
        return false;
    }
    row.make_point();
    true
}

/// The same rows for a verb that takes points only: poses without their turns.
///
/// # Errors
/// Another kind, by name.
pub fn points_only(data: &Measurements, verb: &str) -> crate::Result<Measurements> {
    let mut out = data.clone();
    for (i, row) in out.rows.iter_mut().enumerate() {
        if !to_point(row) {
            let (file, own) = (data.file_of(i).display(), &data.rows[i]);
            return Err(crate::Error::data(
                crate::ErrorKind::Usage,
                format!(
                    "{file}:{}: a row of kind {}, which {verb} does not take",
                    own.line,
                    kind(own).name()
                ),
                "`truearm identify`, `truearm evaluate` and `truearm diagnose` take every kind; give \
                 points or poses here",
            ));
        }
    }
    out.instruments.clear();
    Ok(out)
}
