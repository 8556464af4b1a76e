//! What is attainable, and how large an effect is beside everything else.

use nalgebra::{DMatrix, DVector};
use truearm_host::identify::fit::robust::{Flags, robust_fit};
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Problem, Scaling, State};
use truearm_host::model::Measurements;
use truearm_simulate::arm::Arm;
use truearm_simulate::body::Moment;
use truearm_simulate::effects::Defect;

use super::set::DirtySet;
use crate::simulated::{parse, rms, robot};
use crate::terms::terms;

/// A name at a place.
pub type Place = (String, Vec<usize>);

/// Hold-out RMS (m) of a fit that is told the effects and the noise; `None`
/// where one has no name, or where the fit fails.
pub fn attainable(set: &DirtySet) -> Option<f64> {
    let secret = set.open();
    if secret.hidden.unlisted.is_some() {
        return None;
    }
    let mut robot = robot(&set.robot);
    robot.sigma = secret.noise.of_pose.hypot(secret.noise.of_reading);
    let (data, holdout) = (parse(&robot, &set.measurements), parse(&robot, &set.holdout));
    let all = secret.hidden.listed.iter().map(|d| terms(&d.kind, &secret.arm.gear_ratios));
    let terms = all.collect::<Option<Vec<_>>>()?.concat();
    let problem = Problem::new(&data, &robot, Scaling::Prior);
    let rows: Vec<usize> = (0..data.rows.len()).collect();
    let start = register(&data, &problem.nominal, robot.tool).ok()?;
    let bare = robust_fit(&problem, &rows, &start, Flags::default()).ok()?.fit.state;
    let problem = problem.with_terms(terms.len());
    let found = robust_fit(&problem, &rows, &State { terms, ..bare }, Flags::default()).ok()?;
    Some(rms(&robot, &found.fit.state, &holdout))
}

/// 3-D RMS of each listed effect over the measured poses, geometry and the other
/// effects projected off, over that of the noise.
pub fn floors(set: &DirtySet) -> Vec<f64> {
    let secret = set.open();
    let (robot, [data, _]) = set.read();
    let noise = secret.noise.of_pose.hypot(secret.noise.of_reading) * 3.0_f64.sqrt();
    let listed = secret.hidden.listed.iter();
    let moved: Vec<DVector<f64>> =
        listed.map(|d| moved(&secret.arm, std::slice::from_ref(d), &secret.moments)).collect();
    let geometry = geometry(&data, &robot);
    let size = |k: usize| {
        let others = (0..moved.len()).filter(|o| *o != k).map(|o| &moved[o]);
        let left = off(&geometry, &others.collect::<Vec<_>>(), &moved[k]);
        (left.norm_squared() / secret.moments.len() as f64).sqrt() / noise
    };
    (0..moved.len()).map(size).collect()
}

/// How an effect moves the measured points, m.
pub fn moved(arm: &Arm, effect: &[Defect], moments: &[Moment]) -> DVector<f64> {
    let with = |defects: Vec<Defect>| Arm { defects, ..arm.clone() };
    let (with, without) = (with(effect.to_vec()), with(Vec::new()));
    let of = moments.iter().flat_map(|m| {
        let d = with.point(m) - without.point(m);
        [d.x, d.y, d.z]
    });
    DVector::from_iterator(3 * moments.len(), of)
}

/// Columns of geometry, base and tool at the nominal arm.
fn geometry(data: &Measurements, robot: &truearm_host::model::Robot) -> DMatrix<f64> {
    let problem = Problem::new(data, robot, Scaling::Prior);
    let columns = problem.unknowns.list().len();
    let mut out = DMatrix::zeros(3 * data.rows.len(), columns);
    if let Ok(state) = register(data, &problem.nominal, robot.tool) {
        let at = problem.linearise(&state);
        for row in 0..data.rows.len() {
            out.rows_mut(3 * row, 3).copy_from(&at.equations(row).block);
        }
    }
    out
}

/// A column with others projected off; those that hang on each other are held by
/// a share of 1e-9 of their length.
fn off(geometry: &DMatrix<f64>, others: &[&DVector<f64>], column: &DVector<f64>) -> DVector<f64> {
    let p = geometry.ncols();
    let mut all = geometry.clone().resize_horizontally(p + others.len(), 0.0);
    others.iter().enumerate().for_each(|(k, other)| all.set_column(p + k, other));
    for mut column in all.column_iter_mut() {
        let length = column.norm();
        if length > 0.0 {
            column /= length;
        }
    }
    let mut h = all.tr_mul(&all);
    (0..h.nrows()).for_each(|k| h[(k, k)] += 1e-9);
    match h.cholesky() {
        Some(factor) => column - &all * factor.solve(&all.tr_mul(column)),
        None => column.clone(),
    }
}
