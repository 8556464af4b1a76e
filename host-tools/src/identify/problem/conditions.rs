//! What terms depend on, row by row: gravity, approach side, temperature.

use nalgebra::Vector3;
use rayon::prelude::*;
use truearm::effects::Term;
use truearm::{Approach, Link, Pose};

use crate::model::arm::{ArmMasses, Kinematics, RowInputs, chain};
use crate::model::{ErrorCurve, JointTables, Measurements, Model, Mounting, Robot, Row, Warming};

/// A joint is loaded if its torque varies by more than this share of the most that one varies by.
const LOADED: f64 = 0.01;

/// Where nothing is known.
static RIGID: RowInputs = RowInputs::RIGID;

/// Inputs of every row, and which of them are known at all.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Conditions {
    /// One entry a row; none where nothing but joints moves the arm.
    pub rows: Vec<RowInputs>,
    /// Gravity and masses are given.
    pub masses: bool,
    /// Torques of the joints were read.
    pub torques: bool,
    /// They may be what joints hold or what loads them: gravity's direction is not
    /// known.
    pub torques_of_either_sign: bool,
    /// Some row has a temperature, and they differ.
    pub temperature: bool,
    /// Where they differ and every row that has one has a time: the usual time from row to
    /// row and the length of the longest session, s.
    pub warming: Option<[f64; 2]>,
    /// Some row has approach sides.
    pub direction: bool,
    /// They were taken from the order of the rows.
    pub direction_from_order: bool,
    /// As of [`Measurements`].
    pub sides_found: Vec<usize>,
    /// The row that was measured just before each.
    pub before: Vec<Option<usize>>,
    /// Some row has a time, and they differ.
    pub time: bool,
    /// Some row has a number in the session, and they differ.
    pub ordered: bool,
    /// Labels of the series, in order of appearance.
    pub series: Vec<String>,
}

/// What terms and curves depend on: the state that a row tells, gravity at the
/// masses of a robot, tables of its joints.
pub struct Surroundings {
    masses: Option<ArmMasses>,
    arm: Box<dyn Kinematics>,
    reference: f64,
    curves: Option<JointTables>,
    /// What a torque that a row reads is multiplied by to be one of gravity; none where they
    /// are not read.
    read: Option<f64>,
}

impl Surroundings {
    /// Of a model's arm, with its curves.
    #[must_use]
    pub fn of_model(model: &Model) -> Self {
        let curves = (!model.curves.is_empty()).then(|| JointTables::new(&model.curves));
        Self { curves, ..Self::at(&model.robot, &model.links()) }
    }

    /// Whether joints err by a curve.
    #[must_use]
    pub fn has_curves(&self) -> bool {
        self.curves.is_some()
    }

    /// Of a robot as it is drawn.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Self::at(robot, &robot.nominal())
    }

    /// Of a robot with these links: loads are those of the arm before it bends.
    #[must_use]
    pub fn at(robot: &Robot, links: &[Link<f64>]) -> Self {
        let masses = match robot.gravity {
            Some(gravity) if !robot.links.is_empty() => Some(ArmMasses {
                gravity,
                links: robot.links.iter().map(|l| (l.mass, l.com)).collect(),
                payload: robot.payload,
            }),
            _ => None,
        };
        let arm = chain(links, Pose::identity(), Vector3::zeros());
        Self { masses, arm, reference: robot.reference_temperature, curves: None, read: None }
    }

    /// The same where torques that all of these rows have read count in the place of
    /// computed ones. A joint holds what gravity pulls it by: gravity's torque is the opposite
    /// of what is read, unless the file counts the other way, which computed torques tell.
    #[must_use]
    pub fn reading(self, data: &Measurements, robot: &Robot) -> Self {
        if !data.has_torques() {
            return Self { read: None, ..self };
        }
        // Without gravity's direction nothing tells.
        let assumed = robot.gravity.and_then(|_| robot.with_assumed_loads(Mounting::Upright));
        let assumed = assumed.map(|robot| Self::new(&robot));
        let computing = assumed.as_ref().unwrap_or(&self);
        let alike = |row: &Row| {
            let computed = computing.computed(row, &row.q).torque;
            computed.iter().zip(&row.torques).map(|(computed, read)| computed * read).sum::<f64>()
        };
        let alike: f64 = data.rows.iter().map(alike).sum();
        Self { read: Some(if alike > 0.0 { 1.0 } else { -1.0 }), ..self }
    }

    /// What was read of the torques of a row, as those of gravity.
    #[must_use]
    pub fn torques(&self, row: &Row) -> Option<Vec<f64>> {
        self.read.map(|sign| row.torques.iter().map(|read| sign * read).collect())
    }

    /// Loads that masses give.
    fn computed(&self, row: &Row, q: &[f64]) -> RowInputs {
        let payload = row.payload.unwrap_or(0.0);
        self.masses.as_ref().map(|m| self.arm.load(m, q, payload)).unwrap_or_default()
    }

    /// At joint values `q` (rad or m) in the state that a row tells.
    #[must_use]
    pub fn inputs(&self, row: &Row, q: &[f64]) -> RowInputs {
        let mut load = self.computed(row, q);
        load.torque = self.torques(row).unwrap_or(load.torque);
        let warmth = row.temperature.map_or(0.0, |t| t - self.reference);
        let warming = row.warming.clone();
        let approach = row.directions.iter().map(|d| Approach::of_motion(f64::from(*d)));
        let curves = self.curves.as_ref().map_or_else(Vec::new, |tables| tables.bend(q));
        let approach = approach.collect();
        RowInputs { approach, warmth, warming, curves, ..load }
    }
}

