//! RPIM: from measurements to identified parameters.
//!
//! registration (first guesses) -> robust fit (flags) -> lambda -> fit ->
//! cross-validation -> report. Nothing here reads or writes a file.

mod conditions;
pub mod estimate;
pub mod fit;
pub mod folds;
mod lambda;
mod problem;
pub mod redundancy;
pub mod registration;
pub mod robust;
mod term;
mod unknowns;

pub use conditions::Conditions;
pub use lambda::{LambdaChoice, LambdaRule, choose};
pub use problem::{
    Equations, Linearised, Model as Predictor, Problem, Scaling, link_corrections,
    measurement_column,
};
pub use term::ModelTerm;
pub use unknowns::{State, TOLERANCE_ANGLE, TOLERANCE_LENGTH, Unknown, Unknowns};

use nalgebra::{Rotation3, Vector3};
use truearm::{MdhParameters, Pose};

use crate::chain::chain;
use crate::error::{Error, Result};
use crate::files::{Measurements, Model, Robot};
use crate::report::{AllRows, FlaggedRow, Report, Stats, robust_distance_scale};
use crate::tikhonov::covariance;
use estimate::{Estimate, cross_validate, estimate};
use fit::{Freedom, fit};

/// What the user may choose.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// How lambda is chosen.
    pub rule: LambdaRule,
    /// What lambda weighs.
    pub scaling: Scaling,
    /// Identify even where the measurements give fewer equations than unknowns.
    pub allow_few_poses: bool,
}

/// The result.
#[derive(Debug, Clone)]
pub struct Identification {
    /// For evaluation and packing.
    pub model: Model,
    /// Figures.
    pub report: Report,
    /// Per row: residual of the fit, held-out residual, flagged; m.
    pub rows: Vec<RowResult>,
}

/// What became of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowResult {
    /// Measured minus nominal geometry, m.
    pub nominal: Vector3<f64>,
    /// Measured minus identified, m.
    pub identified: Vector3<f64>,
    /// Measured minus predicted without its fold, m.
    pub held_out: Option<Vector3<f64>>,
    /// Flagged as a gross error.
    pub flagged: bool,
}

