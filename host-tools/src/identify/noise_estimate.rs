//! Noise of each kind of measurement, as its own residuals have it (variance
//! components), and how far off each kind is.

use schemars::JsonSchema;
use serde::Serialize;

use super::RowResult;
use super::kind_figures::KindFigures;
use super::problem::{Problem, Scaling};
use crate::error::{Error, ErrorKind, Result};
use crate::identify::fit::robust::{Flags, Outlier, robust_fit};
use crate::identify::problem::{Group, Noise, State, groups};
use crate::model::{KindId, Measurements, Row};
use crate::observations::{KINDS, Residual, kind};
use crate::tikhonov::covariance;

/// Rounds of estimates, and the change of a scale that ends them.
const ROUNDS: usize = 12;
const SETTLED: f64 = 0.01;
/// Standard deviation of the logarithm of a scale, as it is believed beforehand: noise is
/// stated within a factor of two at best. A kind of two rows says little of its own
/// noise; many rows are believed though they were stated a hundred times too coarse.
const BELIEVED: f64 = std::f64::consts::LN_2;
/// Scales beyond this, either way, are another mistake.
const BOUNDS: [f64; 2] = [1e-3, 1e3];

/// The noise of every kind where there are several; of one kind alone the fit
/// scales its own.
///
/// # Errors
/// As for [`robust_fit`].
pub fn noise(problem: &Problem, rows: &[usize], start: &State) -> Result<Noise> {
    let groups = groups(problem.data);
    let mut noise = Noise::default();
    if groups.len() < 2 {
        return Ok(noise);
    }
    let mut start = start.clone();
    for _ in 0..ROUNDS {
        let scaled = Problem { noise, scaling: Scaling::Prior, ..problem.clone() };
        let found = robust_fit(&scaled, rows, &start, Flags::default())?;
        start = found.fit.state.clone();
        let at = scaled.linearise(&found.fit.state);
        let cov = covariance(&found.fit.normal, scaled.unknowns.free(), 1.0);
        let mut sums = vec![[0.0; 2]; groups.len()];
        for index in &found.kept {
            let e = at.equations(*index);
            let (residual, weighed) = (e.scaled_residual(), &e.block * &cov);
            for (sum, group) in sums.iter_mut().zip(&groups) {
                for c in group.components(&problem.data.rows[*index]) {
                    sum[0] += residual[c].powi(2);
                    sum[1] += 1.0 - weighed.row(c).dot(&e.block.row(c));
                }
            }
        }
        let mut moved = 0.0_f64;
        for ([squares, freedom], group) in sums.iter().zip(&groups) {
            let old = noise.of(group.kind, group.measure);
            let new = most_probable(squares * old * old, freedom.max(0.0));
            moved = moved.max((new / old).ln().abs());
            *noise.scale_mut(*group) = new;
        }
        if moved < SETTLED {
            break;
        }
    }
    Ok(noise)
}

/// The scale of a kind's noise of the largest posterior, by the sum of squares of its
/// residuals in stated sigmas and how many of them are free: the root `u = ln k` of
/// `freedom - squares exp(-2 u) + u / BELIEVED^2`, which rises with u.
fn most_probable(squares: f64, freedom: f64) -> f64 {
    let [mut low, mut high] = BOUNDS.map(f64::ln);
    for _ in 0..HALVINGS {
        let u = 0.5 * (low + high);
        match freedom - squares * (-2.0 * u).exp() + u / BELIEVED.powi(2) < 0.0 {
            true => low = u,
            false => high = u,
        }
    }
    (0.5 * (low + high)).exp()
}

/// Enough for twelve digits.
const HALVINGS: usize = 44;

/// Root mean square of the components of a group over some residuals, in the
/// unit of files; `None` of none.
fn rms<'r>(group: Group, all: impl Iterator<Item = (&'r Row, Residual)>) -> Option<f64> {
    let (mut count, mut square) = (0.0, 0.0);
    for (row, residual) in all {
        let values: Vec<f64> = group.components(row).map(|c| residual[c]).collect();
        if !values.is_empty() {
            count += 1.0;
            square += values.iter().map(|v| v * v).sum::<f64>();
        }
    }
    (count > 0.0).then(|| group.measure.to_file((square / f64::max(count, 1.0)).sqrt()))
}

