//! From findings to model and figures.

use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;
use truearm::{MdhParameters, Pose};

use super::figures::{AllRows, Figures, FlaggedRow};
use super::problem::link_corrections;
use super::{
    Identification, LambdaRule, Problem, RowResult, Scaling, State, TOLERANCE_ANGLE,
    noise_estimate, remarks,
};
use crate::identify::certainty::covariance::{factor, instruments, of_arm};
use crate::identify::certainty::error_bars::uncertainty;
use crate::identify::certainty::unknowns::{Covariances, spread};
use crate::identify::certainty::{redundancy, scale};
use crate::identify::fit::estimate::Estimate;
use crate::identify::fit::{l_curve, robust};
use crate::identify::start::{frame_between, tool};
use crate::model::arm::chain;
use crate::model::{ErrorCurve, Measurements, Model, Provenance, Robot};
use crate::observations::{Residual, kind};
use crate::statistics::{Stats, robust_distance_scale};
use crate::tikhonov::Factorised;

/// All that was found out about a data set.
pub struct Findings<'a> {
    /// How lambda was chosen.
    pub rule: LambdaRule,
    /// The nominal arm.
    pub robot: &'a Robot,
    /// The data, with as many terms as the estimate has.
    pub problem: &'a Problem<'a>,
    /// The same without error curves.
    pub rigid: &'a Problem<'a>,
    /// Base and tool registered with nominal links.
    pub nominal: State,
    /// The estimate.
    pub found: Estimate,
    /// Error curves that the problem's rows were predicted with.
    pub curves: Vec<ErrorCurve>,
    /// Held-out residuals of every row.
    pub held_out: Vec<Option<Residual>>,
    /// The same from folds that are blocks in time.
    pub blocked: Option<Vec<Option<Residual>>>,
    /// How they were held out.
    pub cross_validation: String,
}

