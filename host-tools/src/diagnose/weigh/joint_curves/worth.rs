//! What error curves are worth, and the way from them to the best model.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::diagnose::bending;
use crate::diagnose::weigh::curve::Curve;
use crate::diagnose::weigh::partial_fits::{Explained, Part};
use crate::diagnose::weigh::possible::What;
use crate::diagnose::weigh::row_parts::{Parts, joined};
use crate::diagnose::weigh::sheet;
use crate::diagnose::weigh::weighed::{Curved, Stage};
use crate::evidence::{Explanation, Gram, prior, smooth};
use crate::model::ErrorCurve;
use crate::observations::Residual;

/// What was found, and the sums it was found from.
pub struct From<'s, 'a> {
    /// The linearised data.
    pub all: &'s Explained<'s, 'a>,
    /// What was found.
    pub found: &'s Explanation,
    /// Rows by fold and half.
    pub parts: &'s Parts,
    /// Their sums.
    pub grams: &'s [Gram],
}

/// Each curve with its worth: the fall of the cost that geometry and the curve
/// have to explain the same, and of the error of either half.
#[must_use]
pub fn worth(from: &From, curves: &[Curve], tables: &[ErrorCurve]) -> Vec<Curved> {
    let (all, scale) = (from.all, from.found.scale);
    let whole = joined(from.grams.iter(), all.sheet.size());
    let geometry = whole.geometry(all.precision, scale);
    let solution = all.solution(&whole, &geometry, from.found);
    let halves = [0, 1].map(|half| Half::new(from, half));
    let with = halves.each_ref().map(|half| half.error(from, all.precision));
    let out = tables.par_iter().filter_map(|table| {
        let k = curves.iter().position(|c| c.joint == usize::from(table.joint()))?;
        let columns = all.sheet.columns_of_curve(k);
        let mut held = all.precision.clone();
        held.rows_mut(columns.start, columns.len()).fill(sheet::HELD);
        let without = |half: &Half| half.error(from, &held).max(f64::MIN_POSITIVE);
        let half_gain = [0, 1].map(|h| 1.0 - with[h] / without(&halves[h]));
        let evidence = geometry.worth(all.precision, &solution.geometry, columns);
        let log_odds = evidence + prior::log_odds(all.q.problem.nominal.len(), smooth::PRIORS);
        let Curve { prior, few, .. } = curves[k];
        Some(Curved { table: table.clone(), length: prior.length, log_odds, few, half_gain })
    });
    out.collect()
}

/// One random half, and sums of the other one.
struct Half {
    rows: Vec<usize>,
    other: Gram,
}

impl Half {
    fn new(from: &From, half: usize) -> Self {
        let others = from.parts.of_half(0, 1 - half).map(|p| &from.grams[p]);
        let other = joined(others, from.all.sheet.size());
        Self { rows: from.parts.rows_of_half(0, half), other }
    }

    /// Its error with what the other one tells under a prior of geometry, m.
    fn error(&self, from: &From, precision: &DVector<f64>) -> f64 {
        let all = Explained { precision, ..*from.all };
        let part = all.part(self.other.clone(), from.found.scale);
        let (_, solution) = all.refitted(&part, from.found, &from.found.best.members);
        all.sheet.misfits(&self.rows, &[solution])[0].sqrt()
    }
}

