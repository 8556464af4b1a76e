//! What weighing says.

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::Serialize;

use super::nameless::{self, Nameless};
use super::possible::What;
use super::sheet::ByCurves;
use crate::diagnose::candidates::Candidate;
use crate::diagnose::moments::Moments;
use crate::diagnose::node::Node;
use crate::identify::Scatterer;
use crate::model::ErrorCurve;
use crate::observations::Residual;
use crate::statistics::Stats;

/// A name at a place, and what speaks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Name of the effect.
    pub name: &'static str,
    /// As in reports.
    pub joints: Vec<usize>,
    /// That the arm has it.
    pub probability: f64,
    /// Where it may be there at some of several orders: that each is, cycles a turn.
    pub orders: Vec<(f64, f64)>,
    /// Fall of the error of each half of the poses when it is fitted to the
    /// other one.
    pub half_gain: [f64; 2],
    /// What speaks against the name, however probable.
    pub doubt: Option<Doubt>,
}

/// Structure without a name, and what speaks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Unnamed {
    /// What it is.
    pub what: Nameless,
    /// That it is there.
    pub probability: f64,
    /// As of [`Named`].
    pub half_gain: [f64; 2],
    /// What may be there in its place, and that it is: it shares the probability.
    pub instead: Vec<(What, f64)>,
    /// That it or the first of those without a name is there.
    pub together: f64,
    /// Coefficients in the most probable model and their covariance, SI; none where it is
    /// not in that.
    pub coefficients: Option<(DVector<f64>, DMatrix<f64>)>,
}

/// The answer.
pub struct Weighed {
    /// The most probable model, fitted.
    pub best: Node,
    /// Its names, and others that have some probability.
    pub names: Vec<Named>,
    /// Structure without a name.
    pub nameless: Vec<Unnamed>,
    /// The most probable models that make other claims, with their odds to the
    /// best one.
    pub rivals: Vec<(Vec<Candidate>, f64)>,
    /// Noise over the stated sigma.
    pub scale: f64,
    /// Held-out residuals, everything decided anew in each fold.
    pub nested: Vec<Option<Residual>>,
    /// Effects of the most probable model that are not in the best one, as there is
    /// no room for their terms.
    pub no_room: usize,
    /// Effects that fitted, of signs or sizes that physics refuses.
    pub refused: Vec<Candidate>,
    /// Of these, what would have been named.
    pub surely_refused: Vec<Candidate>,
    /// What scatters by itself, and by how much, rad or m (one standard deviation).
    pub scattering: Vec<(Scatterer, f64)>,
    /// Moments of the links that go with its springs.
    pub moments: Option<Moments>,
    /// Error curves of joints, and what each is worth.
    pub curves: Vec<Curved>,
    /// What is not known of them, at the tool.
    pub by_curves: ByCurves,
    /// Where there are curves: the way from curves alone to the best model.
    pub stages: Vec<Stage>,
}

impl Weighed {
    /// What the most probable model has that has no name.
    #[must_use]
    pub fn held_nameless(&self) -> Vec<nameless::Held> {
        let held = |u: &Unnamed| Some((u.what, u.coefficients.as_ref()?.0.clone()));
        self.nameless.iter().filter_map(held).collect()
    }

    /// RMS of these rows, predicted with everything decided without their fold; `None` where
    /// no row is.
    #[must_use]
    pub fn nested_rms_mm(&self, rows: &[usize]) -> Option<f64> {
        let held = rows.iter().filter_map(|row| self.nested[*row]);
        Stats::of(held).map(|stats| stats.rms_mm)
    }
}

/// An error curve of a joint.
#[derive(Debug, Clone)]
pub struct Curved {
    /// As it is flashed.
    pub table: ErrorCurve,
    /// Length of its covariance, rad.
    pub length: f64,
    /// Log evidence lost without it, its prior odds included.
    pub log_odds: f64,
    /// Log odds of a few waves of whole orders in its place.
    pub few: f64,
    /// As of [`Named`].
    pub half_gain: [f64; 2],
}

/// A model on the way, its coefficients fitted anew without each fold.
#[derive(Debug, Clone)]
pub struct Stage {
    /// What it leaves of every row that it was fitted to, moments of its own among what was
    /// fitted; `None` where no spring bends in it.
    pub fitted: Option<Vec<Option<Residual>>>,
    /// Effects that the stage has beside the curves.
    pub names: Vec<&'static str>,
    /// Its curves.
    pub tables: Vec<ErrorCurve>,
    /// Held-out residuals.
    pub held_out: Vec<Option<Residual>>,
}

/// What speaks against a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Doubt {
    /// The halves of the poses disagree, or one does not gain by the other.
    Halves,
    /// The joint is also off by a share of its last move, which has no name: the side
    /// that it came from and a share of its angle are parts of that.
    Memory,
    /// The joint was measured at so few angles that any function of it fits.
    Levels,
    /// Nobody stated the masses of the links: what hangs on the joint loads it by the cosine
    /// of its angle, and a spring does what an eccentricity does.
    Unweighed,
    /// Poses of the hold-out file are missed by more with it than without it, and by no little.
    HeldOut,
    /// The joint's spring stiffens, and the side of its gap is that of its load: what the two
    /// slopes of a harmonic drive are beside that of a spring that stiffens in proportion.
    Knee,
    /// A few waves of the joint's angle are nearly as probable as its curve, or more so.
    Waves,
}

impl Doubt {
    /// In a report's line.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Halves => "the halves of the poses disagree",
            Self::Memory => "the joint depends on its last move in a way that has no name",
            Self::Levels => "at so few angles of the joint any function of them fits",
            Self::Unweighed => "without [[links]] a spring of the joint does the same",
            Self::HeldOut => "poses of the hold-out file are missed by less without it",
            Self::Waves => "a few waves of the joint's angle do as well",
            Self::Knee => "its side is that of the load, and a spring of two slopes does the same",
        }
    }
}
