use nalgebra::{DMatrix, DVector};
use truearm::MdhParameters;

use super::part::{FoldSums, Part};
use super::{LAST, NEAR, state};
use crate::error::{Error, ErrorKind, Result};
use crate::identify::certainty::carried::Carried;
use crate::identify::certainty::covariance::{factor, of_arm_by};
use crate::identify::certainty::unknowns::{Covariances, spread};
use crate::identify::fit::robust::Flags;
use crate::identify::fit::suspects::MOST_FLAGGED;
use crate::identify::fit::{ANOTHER_ARM, LambdaRule, lambda_of};
use crate::identify::{Problem, State, Target, firmness, link_corrections, spreads};
use crate::model::{GramState, Model, Provenance};
use crate::tikhonov::{HELD, Normal};

/// A step below this many tolerances is no step: the end is known far better then, by how
/// fast steps become small.
const SETTLED: f64 = 1e-9;

/// From this lambda on it holds the links by itself...
const FIRM: f64 = 1e-3;
/// ...and steps of base and target are held by this share of it at most, ...
const LIGHTER: f64 = 1e-3;
/// ...but for this share of their own diagonal: a thousand times what is lost to rounding.
const ROUNDING: f64 = 1e-13;

/// The next state, and what is known of this one.
#[derive(Debug, Clone)]
pub struct Step {
    /// The state to accumulate at next, or the identified arm.
    pub model: Model,
    /// Largest step of an unknown, in tolerances.
    pub largest: f64,
    /// Root mean square of the distances left at the state that the parts are of, mm; weighed
    /// by 1/sigma^2. `None` in the first round.
    pub rms_mm: Option<f64>,
    /// The same of poses held out.
    pub cross_validated_rms_mm: Option<f64>,
    /// Whether the scale of the residuals and lambda stay as they are from here on.
    pub(super) steady: bool,
    /// Of each fold the step to what the others lead to, in units; `None` where they lead
    /// nowhere.
    pub(super) held_out: Vec<Option<DVector<f64>>>,
}

/// Solves a round.
///
/// # Errors
/// Parts of another state, no row that counts, and equations that do not lead anywhere.
pub fn step(model: &Model, part: &Part) -> Result<Step> {
    if part.state != state::digest(model) {
        return Err(Error::data(
            ErrorKind::OtherArm,
            "the parts were not accumulated at this state",
            "accumulate them with the STATE that is given here",
        ));
    }
    let unknowns = state::problem(model, &state::no_rows(model)).unknowns.list().len();
    let turns = model.stations.len() * model.markers.len();
    if part.shape() != [unknowns, model.robot.joints.len(), turns] {
        return Err(Error::data(
            ErrorKind::OtherArm,
            "the parts have other unknowns than this state",
            "accumulate them with the STATE that is given here",
        ));
    }
    let scale = |digits: f64| (part.residuals.scale().max(1.0) * digits).round() / digits;
    // Three digits: how rows are split must not matter.
    let k = scale(if part.residuals.scale() < 10.0 { 100.0 } else { 1.0 });
    let Some(gram) = &model.gram else {
        let mut next = model.clone();
        next.gram = Some(GramState {
            stage: 1,
            settled: false,
            step: None,
            k,
            weights: Flags::default().limit(k) * k,
            flagged: 0,
            targets: state::places(model),
        });
        return Ok(Step {
            model: next,
            largest: 0.0,
            rms_mm: None,
            cross_validated_rms_mm: None,
            steady: false,
            held_out: Vec::new(),
        });
    };
    if part.folds.iter().all(|fold| fold.rows == 0) {
        return Err(Error::contradiction(part.flagged as usize, part.rows as usize));
    }
    let data = state::no_rows(model);
    let mut problem = state::problem(model, &data);
    let places = state::places(model);
    let spreads = spreads(&part.turns, places.len(), &|_| false);
    let target = |(spread, place)| Target { place, firmness: firmness(spread) };
    problem.targets = spreads.iter().zip(places).map(target).collect();
    let at = state::state(model);
    let round = Round { problem: &problem, at: &at, part, model };
    round.solved(gram, k)
}

