//! Each named effect at its place: the error that the rows show of it, and what
//! the model says it is.

use nalgebra::Vector3;
use truearm::JointKind;
use truearm::effects::ActsOn;

use super::super::numbers::{cycles, period};
use super::{Seen, covariate::Covariate};
use crate::diagnose::Effect;
use crate::identify::measurement_column;
use crate::model::{CURVE, Clock, JointTables, ModelTerm};
use crate::statistics::median;
use crate::units::{MICRO, MILLI};

/// Places along a curve.
const PLACES: usize = 721;
/// Half width of a 95 % interval in standard deviations.
const WIDE: f64 = 1.96;
/// Bins of rows, at most.
const BINS: usize = 20;
/// Rows of a bin, at least.
const FULL: usize = 25;

/// An effect at a place, against what it goes with.
#[derive(Debug, Clone)]
pub struct Part {
    /// Name of the effect.
    pub effect: &'static str,
    /// The joint it acts on, counted from 1.
    pub joint: Option<usize>,
    /// What it is, in words.
    pub title: String,
    /// What it goes with, with its unit.
    pub x_label: String,
    /// Names of the values of x, if it has some.
    pub names: Vec<String>,
    /// What it does, with its unit.
    pub y_label: String,
    /// Rows: what each shows of the effect, everything else taken off.
    pub points: Vec<(f64, f64)>,
    /// Rows that tell next to nothing of it and are not shown.
    pub silent: usize,
    /// Means of bins of them, where there are enough, with their 95 % intervals.
    pub means: Vec<(f64, f64)>,
    /// See [`Part::means`].
    pub intervals: Vec<(f64, f64)>,
    /// What the model says.
    pub curve: Vec<(f64, f64)>,
    /// Its 95 % band.
    pub band: Vec<(f64, f64)>,
}

/// All parts of a model: error curves first, then terms in their order.
#[must_use]
pub fn parts(seen: &Seen, effects: &[Effect]) -> Vec<Part> {
    let mut out: Vec<Part> = (0..seen.on.model.curves.len()).map(|c| curve(seen, c)).collect();
    let mut groups: Vec<(Key, Vec<&ModelTerm>)> = Vec::new();
    for term in &seen.state.terms {
        let key = Key::of(term);
        match groups.iter_mut().find(|g| g.0 == key) {
            Some((_, terms)) => terms.push(term),
            None => groups.push((key, vec![term])),
        }
    }
    out.extend(groups.iter().map(|(key, terms)| of_terms(seen, key, terms, effects)));
    out
}

/// What makes terms one part.
#[derive(Debug, Clone, PartialEq)]
struct Key {
    effect: &'static str,
    covariate: Covariate,
    /// Joint it acts on, or component where there is none.
    place: (Option<u8>, usize),
}

impl Key {
    fn of(term: &ModelTerm) -> Self {
        let place = match term {
            ModelTerm::Arm(t) => (t.own_joint(), 0),
            ModelTerm::Drift { component, .. } => (None, *component),
            ModelTerm::Lag { joint, .. } => (Some(*joint as u8), 0),
            ModelTerm::Remount { axis, .. } => (None, *axis),
        };
        Self { effect: term.effect_name(), covariate: Covariate::of(term), place }
    }
}

/// What an amount of an effect is, and how many of its unit one of SI is.
fn amount(term: &ModelTerm, seen: &Seen) -> (String, f64) {
    match term {
        ModelTerm::Drift { component, .. } => {
            let axis = ["x", "y", "z"][component % 3];
            match component {
                0..3 => (format!("turn about the tracker's {axis}, mrad"), MILLI),
                _ => (format!("shift along the tracker's {axis}, mm"), MILLI),
            }
        }
        ModelTerm::Lag { joint, .. } => of_joint(*joint, seen),
        ModelTerm::Remount { axis, .. } => {
            (format!("shift of the target along {}, mm", ["x", "y", "z"][axis % 3]), MILLI)
        }
        ModelTerm::Arm(t) => match t.effect.acts_on() {
            ActsOn::Base => {
                let axis = ["x", "y"][usize::from(t.component) % 2];
                (format!("turn of the base about its {axis}, mrad"), MILLI)
            }
            ActsOn::Axis => (format!("tilt of the axis of joint {}, mrad", t.joint + 1), MILLI),
            ActsOn::Lengths => ("growth of lengths, um/m".to_owned(), MICRO),
            ActsOn::Joint => of_joint(usize::from(t.joint), seen),
        },
    }
}

