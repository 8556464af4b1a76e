//! One cell in full, for the counterparts of the paper's figures: the cell
//! beyond geometry, base and tool held as in the paper.

use nalgebra::Vector3;
use truearm::Pose;

use super::cell::{Cell, Kind};
use super::trial::{Contest, contest_of};
use truearm_host::error::Result;
use truearm_host::evaluate::{Reregister, residuals};
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Conditions, Problem, Scaling, State, nominal_state};
use truearm_host::methods::{Comparison, Frames, Printed, Task, all, compare};
use truearm_host::model::Measurements;
use truearm_host::model::arm::chain;

/// The cell and what follows from it.
pub struct Example {
    /// The cell.
    pub cell: Cell,
    /// Its methods, base and tool held.
    pub held: Comparison,
    /// Scores with base and tool fitted, then held.
    pub contests: [Contest; 2],
    /// Registered nominal arm.
    pub start: State,
    /// The L-curve.
    pub curve: Curve,
}

/// Regularisation as printed, for every lambda.
pub struct Curve {
    /// Lambda, residual norm (m), solution norm (m and rad).
    pub points: Vec<[f64; 3]>,
    /// Lambda, mean error of the 52 points and of the 250, mm.
    pub errors: Vec<[f64; 3]>,
    /// The corner, as an entry of `points`.
    pub corner: [f64; 3],
    /// Lambdas of the first step with the mean error of the 52 points, mm.
    pub decades: Vec<(f64, f64)>,
    /// Of the second.
    pub tenths: Vec<(f64, f64)>,
    /// What the two steps choose, as an entry of `points`.
    pub chosen: [f64; 3],
    /// Modelled 52 points for each lambda of the second step, m.
    pub simulated: Vec<Vec<Vector3<f64>>>,
    /// Errors of the 52 points for a few lambdas, mm.
    pub by_point: Vec<(f64, Vec<f64>)>,
    /// Largest singular value squared: what lambda is to be seen against.
    pub largest: f64,
}

impl Example {
    /// Of a seed.
    ///
    /// # Errors
    /// When the cell cannot be identified.
    pub fn new(seed: u64) -> Result<Self> {
        let cell = Cell::draw(seed, Kind::Beyond)?;
        let robot = &cell.arm.robot;
        let judge = Some((&cell.validation, Reregister::Nothing));
        let run = |frames| compare(robot, &cell.identification, judge, frames, &all());
        let (held, fitted) = (run(Frames::Held)?, run(Frames::Fitted)?);
        let problem = Problem::new(&cell.identification, robot, Scaling::Prior);
        let rows: Vec<usize> = (0..cell.identification.rows.len()).collect();
        let first = register(&cell.identification, &problem.nominal, robot.tool)?;
        let start = nominal_state(&problem, &rows, &first)?;
        let task = Task::new(&problem, start.clone(), &rows, Frames::Held);
        let curve = curve(&cell, &task)?;
        let contests = [contest_of(&cell, &fitted), contest_of(&cell, &held)];
        Ok(Self { held, contests, start, curve, cell })
    }

    /// Nominal points of the 52 poses in the robot's frame, m.
    #[must_use]
    pub fn reference(&self) -> Vec<Vector3<f64>> {
        let robot = &self.cell.arm.robot;
        let arm = chain(&robot.nominal(), Pose::identity(), self.start.markers[0]);
        self.cell.identification.rows.iter().map(|r| arm.pose(&r.q).translation).collect()
    }
}

fn distances(cell: &Cell, data: &Measurements, state: &State) -> Vec<f64> {
    let all = residuals(data, &Conditions::new(data, &cell.arm.robot), state);
    all.iter().map(|r| r.norm() * 1e3).collect()
}

fn curve(cell: &Cell, task: &Task) -> Result<Curve> {
    let printed = Printed::new(task);
    let factorised = printed.factorised();
    let largest = factorised.singular_values().iter().copied().fold(0.0, f64::max).powi(2);
    let grid: Vec<f64> =
        (0..=80).map(|k| largest * 10_f64.powf(-18.0 + 0.25 * f64::from(k))).collect();
    let point =
        |l: &f64| [*l, factorised.residual_square(*l).sqrt(), factorised.norm_square(*l).sqrt()];
    let mean = |v: Vec<f64>| v.iter().sum::<f64>() / v.len() as f64;
    let mut errors = Vec::new();
    for lambda in &grid {
        let state = printed.state(*lambda)?;
        let of = |data| mean(distances(cell, data, &state));
        errors.push([*lambda, of(&cell.identification), of(&cell.exact)]);
    }
    let tried = |lambdas: &[f64]| -> Vec<(f64, f64)> {
        lambdas.iter().map(|l| (*l, printed.mean_error(*l) * 1e3)).collect()
    };
    let decades = printed.decades();
    let tenths = printed.tenths(printed.best(&decades));
    let data = &cell.identification;
    let mut simulated = Vec::new();
    for lambda in &tenths {
        let state = printed.state(*lambda)?;
        let residuals = residuals(data, &Conditions::new(data, &cell.arm.robot), &state);
        simulated.push(
            data.rows
                .iter()
                .zip(residuals)
                .map(|(row, r)| row.measured.point() - r.point())
                .collect(),
        );
    }
    let mut by_point = Vec::new();
    for share in [1e-15, 1e-6, 1e-4, 1e-2, 1.0] {
        let lambda = largest * share;
        by_point.push((lambda, distances(cell, data, &printed.state(lambda)?)));
    }
    Ok(Curve {
        points: grid.iter().map(point).collect(),
        errors,
        corner: point(&printed.corner()),
        decades: tried(&decades),
        tenths: tried(&tenths),
        chosen: point(&printed.two_step()),
        simulated,
        by_point,
        largest,
    })
}
