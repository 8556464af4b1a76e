use super::part::{FoldSums, Part};
use super::{FOLDS, state};
use crate::error::{Error, ErrorKind, Result};
use crate::identify::certainty::covariance::FrameSums;
use crate::identify::problem::accumulate::{CHUNK, tree};
use crate::identify::start::Pairs;
use crate::identify::{Linearised, Problem, State};
use crate::model::arm::{Kinematics, chain};
use crate::model::{Measurements, Model, Row, Values};
use crate::tikhonov::Normal;
use nalgebra::Vector3;
use rayon::prelude::*;
use truearm::{JointKind, Pose};

/// Sums over the rows of a part at a state.
///
/// # Errors
/// A file without rows, rows that are no points, and labels that the state does not know.
pub fn accumulate(model: &Model, data: &Measurements) -> Result<Part> {
    let data = &state::labelled(model, data)?;
    model.loaded(data)?;
    model.timed(data)?;
    let (problem, at) = (state::problem(model, data), state::state(model));
    let rows = problem.counted();
    if rows.is_empty() {
        return Err(Error::data(ErrorKind::NoRows, "no rows to add", "give a file with rows"));
    }
    let here = problem.linearise(&at).about_here();
    let residuals: Vec<Values> = rows.par_iter().map(|row| here.scaled_residual(*row)).collect();
    let (unknowns, joints) = (problem.unknowns.list().len(), problem.nominal.len());
    let mut part = Part::none(
        state::digest(model),
        unknowns,
        joints,
        data.stations.len() * data.markers.len(),
    );
    (part.files, part.poses, part.rows) = (1, data.poses as u64, rows.len() as u64);
    part.covered = data.covered();
    residuals.iter().flat_map(|r| r.to_vec()).for_each(|r| part.residuals.add(r));
    let flange = chain(&problem.nominal, Pose::identity(), Vector3::zeros());
    for row in &data.rows {
        part.turns[row.station * data.markers.len() + row.marker]
            .add(&flange.pose(&row.q).rotation);
    }
    // The first round measures the scale that the others weigh by.
    let Some(gram) = &model.gram else { return Ok(part) };
    let counts = |r: &Values| r.amax() <= gram.weights;
    let kept: Vec<usize> =
        rows.iter().zip(&residuals).filter(|(_, r)| counts(r)).map(|(row, _)| *row).collect();
    part.flagged = (rows.len() - kept.len()) as u64;
    for (k, fold) in part.folds.iter_mut().enumerate() {
        let own: Vec<usize> =
            kept.iter().copied().filter(|row| fold_of(&problem, &data.rows[*row]) == k).collect();
        *fold = sums(&here, &problem, &own, unknowns);
    }
    let frame = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    part.frame = FrameSums::of(&problem, &at, &kept, &frame);
    part.points = points(&problem, &at, &kept);
    Ok(part)
}

fn sums(here: &Linearised, problem: &Problem, rows: &[usize], unknowns: usize) -> FoldSums {
    if rows.is_empty() {
        return FoldSums { normal: Normal::none(unknowns), rows: 0, precision: 0.0 };
    }
    let precision = rows.iter().map(|row| problem.data.rows[*row].sigma.powi(-2)).sum();
    FoldSums { normal: here.normal(rows, None), rows: rows.len() as u64, precision }
}

/// Points of the identified and of the nominal arm, without the station.
fn points(problem: &Problem, at: &State, rows: &[usize]) -> Pairs {
    let arms = |links: &[truearm::Link<f64>]| -> Vec<Box<dyn Kinematics>> {
        at.markers.iter().map(|m| chain(links, Pose::identity(), *m)).collect()
    };
    let (identified, nominal) = (arms(&at.links), arms(&problem.nominal));
    let leaf = |rows: &[usize]| {
        let mut pairs = Pairs::default();
        for row in rows.iter().map(|row| &problem.data.rows[*row]) {
            let at = |arms: &[Box<dyn Kinematics>]| arms[row.marker].pose(&row.q).translation;
            pairs.add(at(&identified), at(&nominal));
        }
        pairs
    };
    tree(rows, CHUNK, &leaf, &|a, b| a.plus(&b))
}

/// Edge of a cell of joint values, rad or m: a pose read again is mostly in the same one.
const CELL: [f64; 2] = [1.745_329_251_994_33e-4, 1e-5];

/// The fold of a row: by the cell of its joint values alone, so that every part agrees.
fn fold_of(problem: &Problem, row: &Row) -> usize {
    let edge = |kind: JointKind| match kind {
        JointKind::Revolute => CELL[0],
        JointKind::Prismatic => CELL[1],
    };
    let cells = row.q.iter().zip(&problem.nominal).map(|(q, l)| (q / edge(l.kind)).round() as i64);
    // FNV-1a, then its high bits: the low ones of such a product are poor.
    let hash = cells.flat_map(i64::to_le_bytes).fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    ((hash >> 32) % FOLDS as u64) as usize
}