/// Called with (done, of so many) as the work goes on.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Identifies the arm.
///
/// # Errors
/// Too few or too similar poses, points on a line, or data that contradict the
/// nominal geometry; each with its remedy.
pub fn identify(
    robot: &Robot,
    data: &Measurements,
    options: &Options,
    progress: Progress,
) -> Result<Identification> {
    let problem = Problem::new(data, robot, options.scaling);
    enough(&problem, options)?;
    let start = registration::register(data, &problem.nominal, robot.tool)?;
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let folds = folds::random(data, &rows, folds::SEED);
    let blocks = folds::blocked(data, &rows);
    let total = 1 + folds.len() + blocks.as_ref().map_or(0, Vec::len);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let tick = || {
        let now = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        progress(now, total);
    };

    let found = estimate(&problem, options.rule, &rows, &start, true)?;
    tick();
    let held_out = cross_validate(&problem, options.rule, &folds, &start, &tick)?;
    let blocked = match &blocks {
        Some(folds) => Some(cross_validate(&problem, options.rule, folds, &start, &tick)?),
        None => None,
    };

    let prior = Problem { scaling: Scaling::Prior, ..problem.clone() };
    let nominal = fit(&prior, &found.robust.kept, None, &start, Freedom::Frames)?.state;
    let redundancy = redundancy::analyse(&problem, &nominal, &found.robust.kept);
    let results = row_results(&problem, &nominal, &found, &held_out);
    let own = |cv: &[Option<Vector3<f64>>]| judged(&results, cv);
    let flags: Vec<FlaggedRow> = found.robust.outliers.iter().map(flagged_row).collect();

    let stats = |all: bool, f: fn(&RowResult) -> Vector3<f64>| {
        let used = results.iter().filter(|r| all || !r.flagged);
        Stats::of(&used.map(f).collect::<Vec<_>>())
    };
    let mut warnings = [robot.warnings.clone(), data.warnings.clone()].concat();
    if 2 * data.poses < data.rows.len() && data.markers.len() * data.stations.len() == 1 {
        warnings.push(format!(
            "{}: {} rows but only {} distinct poses; repeats average noise, they do not identify",
            data.path.display(),
            data.rows.len(),
            data.poses
        ));
    }
    let report = Report {
        schema: "truearm-report-1",
        command: "identify",
        robot: robot.name.clone(),
        data: data.path.display().to_string(),
        rows: data.rows.len(),
        poses: data.poses,
        stations: data.stations.clone(),
        markers: data.markers.clone(),
        parameters: problem.unknowns.list().len(),
        rank: redundancy.rank,
        condition_number: redundancy.condition,
        condition_number_raw: redundancy.condition_raw.into(),
        lambda: found.lambda,
        lambda_rule: options.rule.name(),
        lambda_scaling: match options.scaling {
            Scaling::Prior => "prior",
            Scaling::Printed => "printed",
        },
        lambda_choice: found.choice.clone(),
        correction_norm: prior.corrections(&found.fit.state).norm(),
        residual_over_sigma: found.robust.scale,
        nominal: stats(false, |r| r.nominal),
        identified: stats(false, |r| r.identified),
        cross_validated: Stats::of(&own(&held_out)),
        cross_validation: match folds.len() {
            n if n == data.poses => format!("leave-one-out over {n} poses"),
            n => format!("{n} random folds of poses"),
        },
        cross_validated_blocked: blocked.and_then(|b| Stats::of(&own(&b))),
        rows_not_cross_validated: held_out.iter().filter(|r| r.is_none()).count(),
        validation: None,
        all_rows: AllRows {
            nominal: stats(true, |r| r.nominal),
            identified: stats(true, |r| r.identified),
            cross_validated: Stats::of(&held_out.iter().flatten().copied().collect::<Vec<_>>()),
        },
        outlier_rows: flags.iter().map(|f| f.row).collect(),
        outliers: flags,
        unidentifiable: redundancy.redundant,
        weakly_determined: redundancy.weak,
        warnings,
    };
    let model = model(robot, data, &problem, &found, &report);
    Ok(Identification { model, report, rows: results })
}

/// Enough equations for the unknowns?
fn enough(problem: &Problem, options: &Options) -> Result<()> {
    let data = problem.data;
    if data.poses == 1 {
        return Err(Error::data(
            format!("{}: all rows have the same joint values", data.path.display()),
            "measure different poses; column q1_deg.. is the encoder reading of each",
        ));
    }
    let mut distinct: Vec<_> = data.rows.iter().map(|r| (r.pose, r.marker)).collect();
    distinct.sort_unstable();
    distinct.dedup();
    let (points, unknowns) = (distinct.len(), problem.unknowns.list().len());
    if 3 * points < unknowns && !options.allow_few_poses {
        return Err(Error::data(
            format!(
                "{}: {points} distinct points give {} equations for {unknowns} unknowns",
                data.path.display(),
                3 * points
            ),
            format!(
                "measure at least {} poses, better 50; --allow-few-poses goes on, and the \
                 tolerances then decide what the data leave open",
                unknowns.div_ceil(3)
            ),
        ));
    }
    Ok(())
}

fn row_results(
    problem: &Problem,
    nominal: &State,
    found: &Estimate,
    held_out: &[Option<Vector3<f64>>],
) -> Vec<RowResult> {
    let (before, after) = (problem.linearise(nominal), problem.linearise(&found.fit.state));
    let flagged: Vec<usize> = found.robust.outliers.iter().map(|o| o.row).collect();
    (0..problem.data.rows.len())
        .map(|row| RowResult {
            nominal: before.residual(row),
            identified: after.residual(row),
            held_out: held_out[row],
            flagged: flagged.contains(&row),
        })
        .collect()
}