impl Findings<'_> {
    /// Model, figures and what became of each row.
    #[must_use]
    pub fn summarise(&self) -> Identification {
        let results = self.row_results();
        let factorised = self.factorised();
        let figures = self.figures(&results, &factorised);
        let links = factorised.penalised();
        Identification { model: self.model(&figures), figures, rows: results, links }
    }

    fn figures(&self, results: &[RowResult], factorised: &Factorised) -> Figures {
        let Self { robot, problem, found, held_out, .. } = self;
        let data = problem.data;
        let prior = Problem { scaling: Scaling::Prior, ..(*problem).clone() };
        let geometry = problem.with_terms(0);
        let mut redundancy = redundancy::analyse(&geometry, &self.nominal, &found.robust.kept);
        if scale::is_open(problem, &self.nominal) {
            // Where residuals are not zero it shows as weak only.
            redundancy.rank -= 1;
            redundancy.redundant.insert(0, scale::SCALE_OPEN.to_owned());
        }
        let own = |cv: &[Option<Residual>]| lengths(judged(results, cv));
        let flags: Vec<FlaggedRow> =
            found.robust.outliers.iter().map(|o| flagged_row(data, o)).collect();
        Figures {
            robot: robot.name.clone(),
            data: data.files(),
            rows: data.rows.len(),
            poses: data.poses,
            stations: data.stations.clone(),
            markers: data.markers.clone(),
            parameters: problem.unknowns.list().len(),
            rank: redundancy.rank + found.fit.state.terms.len(),
            condition_number: redundancy.condition,
            condition_number_raw: redundancy.condition_raw.into(),
            lambda: found.lambda,
            lambda_rule: self.rule.name(),
            lambda_scaling: match problem.scaling {
                Scaling::Prior => "prior",
                Scaling::Printed => "printed",
            },
            lambda_choice: found.choice.clone(),
            l_curve: l_curve(factorised, problem.equations(&found.robust.kept), found.lambda),
            correction_norm: prior.corrections(&found.fit.state).norm(),
            largest_correction: prior.corrections(&found.fit.state).amax(),
            residual_over_sigma: found.robust.scale * problem.noise.largest(data),
            nominal: stats(results, false, |r| r.nominal),
            identified: stats(results, false, |r| r.identified),
            cross_validated: own(held_out),
            cross_validation: self.cross_validation.clone(),
            cross_validated_blocked: self.blocked.as_ref().and_then(|b| own(b)),
            rows_not_cross_validated: without(held_out, &problem.counted()),
            all_rows: AllRows {
                nominal: stats(results, true, |r| r.nominal),
                identified: stats(results, true, |r| r.identified),
                cross_validated: lengths(held_out.iter().flatten().copied()),
            },
            drawn: None,
            outlier_rows: flags.iter().map(|f| f.row).collect(),
            outliers: flags,
            unidentifiable: redundancy.redundant,
            weakly_determined: redundancy.weak,
            uncertainty: uncertainty(problem, found, &self.covariances()),
            kinds: noise_estimate::figures(problem, results),
            left_open: noise_estimate::left_open(data),
            orientation_identified: orientation_identified(problem, found, &self.covariances()),
            warnings: remarks::of(robot, problem, found.robust.scale),
        }
    }

    /// The problem at the fit, for every lambda.
    fn factorised(&self) -> Factorised {
        let Self { problem, found, .. } = self;
        let factorise = || {
            let triangle = problem.linearise(&found.fit.state).triangle(&found.robust.kept, None);
            Factorised::new(&triangle, problem.unknowns.free())
        };
        found.solved.clone().unwrap_or_else(factorise)
    }

    fn row_results(&self) -> Vec<RowResult> {
        let before = self.rigid.linearise(&self.nominal);
        let after = self.problem.linearise(&self.found.fit.state);
        // Copies of a row are what it is.
        let first = self.problem.data.first_of_copies();
        let mut flagged = vec![false; first.len()];
        self.found.robust.outliers.iter().for_each(|o| flagged[o.row] = true);
        (0..first.len())
            .into_par_iter()
            .map(|row| RowResult {
                nominal: before.residual(row),
                identified: after.residual(row),
                held_out: self.held_out[row],
                flagged: flagged[first[row]],
            })
            .collect()
    }

    fn model(&self, figures: &Figures) -> Model {
        let Self { robot, problem, found, .. } = self;
        let data = problem.data;
        let state = &found.fit.state;
        let unknowns = self.covariances().total();
        let sigma: Vec<f64> = unknowns.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
        let at = |i: usize| problem.unknowns.free() + 5 * i;
        let uncertainties = (0..robot.joints.len())
            .map(|i| MdhParameters::from_array(core::array::from_fn(|k| sigma[at(i) + k])));
        let frame = robot_frame(problem, found);
        let covariance = of_arm(problem, state, &found.robust.kept, &unknowns, &frame);
        // Not by the arc cosine of a trace, which rounding takes beyond 3.
        let turn = frame.rotation_vector();
        let stations = data.stations.iter().cloned().zip(state.bases.iter().copied());
        let markers = data.markers.iter().cloned().zip(state.markers.iter().copied());
        Model {
            robot: (*robot).clone(),
            corrections: link_corrections(state, &problem.nominal),
            uncertainties: uncertainties.collect(),
            covered: data.covered().into_iter().map(Some).collect(),
            terms: state.terms.clone(),
            curves: self.curves.clone(),
            stations: stations.collect(),
            markers: markers.collect(),
            not_measured: tool::not_measured(data),
            instruments: instruments(problem, state, &unknowns),
            frame_translation: frame.translation,
            frame_rotation: turn,
            orientation_identified: figures.orientation_identified,
            robot_id: None,
            covariance: Some(factor(&covariance)),
            changed: false,
            gram: None,
            provenance: provenance(figures),
            unidentifiable: [figures.unidentifiable.clone(), figures.weakly_determined.clone()]
                .concat(),
        }
    }

    /// Covariance of all unknowns, from noise and from regularisation.
    #[must_use]
    pub fn covariances(&self) -> Covariances {
        Covariances::of(self.problem, &self.found, spread(self.rule, self.found.lambda))
    }
}

