//! Find, name, add, show: what rigid geometry cannot explain.
//!
//! robust geometric fit -> *where* the residuals are -> *what* explains them
//! ([`search`]) -> *show* the gap shrink on held-out poses -> verdict.

pub mod candidates;
mod chi_square;
mod outcome;
pub mod policy;
pub mod search;
mod show;
mod tell;
mod verdict;
pub mod weigh;

pub use outcome::{Alternative, Coefficient, Effect, GapRow, Outcome, Verdict};

use truearm::effects::MAX_TERMS;

use crate::error::{Kind, Result};
use crate::identify::estimate::Estimate;
use crate::identify::registration::register;
use crate::identify::robust::{Crowd, Flags};
use crate::identify::{
    Findings, Options, Problem, RowResult, Scaling, State, enough, folds, nominal_state,
};
use crate::model::{Measurements, Model, Robot};
use crate::observations::kind;
use policy::POLICY;
use search::Search;
use search::node::Node;
use verdict::{judge, with_held_out_gain};

/// The result.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// With all terms, for evaluation and packing.
    pub model: Model,
    /// Figures and names.
    pub outcome: Outcome,
    /// Per row.
    pub rows: Vec<RowResult>,
    /// What was named, with base, marker and terms.
    pub state: State,
    /// The alternatives of the report, in its order.
    pub alternatives: Vec<State>,
}

/// What the user may choose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagnoseOptions {
    /// Highest order of a periodic error to scan, cycles a turn.
    pub highest_order: f64,
    /// Most terms of the arm that the model may have.
    pub most_terms: usize,
    /// Go on with fewer equations than unknowns.
    pub allow_few_poses: bool,
}

impl Default for DiagnoseOptions {
    fn default() -> Self {
        Self { highest_order: 420.0, most_terms: 64, allow_few_poses: false }
    }
}

/// Names what is missing in the geometry of `robot`. `holdout` poses are never
/// fitted; they only show.
///
/// # Errors
/// As for `identify`, and a hold-out file of unknown stations; but rows that
/// contradict each other are no error here, they are what is shown.
pub fn diagnose(
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    let with = |crowd| diagnosed(robot, data, holdout, options, crowd, progress);
    match with(Crowd::Refused) {
        Err(error) if error.kind() == Kind::Contradiction => with(Crowd::Described),
        done => done,
    }
}

fn diagnosed(
    robot: &Robot,
    data: &Measurements,
    holdout: Option<&Measurements>,
    options: &DiagnoseOptions,
    crowd: Crowd,
    progress: &dyn Fn(&'static str),
) -> Result<Diagnosis> {
    let assumed = robot.with_assumed_masses();
    let robot = assumed.as_ref().unwrap_or(robot);
    let problem = Problem::new(data, robot, Scaling::Prior);
    enough(&problem, &Options { allow_few_poses: options.allow_few_poses, ..Options::default() })?;
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let start = register(data, &problem.nominal, robot.tool)?;
    let (candidates, not_testable) = candidates::all(&problem, robot);
    let mut search = Search {
        problem: &problem,
        candidates: &candidates,
        highest_order: options.highest_order,
        flags: Flags { lambda: 1.0, gross: POLICY.gross, crowd },
        rows: &rows,
        most_terms: options.most_terms,
    };
    progress("geometry");
    let first = search.fit(Vec::new(), &start)?;
    search.flags.lambda = believable_lambda(&problem, &first);
    let root = search.fit(Vec::new(), &first.fit.fit.state)?;
    let nodes = search.run(root.clone(), &|| progress("searching for effects"))?;
    progress("held-out poses");
    let best = search.within(nodes[0].clone())?;
    let (verdict, best) = judge(&search, &root, &nodes[0], &best)?;

    let folds = folds::random(data, &rows, folds::SEED);
    let show = show::Show { search: &search, folds: &folds, holdout, robot };
    shown(&show, Found { verdict, best, root, nodes, start, not_testable })
}

/// What a search found.
struct Found {
    verdict: Verdict,
    best: Node,
    root: Node,
    nodes: Vec<Node>,
    /// Where the search began.
    start: State,
    not_testable: Vec<String>,
}

/// The model, and what shows how good it is.
fn shown(show: &show::Show, found: Found) -> Result<Diagnosis> {
    let Found { verdict, best, root, nodes, start, not_testable } = found;
    let problem = show.search.problem;
    let nominal = nominal_state(problem, &best.fit.kept, &start)?;
    let (best, stages, gap) = with_held_out_gain(show, &root, best, &nominal)?;
    let nothing = best.added.is_empty() && best.fit.outliers.is_empty();
    let verdict = match verdict {
        Verdict::Explained if nothing => Verdict::Clean,
        other => other,
    };
    let alternatives = if matches!(verdict, Verdict::Explained) {
        show::alternatives(show.search, show.robot, &best, &nodes)
    } else {
        Vec::new()
    };
    let (alternatives, rivals) = alternatives.into_iter().unzip();
    let terms = problem.with_terms(best.fit.fit.state.terms.len());
    let findings = findings(show, &terms, &best, nominal)?;
    let mut identified = findings.summarise();
    identified.figures.warnings.extend(too_many(&best));
    let rows = &problem.data.rows;
    let variance: f64 = rows.iter().map(|r| kind(r).noise(r).powi(2)).sum();
    let outcome = Outcome {
        figures: identified.figures,
        verdict,
        effects: show::effects(&findings, &stages, &gap, &best),
        noise_floor_mm: (variance / rows.len() as f64).sqrt() * 1e3,
        reduced_chi_square: best.reduced,
        geometry_reduced_chi_square: root.reduced,
        gap,
        alternatives,
        not_testable,
        whereabouts: tell::sentences(problem, &root, show.search.flags.lambda),
    };
    Ok(Diagnosis {
        model: identified.model,
        outcome,
        rows: identified.rows,
        state: best.fit.fit.state,
        alternatives: rivals,
    })
}

/// The final model as an estimate, with its held-out errors.
fn findings<'a>(
    show: &show::Show<'a>,
    problem: &'a Problem<'a>,
    best: &Node,
    nominal: State,
) -> Result<Findings<'a>> {
    let blocked = match folds::blocked(problem.data, show.search.rows) {
        Some(folds) => Some(show::Show { folds: &folds, ..*show }.held_out(best)?),
        None => None,
    };
    Ok(Findings {
        rule: "marginal-likelihood",
        robot: show.robot,
        problem,
        nominal,
        found: Estimate {
            fit: best.fit.fit.clone(),
            robust: best.fit.clone(),
            lambda: show.search.flags.lambda,
            choice: None,
        },
        held_out: show.held_out(best)?,
        blocked,
        cross_validation: format!(
            "{} folds of poses, flags redone in each, terms held",
            show.folds.len()
        ),
    })
}

/// A remark where a controller has no room for the model.
fn too_many(best: &Node) -> Option<String> {
    let terms = candidates::arm_terms(&best.added);
    (terms > MAX_TERMS).then(|| {
        format!(
            "{terms} terms of the arm where a controller takes {MAX_TERMS}: --most-terms \
             {MAX_TERMS} gives the best model that can be packed"
        )
    })
}

/// The tolerances of the prior are a guess; corrections that are larger all
/// over say that the arm was made to wider ones (one step towards the maximum of
/// the marginal likelihood).
fn believable_lambda(problem: &Problem, node: &Node) -> f64 {
    let norm = problem.corrections(&node.fit.fit.state).norm_squared();
    let count = 5.0 * problem.nominal.len() as f64;
    (count / norm.max(1e-9)).clamp(POLICY.least_lambda, 1.0)
}
