//! Waves that only a few angles of a joint hold in place: between these they may do anything.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use truearm::JointKind;

use super::doubts::{OTHERS, levels};
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::Node;
use crate::identify::Problem;
use crate::model::ModelTerm;

/// Waves may be so many times as large between the angles as at them.
const WILD: f64 = 3.0;
/// Cosine or sine of a line that turns more than half between two angles, rad: gears of real arms
/// have up to 3e-4, and anything smooth looks like such a line there.
const OF_A_GEAR: f64 = 5e-4;
/// Angles over the range at which they are looked at.
const LOOKED_AT: usize = 2000;

/// The additions of joints whose waves turn more than half between the few angles that they
/// were measured at and are larger than gears make them; without such, of joints whose waves
/// together do more between these angles than there, beside a constant and a slope: poses held
/// out are at these angles as well, and do not tell.
pub fn wild(problem: &Problem, node: &Node) -> Vec<Candidate> {
    let joints = 0..problem.nominal.len();
    let wild: Vec<(usize, Vec<f64>)> = joints.map(|j| (j, wild_of(problem, node, j))).collect();
    let is_wild = |t: &ModelTerm| {
        let of_joint = |(joint, orders): &(usize, Vec<f64>)| {
            is_wave(t, *joint) && t.order().is_some_and(|order| orders.contains(&order))
        };
        wild.iter().any(of_joint)
    };
    node.added.iter().filter(|c| c.terms.iter().any(is_wild)).cloned().collect()
}

fn is_wave(term: &ModelTerm, joint: usize) -> bool {
    term.order().is_some_and(|order| order > 0.0) && term.joints() == [joint + 1]
}

/// Orders of a joint's waves that are refused.
fn wild_of(problem: &Problem, node: &Node, joint: usize) -> Vec<f64> {
    let terms = node.fit.fit.state.terms.iter();
    let waves: Vec<&ModelTerm> = terms.filter(|t| is_wave(t, joint)).collect();
    if waves.is_empty() || problem.nominal[joint].kind != JointKind::Revolute {
        return Vec::new();
    }
    let angles = node.fit.kept.iter().map(|r| problem.data.rows[*r].q[joint]);
    refused(&waves, &angles.collect::<Vec<f64>>())
}

/// The same of waves over the angles of the rows.
fn refused(waves: &[&ModelTerm], angles: &[f64]) -> Vec<f64> {
    let highest = waves.iter().filter_map(|t| t.order()).fold(0.0, f64::max);
    let levels = levels(angles, highest);
    if levels > waves.len() + OTHERS {
        return Vec::new();
    }
    let value = |q: f64| waves.iter().map(|t| wave(t, q)).sum::<f64>();
    let [low, high] = [f64::min, f64::max].map(|of| angles.iter().copied().reduce(of));
    let (Some(low), Some(high)) = (low, high) else { return Vec::new() };
    let apart = (high - low) / levels.saturating_sub(1).max(1) as f64;
    let turns = |t: &&&ModelTerm| t.order().is_some_and(|order| order * apart > PI);
    let large = |t: &&&ModelTerm| t.coefficient().abs() > OF_A_GEAR;
    let orders = |of: &mut dyn Iterator<Item = &&ModelTerm>| of.filter_map(|t| t.order()).collect();
    let alone: Vec<f64> = orders(&mut waves.iter().filter(turns).filter(large));
    if !alone.is_empty() {
        return alone;
    }
    let line = |q: f64, k: usize| if k == 0 { 1.0 } else { (q - low) / (high - low).max(1e-9) };
    let straight = DMatrix::from_fn(angles.len(), 2, |i, k| line(angles[i], k));
    let own = DVector::from_iterator(angles.len(), angles.iter().map(|q| value(*q)));
    let Ok(held) = straight.clone().svd(true, true).solve(&own, 1e-9) else { return Vec::new() };
    let there = (&own - &straight * &held).norm() / (own.len() as f64).sqrt();
    let between = (0..LOOKED_AT).map(|k| {
        let q = low + (high - low) * k as f64 / LOOKED_AT as f64;
        (value(q) - line(q, 0) * held[0] - line(q, 1) * held[1]).powi(2)
    });
    let between = (between.sum::<f64>() / LOOKED_AT as f64).sqrt();
    if between > WILD * there { orders(&mut waves.iter()) } else { Vec::new() }
}

/// What a wave bends its joint by at an angle, rad.
pub fn wave(term: &ModelTerm, q: f64) -> f64 {
    let ModelTerm::Arm(own) = term else { return 0.0 };
    let (sin, cos) = (own.order * q).sin_cos();
    own.coefficient * if own.component == 0 { cos } else { sin }
}

#[cfg(test)]
mod tests {
    use truearm::effects::{Effect, Term};

    use super::*;

    fn waves(of: &[(f64, f64)]) -> Vec<ModelTerm> {
        let term = |(order, coefficient): &(f64, f64)| {
            let effect = Effect::JointPeriodicError;
            let (order, coefficient) = (*order, *coefficient);
            ModelTerm::Arm(Term { effect, joint: 1, source: 0, component: 0, order, coefficient })
        };
        of.iter().map(term).collect()
    }

    fn refused_of(of: &[(f64, f64)], angles: &[f64]) -> Vec<f64> {
        let waves = waves(of);
        refused(&waves.iter().collect::<Vec<_>>(), angles)
    }

    /// Three angles, each often.
    fn few() -> Vec<f64> {
        (0..90).map(|i| f64::from(i % 3)).collect()
    }

    #[test]
    fn a_wave_larger_than_gears_make_goes_alone() {
        // Order 1 turns less than half between angles 1 rad apart, order 20 many times.
        assert_eq!(refused_of(&[(1.0, 1e-3), (20.0, 2e-3)], &few()), [20.0]);
        // As gears make it, and what it does there is what it does between.
        assert!(refused_of(&[(1.0, 1e-3), (20.0, 1e-4)], &few()).is_empty());
    }

    #[test]
    fn waves_that_do_more_between_the_angles_than_there_go_together() {
        // At 0, 1 and 2 rad cos(pi q) is as a line and a little; 2 pi q is nothing at all.
        let tau = 2.0 * PI;
        assert_eq!(refused_of(&[(0.01, 1e-5), (tau, 4e-4)], &few()), [0.01, tau]);
    }

    #[test]
    fn more_angles_than_waves_have_say_hold_them() {
        // Two waves and what geometry has: four angles are few, five are not.
        let of = [(1.0, 1e-3), (20.0, 2e-3)];
        let at = |count: i32| (0..90).map(|i| f64::from(i % count)).collect::<Vec<f64>>();
        assert_eq!(refused_of(&of, &at(4)), [20.0]);
        assert!(refused_of(&of, &at(5)).is_empty());
    }
}