/// Curves alone, then one effect after the other, the one that is needed most first;
/// without what is left out held-out poses are predicted as well.
#[must_use]
pub fn stages(from: &From) -> Vec<Stage> {
    let members = &from.found.best.members;
    let name = |m: &usize| match &from.all.possible[*m].what {
        What::Effect(candidate) => Some(candidate.name()),
        What::Nameless(_) => None,
    };
    let mut sizes: Vec<(&'static str, f64)> = Vec::new();
    for (m, floors) in members.iter().zip(&from.found.floors) {
        let Some(name) = name(m) else { continue };
        match sizes.iter_mut().find(|s| s.0 == name) {
            Some(known) => known.1 = known.1.hypot(*floors),
            None => sizes.push((name, *floors)),
        }
    }
    sizes.sort_by(|a, b| b.1.total_cmp(&a.1));
    // Moments bend springs: without those they are as stated.
    let held = from.all.sheet.holding_moments(from.all.precision);
    let stiff = Explained { precision: &held, ..*from.all };
    let [sprung, stiff] = [from.all, &stiff].map(|all| Sums::new(from, all));
    let named = |names: &[&'static str]| {
        let of = |m: &usize| name(m).is_some_and(|n| names.contains(&n));
        let own: Vec<usize> = members.iter().copied().filter(of).collect();
        let bends = names.iter().any(|name| bending::bends(name));
        (own, if bends { &sprung } else { &stiff })
    };
    let held_out = |names: &[&'static str]| {
        let (own, sums) = named(names);
        sums.held_out(from, &own)
    };
    let stage = |names: Vec<&'static str>| {
        let (own, sums) = named(&names);
        let tables = sums.all.tables(&sums.whole, from.found, &own);
        let bends = names.iter().any(|name| bending::bends(name));
        let fitted = bends.then(|| sums.fitted(from, &own));
        Stage { fitted, tables, held_out: held_out(&names), names }
    };
    // A gross error would outweigh all others.
    let kept = from.parts.rows.concat();
    let left = |names: &[&'static str]| from.all.sheet.weighed(&kept, &held_out(names));
    // What an effect is worth is told beside all others: alone it may predict poses worse.
    let mut names: Vec<&'static str> = sizes.iter().map(|s| s.0).collect();
    loop {
        let without = |name: &&'static str| {
            let others: Vec<_> = names.iter().copied().filter(|n| n != name).collect();
            (*name, left(&others))
        };
        let mut each: Vec<(&'static str, f64)> = names.iter().map(without).collect();
        each.sort_by(|a, b| b.1.total_cmp(&a.1));
        names = each.iter().map(|e| e.0).collect();
        let own = left(&names);
        match each.last() {
            Some((_, others)) if *others <= own => _ = names.pop(),
            _ => return (0..=names.len()).map(|k| stage(names[..k].to_vec())).collect(),
        }
    }
}

/// Sums without each fold and of all rows, under a prior of geometry.
struct Sums<'e, 's, 'a> {
    all: &'e Explained<'s, 'a>,
    folds: Vec<Part>,
    whole: Part,
}

impl<'e, 's, 'a> Sums<'e, 's, 'a> {
    fn new(from: &From, all: &'e Explained<'s, 'a>) -> Self {
        let (size, scale) = (all.sheet.size(), from.found.scale);
        let without = |k: usize| {
            let others = (0..from.grams.len()).filter(|p| from.parts.fold[*p] != k);
            all.part(joined(others.map(|p| &from.grams[p]), size), scale)
        };
        let folds = (0..all.q.folds.len()).into_par_iter().map(without).collect();
        Self { all, folds, whole: all.part(joined(from.grams.iter(), size), scale) }
    }

    /// What is left of every row with these members.
    fn fitted(&self, from: &From, members: &[usize]) -> Vec<Option<Residual>> {
        let mut out = vec![None; self.all.q.problem.data.rows.len()];
        let (_, solution) = self.all.refitted(&self.whole, from.found, members);
        for (row, left) in self.all.sheet.left(self.all.q.rows, &solution) {
            out[row] = Some(left);
        }
        out
    }

    /// Every row predicted without its fold, with these members.
    fn held_out(&self, from: &From, members: &[usize]) -> Vec<Option<Residual>> {
        let mut out = vec![None; self.all.q.problem.data.rows.len()];
        let left = self.folds.par_iter().zip(self.all.q.folds).map(|(part, fold)| {
            let (_, solution) = self.all.refitted(part, from.found, members);
            self.all.sheet.left(&fold.held_out, &solution)
        });
        for (row, left) in left.collect::<Vec<_>>().into_iter().flatten() {
            out[row] = Some(left);
        }
        out
    }
}