/// Held-out residuals that count: a row is left out only if it is flagged and
/// its own held-out residual is beyond 10 robust standard deviations.
fn judged(results: &[RowResult], held_out: &[Option<Vector3<f64>>]) -> Vec<Vector3<f64>> {
    let distances: Vec<f64> = held_out.iter().flatten().map(|r| r.norm()).collect();
    let limit = 10.0 * robust_distance_scale(&distances);
    let counts = |(row, r): &(&RowResult, Vector3<f64>)| !(row.flagged && r.norm() > limit);
    let rows = results.iter().zip(held_out).filter_map(|(row, r)| Some((row, (*r)?)));
    rows.filter(counts).map(|(_, r)| r).collect()
}

fn flagged_row(outlier: &robust::Outlier) -> FlaggedRow {
    FlaggedRow {
        row: outlier.row + 1,
        coordinates: outlier.coordinates.iter().map(|c| ["x", "y", "z"][*c]).collect(),
        residual_mm: (outlier.residual * 1e3).into(),
    }
}

fn model(
    robot: &Robot,
    data: &Measurements,
    problem: &Problem,
    found: &Estimate,
    report: &Report,
) -> Model {
    let state = &found.fit.state;
    let cov = covariance(&found.fit.triangle, problem.unknowns.free(), found.lambda);
    let noise = match problem.scaling {
        Scaling::Prior => found.robust.scale,
        Scaling::Printed => {
            found.robust.scale
                * robust::median(&data.rows.iter().map(|r| r.sigma).collect::<Vec<_>>())
        }
    };
    let sigma =
        |k: usize| cov[(k, k)].max(0.0).sqrt() * noise * problem.unit(problem.unknowns.list()[k]);
    let at = |i: usize| problem.unknowns.free() + 5 * i;
    let uncertainties = (0..robot.joints.len())
        .map(|i| MdhParameters::from_array(core::array::from_fn(|k| sigma(at(i) + k))));
    let frame = robot_frame(problem, found);
    let turn = Rotation3::from_matrix_unchecked(frame.rotation).scaled_axis();
    let labels = |l: &[String]| l.to_vec();
    Model {
        robot: robot.clone(),
        corrections: link_corrections(state, &problem.nominal),
        uncertainties: uncertainties.collect(),
        covered: data.covered(),
        terms: Vec::new(),
        stations: labels(&data.stations).into_iter().zip(state.bases.iter().copied()).collect(),
        markers: labels(&data.markers).into_iter().zip(state.markers.iter().copied()).collect(),
        frame_translation: frame.translation,
        frame_rotation: turn,
        provenance: crate::files::Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            created: humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string(),
            data: report.data.clone(),
            rows: report.rows,
            poses: report.poses,
            outlier_rows: report.outlier_rows.clone(),
            lambda: report.lambda,
            lambda_rule: report.lambda_rule.to_owned(),
            nominal_rms_mm: report.nominal.map_or(0.0, |s| s.rms_mm),
            cross_validated_rms_mm: report.cross_validated.map_or(0.0, |s| s.rms_mm),
        },
        unidentifiable: [report.unidentifiable.clone(), report.weakly_determined.clone()].concat(),
    }
}

/// The rigid transform that best carries identified tool points onto nominal
/// ones over the identification poses: what is left of the redundancy between
/// geometry and base once the commanded frame is declared to be the nominal one.
fn robot_frame(problem: &Problem, found: &Estimate) -> Pose<f64> {
    let state = &found.fit.state;
    let points = |links: &[truearm::Link<f64>]| -> Vec<Vector3<f64>> {
        let chains: Vec<_> =
            state.markers.iter().map(|m| chain(links, Pose::identity(), *m)).collect();
        let rows = found.robust.kept.iter().map(|r| &problem.data.rows[*r]);
        rows.map(|r| chains[r.marker].pose(&r.q).translation).collect()
    };
    let weights = vec![1.0; found.robust.kept.len()];
    registration::rigid_transform(&points(&state.links), &points(&problem.nominal), &weights)
        .unwrap_or_else(Pose::identity)
}
