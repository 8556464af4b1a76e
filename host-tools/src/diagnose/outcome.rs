//! What a diagnosis found: the figures of the final model, and what it names.

use schemars::JsonSchema;
use serde::Serialize;

use super::described::Described;
use super::effect::Effect;
use super::policy::POLICY;
use crate::identify::Figures;
use crate::observations::Measure;

/// The verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Geometry alone leaves nothing but noise.
    Clean,
    /// The model leaves nothing that has a name.
    Explained,
    /// Structure is left that no effect of the repertoire explains.
    Unexplained,
}

/// A line of the gap table.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GapRow {
    /// `nominal`, `geometry`, `+ joint-compliance`...
    pub model: String,
    /// RMS of the fitted rows, flagged ones left out, mm.
    pub train_rms_mm: f64,
    /// RMS of poses held out in folds, mm.
    pub cross_validated_rms_mm: Option<f64>,
    /// RMS of the hold-out file, mm.
    pub holdout_rms_mm: Option<f64>,
    /// RMS of the kept rows in standard deviations, each kind's by the noise that was
    /// found of it: 1 where normal noise alone is left, more where it has tails, of which
    /// `noise_scale` is the middle.
    pub train_rms_sigmas: f64,
    /// The same of poses held out in folds.
    pub cross_validated_rms_sigmas: Option<f64>,
    /// The same of the hold-out file.
    pub holdout_rms_sigmas: Option<f64>,
}

/// Rows of the hold-out file that stand out from the final model, by more than ten robust
/// standard deviations of its rows.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct HoldOut {
    /// The file.
    pub file: String,
    /// Its rows.
    pub rows: usize,
    /// The worst, at most 1 % of them, counted from 1: left out of its figures.
    pub left_out: Vec<usize>,
    /// The others, counted from 1: in its figures.
    pub standing_out: Vec<usize>,
    /// RMS of the final model with those that are left out, mm.
    pub all_rows_rms_mm: f64,
    /// The same in standard deviations of each kind's noise.
    pub all_rows_rms_sigmas: f64,
}

/// By so much more a model may miss poses that no fit saw than less of a model does, before it
/// is said: no study set it.
const WORSE: f64 = 1.03;

/// Poses that no fit saw are missed by more than with less of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worse {
    /// RMS of the model, mm.
    pub rms_mm: f64,
    /// The same of less of it, mm.
    pub less_mm: f64,
    /// Which is the drawn arm, not geometry alone.
    pub drawn: bool,
}

/// Of poses held out in folds and of the hold-out file.
#[must_use]
pub fn worse(gap: &[GapRow]) -> [Option<Worse>; 2] {
    let (Some(drawn), Some(geometry), Some(last)) = (gap.first(), gap.get(1), gap.last()) else {
        return [None; 2];
    };
    // The drawn arm is fitted to nothing.
    let crossed = |row: &GapRow| row.cross_validated_rms_mm.or(Some(row.train_rms_mm));
    let held_out = |row: &GapRow| row.holdout_rms_mm;
    [crossed as fn(&GapRow) -> Option<f64>, held_out].map(|of| {
        let (rms_mm, drawn, geometry) = (of(last)?, of(drawn)?, of(geometry)?);
        let less = [(drawn, true), (geometry, false)];
        let (less_mm, drawn) = less.into_iter().find(|(less, _)| rms_mm > WORSE * less)?;
        Some(Worse { rms_mm, less_mm, drawn })
    })
}

/// How far off residuals are, root mean square.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rms {
    /// mm; of what is no length as [`crate::observations::Kind::miss`] counts it.
    pub mm: f64,
    /// Standard deviations of an equation.
    pub sigmas: f64,
}

impl GapRow {
    /// Of a model.
    #[must_use]
    pub fn new(model: String, train: Rms, folds: Option<Rms>, holdout: Option<Rms>) -> Self {
        Self {
            model,
            train_rms_mm: train.mm,
            cross_validated_rms_mm: folds.map(|r| r.mm),
            holdout_rms_mm: holdout.map(|r| r.mm),
            train_rms_sigmas: train.sigmas,
            cross_validated_rms_sigmas: folds.map(|r| r.sigmas),
            holdout_rms_sigmas: holdout.map(|r| r.sigmas),
        }
    }
}

/// What the gap counts in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GapUnit {
    /// Where one kind measured lengths.
    Millimetres,
    /// Where kinds, or lengths and angles, count together: each in standard deviations
    /// of its own noise.
    Deviations,
}

impl GapUnit {
    /// Fitted rows, rows held out in folds, hold-out file.
    #[must_use]
    pub fn figures(self, row: &GapRow) -> [Option<f64>; 3] {
        match self {
            Self::Millimetres => {
                [Some(row.train_rms_mm), row.cross_validated_rms_mm, row.holdout_rms_mm]
            }
            Self::Deviations => {
                [Some(row.train_rms_sigmas), row.cross_validated_rms_sigmas, row.holdout_rms_sigmas]
            }
        }
    }

    /// What its figures are.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Millimetres => "RMS error, mm",
            Self::Deviations => "RMS error, standard deviations of each kind's noise",
        }
    }
}

impl Outcome {
    /// Whether poses that no fit saw are missed by more than with less of a model.
    #[must_use]
    pub fn is_worse_elsewhere(&self) -> bool {
        worse(&self.gap).iter().any(Option::is_some)
    }

    /// What is left of the kind that is farthest beyond its stated noise, over that.
    fn times_stated(&self) -> f64 {
        let left = self.gap.last().map_or(1.0, |last| last.train_rms_sigmas.max(1.0));
        let kinds = self.figures.kinds.iter().map(|kind| kind.noise_scale);
        left * kinds.fold(self.noise_scale, f64::max)
    }

