//! Poses that tell explanations of one data set apart.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::error::{Error, ErrorKind, Result};
use crate::evaluate::residuals;
use crate::identify::{Conditions, Problem, Scaling, State};
use crate::model::{Measurements, Robot, Workspace};
use crate::observations::Residual;
use crate::tikhonov::covariance;

/// What a diagnosis left: one explanation, and those that it could not rule out.
#[derive(Debug, Clone, Copy)]
pub struct Explained<'a> {
    /// What was named, with base, marker and terms.
    pub named: &'a State,
    /// The others.
    pub alternatives: &'a [State],
    /// Rows that were fitted.
    pub kept: &'a [usize],
    /// Lambda of the fit.
    pub lambda: f64,
}

/// Poses and how well they will separate.
#[derive(Debug, Clone)]
pub struct Discrimination {
    /// Joint values, rad or m.
    pub poses: Vec<Vec<f64>>,
    /// Side from which each joint is to come to rest, where the data say it of
    /// theirs.
    pub directions: Vec<Vec<i8>>,
    /// By how much each alternative is expected to fit worse than the named
    /// explanation if that is true, in units of chi-square.
    pub separation: Vec<f64>,
}

/// An alternative that is fitted, pose by pose, to what the named explanation
/// predicts.
struct Rival {
    blocks: Vec<DMatrix<f64>>,
    apart: Vec<DVector<f64>>,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    separation: f64,
}

impl Rival {
    /// Innovation, its information, and the chi-square that a pose adds.
    fn gain(&self, k: usize) -> f64 {
        let block = &self.blocks[k];
        let left = &self.apart[k] - block * &self.mean;
        let spread = self.spread(k);
        spread.cholesky().map_or(0.0, |s| left.dot(&s.solve(&left)))
    }

    fn spread(&self, k: usize) -> DMatrix<f64> {
        let block = &self.blocks[k];
        let hat = block * &self.covariance * block.transpose();
        DMatrix::identity(block.nrows(), block.nrows()) + hat
    }

    /// Measures the pose: a step of a Kalman filter.
    fn learn(&mut self, k: usize) {
        self.separation += self.gain(k);
        let block = &self.blocks[k];
        let left = &self.apart[k] - block * &self.mean;
        let Some(inverse) = self.spread(k).try_inverse() else { return };
        let gain = &self.covariance * block.transpose() * inverse;
        self.mean += &gain * left;
        self.covariance -= gain * (block * &self.covariance);
    }
}

/// Picks, one after another, the poses that most raise the chi-square by which
/// the worst-separated alternative of a diagnosis will be worse (T-optimality,
/// Atkinson and Fedorov, Biometrika 62, 1975; greedy). An alternative may refit
/// all its parameters to the new poses within what `data` leave open of them:
/// only what no refit absorbs counts.
///
/// # Errors
/// No alternatives, and as for [`Workspace::sample`].
pub fn discriminate(
    robot: &Robot,
    data: &Measurements,
    explained: &Explained,
    workspace: &Workspace,
    (count, candidates, seed): (usize, usize, u64),
) -> Result<Discrimination> {
    if explained.alternatives.is_empty() {
        return Err(Error::data(
            ErrorKind::NoAlternative,
            "the diagnosis names no alternative: there is nothing to tell apart",
            "plan without --discriminate to make the model as a whole better",
        ));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let poses = workspace.sample(robot, candidates.max(count), &mut rng)?;
    let trial = data.trial(&poses, &mut rng);
    let conditions = Conditions::at(&trial, robot, &explained.named.links);
    let named = residuals(&trial, &conditions, explained.named);
    let mut rivals: Vec<Rival> = explained
        .alternatives
        .iter()
        .map(|state| rival(robot, data, explained, state, (&trial, &named)))
        .collect();
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < count {
        let reached = |k: usize| {
            rivals.iter().map(|r| r.separation + r.gain(k)).fold(f64::INFINITY, f64::min)
        };
        let left = (0..poses.len()).filter(|k| !chosen.contains(k));
        let best = left.map(|k| (reached(k), k)).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, k)) = best else { break };
        rivals.iter_mut().for_each(|r| r.learn(k));
        chosen.push(k);
    }
    Ok(Discrimination {
        directions: chosen.iter().map(|k| trial.rows[*k].directions.clone()).collect(),
        poses: chosen.into_iter().map(|k| poses[k].clone()).collect(),
        separation: rivals.iter().map(|r| r.separation).collect(),
    })
}

fn rival(
    robot: &Robot,
    data: &Measurements,
    explained: &Explained,
    state: &State,
    (trial, named): (&Measurements, &[Residual]),
) -> Rival {
    let terms = state.terms.len();
    let on = |data| {
        let loaded = Conditions::at(data, robot, &state.links);
        Problem::under(data, robot, Scaling::Prior, loaded).with_terms(terms)
    };
    let (measured, planned) = (on(data), on(trial));
    let normal = measured.linearise(state).normal(explained.kept, None);
    let at = planned.linearise(state);
    let equations = (0..trial.rows.len()).map(|k| {
        let e = at.equations(k);
        // The named explanation's residual less this one's: how far its
        // prediction is off theirs.
        let apart = e.scaled(&(e.residual - named[k]));
        (e.block, apart.column().into_owned())
    });
    let (blocks, apart) = equations.unzip();
    Rival {
        blocks,
        apart,
        mean: DVector::zeros(measured.unknowns.list().len()),
        covariance: covariance(&normal, measured.unknowns.free(), explained.lambda),
        separation: 0.0,
    }
}