/// Whether the scale of the residuals and lambda stay as they are.
fn steady(gram: &GramState) -> bool {
    gram.step.is_some_and(|step| step < NEAR) || gram.stage >= LAST
}

/// A round after the first.
struct Round<'a> {
    problem: &'a Problem<'a>,
    at: &'a State,
    part: &'a Part,
    model: &'a Model,
}

impl Round<'_> {
    fn solved(&self, gram: &GramState, k: f64) -> Result<Step> {
        let whole = self.part.whole();
        let lambda = self.lambda(gram, &whole);
        let targets = Normal::new(&self.problem.of_targets(self.at));
        let far = || {
            Error::data(
                ErrorKind::NotConverged,
                "the parts do not lead to an arm",
                "begin with `truearm identify` of more rows, which says why it fails",
            )
        };
        let solve = |normal: Normal| self.solve(&normal.plus(&targets), lambda).ok_or_else(far);
        let x = solve(whole.clone())?;
        let corrections = self.problem.corrections(self.at) + &x;
        if !corrections.iter().all(|c| c.is_finite()) || corrections.amax() > ANOTHER_ARM {
            return Err(far());
        }
        let folds = &self.part.folds;
        let without = |fold: &FoldSums| solve(whole.minus(&fold.normal)?).ok();
        let held_out: Vec<Option<DVector<f64>>> = folds.iter().map(without).collect();
        let judged = folds.iter().zip(&held_out).filter(|(fold, _)| fold.rows > 0);
        let square = |(fold, x): (&FoldSums, &Option<DVector<f64>>)| {
            x.as_ref().map_or(f64::NAN, |x| residual_square(&fold.normal, x))
        };
        let square: f64 = judged.map(square).sum();
        let precision: f64 = folds.iter().map(|fold| fold.precision).sum();
        let mm = |square: f64| (square / precision).sqrt() * 1e3;
        let largest = x.amax();
        let steady = steady(gram);
        // As `identify` does, once it is known which rows do not fit.
        if steady && self.part.flagged as f64 > MOST_FLAGGED * self.part.rows as f64 {
            return Err(Error::contradiction(self.part.flagged as usize, self.part.rows as usize));
        }
        let gram = GramState {
            stage: gram.stage.saturating_add(1),
            settled: steady && largest < SETTLED,
            step: Some(largest),
            k: if steady { gram.k } else { k },
            weights: if steady { gram.weights } else { Flags::default().limit(k) * k },
            flagged: self.part.flagged as usize,
            targets: state::places(self.model),
        };
        let cross_validated_rms_mm = Some(mm(square)).filter(|rms| rms.is_finite());
        let model = self.next((&whole, lambda), &x, gram, cross_validated_rms_mm);
        let rms_mm = Some(mm(whole.s().max(0.0)));
        Ok(Step { model, largest, rms_mm, cross_validated_rms_mm, steady, held_out })
    }

    /// Lambda of this round. Two digits: how rows are split must not matter.
    fn lambda(&self, gram: &GramState, whole: &Normal) -> f64 {
        let known = &self.model.provenance;
        let anew = known.lambda_rule == LambdaRule::MaximumLikelihood.name();
        if steady(gram) || !anew {
            return known.lambda;
        }
        // Corrections are counted from nominal there.
        let x = self.problem.corrections(self.at);
        let normal = whole.recounted(&DVector::repeat(x.len(), 1.0), &-x);
        let found = lambda_of(LambdaRule::MaximumLikelihood, &normal, self.problem.unknowns.free());
        found.map_or(known.lambda, |lambda| {
            let unit = 10_f64.powf(lambda.log10().floor() - 1.0);
            (lambda / unit).round() * unit
        })
    }

    /// The step that these equations about the state lead to.
    fn solve(&self, normal: &Normal, lambda: f64) -> Option<DVector<f64>> {
        let (free, x) = (self.problem.unknowns.free(), self.problem.corrections(self.at));
        let (mut h, mut right) = (normal.h().into_owned(), normal.g());
        let least = h.diagonal().max() * HELD * HELD;
        // What holds steps of base and target holds, where only lambda tells them from the links,
        // those of links, too: of millions of rows by as much as lambda does, and then each step
        // goes half of the way.
        let held = |h: f64| match lambda >= FIRM {
            true => (HELD * h).min((LIGHTER * lambda).max(ROUNDING * h)),
            false => HELD * h,
        };
        for k in 0..x.len() {
            if k < free {
                h[(k, k)] += held(h[(k, k)].max(least));
            } else {
                h[(k, k)] += lambda;
                right[k] -= lambda * x[k];
            }
        }
        Some(h.cholesky()?.solve(&right))
    }

    fn next(
        &self,
        (whole, lambda): (&Normal, f64),
        x: &DVector<f64>,
        gram: GramState,
        cross_validated: Option<f64>,
    ) -> Model {
        let Self { problem, at, part, model } = self;
        let columns = &problem.unknowns;
        let state = at.stepped(columns, &x.component_mul(&problem.units()));
        let rule = LambdaRule::ALL.into_iter().find(|r| r.name() == model.provenance.lambda_rule);
        let spread = spread(rule.unwrap_or(LambdaRule::Fixed(lambda)), lambda);
        // About the state the right-hand sides are residuals.
        let carried = Carried::of_sums(whole, &DVector::zeros(whole.unknowns()));
        let of = Covariances::of_sums(problem, &state, (whole, &carried), (lambda, spread));
        let unknowns = of.total();
        let sigma = |i: usize, k: usize| {
            let column = columns.free() + 5 * i + k;
            unknowns[(column, column)].max(0.0).sqrt()
        };
        let uncertainties = (0..problem.nominal.len())
            .map(|i| MdhParameters::from_array(core::array::from_fn(|k| sigma(i, k))));
        let frame = part.points.frame();
        let known = |label: &String| model.markers.iter().position(|(own, _)| own == label);
        let marker = model.tool_marker().and_then(|(label, _)| known(label));
        let covariance: DMatrix<f64> = of_arm_by(problem, &state, &part.frame, marker, &unknowns);
        let known = &model.provenance;
        Model {
            corrections: link_corrections(&state, &problem.nominal),
            uncertainties: uncertainties.collect(),
            covered: part.covered.iter().copied().map(Some).collect(),
            terms: state.terms,
            stations: labelled(&model.stations, state.bases),
            markers: labelled(&model.markers, state.markers),
            frame_translation: frame.translation,
            frame_rotation: frame.rotation_vector(),
            covariance: Some(factor(&covariance)),
            changed: false,
            provenance: Provenance {
                version: env!("CARGO_PKG_VERSION").to_owned(),
                created: humantime::format_rfc3339_seconds(std::time::SystemTime::now())
                    .to_string(),
                data: crate::error::count(part.files as usize, "file") + " by parts",
                rows: part.rows as usize,
                poses: part.poses as usize,
                outlier_rows: Vec::new(),
                lambda,
                cross_validated_rms_mm: cross_validated.unwrap_or(known.cross_validated_rms_mm),
                ..known.clone()
            },
            gram: Some(gram),
            ..(*model).clone()
        }
    }
}

fn labelled<T, U>(known: &[(String, T)], now: Vec<U>) -> Vec<(String, U)> {
    known.iter().map(|(label, _)| label.clone()).zip(now).collect()
}

/// `|A x - b|^2`
fn residual_square(normal: &Normal, x: &DVector<f64>) -> f64 {
    normal.s() - 2.0 * normal.g().dot(x) + (x.transpose() * normal.h() * x)[0]
}