/// How far off each kind is; flagged rows do not count.
#[must_use]
pub fn figures(problem: &Problem, results: &[RowResult]) -> Vec<KindFigures> {
    let data = problem.data;
    let used = || data.rows.iter().zip(results).filter(|(_, r)| !r.flagged);
    let figures = |group: Group| {
        let known = KINDS[usize::from(group.kind.0)];
        let mine = |row: &&Row| group.components(row).next().is_some();
        KindFigures {
            kind: known.name(),
            unit: group.measure.unit(),
            rows: data.rows.iter().filter(mine).count(),
            nominal_rms: rms(group, used().map(|(row, r)| (row, r.nominal))),
            identified_rms: rms(group, used().map(|(row, r)| (row, r.identified))),
            cross_validated_rms: rms(group, used().filter_map(|(row, r)| Some((row, r.held_out?)))),
            noise_scale: problem.noise.of(group.kind, group.measure),
        }
    };
    groups(data).into_iter().map(figures).collect()
}

/// A kind of a file that was not fitted.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct KindScore {
    /// Its name.
    pub kind: &'static str,
    /// `mm`, `deg` or `px`.
    pub unit: &'static str,
    /// Root mean square with the nominal geometry, registered on the file.
    pub nominal_rms: Option<f64>,
    /// The same of the model.
    pub rms: Option<f64>,
}

/// How far off each kind is, by nominal geometry and by a model, without rows that are
/// left out.
#[must_use]
pub fn scores(
    data: &Measurements,
    nominal: &[Residual],
    found: &[Residual],
    without: &[usize],
) -> Vec<KindScore> {
    let of = |group: Group, all: &[Residual]| {
        let rows = data.rows.iter().zip(all).enumerate();
        let kept = rows.filter(|(i, _)| !without.contains(i));
        rms(group, kept.map(|(_, (row, r))| (row, *r)))
    };
    let score = |group: Group| KindScore {
        kind: KINDS[usize::from(group.kind.0)].name(),
        unit: group.measure.unit(),
        nominal_rms: of(group, nominal),
        rms: of(group, found),
    };
    groups(data).into_iter().map(score).collect()
}

/// Most rows of a kind that are gross errors one by one; of more it is the kind that
/// contradicts the others, or what it was measured with.
const MOST_LOST: f64 = 0.5;
/// So few rows of a kind may all be gross errors.
const FEW: usize = 3;

/// What to do where rows contradict the rest.
const NO_GROSS_ERRORS: &str = "so many are no gross errors: check the units and coordinates in \
                               instruments.toml (inches are 25.4 mm), and the labels of the rows";

/// That no kind is as far off as before it was fitted, its noise being as large as is
/// believed at most: a kind whose sigma alone is wrong is described all the same.
///
/// # Errors
/// [`ErrorKind::Contradiction`], naming the kind.
pub fn none_is_given_up(problem: &Problem, kinds: &[KindFigures]) -> Result<()> {
    /// Rounding.
    const NEARLY: f64 = 0.999;
    /// Of what it was off.
    const DESCRIBED: f64 = 0.5;
    let given_up = |k: &&KindFigures| {
        let [before, after] = [k.nominal_rms, k.identified_rms].map(|rms| rms.unwrap_or(0.0));
        k.noise_scale > NEARLY * BOUNDS[1] && after > DESCRIBED * before
    };
    match kinds.iter().find(given_up) {
        None => Ok(()),
        Some(kind) => Err(Error::data(
            ErrorKind::Contradiction,
            format!(
                "{}: the rows of kind {} contradict the rest: {:.3} {} are left of them",
                problem.data.path.display(),
                kind.kind,
                kind.identified_rms.unwrap_or(0.0),
                kind.unit
            ),
            NO_GROSS_ERRORS,
        )),
    }
}

/// That no kind is lost row by row.
///
/// # Errors
/// [`ErrorKind::Contradiction`], naming the kind.
pub fn none_is_lost(data: &Measurements, rows: &[usize], outliers: &[Outlier]) -> Result<()> {
    for (known, id) in KINDS.iter().zip(0..).map(|(known, id)| (known, KindId(id))) {
        let of = |row: usize| data.rows[row].kind == id;
        let all = rows.iter().filter(|row| of(**row)).count();
        let lost = outliers.iter().filter(|o| of(o.row)).count();
        if all > FEW && lost as f64 > MOST_LOST * all as f64 {
            return Err(Error::data(
                ErrorKind::Contradiction,
                format!(
                    "{}: {lost} of {all} rows of kind {} contradict the rest",
                    data.path.display(),
                    known.name()
                ),
                NO_GROSS_ERRORS,
            ));
        }
    }
    Ok(())
}

