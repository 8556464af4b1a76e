//! What a search ended with, and the answer that it gives.

use super::curve::Curve;
use super::joint_curves::worth;
use super::judge;
use super::nameless;
use super::partial_fits::Explained;
use super::possible::{self, Possible};
use super::row_parts::{Parts, joined};
use super::sheet::{Scattered, Sheet, Weights};
use super::start::{Bent, Start};
use super::weighed::Weighed;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::node::{Node, fitted};
use crate::diagnose::question::Question;
use crate::diagnose::weigh::joint_curves::choice::{self, Chosen, Few};
use crate::error::Result;
use crate::evidence::Explanation;
use crate::identify::State;

/// Where it ends: what was weighed in the last round, and the fit of what it found.
pub struct Searched {
    /// Nothing changed any more, or rounds were over: not only as far as it was let.
    pub ended: bool,
    /// Its first round changed nothing.
    pub still: bool,
    pub best: Node,
    pub curves: Vec<Curve>,
    pub bent: Bent,
    /// State, curves and moments that it was weighed at.
    pub state: State,
    pub held: Bent,
    pub rows: Vec<usize>,
    pub possible: Vec<Possible>,
    pub weights: Weights,
    pub found: Explanation,
    pub refused: Vec<Candidate>,
    /// Of that, what would have been named.
    pub surely_refused: Vec<Candidate>,
    /// Joints of which no scan is believed.
    pub closed: Vec<usize>,
}

impl Searched {
    /// A new search from here.
    pub fn again(&self) -> Start {
        Start {
            node: self.best.clone(),
            curves: self.curves.clone(),
            bent: self.bent.clone(),
            scale: self.found.scale,
            refused: self.refused.clone(),
            surely_refused: self.surely_refused.clone(),
            lines: Vec::new(),
            closed: self.closed.clone(),
            scattering: self.weights.scattering.clone(),
            even: false,
            nameless: self.nameless(),
        }
    }

    /// A new search from here, with a few lines in the place of others.
    pub fn with_few(&self, q: &Question, few: &[Few]) -> Result<Start> {
        let start = self.again();
        if few.is_empty() {
            return Ok(start);
        }
        let stays = |c: &&Candidate| !few.iter().any(|few| few.instead_of.contains(c));
        let kept = self.best.added.iter().filter(stays).cloned();
        let added = kept.chain(few.iter().flat_map(Few::candidates)).collect();
        let problem = self.bent.problem(q.problem);
        let node = fitted(&Question { problem: &problem, ..*q }, added, &self.best.fit.fit.state)?;
        Ok(Start { node, ..start })
    }

    /// What its model has that has no name.
    pub fn nameless(&self) -> Vec<nameless::Held> {
        possible::nameless(&self.possible, &self.found)
    }

    /// What joints are off by beside what was found: curves, and lines in their place.
    pub fn wanted(&self, q: &Question) -> Chosen {
        let problem = &self.bent.problem(q.problem);
        let members = self.found.best.members.iter();
        let members: Vec<Possible> = members.map(|m| self.possible[*m].clone()).collect();
        let (state, rows) = (&self.best.fit.fit.state, &self.best.fit.kept);
        let noise = (q.flags.lambda, self.found.scale);
        choice::chosen(problem, state, rows, &members, &self.weights, noise)
    }

    /// The answer.
    pub fn judged(self, q: &Question) -> Result<Weighed> {
        let problem = self.held.problem(q.problem);
        let asked = Question { problem: &problem, ..*q };
        let bending = self.held.bending(&self.state);
        let sheet = Sheet::new(&problem, &self.state, &self.possible, &self.weights, &self.curves)
            .bending(bending, &self.rows, q.flags.lambda);
        let precision = sheet.precision(q.flags.lambda);
        let parts = Parts::new(&asked, &self.rows);
        let grams = sheet.grams(&parts.rows);
        let whole = joined(grams.iter(), sheet.size());
        let all =
            Explained { q: &asked, possible: &self.possible, sheet: &sheet, precision: &precision };
        let within = judge::within(&all, &whole, &self.found);
        let no_room = self.best.added.len().saturating_sub(within.len());
        let best = match within.len() == self.best.added.len() {
            true => self.best,
            false => {
                let problem = self.bent.problem(q.problem);
                fitted(&Question { problem: &problem, ..*q }, within, &self.state)?
            }
        };
        let mut answer = judge::answer(&all, best, &self.found, &parts, &grams);
        answer.refused = self.refused;
        answer.surely_refused = self.surely_refused;
        let rad = |ratio: f64| self.found.scale * ratio.sqrt();
        // What was found since may leave none of it.
        let scattering = self.weights.scattering.iter().filter(|(_, ratio)| *ratio > 0.0);
        answer.scattering = scattering.map(|(source, ratio)| (*source, rad(*ratio))).collect();
        // What is said of the noise, and of what it makes of a model, is of all of it.
        let (state, rows) = (&answer.best.fit.fit.state, &self.rows);
        answer.scale *= Scattered::of(&problem, state, rows, &self.weights.scattering).together();
        answer.moments = self.bent.moments;
        answer.no_room = no_room;
        if !self.curves.is_empty() {
            let at = (q.flags.lambda, self.found.scale);
            answer.by_curves = sheet.by_curves_unknown(&self.rows, &whole, at);
            let from = worth::From { all: &all, found: &self.found, parts: &parts, grams: &grams };
            answer.stages = worth::stages(&from);
            // The model is the last stage.
            let tables = answer.stages.last().map_or(&[][..], |stage| &stage.tables);
            answer.curves = worth::worth(&from, &self.curves, tables);
        }
        Ok(answer)
    }
}
