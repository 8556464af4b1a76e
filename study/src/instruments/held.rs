//! Which 95 % intervals of one identification hold the truth, kind by kind: arms
//! drawn from the tolerances, so that a posterior must be right about all of them.

use nalgebra::DVector;
use rayon::prelude::*;
use truearm_host::identify::certainty::unknowns::Covariances;
use truearm_host::identify::{Problem, Unknown};
use truearm_host::model::Robot;
use truearm_simulate::instruments::Cell;

use super::cases::Wanted;
use crate::coverage::{DETERMINED, Held};
use crate::judged::solved;

/// Of parameters that the data determine, and of combinations of them.
pub type Both = [Held; 2];

/// Where the seeds of intervals begin: none of those that judge errors.
const SEEDS: u64 = 1 << 32;

/// One identification.
///
/// # Panics
/// Where it fails.
#[must_use]
pub fn held(robot: &Robot, wanted: &Wanted, seed: u64) -> Both {
    let counted = solved(robot, wanted, SEEDS + seed, |solved, _| {
        let (problem, found) = (solved.problem, solved.found);
        let covariances = Covariances::of(problem, found, 1.0);
        let total = &covariances.noise + &covariances.bias;
        let real = truth(problem, solved.cell);
        let at = problem.corrections(&found.fit.state);
        let tool = found.fit.state.markers[0];
        let known = |k: usize| match problem.unknowns.list()[k] {
            Unknown::Link(..) => Some(real[k] - at[k]),
            Unknown::Marker(0, c) => {
                Some((solved.cell.tool[c] - tool[c]) / problem.unit(problem.unknowns.list()[k]))
            }
            _ => None,
        };
        let of: Vec<(usize, f64)> = (0..real.len()).filter_map(|k| Some((k, known(k)?))).collect();
        let places: Vec<usize> = of.iter().map(|x| x.0).collect();
        let [noise, total] =
            [&covariances.noise, &total].map(|c| c.select_rows(&places).select_columns(&places));
        let error = DVector::from_iterator(of.len(), of.iter().map(|x| x.1));
        let mut out = Both::default();
        for k in 0..of.len() {
            let sigmas = [noise[(k, k)], total[(k, k)]].map(f64::sqrt);
            if sigmas[1] < DETERMINED {
                out[0].count(error[k], sigmas);
            }
        }
        let axes = total.symmetric_eigen();
        for (k, axis) in axes.eigenvectors.column_iter().enumerate() {
            let sigma = axes.eigenvalues[k].max(0.0).sqrt();
            if sigma < DETERMINED {
                out[1].count(axis.dot(&error), [axis.dot(&(&noise * axis)).sqrt(), sigma]);
            }
        }
        out
    });
    counted.unwrap_or_else(|error| panic!("{wanted:?} {seed}: {error}"))
}

/// The arm's true corrections, in tolerances; nothing of the free unknowns.
fn truth(problem: &Problem, cell: &Cell) -> DVector<f64> {
    let mut real = DVector::zeros(problem.unknowns.list().len());
    for (k, unknown) in problem.unknowns.list().iter().enumerate() {
        if let Unknown::Link(joint, _) = unknown {
            let nominal = problem.nominal[*joint].parameters.to_array();
            let place = k - problem.unknowns.free() - 5 * joint;
            real[k] = (cell.links[*joint][place] - nominal[place]) / problem.unit(*unknown);
        }
    }
    real
}

/// Shares of intervals that hold the truth over simulations, of parameters and
/// of combinations.
#[must_use]
pub fn shares(robot: &Robot, wanted: &Wanted, simulations: u64) -> [f64; 2] {
    let all: Vec<Both> =
        (0..simulations).into_par_iter().map(|seed| held(robot, wanted, seed)).collect();
    [0, 1].map(|k| Held::share(all.iter().map(|both| &both[k]))[0])
}