/// What the kinds of a file leave undetermined, in words; nothing is said where
/// there are points.
#[must_use]
pub fn left_open(data: &Measurements) -> Vec<String> {
    if data.rows.iter().any(|row| kind(row).point(row).is_some()) {
        return Vec::new();
    }
    let mut kinds: Vec<KindId> = data.rows.iter().map(|row| row.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let words = |id: KindId| {
        let kind = KINDS[usize::from(id.0)];
        format!("{} alone leaves open: {}", kind.name(), kind.leaves())
    };
    kinds.into_iter().map(words).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::model::{Robot, Values};

    /// Many residuals say their scale, two say little and none nothing.
    #[test]
    fn scales_of_noise() {
        for scale in [0.01, 0.03, 0.3, 1.0, 30.0, 100.0_f64] {
            let found = most_probable(100.0 * scale * scale, 100.0);
            assert!((found / scale).ln().abs() < 0.05, "{scale}: {found}");
        }
        assert!((most_probable(0.0, 0.0) - 1.0).abs() < 1e-9);
        let of_two = most_probable(2.0 * 0.01, 2.0);
        assert!((0.2..0.6).contains(&of_two), "{of_two}");
        let of_none_free = most_probable(1e-20, 0.0);
        assert!((0.99..1.01).contains(&of_none_free), "{of_none_free}");
    }

    /// A sigma in metres is a wrong sigma of rows that are described; coordinates in inches
    /// describe nothing.
    #[test]
    fn a_kind_is_given_up_where_it_is_as_far_off_as_before() {
        let joint = "[[joints]]\nalpha_deg = 0.0\na_mm = 0.0\ntheta_offset_deg = 0.0\nd_mm = 0.0\n";
        let robot = Robot::parse(Path::new("robot.toml"), joint).unwrap();
        let text = "q1_deg,x_mm,y_mm,z_mm\n0,1,0,0\n90,0,1,0\n";
        let data = Measurements::parse(Path::new("m.csv"), text, &robot).unwrap();
        let problem = Problem::new(&data, &robot, Scaling::Prior);
        for (noise_scale, before, after, fine) in [
            (1000.0, 3.0, 0.02, true),
            (1000.0, 170.0, 170.2, false),
            (400.0, 170.0, 170.2, true),
            (1.0, 0.02, 0.02, true),
        ] {
            let kind = KindFigures {
                kind: "point",
                unit: "mm",
                rows: 2,
                nominal_rms: Some(before),
                identified_rms: Some(after),
                cross_validated_rms: None,
                noise_scale,
            };
            let said = none_is_given_up(&problem, &[kind]);
            assert_eq!(said.is_ok(), fine, "{noise_scale} {before} {after}: {said:?}");
        }
    }

    /// Three rows of a kind may all be gross errors, of four no more than two.
    #[test]
    fn few_rows_may_all_be_lost() {
        let joint = "[[joints]]\nalpha_deg = 0.0\na_mm = 0.0\ntheta_offset_deg = 0.0\nd_mm = 0.0\n";
        let robot = Robot::parse(Path::new("robot.toml"), joint).unwrap();
        let file = |touches: usize| {
            let rows = (0..touches).map(|k| format!("{k},touch,plane,,,\n"));
            let points = (0..9).map(|k| format!("{},point,,{k},0,0\n", 10 * k));
            let head = "q1_deg,kind,surface,x_mm,y_mm,z_mm\n".to_owned();
            head + &rows.chain(points).collect::<String>()
        };
        for (touches, lost, fine) in [(3, 3, true), (4, 2, true), (4, 3, false), (4, 4, false)] {
            let data = Measurements::parse(Path::new("m.csv"), &file(touches), &robot).unwrap();
            let outlier = |row: usize| Outlier {
                row,
                components: Vec::new(),
                residual: Residual::new(&data.rows[row], Values::repeat(1, 0.0)),
            };
            let outliers: Vec<Outlier> = (0..lost).map(outlier).collect();
            let rows: Vec<usize> = (0..data.rows.len()).collect();
            let said = none_is_lost(&data, &rows, &outliers);
            assert_eq!(said.is_ok(), fine, "{lost} of {touches}: {said:?}");
        }
    }
}
