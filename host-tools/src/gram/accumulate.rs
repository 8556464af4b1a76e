use super::part::{FoldSums, Part};
use super::{FOLDS, state};
use crate::error::{Error, ErrorKind, Result};
use crate::identify::problem::accumulate::tree;
use crate::identify::problem::moving;
use crate::identify::{Conditions, Predictor, Unknowns};
use crate::model::arm::{Kinematics, RowInputs, chain};
use crate::model::near::cell;
use crate::model::{Measurements, Model, Row};
use nalgebra::{DVector, Vector3};
use truearm::{Link, Pose};

/// Rows of a part that one core sums.
const LEAF: usize = 8192;
/// Rows of a fold whose equations are summed at once: they stay in the processor's cache.
const AT_ONCE: usize = 32;

/// Sums over the rows of a part at a state.
///
/// # Errors
/// A file without rows, rows that are no points, and labels that the state does not know.
pub fn accumulate(model: &Model, data: &Measurements) -> Result<Part> {
    let data = &*state::labelled(model, data)?;
    model.loaded(data)?;
    model.timed(data)?;
    let rows = data.distinct();
    if rows.is_empty() {
        return Err(Error::data(ErrorKind::NoRows, "no rows to add", "give a file with rows"));
    }
    let summing = Summing::new(model, &state::no_rows(model));
    let conditions = summing.bent.then(|| Conditions::of_model(data, model));
    let rigid = RowInputs::default();
    let leaf = |rows: &[usize]| {
        let mut sums = Sums::none(&summing);
        for index in rows {
            let inputs = conditions.as_ref().map_or(&rigid, |known| &known.rows[*index]);
            sums.add(&data.rows[*index], inputs);
        }
        sums.part()
    };
    let join = |a: Part, b: Part| a.joined(&b).unwrap_or_else(|e| unreachable!("one state: {e}"));
    let mut part = tree(&rows, LEAF, &leaf, &join);
    (part.files, part.poses, part.rows) = (1, data.poses as u64, rows.len() as u64);
    part.covered = data.covered();
    Ok(part)
}

/// The fold of a row: by the cell of its joint values alone, so that every part agrees.
pub(super) fn fold_of(q: &[f64], links: &[Link<f64>]) -> usize {
    // The high bits: the low ones of such a product are poor.
    ((cell(q, links.iter().map(|link| link.kind)) >> 32) % FOLDS as u64) as usize
}

/// What a state is to its rows.
struct Summing<'a> {
    model: &'a Model,
    digest: u64,
    unknowns: Unknowns,
    units: DVector<f64>,
    predictor: Predictor,
    /// Without base and target, of nominal links.
    flange: Box<dyn Kinematics>,
    /// The robot's frame, and of each marker the state's links in it.
    frame: Pose<f64>,
    framed: Vec<Box<dyn Kinematics>>,
    /// Whether anything beside its joints moves the arm.
    bent: bool,
    nominal: Vec<Link<f64>>,
}

impl<'a> Summing<'a> {
    fn new(model: &'a Model, no_rows: &Measurements) -> Self {
        let (problem, at) = (state::problem(model, no_rows), state::state(model));
        let frame = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
        Self {
            model,
            digest: state::digest(model),
            units: problem.units(),
            flange: chain(&problem.nominal, Pose::identity(), Vector3::zeros()),
            framed: at.markers.iter().map(|marker| chain(&at.links, frame, *marker)).collect(),
            frame,
            bent: !model.terms.is_empty() || !model.curves.is_empty(),
            predictor: Predictor::new(&at),
            unknowns: problem.unknowns,
            nominal: problem.nominal,
        }
    }
}

/// Sums on the way.
struct Sums<'a> {
    of: &'a Summing<'a>,
    part: Part,
    /// Of each fold, equations `[a; b]` that are not summed yet.
    waiting: Vec<Vec<f64>>,
}

impl<'a> Sums<'a> {
    fn none(of: &'a Summing<'a>) -> Self {
        let Summing { model, digest, unknowns, nominal, .. } = of;
        let turns = model.stations.len() * model.markers.len();
        let part = Part::none(*digest, unknowns.list().len(), nominal.len(), turns);
        Self { of, part, waiting: vec![Vec::new(); FOLDS] }
    }

    fn add(&mut self, row: &Row, inputs: &RowInputs) {
        let Summing { model, predictor, flange, .. } = self.of;
        let place = model.markers.len() * row.station + row.marker;
        let nominal = flange.pose(&row.q);
        self.part.turns[place].add(&nominal.rotation);
        // The first round measures the scale that the others weigh by.
        let Some(gram) = &model.gram else {
            let residual = (row.measured.point() - predictor.point(row, inputs)) / row.sigma;
            residual.iter().for_each(|r| self.part.residuals.add(*r));
            return;
        };
        let d = predictor.derivatives(row, inputs);
        let residual = row.measured.point() - d.point;
        let scaled = residual / row.sigma;
        if scaled.amax() > gram.weights {
            self.part.flagged += 1;
            return;
        }
        // What gross errors leave is no noise.
        scaled.iter().for_each(|r| self.part.residuals.add(*r));
        let Summing { unknowns, units, nominal: links, frame, framed, bent, .. } = self.of;
        let fold = fold_of(&row.q, links);
        let terms = match unknowns.terms().is_empty() {
            true => Vec::new(),
            false => predictor.columns(row, inputs, &d),
        };
        let (height, waiting) = (units.len() + 1, &mut self.waiting[fold]);
        let first = waiting.len();
        waiting.resize(first + 3 * height, 0.0);
        let equations = &mut waiting[first..];
        moving(unknowns, row, (&d, &terms), &mut |column, moved| {
            let factor = units[column] / row.sigma;
            (0..3).for_each(|c| equations[c * height + column] = moved[c] * factor);
        });
        (0..3).for_each(|c| equations[(c + 1) * height - 1] = scaled[c]);
        let sums = &mut self.part.folds[fold];
        (sums.rows, sums.precision) = (sums.rows + 1, sums.precision + row.sigma.powi(-2));
        if waiting.len() >= 3 * AT_ONCE * height {
            sums.normal.add_columns(waiting);
            waiting.clear();
        }
        // What bends the arm is not in its frame.
        let framed = match bent {
            false => d.rebased(&model.stations[row.station].1, frame),
            true => framed[row.marker].derivatives(&row.q, &[], &RowInputs::default()),
        };
        self.part.frame.add(unknowns, row, &framed);
        let identified = frame.inverse().transform_point(&framed.point);
        let target = nominal.transform_point(&model.markers[row.marker].1);
        self.part.points.add(identified, target);
    }

    fn part(mut self) -> Part {
        for (FoldSums { normal, .. }, waiting) in self.part.folds.iter_mut().zip(&self.waiting) {
            normal.add_columns(waiting);
        }
        self.part
    }
}
