//! The sealed part of a blind set: what was hidden, and what a fit that is told of
//! it attains.

use truearm::effects::{Effect, Term};
use truearm_host::identify::fit::robust::{Flags, robust_fit};
use truearm_host::identify::{Conditions, Problem, Scaling, State};
use truearm_host::model::{Measurements, ModelTerm, Robot};
use truearm_simulate::arm::Arm;
use truearm_simulate::effects::DefectKind;

use crate::simulated::rms;
use crate::terms::terms;

/// What was hidden.
pub struct Secret {
    pub arm: Arm,
    /// Geometry and frames.
    pub truth: State,
    /// Size of the geometric errors, tolerances.
    pub scale: f64,
    /// Rows with gross errors, from 1.
    pub outliers: Vec<usize>,
    /// True gravity torque of each row on a joint with a gap; else empty.
    pub torques: Vec<f64>,
}

impl Secret {
    /// Hold-out RMS (m) and reduced chi-square of a fit that is told which
    /// effects there are; `None` if one of them is unlisted.
    pub fn fit(
        &self,
        robot: &Robot,
        data: &Measurements,
        holdout: &Measurements,
    ) -> Option<[f64; 2]> {
        let kinds = self.arm.defects.iter().map(|d| terms(&d.kind, &self.arm.gear_ratios));
        let terms = kinds.collect::<Option<Vec<_>>>()?.concat();
        // With masses that are a few percent off, the torque where gravity takes
        // over a gap is as far off: the best one is looked for.
        let gap = self.arm.defects.iter().any(|d| matches!(d.kind, DefectKind::Backlash { .. }));
        let factors = if gap { -10..=10 } else { 0..=0 };
        let fits = factors.filter_map(|k| {
            let mut terms = terms.clone();
            for term in &mut terms {
                if let ModelTerm::Arm(Term { effect: Effect::Backlash, order, .. }) = term {
                    *order *= 1.0 + 0.02 * f64::from(k);
                }
            }
            self.fit_terms(terms, robot, data, holdout)
        });
        let best = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(best.1)
    }

    /// Cost of the fit, then what [`Secret::fit`] tells.
    fn fit_terms(
        &self,
        terms: Vec<ModelTerm>,
        robot: &Robot,
        data: &Measurements,
        holdout: &Measurements,
    ) -> Option<(f64, [f64; 2])> {
        let problem = Problem::new(data, robot, Scaling::Prior).with_terms(terms.len());
        let start = State { terms, ..self.truth.clone() };
        let rows: Vec<usize> = (0..data.rows.len()).collect();
        let flags = Flags { lambda: self.scale.powi(-2), gross: 6.0, ..Flags::default() };
        let found = robust_fit(&problem, &rows, &start, flags).ok()?;
        let at = problem.linearise(&found.fit.state);
        let square: f64 = found
            .kept
            .iter()
            .map(|r| (at.residual(*r) / data.rows[*r].sigma).values().norm_squared())
            .sum();
        // The unknowns that no data can tell apart do not count: about six.
        let freedom = 3 * found.kept.len() + 6 - problem.unknowns.list().len();
        let rms = rms(robot, &found.fit.state, holdout);
        let cost = square + flags.gross.powi(2) * found.outliers.len() as f64;
        Some((cost, [rms, square / freedom as f64]))
    }

    /// Rows (from 1) on the other side of a gap than stated masses and the true
    /// friction say.
    pub fn turned(&self, robot: &Robot, data: &Measurements) -> Vec<usize> {
        let conditions = Conditions::new(data, robot);
        let mut out = Vec::new();
        for defect in &self.arm.defects {
            let DefectKind::Backlash { joint, friction } = defect.kind else { continue };
            let side = |torque: f64, row: usize| {
                let lag = -f64::from(data.rows[row].directions[joint]);
                if torque.abs() > friction { torque.signum() } else { lag }
            };
            let wrong = |row: &usize| {
                let stated = side(conditions.rows[*row].torque[joint], *row);
                stated != side(self.torques[*row], *row)
            };
            out.extend((0..data.rows.len()).filter(wrong).map(|row| row + 1));
        }
        out
    }
}