fn of_joint(joint: usize, seen: &Seen) -> (String, f64) {
    match seen.state.links[joint].kind {
        JointKind::Revolute => (format!("error of joint {}, mrad", joint + 1), MILLI),
        JointKind::Prismatic => (format!("error of joint {}, um", joint + 1), MICRO),
    }
}

/// How what rows measure of their targets moves with an amount of a term, m per SI.
fn action(seen: &Seen, term: &ModelTerm) -> Vec<Vector3<f64>> {
    let of = |(k, d): (usize, &crate::model::arm::Derivatives)| match term {
        ModelTerm::Arm(t) => seen.action(t, d, k),
        ModelTerm::Remount { axis, .. } => d.tool[*axis],
        ModelTerm::Lag { joint, .. } => d.links[*joint].theta,
        ModelTerm::Drift { component, .. } => {
            let row = &seen.on.data.rows[seen.kept[k]];
            let hour = crate::model::Row { time: Some(3600.0), ..row.clone() };
            let (component, course) = (*component, Clock::Time.goes_on());
            let whole = ModelTerm::Drift { component, course, coefficient: 1.0 };
            measurement_column(&whole, &hour, d)
        }
    };
    seen.moves.iter().enumerate().map(|(k, d)| seen.measured(k, &of((k, d)))).collect()
}

/// What a row shows of an action, SI.
struct Row {
    x: f64,
    y: f64,
    /// What is left of it: `y` less what the model says.
    left: f64,
    /// How far the target moves.
    lever: f64,
}

/// What rows show of an action that the model takes for `modelled`, in SI.
fn shown(
    seen: &Seen,
    action: &[Vector3<f64>],
    covariate: &Covariate,
    modelled: impl Fn(usize) -> f64,
) -> Vec<Row> {
    let of = |k: usize| {
        let left = seen.left(k).dot(&action[k]) / action[k].norm_squared();
        let lever = action[k].norm();
        Row { x: covariate.value(seen, k), y: modelled(k) + left, left, lever }
    };
    seen.telling(action).into_iter().map(of).filter(|p| p.x.is_finite()).collect()
}

/// Means of bins of as many rows, each with half the width of its 95 % interval;
/// none where a bin would have few, or x few values.
fn means(rows: &[Row]) -> Vec<(f64, f64, f64)> {
    let bins = (rows.len() / FULL).min(BINS);
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
    let of_few = sorted.windows(2).filter(|w| w[0].x < w[1].x).count() < 2 * BINS;
    if bins < 6 || of_few {
        return Vec::new();
    }
    let sizes: Vec<f64> = rows.iter().map(|r| (r.left * r.lever).abs()).collect();
    let scale = 1.4826 * median(&sizes);
    let mean = |bin: &[&Row]| {
        let weight: f64 = bin.iter().map(|r| r.lever.powi(2)).sum();
        let y = bin.iter().map(|r| r.y * r.lever.powi(2)).sum::<f64>() / weight;
        let x = bin.iter().map(|r| r.x).sum::<f64>() / bin.len() as f64;
        (x, y, WIDE * scale / weight.sqrt())
    };
    sorted.chunks(rows.len().div_ceil(bins)).map(mean).collect()
}

fn curve(seen: &Seen, which: usize) -> Part {
    let curve = &seen.on.model.curves[which];
    let joint = usize::from(curve.joint());
    let tables = JointTables::new(std::slice::from_ref(curve));
    let covariate = Covariate::Angle(joint);
    let kind = seen.state.links[joint].kind;
    let action = seen.along_joint(joint, kind);
    let rows = &seen.on.data.rows;
    let at = |k: usize| tables.value(curve.joint(), rows[seen.kept[k]].q[joint]);
    let points = shown(seen, &action, &covariate, at);
    let (y_label, unit) = of_joint(joint, seen);
    let looks: Vec<(f64, f64, f64)> = places(&covariate, &points)
        .into_iter()
        .map(|x| (x, x.to_radians()))
        .map(|(x, q)| (x, tables.value(curve.joint(), q), WIDE * curve.band_at(q)))
        .collect();
    Part {
        effect: CURVE,
        joint: Some(joint + 1),
        title: format!("Joint {}: error over its angle", joint + 1),
        x_label: covariate.label(&kinds(seen)),
        names: Vec::new(),
        y_label,
        silent: seen.kept.len() - points.len(),
        points: points.iter().map(|r| (r.x, r.y * unit)).collect(),
        // A bin would be wider than what the curve turns in.
        means: Vec::new(),
        intervals: Vec::new(),
        curve: looks.iter().map(|p| (p.0, p.1 * unit)).collect(),
        band: looks.iter().map(|p| ((p.1 - p.2) * unit, (p.1 + p.2) * unit)).collect(),
    }
}

