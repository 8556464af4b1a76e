//! What is left that goes with something recorded: free curves, means of bins,
//! of every joint against everything recorded. No effect need have a name for it.

use nalgebra::Vector3;

use super::Seen;
use super::covariate::Covariate;
use crate::model::Clock;
use crate::statistics::median;
use crate::units::MILLI;

/// Bins of a curve.
const BINS: usize = 24;
/// Rows a bin, at least.
const LEAST: usize = 5;
/// Standard deviations of a chi-square above its mean from which on a curve is
/// told from chance, though so many are looked at.
const TOLD: f64 = 8.0;
/// Curves that are shown.
const MOST: usize = 6;

/// What is left of one action against one covariate.
#[derive(Debug, Clone)]
pub struct Unexplained {
    /// In words.
    pub title: String,
    /// With its unit.
    pub x_label: String,
    /// With its unit.
    pub y_label: String,
    /// Mean of each bin.
    pub means: Vec<(f64, f64)>,
    /// Their 95 % intervals.
    pub intervals: Vec<(f64, f64)>,
    /// Rows that were averaged.
    pub rows: usize,
    /// Standard deviations above what chance leaves.
    pub deviations: f64,
    /// RMS of what it explains of these rows, mm.
    pub explains_mm: f64,
    /// RMS of what was left of them, mm.
    pub of_mm: f64,
}

/// A curve, and what it is of every row: what is left less so much.
struct Curve {
    shown: Unexplained,
    takes: Vec<(usize, Vector3<f64>)>,
    joint: usize,
}

impl Curve {
    /// Sum of the squares that it explains.
    fn explains(&self) -> f64 {
        self.shown.explains_mm.powi(2) * self.shown.rows as f64
    }
}

/// The curves that are told from chance, one an action: first the one that explains most,
/// and so on of what those before it leave. A joint that swings the target as another does,
/// by a shorter lever, would else be shown with the other's curve.
#[must_use]
pub fn unexplained(seen: &Seen) -> Vec<Unexplained> {
    let kinds: Vec<_> = seen.state.links.iter().map(|link| link.kind).collect();
    let covariates = covariates(seen, kinds.len());
    let along = |(j, kind): (usize, &truearm::JointKind)| seen.along_joint(j, *kind);
    let actions: Vec<_> = kinds.iter().enumerate().map(along).collect();
    let mut rest: Vec<Vector3<f64>> = (0..seen.kept.len()).map(|k| seen.left(k)).collect();
    let mut joints: Vec<usize> = (0..kinds.len()).collect();
    let mut out = Vec::new();
    while out.len() < MOST {
        let of = |joint: &usize| {
            let of = (*joint, actions[*joint].as_slice());
            let curves = covariates.iter().filter_map(|c| binned(seen, &rest, of, c, &kinds));
            curves.filter(|curve| curve.shown.deviations > TOLD).collect::<Vec<_>>()
        };
        let best = joints.iter().flat_map(of);
        let Some(best) = best.max_by(|a, b| a.explains().total_cmp(&b.explains())) else { break };
        best.takes.iter().for_each(|(k, part)| rest[*k] -= part);
        joints.retain(|joint| *joint != best.joint);
        out.push(best.shown);
    }
    out
}

/// Everything recorded that a curve may go with.
fn covariates(seen: &Seen, joints: usize) -> Vec<Covariate> {
    let mut covariates: Vec<Covariate> = (0..joints).map(Covariate::Angle).collect();
    if seen.conditions.masses || seen.conditions.torques {
        covariates.extend((0..joints).map(Covariate::Torque));
    }
    if seen.conditions.time {
        covariates.push(Covariate::Session(Clock::Time));
    } else if seen.conditions.ordered {
        covariates.push(Covariate::Session(Clock::Rows));
    }
    if seen.conditions.temperature {
        covariates.push(Covariate::Warmth(0.0));
    }
    covariates
}

fn binned(
    seen: &Seen,
    rest: &[Vector3<f64>],
    (joint, action): (usize, &[Vector3<f64>]),
    covariate: &Covariate,
    kinds: &[truearm::JointKind],
) -> Option<Curve> {
    let mut rows: Vec<(f64, usize)> =
        seen.telling(action).into_iter().map(|k| (covariate.value(seen, k), k)).collect();
    rows.retain(|r| r.0.is_finite());
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let bins = BINS.min(rows.len() / LEAST);
    // Values of which there are few are no curve.
    let spread =
        rows.first()?.0 < rows[rows.len() / 4].0 && rows[rows.len() / 4].0 < rows.last()?.0;
    if bins < 4 || !spread {
        return None;
    }
    // Along the action, m: of one size whatever the lever.
    let along = |k: usize| rest[k].dot(&action[k]) / action[k].norm();
    let sizes: Vec<f64> = rows.iter().map(|r| along(r.1).abs()).collect();
    let scale = 1.4826 * median(&sizes);
    let (mut means, mut intervals, mut square) = (Vec::new(), Vec::new(), 0.0);
    let mut takes = Vec::new();
    for bin in rows.chunks(rows.len().div_ceil(bins)) {
        let sum = |of: &dyn Fn(usize) -> f64| bin.iter().map(|r| of(r.1)).sum::<f64>();
        let weight = sum(&|k| action[k].norm_squared());
        let mean = sum(&|k| rest[k].dot(&action[k])) / weight;
        let wide = scale / weight.sqrt();
        square += (mean / wide).powi(2);
        let x = bin.iter().map(|r| r.0).sum::<f64>() / bin.len() as f64;
        means.push((x, mean * MILLI));
        intervals.push(((mean - 1.96 * wide) * MILLI, (mean + 1.96 * wide) * MILLI));
        takes.extend(bin.iter().map(|r| (r.1, action[r.1] * mean)));
    }
    let count = means.len() as f64;
    let unit = if kinds[joint] == truearm::JointKind::Revolute { "mrad" } else { "mm" };
    let x_label = covariate.label(kinds);
    let with = x_label.split(',').next().unwrap_or_default().to_owned();
    let rms = |squares: f64| (squares / rows.len() as f64).sqrt() * MILLI;
    let shown = Unexplained {
        title: format!("Joint {}, left over, against the {with}", joint + 1),
        x_label,
        y_label: format!("left of joint {}, {unit}", joint + 1),
        means,
        intervals,
        rows: rows.len(),
        deviations: (square - count) / (2.0 * count).sqrt(),
        explains_mm: rms(takes.iter().map(|(_, part)| part.norm_squared()).sum()),
        of_mm: rms(rows.iter().map(|r| rest[r.1].norm_squared()).sum()),
    };
    Some(Curve { shown, takes, joint })
}