    /// Whether what is left may be called noise: poses do not miss by more than their repeats
    /// scatter, and rows of no kind by more than any instrument is misstated by.
    #[must_use]
    pub fn leaves_noise(&self) -> bool {
        self.beyond_repeats.is_none() && self.times_stated() <= POLICY.beyond_stated
    }

    /// What else it is, in words.
    #[must_use]
    pub fn what_is_left(&self) -> String {
        match self.beyond_repeats {
            Some(times) => {
                format!("has no name: poses are off by {times:.1} times what their repeats scatter")
            }
            None => format!("has no name: it is {:.1} times the stated noise", self.times_stated()),
        }
    }

    /// What its gap is told in.
    #[must_use]
    pub fn gap_unit(&self) -> GapUnit {
        match &self.figures.kinds[..] {
            [] => GapUnit::Millimetres,
            [only] if only.unit == Measure::Length.unit() => GapUnit::Millimetres,
            _ => GapUnit::Deviations,
        }
    }
}

/// Another explanation that the data cannot rule out.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Alternative {
    /// Its effects: name and joints.
    pub effects: Vec<(&'static str, Vec<usize>)>,
    /// Where links grow: the time constant with which the arm then follows the temperature
    /// that was read, s; none where it does at once.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_constant_s: Option<f64>,
    /// How much worse it is: -2 ln of its odds to the named one, in units of
    /// chi-square.
    pub worse_by: f64,
    /// Poses that would tell the two apart best, degrees (mm for prismatic
    /// joints), each with the distance of the two predictions in mm; none where the two
    /// differ in how late the arm follows its temperature.
    pub separating_poses: Vec<SeparatingPose>,
}

impl Alternative {
    /// Whether poses tell it from the model: one that differs in how late the arm follows its
    /// temperature is told by when they are measured.
    #[must_use]
    pub fn is_told_by_poses(&self) -> bool {
        !self.separating_poses.is_empty()
    }
}

/// A pose to measure next.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SeparatingPose {
    /// Joint values, degrees or mm.
    pub joints: Vec<f64>,
    /// Distance between the predictions of the two explanations, mm.
    pub difference_mm: f64,
}

/// What a diagnosis found.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Outcome {
    /// Figures of the final model.
    #[serde(flatten)]
    pub figures: Figures,
    /// The verdict.
    pub verdict: Verdict,
    /// What was found, most important first: a probability of 0.9 and more, and
    /// both halves of the poses agree.
    pub effects: Vec<Effect>,
    /// What the model has besides: less probable, or something speaks against the name
    /// (`doubt`).
    pub suspected: Vec<Effect>,
    /// Structure without a name that is left, in words, strongest first.
    pub unnamed: Vec<String>,
    /// What of it is a part of the cell that errs with something recorded, surest first.
    pub described: Vec<Described>,
    /// Noise over the stated standard deviation; of several kinds the middle of theirs,
    /// each counted by its equations: the geometric mean of `noise_scale` of `kinds`.
    pub noise_scale: f64,
    /// How many times farther off poses are than their repeats scatter, where that is many:
    /// most of what is left then returns with the pose.
    pub beyond_repeats: Option<f64>,
    /// RMS of held-out poses when everything is decided anew without each fold,
    /// the choice of effects included, mm.
    pub nested_rms_mm: Option<f64>,
    /// From nominal to the final model.
    pub gap: Vec<GapRow>,
    /// What stands out in the hold-out file, where one was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hold_out: Option<HoldOut>,
    /// 3-D RMS of a perfect model by the stated standard deviations, mm.
    pub noise_floor_mm: f64,
    /// Chi-square over degrees of freedom of the final model, by the noise that
    /// was found.
    pub reduced_chi_square: f64,
    /// The same of geometry alone.
    pub geometry_reduced_chi_square: f64,
    /// Explanations within reach of each other.
    pub alternatives: Vec<Alternative>,
    /// Effects that need a column or key the data do not have.
    pub not_testable: Vec<String>,
    /// Where the residuals of the geometric fit are.
    #[serde(rename = "where")]
    pub whereabouts: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(train: f64, crossed: Option<f64>, held: Option<f64>) -> GapRow {
        GapRow {
            model: String::new(),
            train_rms_mm: train,
            cross_validated_rms_mm: crossed,
            holdout_rms_mm: held,
            train_rms_sigmas: 1.0,
            cross_validated_rms_sigmas: None,
            holdout_rms_sigmas: None,
        }
    }

    #[test]
    fn less_of_a_model_is_better_where_poses_are_missed_by_more() {
        let drawn = row(2.0, None, Some(2.1));
        let geometry = row(0.5, Some(0.6), Some(0.7));
        let of = |last: GapRow| worse(&[drawn.clone(), geometry.clone(), last]);
        let told = |of: Option<Worse>| of.map(|w| (w.less_mm, w.drawn));
        assert_eq!(of(row(0.1, Some(0.2), Some(0.71))), [None, None]);
        let [crossed, held] = of(row(0.1, Some(0.2), Some(1.2))).map(told);
        assert_eq!((crossed, held), (None, Some((0.7, false))));
        let [crossed, held] = of(row(0.1, Some(0.65), Some(2.3))).map(told);
        assert_eq!((crossed, held), (Some((0.6, false)), Some((2.1, true))));
        // Wrong rows of a few: geometry alone is worse than none.
        let few = [row(1.6, None, None), row(0.3, Some(2.1), None)];
        assert_eq!(worse(&few).map(told), [Some((1.6, true)), None]);
        assert_eq!(worse(&few[..1]), [None, None]);
    }
}
