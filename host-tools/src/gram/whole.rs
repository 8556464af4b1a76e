//! Identification of more rows than are held at once: parts of files that are read anew in
//! every round, from the identification of rows that were drawn from them.

use nalgebra::DVector;

use super::accumulate::fold_of;
use super::{Part, Step, accumulate, state, step};
use crate::error::{Error, ErrorKind, Result};
use crate::files::{Pieces, Sample};
use crate::identify::fit::estimate::Estimate;
use crate::identify::fit::robust::{Outlier, RobustFit};
use crate::identify::fit::{CONVERGED, Fit, LambdaRule};
use crate::identify::noise_estimate::none_is_lost;
use crate::identify::{
    Drawn, Findings, Identification, Linearised, Options, Problem, Scaling, identify, nominal_state,
};
use crate::model::Model;
use crate::observations::Residual;
use crate::tikhonov::{Factorised, covariance, used};

/// Rows above which files are read in pieces: so many are in memory 1.3 GB.
pub const LARGE: usize = 1_000_000;
/// Rows to draw to begin with, and that figures of distances are of: they tell a root mean
/// square to half a per cent.
pub const DRAWN: usize = 20_000;
/// Rounds that no identification took.
const MOST_ROUNDS: u32 = 30;

/// Called with the round, and rows read in it.
pub type Rounds<'a> = &'a (dyn Fn(u32, usize) + Sync);

/// Whether rows can be read in pieces for these options.
///
/// # Errors
/// What needs rows that are held.
pub fn sums_tell(options: &Options) -> Result<()> {
    let help = "leave it out, or write --in-pieces=never: that holds all rows";
    if options.scaling == Scaling::Printed {
        return Err(Error::usage("--scaling printed, and rows that are read in pieces", help));
    }
    match options.rule {
        LambdaRule::MaximumLikelihood | LambdaRule::MaximumAPosteriori | LambdaRule::Fixed(_) => {
            Ok(())
        }
        rule => {
            let what = format!("--lambda {}, and rows that are read in pieces", rule.name());
            Err(Error::usage(what, help))
        }
    }
}

/// Identifies the arm of files of points from rows drawn of them. Figures of distances and rows
/// are of those drawn, all others of all.
///
/// # Errors
/// As for [`sums_tell`], for [`identify`] of rows drawn, and for [`step()`] of all.
pub fn identify_in_pieces(
    rows: &Pieces,
    sample: &Sample,
    options: &Options,
    progress: Rounds,
) -> Result<Identification> {
    sums_tell(options)?;
    let start = identify(rows.robot(), &sample.data, options, &|_, _| ())?;
    // Those drawn tell the scale of the residuals that the first round begins with.
    let drawn = accumulate(&start.model, &sample.data)?;
    let mut model = step(&start.model, &drawn)?.model;
    for round in 1..=MOST_ROUNDS {
        let read = std::sync::atomic::AtomicUsize::new(0);
        let part = rows.fold(
            &|data| {
                let some = data.rows.len();
                let now = read.fetch_add(some, std::sync::atomic::Ordering::Relaxed) + some;
                progress(round, now);
                accumulate(&model, &data)
            },
            &|a, b| a.beside(&b),
        )?;
        let next = step(&model, &part)?;
        if next.steady && next.largest < CONVERGED {
            return settled(rows, options.rule, (sample, start), (&model, &part, next));
        }
        model = next.model;
    }
    Err(Error::data(
        ErrorKind::NotConverged,
        format!("{}: not at rest after {MOST_ROUNDS} rounds", rows.names()),
        "identify some of the rows, which says why",
    ))
}