fn stats(results: &[RowResult], all: bool, of: fn(&RowResult) -> Residual) -> Option<Stats> {
    lengths(results.iter().filter(|r| all || !r.flagged).map(of))
}

/// Rows that were left without a prediction.
fn without(held_out: &[Option<Residual>], rows: &[usize]) -> usize {
    rows.iter().filter(|row| held_out[**row].is_none()).count()
}

/// Of those that say how far off something is.
fn lengths(residuals: impl Iterator<Item = Residual>) -> Option<Stats> {
    Stats::of(residuals.filter(Residual::is_length))
}

fn provenance(figures: &Figures) -> Provenance {
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        created: humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string(),
        sequence: None,
        data: figures.data.clone(),
        rows: figures.rows,
        poses: figures.poses,
        outlier_rows: figures.outlier_rows.clone(),
        lambda: figures.lambda,
        lambda_rule: figures.lambda_rule.to_owned(),
        nominal_rms_mm: figures.nominal.map_or(0.0, |s| s.rms_mm),
        cross_validated_rms_mm: figures.cross_validated.map_or(0.0, |s| s.rms_mm),
        tool_point_mm: Some(figures.uncertainty.tool_point.rms_mm),
    }
}

/// Held-out residuals that count: a row is left out only if it is flagged and
/// its own held-out residual is beyond 10 robust standard deviations.
fn judged<'r>(
    results: &'r [RowResult],
    held_out: &'r [Option<Residual>],
) -> impl Iterator<Item = Residual> + 'r {
    let distances: Vec<f64> = held_out.iter().flatten().map(|r| r.norm()).collect();
    let limit = 10.0 * robust_distance_scale(&distances);
    let counts = move |(row, r): &(&RowResult, Residual)| !(row.flagged && r.norm() > limit);
    let rows = results.iter().zip(held_out).filter_map(|(row, r)| Some((row, (*r)?)));
    rows.filter(counts).map(|(_, r)| r)
}

fn flagged_row(data: &Measurements, outlier: &robust::Outlier) -> FlaggedRow {
    FlaggedRow {
        row: outlier.row + 1,
        file: data.file_of(outlier.row).display().to_string(),
        line: data.rows[outlier.row].line,
        coordinates: outlier.components.clone(),
        residual_mm: outlier.residual.in_files(),
    }
}

/// Poses that must have said how the last frame is turned.
const TURNED: usize = 6;

/// Whether the data say how the last frame is turned, up to how the marker sits
/// on it: at every pose that they say something of, better than a tolerance.
/// Points say nothing of it. A turn of all poses together is left out: it is how the arm stands
/// in the frame of the station, which nothing may tell, and commanded poses refer to the arm.
fn orientation_identified(problem: &Problem, found: &Estimate, of: &Covariances) -> bool {
    let at = problem.linearise(&found.fit.state);
    let turning = |row: &&usize| kind(&problem.data.rows[**row]).turns();
    let rows: Vec<&usize> = found.robust.kept.iter().filter(turning).collect();
    let mut poses: Vec<usize> = rows.iter().map(|row| problem.data.rows[**row].pose).collect();
    poses.sort_unstable();
    poses.dedup();
    if poses.len() < TURNED {
        return false;
    }
    let mut common = DMatrix::zeros(3, problem.unknowns.list().len());
    rows.iter().for_each(|row| common += at.turn(**row));
    common /= rows.len() as f64;
    let sigma = |row: &&usize| of.of_predicted(&(at.turn(**row) - &common))[1].amax();
    rows.iter().map(sigma).all(|sigma| sigma < TOLERANCE_ANGLE)
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
    frame_between(&points(&state.links), &points(&problem.nominal))
}