fn of_terms(seen: &Seen, key: &Key, terms: &[&ModelTerm], effects: &[Effect]) -> Part {
    let action = action(seen, terms[0]);
    let covariate = &key.covariate;
    let sum = |of: &dyn Fn(&ModelTerm) -> f64| terms.iter().map(|t| of(t)).sum::<f64>();
    let at = |x: f64| sum(&|t| t.coefficient() * covariate.basis(t, x, seen));
    let points = shown(seen, &action, covariate, |k| at(covariate.value(seen, k)));
    let (y_label, unit) = amount(terms[0], seen);
    let means = means(&points);
    let sigma = |t: &ModelTerm| sigma(t, effects);
    let looks: Vec<(f64, f64, f64)> = places(covariate, &points)
        .into_iter()
        .map(|x| {
            let square = sum(&|t| (sigma(t) * covariate.basis(t, x, seen)).powi(2));
            (x, at(x), WIDE * square.sqrt())
        })
        .collect();
    Part {
        effect: key.effect,
        joint: key.place.0.map(|joint| usize::from(joint) + 1),
        title: title(key, terms[0]),
        x_label: covariate.label(&kinds(seen)),
        names: covariate.names(seen),
        y_label,
        silent: seen.kept.len() - points.len(),
        points: points.iter().map(|r| (r.x, r.y * unit)).collect(),
        means: means.iter().map(|m| (m.0, m.1 * unit)).collect(),
        intervals: means.iter().map(|m| ((m.1 - m.2) * unit, (m.1 + m.2) * unit)).collect(),
        curve: looks.iter().map(|p| (p.0, p.1 * unit)).collect(),
        band: looks.iter().map(|p| ((p.1 - p.2) * unit, (p.1 + p.2) * unit)).collect(),
    }
}

fn kinds(seen: &Seen) -> Vec<JointKind> {
    seen.state.links.iter().map(|link| link.kind).collect()
}

/// What a part is, with its joint and its period.
fn title(key: &Key, term: &ModelTerm) -> String {
    let name = key.effect.replace('-', " ");
    let joint = key.place.0.map(|joint| usize::from(joint) + 1);
    match (joint, &key.covariate) {
        (Some(j), Covariate::Cycle(_, n)) => {
            format!("Joint {j}: {name}, {}, a period of {}", cycles(*n), period(*n))
        }
        (Some(j), Covariate::Angle(source)) if source + 1 != j => {
            format!("Joint {j}: {name} with joint {}", source + 1)
        }
        (Some(j), _) => match term.order() {
            Some(n) => format!("Joint {j}: {name}, {}", cycles(n)),
            None => format!("Joint {j}: {name}"),
        },
        (None, _) => {
            let about = match term {
                ModelTerm::Arm(t) if t.effect.acts_on() == ActsOn::Base => {
                    format!(" about {}", ["x", "y"][usize::from(t.component) % 2])
                }
                _ => String::new(),
            };
            format!("{}{}{about}", name[..1].to_uppercase(), &name[1..])
        }
    }
}

/// One standard deviation of a term's coefficient, as the report has it.
fn sigma(term: &ModelTerm, effects: &[Effect]) -> f64 {
    let own = effects.iter().filter(|e| e.name == term.effect_name() && e.order == term.order());
    let mut all = own.flat_map(|e| &e.coefficients);
    let found = all.find(|c| c.part == term.part() && c.value == term.coefficient());
    found.map_or(0.0, |c| c.sigma)
}

/// Where a curve is looked at: as far as the rows go.
fn places(covariate: &Covariate, rows: &[Row]) -> Vec<f64> {
    let low = rows.iter().map(|r| r.x).fold(f64::INFINITY, f64::min);
    let high = rows.iter().map(|r| r.x).fold(f64::NEG_INFINITY, f64::max);
    if low > high {
        return Vec::new();
    }
    let (low, high) = match covariate {
        Covariate::Cycle(_, n) => (0.0, 360.0 / n),
        Covariate::Series | Covariate::Side(_) | Covariate::Arrival(_) => {
            return (low as usize..=high as usize).map(|k| k as f64).collect();
        }
        _ => (low, high),
    };
    (0..PLACES).map(|i| low + (high - low) * i as f64 / (PLACES - 1) as f64).collect()
}