/// The findings of the last round: sums that are of `model`, and what they lead to.
fn settled(
    rows: &Pieces,
    rule: LambdaRule,
    (sample, start): (&Sample, Identification),
    (model, part, last): (&Model, &Part, Step),
) -> Result<Identification> {
    let data = &sample.data;
    let (Some(gram), at) = (&model.gram, state::state(model)) else {
        return Err(Error::data(ErrorKind::NotConverged, "no round", "give more rows"));
    };
    let problem = Problem::rigid(data, &model.robot, Scaling::Prior).about(&at);
    let here = problem.linearise(&at).about_here();
    let counts = |row: &usize| here.scaled_residual(*row).amax() <= gram.weights;
    let (kept, flagged): (Vec<usize>, Vec<usize>) = problem.counted().into_iter().partition(counts);
    let outliers: Vec<Outlier> =
        flagged.into_iter().map(|row| outlier(row, &here, gram.weights)).collect();
    none_is_lost(data, &problem.counted(), &outliers)?;
    let nominal = nominal_state(&problem, &kept, &at)?;
    let x = problem.corrections(&at);
    let whole = part.whole().recounted(&DVector::repeat(x.len(), 1.0), &-x);
    let solved = Factorised::of_normal(&whole, problem.unknowns.free());
    let fit = Fit { state: at.clone(), normal: whole, steps: gram.stage as usize };
    let lambda = last.model.provenance.lambda;
    let used = used(&fit.normal, &covariance(&fit.normal, problem.unknowns.free(), lambda));
    let robust = RobustFit { fit: fit.clone(), kept, outliers, scale: gram.k, used };
    let found = Estimate { fit, robust, lambda, choice: None, solved: Some(solved) };
    let held_out = held_out(&problem, &here, &last.held_out);
    let identified = Findings {
        rule,
        robot: &model.robot,
        problem: &problem,
        rigid: &problem,
        curves: Vec::new(),
        nominal,
        found,
        held_out,
        blocked: None,
        cross_validation: format!("{} folds of poses", super::FOLDS),
    }
    .summarise();
    let drawn = Drawn {
        rows: data.rows.len(),
        rounds: gram.stage,
        flagged: part.flagged() as usize,
        twice: sample.twice,
        rms_mm: last.rms_mm.unwrap_or_default(),
        cross_validated_rms_mm: last.cross_validated_rms_mm,
    };
    Ok(of_all(identified, (rows, sample), drawn, (last.model, start.model.not_measured)))
}

/// The same with figures of all rows, but for those that only rows at hand tell, and with the
/// model that they lead to.
fn of_all(
    mut identified: Identification,
    (rows, sample): (&Pieces, &Sample),
    drawn: Drawn,
    (model, not_measured): (Model, Vec<String>),
) -> Identification {
    let figures = &mut identified.figures;
    figures.drawn = Some(drawn);
    (figures.rows, figures.poses, figures.data) = (sample.rows, sample.poses, rows.names());
    let provenance = crate::model::Provenance {
        data: rows.names(),
        rows: sample.rows,
        poses: sample.poses,
        nominal_rms_mm: figures.nominal.map_or(0.0, |s| s.rms_mm),
        cross_validated_rms_mm: figures.cross_validated.map_or(0.0, |s| s.rms_mm),
        tool_point_mm: Some(figures.uncertainty.tool_point.rms_mm),
        ..model.provenance.clone()
    };
    identified.model = Model {
        provenance,
        gram: None,
        unidentifiable: identified.model.unidentifiable,
        not_measured,
        ..model
    };
    identified
}

fn outlier(row: usize, here: &Linearised, limit: f64) -> Outlier {
    let (residual, scaled) = (here.residual(row), here.scaled_residual(row));
    let names = residual.components().iter().zip(scaled.iter());
    let components = names.filter(|(_, r)| r.abs() > limit).map(|(name, _)| *name).collect();
    Outlier { row, components, residual }
}

/// What the others of its fold leave of each row, to first order about the whole.
fn held_out(
    problem: &Problem,
    here: &Linearised,
    steps: &[Option<DVector<f64>>],
) -> Vec<Option<Residual>> {
    let of = |row: usize| {
        let step = steps[fold_of(&problem.data.rows[row].q, &problem.nominal)].as_ref()?;
        let equations = here.equations(row);
        let moved = &equations.block * step;
        let (residual, scale) = (equations.residual, equations.scale);
        let mut values = *residual.values();
        (0..values.len()).for_each(|c| values[c] -= moved[c] * scale[c]);
        Some(residual.with(values))
    };
    (0..problem.data.rows.len()).map(of).collect()
}