impl Conditions {
    /// Of an arm that nothing but its joints moves, at any row.
    #[must_use]
    pub fn rigid() -> Self {
        Self::default()
    }

    /// As many ways there were to choose the sides that were found of a joint, counted from 0.
    #[must_use]
    pub fn ways_of_sides(&self, joint: usize) -> f64 {
        self.sides_found.get(joint).map_or(1.0, |found| (*found as f64).exp2())
    }

    /// Inputs of a row.
    #[must_use]
    pub fn row(&self, row: usize) -> &RowInputs {
        if self.rows.is_empty() { &RIGID } else { &self.rows[row] }
    }

    /// Of these measurements, loads of the robot as it is drawn.
    #[must_use]
    pub fn new(data: &Measurements, robot: &Robot) -> Self {
        Self::at(data, robot, &robot.nominal())
    }

    /// Whether what loads a joint, counted from 0, varies from row to row, as far as masses tell,
    /// assumed ones too.
    #[must_use]
    pub fn is_loaded(&self, joint: usize) -> bool {
        let range = |joint: usize| {
            let torques = self.rows.iter().filter_map(|row| row.torque.get(joint));
            let ends = torques.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
                (low.min(*t), high.max(*t))
            });
            (ends.1 - ends.0).max(0.0)
        };
        let joints = self.rows.iter().map(|row| row.torque.len()).max().unwrap_or(0);
        let most = (0..joints).map(range).fold(0.0, f64::max);
        range(joint) > LOADED * most
    }

    /// Of these measurements, loads of the robot with these links.
    #[must_use]
    pub fn at(data: &Measurements, robot: &Robot, links: &[Link<f64>]) -> Self {
        let surroundings = Surroundings::at(robot, links).reading(data, robot);
        let torques = surroundings.read.is_some();
        let rows = data.rows.par_iter().map(|row| surroundings.inputs(row, &row.q)).collect();
        let differ = |f: fn(&crate::model::Row) -> Option<f64>| {
            let mut values = data.rows.iter().filter_map(f);
            values.next().is_some_and(|first| values.any(|v| v != first))
        };
        let mut series: Vec<String> = Vec::new();
        for label in data.rows.iter().filter_map(|r| r.series.as_ref()) {
            if !series.contains(label) {
                series.push(label.clone());
            }
        }
        Self {
            rows,
            masses: surroundings.masses.is_some(),
            torques,
            torques_of_either_sign: torques && robot.gravity.is_none(),
            temperature: differ(|r| r.temperature),
            warming: warming(&data.rows).filter(|_| differ(|r| r.temperature)),
            direction: data.rows.iter().any(|r| r.directions.iter().any(|d| *d != 0)),
            direction_from_order: data.directions_from_order,
            sides_found: data.sides_found.clone(),
            before: data.moved_from(),
            time: differ(|r| r.time),
            ordered: differ(|r| r.order),
            series,
        }
    }

    /// Of these measurements of a model's arm, with its curves.
    #[must_use]
    pub fn of_model(data: &Measurements, model: &Model) -> Self {
        Self::at(data, &model.robot, &model.links()).with_curves(data, &model.curves)
    }

    /// The largest load of a spring, at least so much that it can be divided by.
    #[must_use]
    pub fn largest_load(&self, spring: &Term<f64>) -> f64 {
        let loads = self.rows.iter().map(|row| row.load(spring).abs());
        loads.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The same with gravity at the masses of another robot, and with these links.
    #[must_use]
    pub fn with_loads(mut self, data: &Measurements, robot: &Robot, links: &[Link<f64>]) -> Self {
        let surroundings = Surroundings::at(robot, links);
        self.rows.par_iter_mut().zip(&data.rows).for_each(|(inputs, row)| {
            let RowInputs { torque, moment, across, .. } = surroundings.computed(row, &row.q);
            (inputs.torque, inputs.moment, inputs.across) = (torque, moment, across);
        });
        self
    }

    /// The same with these curves, at the joint values of these measurements.
    #[must_use]
    pub fn with_curves(mut self, data: &Measurements, curves: &[ErrorCurve]) -> Self {
        let tables = JointTables::new(curves);
        for (inputs, row) in self.rows.iter_mut().zip(&data.rows) {
            inputs.curves = if curves.is_empty() { Vec::new() } else { tables.bend(&row.q) };
        }
        self
    }
}

/// The usual time from row to row and the length of the longest session, s, if every row
/// that has a temperature is in one.
fn warming(rows: &[Row]) -> Option<[f64; 2]> {
    if rows.iter().any(|row| row.temperature.is_some() && row.warming.is_none()) {
        return None;
    }
    let all = || rows.iter().filter_map(|row| row.warming.as_ref());
    let mut steps: Vec<f64> = all().filter_map(Warming::step).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let usual = *steps.get(steps.len() / 2)?;
    Some([usual, all().map(Warming::passed).fold(0.0, f64::max)])
}
