//! Structure without a name, described: what errs, with what, how, and what speaks for it.

use schemars::JsonSchema;
use serde::Serialize;
use truearm::JointKind;

use super::naming::said;
use super::policy::POLICY;
use super::tell::place;
use super::weigh::{Follows, Nameless, Unnamed, Weighed, What};
use crate::identify::Problem;

/// Structure that no effect of the repertoire explains.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Described {
    /// What errs: `joint`, `axis` of a joint, `link` behind one, `links` that grow, `base`
    /// (shifts), `base tilt`, `target`, or of the instrument its `azimuth`, `elevation` or
    /// `distance`, as seen from the origin of the frame that it measures in; a touched `surface`,
    /// or a `length` to an anchor.
    pub part: &'static str,
    /// Its joint, counted from 1.
    pub joint: Option<usize>,
    /// With what: `joint` (its angle, or position), `time`, `order`, `temperature`, `payload`,
    /// `load`, `last move` of the joint, `azimuth`, `elevation`, `distance`, `length`, the place
    /// along `x`, `y` or `z` of the base; `row`: from one on.
    pub with: &'static str,
    /// The joint of that, counted from 1.
    pub with_joint: Option<usize>,
    /// The first row that is another way, counted from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_row: Option<usize>,
    /// In words, with what may be there in its place.
    pub words: String,
    /// That it is there, given the data and all that was looked at.
    pub probability: f64,
    /// What explains the same and may be there in its place, most probable first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub instead: Vec<Instead>,
    /// 1 - RMS with over RMS without it of either half of the poses, at random, when all
    /// coefficients are fitted to the other half.
    pub half_gain: [f64; 2],
    /// How it goes; none of what is no smooth function of one thing, or is not in the most
    /// probable model.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<ErrorCourse>,
}

/// What may be there in the place of something.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Instead {
    /// In words.
    pub words: String,
    /// That it is there and the other is not.
    pub probability: f64,
}

/// How a part goes with a covariate along one axis.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ErrorCourse {
    /// Axis of the base's or the last frame; empty where there is only one way to err.
    pub axis: &'static str,
    /// Unit of the covariate.
    pub at_unit: &'static str,
    /// Unit of the value and its deviation.
    pub unit: &'static str,
    /// Covariate, value (but for a constant, and of a surface whose place is found a tilt, which
    /// geometry has) and one standard deviation, within what was measured.
    pub points: Vec<[f64; 3]>,
}

/// Places of a covariate at which a curve is told.
const POINTS: u16 = 41;

/// What is more probable than not, surest first; of two that explain the same and are so
/// together, the more probable with the other beside it.
#[must_use]
pub fn described(problem: &Problem, weighed: &Weighed) -> Vec<Described> {
    let first = |u: &Unnamed| u.instead.first().is_none_or(|other| other.1 < u.probability);
    let is = |u: &Unnamed| {
        u.probability >= POLICY.worth_saying || first(u) && u.together >= POLICY.worth_saying
    };
    let mut out: Vec<Described> =
        weighed.nameless.iter().filter(|u| is(u)).map(|u| of(problem, u)).collect();
    out.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    out
}

/// What shares the probability of something.
fn instead(problem: &Problem, unnamed: &Unnamed) -> Vec<Instead> {
    let words = |what: &What| match what {
        What::Nameless(other) => other.words(problem),
        What::Effect(candidate) => place(candidate.name(), &candidate.joints()),
    };
    let of = |(what, probability): &(What, f64)| Instead {
        words: words(what),
        probability: *probability,
    };
    let shares = unnamed.instead.iter().filter(|other| other.1 >= POLICY.shares);
    shares.take(POLICY.alternatives).map(of).collect()
}

fn of(problem: &Problem, unnamed: &Unnamed) -> Described {
    let what = &unnamed.what;
    let own = what.joint();
    let (part, with, with_joint, from_row) = match *what {
        Nameless::Wobble { .. } => ("axis", "joint", own, None),
        Nameless::Bend { .. } => ("link", "load", own, None),
        Nameless::Memory { .. } => ("joint", "last move", own, None),
        Nameless::Creep { .. } => ("joint", "time", None, None),
        Nameless::Growth { .. } => ("links", "time", None, None),
        Nameless::Slip { row, .. } => ("joint", "row", None, Some(row + 1)),
        Nameless::Reseated { row } => ("target", "row", None, Some(row + 1)),
        Nameless::Shifted { row } => ("base", "row", None, Some(row + 1)),
        Nameless::Follows(Follows { part, with, .. }) => {
            (part.name(), with.name(), with.joint(), None)
        }
    };
    let curves = match what {
        Nameless::Follows(follows) => curves(problem, follows, unnamed),
        _ => Vec::new(),
    };
    let largest = curves.iter().flat_map(|c| c.points.iter().map(move |p| (p[1].abs(), c.unit)));
    let largest = largest.max_by(|a, b| a.0.total_cmp(&b.0));
    let by = largest.map_or_else(String::new, |(by, unit)| format!(", by up to {by:.3} {unit}"));
    let instead = instead(problem, unnamed);
    let or: String =
        instead.iter().map(|o| format!(", or {} ({})", o.words, said(o.probability))).collect();
    let sure = said(unnamed.probability);
    Described {
        part,
        joint: own.map(|joint| joint + 1),
        with,
        with_joint: with_joint.map(|joint| joint + 1),
        from_row,
        words: format!("{}{by} (probability {sure}){or}", what.words(problem)),
        probability: unnamed.probability,
        instead,
        half_gain: unnamed.half_gain,
        curves,
    }
}

fn curves(problem: &Problem, follows: &Follows, unnamed: &Unnamed) -> Vec<ErrorCourse> {
    let Some((mean, covariance)) = &unnamed.coefficients else { return Vec::new() };
    let slides = |joint: usize| problem.nominal[joint].kind == JointKind::Prismatic;
    let (axes, times, unit) = follows.part.axes(follows.part.joint().is_some_and(slides));
    let (at_times, at_unit) = follows.with.unit(problem);
    let [low, high] = follows.how.range;
    let count = follows.how.shape.count();
    let has_slope = follows.part.has_slope(problem);
    let way = |(way, axis): (usize, &&'static str)| {
        let mean = mean.rows(way * count, count);
        let covariance = covariance.view((way * count, way * count), (count, count));
        let point = |k: u16| {
            let value = low + (high - low) * f64::from(k) / f64::from(POINTS - 1);
            let mut f = nalgebra::DVector::from_vec(follows.how.at(value));
            if has_slope {
                f[0] = 0.0;
            }
            let sigma = f.dot(&(covariance * &f)).max(0.0).sqrt();
            [value * at_times, f.dot(&mean) * times, sigma * times]
        };
        ErrorCourse { axis, at_unit, unit, points: (0..POINTS).map(point).collect() }
    };
    axes.iter().enumerate().map(way).collect()
}
