//! Where a search begins, and the problem as what was found so far bends it.

use std::sync::Arc;

use super::curve::Curve;
use super::lines::Held;
use super::nameless;
use super::sheet::{Sheet, Solution};
use crate::diagnose::bending::Bending;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::moments::Moments;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::question::Question;
use crate::error::Result;
use crate::evidence::Geometry;
use crate::identify::{Problem, Scatterer, State};
use crate::model::ErrorCurve;

/// Where a search begins, and where it stands between rounds.
#[derive(Clone)]
pub struct Start {
    pub node: Node,
    pub curves: Vec<Curve>,
    pub bent: Bent,
    /// Noise over the stated sigma, 0 where it is not known yet.
    pub scale: f64,
    /// What physics refused.
    pub refused: Vec<Candidate>,
    /// Of that, what would have been named.
    pub surely_refused: Vec<Candidate>,
    /// Lines to be weighed beside those of the model.
    pub lines: Vec<Held>,
    /// Joints, counted from 0, of which no scan is believed.
    pub closed: Vec<usize>,
    /// What scatters by itself, and the ratio of variance of each as far as it is known.
    pub scattering: Vec<(Scatterer, f64)>,
    /// Rows count alike in the first round, whatever tails the fit leaves.
    pub even: bool,
    /// What has no name, as far as it is known: rows that it moves far are no tails.
    pub nameless: Vec<nameless::Held>,
}

impl Start {
    /// At a fit of which nothing else is known.
    pub fn at(q: &Question, root: &Node) -> Self {
        Self {
            node: root.clone(),
            curves: Vec::new(),
            bent: Bent { tables: Vec::new(), moments: q.moments.cloned() },
            scale: 0.0,
            refused: Vec::new(),
            surely_refused: Vec::new(),
            lines: Vec::new(),
            closed: Vec::new(),
            scattering: Vec::new(),
            even: false,
            nameless: Vec::new(),
        }
    }

    /// Fits these candidates as a search does: what has no name is set aside.
    ///
    /// # Errors
    /// When the fit does not converge.
    pub fn fit(&mut self, q: &Question, added: Vec<Candidate>) -> Result<()> {
        let state = &self.node.fit.fit.state;
        let apart = nameless::without(q.problem, state, &self.nameless);
        let problem = self.bent.problem(&apart);
        self.node = fitted(&Question { problem: &problem, ..*q }, added, state)?;
        Ok(())
    }

    /// A curve that is no longer wanted must not stay in what is predicted.
    pub fn keep_tables(&mut self) {
        let kept = |t: &ErrorCurve| self.curves.iter().any(|c| c.joint == usize::from(t.joint()));
        self.bent.tables.retain(kept);
    }
}

/// A problem whose joints err by these curves.
#[must_use]
pub fn with_curves<'a>(problem: &Problem<'a>, tables: &[ErrorCurve]) -> Problem<'a> {
    if tables.is_empty() {
        return problem.clone();
    }
    let conditions = (*problem.conditions).clone().with_curves(problem.data, tables);
    Problem { conditions: Arc::new(conditions), ..problem.clone() }
}

/// What was found that every row's prediction depends on beside state and terms.
#[derive(Debug, Clone)]
pub struct Bent {
    /// Curves of joints.
    pub tables: Vec<ErrorCurve>,
    /// Masses and moments of links.
    pub moments: Option<Moments>,
}

impl Bent {
    /// The problem with it.
    #[must_use]
    pub fn problem<'a>(&self, of: &Problem<'a>) -> Problem<'a> {
        let loaded = self.moments.as_ref().map(|m| m.loaded(of));
        with_curves(loaded.as_ref().unwrap_or(of), &self.tables)
    }

    /// With loads of links that are where a state has them.
    pub fn stand_at(&mut self, state: &State) {
        self.moments.iter_mut().for_each(|moments| moments.stand_at(state));
    }

    /// What the moments bend of a state.
    #[must_use]
    pub fn bending(&self, state: &State) -> Option<Bending> {
        self.moments.as_ref().and_then(|moments| moments.bending(state))
    }

    /// Takes over a solution's curves and moments.
    pub fn find(&mut self, sheet: &Sheet, solution: &Solution, geometry: &Geometry) {
        self.tables = sheet.tables(solution, geometry);
        if let Some(moments) = &mut self.moments {
            moments.find(sheet.moments(solution));
        }
    }

    /// The curves of another, and moments a share of the way there.
    #[must_use]
    pub fn towards(&self, other: &Self, share: f64) -> Self {
        let moments = self.moments.as_ref().zip(other.moments.as_ref());
        let moments = moments.map(|(from, to)| from.towards(to, share));
        Self { tables: other.tables.clone(), moments }
    }

    /// Whether its moments are others.
    #[must_use]
    pub fn moved_from(&self, other: &Self) -> bool {
        let moments = self.moments.as_ref().zip(other.moments.as_ref());
        moments.is_some_and(|(own, other)| own.moved_from(other))
    }
}
