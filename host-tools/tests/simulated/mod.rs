//! What the simulator has, as a user would bring it: measurements written as
//! text and read as files are. For the tests of the host and for the studies.

#![allow(dead_code, unused_imports, reason = "each test takes what it needs")]

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use rand::{Rng, RngExt};
use truearm::{JointKind, Link, MdhParameters, Pose};
use truearm_host::Result;
use truearm_host::identify::{Conditions, Identification, State};
use truearm_host::model::{Joint, Measurements, Robot};
use truearm_simulate::oracle;
pub use truearm_simulate::robots::{ON_RAIL, UR10_LIKE};
use truearm_simulate::{csv, rigid};
pub use truearm_simulate::{normal, vector};

pub fn robot(text: &str) -> Robot {
    Robot::parse(Path::new("robot.toml"), text).unwrap()
}

/// The robot file in the simulator's words.
pub fn stated(robot: &Robot) -> truearm_simulate::Robot {
    let joint = |j: &Joint| truearm_simulate::Joint {
        kind: j.link.kind,
        link: j.link.parameters.to_array(),
        limits: j.limits,
        gear_ratio: j.gear_ratio,
    };
    truearm_simulate::Robot {
        joints: robot.joints.iter().map(joint).collect(),
        masses: robot.links.iter().map(|l| (l.mass, l.com)).collect(),
        gravity: robot.gravity,
        tool: robot.tool,
    }
}

/// A true arm, seen by some tracker stations, carrying some markers.
pub struct Truth {
    pub robot: Robot,
    pub links: Vec<Link<f64>>,
    pub bases: Vec<oracle::Matrix<f64>>,
    pub tools: Vec<Vector3<f64>>,
}

impl Truth {
    /// Geometric errors of the size of the tolerances, frames anywhere.
    pub fn draw(robot: &Robot, stations: usize, markers: usize, rng: &mut impl Rng) -> Self {
        Self::draw_sized(robot, stations, markers, 1.0, rng)
    }

    /// Geometric errors of so many tolerances.
    pub fn draw_sized(
        robot: &Robot,
        stations: usize,
        markers: usize,
        tolerances: f64,
        rng: &mut impl Rng,
    ) -> Self {
        let mut links = robot.nominal();
        for link in &mut links {
            let error = core::array::from_fn(|_| normal(rng) * tolerances * 1e-3);
            *link = link.corrected(&MdhParameters::from_array(error));
        }
        let bases = (0..stations).map(|_| {
            let turn = vector(rng);
            rigid(&turn, &Vector3::from_fn(|_, _| rng.random_range(-3.0..3.0)))
        });
        let bases = bases.collect();
        let mut tools = vec![robot.tool + vector(rng) * 1e-3];
        while tools.len() < markers {
            tools.push(robot.tool + vector(rng) * 0.05);
        }
        Self { robot: robot.clone(), links, bases, tools }
    }

    pub fn point(&self, q: &[f64], station: usize, marker: usize) -> Vector3<f64> {
        let kinds: Vec<_> = self.links.iter().map(|l| l.kind).collect();
        let mut x: Vec<f64> = self.links.iter().flat_map(|l| l.parameters.to_array()).collect();
        x.extend([0.0; 6]);
        x.extend(self.tools[marker].iter());
        let m = oracle::forward(&kinds, &self.bases[station], &x, q);
        Vector3::new(m[0][3], m[1][3], m[2][3])
    }

    pub fn state(&self) -> State {
        let pose = |base: &oracle::Matrix<f64>| Pose {
            rotation: Matrix3::from_fn(|i, j| base[i][j]),
            translation: Vector3::new(base[0][3], base[1][3], base[2][3]),
        };
        State {
            bases: self.bases.iter().map(pose).collect(),
            markers: self.tools.clone(),
            instruments: Vec::new(),
            links: self.links.clone(),
            terms: Vec::new(),
        }
    }

    /// Random poses as a CSV text; with several stations or markers every pose
    /// is seen from a random one of each.
    pub fn measure(&self, poses: usize, sigma: f64, rng: &mut impl Rng) -> String {
        let mut names: Vec<String> = Vec::new();
        for (j, joint) in self.robot.joints.iter().enumerate() {
            let unit = if joint.link.kind == JointKind::Revolute { "deg" } else { "mm" };
            names.push(format!("q{}_{unit}", j + 1));
        }
        names.extend(["x_mm", "y_mm", "z_mm", "station", "marker"].map(str::to_owned));
        let mut rows = vec![names];
        for _ in 0..poses {
            let mut cells = Vec::new();
            let mut q = Vec::new();
            for joint in &self.robot.joints {
                // What the file says is what the joints were: rounded first.
                if joint.link.kind == JointKind::Revolute {
                    let degrees = (rng.random_range(-150.0..150.0_f64) * 1e5).round() / 1e5;
                    q.push(degrees.to_radians());
                    cells.push(format!("{degrees:.5}"));
                } else {
                    let mm = (rng.random_range(0.0..1500.0_f64) * 1e4).round() / 1e4;
                    q.push(mm * 1e-3);
                    cells.push(format!("{mm:.4}"));
                }
            }
            let station = rng.random_range(0..self.bases.len());
            let marker = rng.random_range(0..self.tools.len());
            let p = self.point(&q, station, marker) + vector(rng) * sigma;
            cells.extend(p.iter().map(|x| format!("{:.7}", x * 1e3)));
            cells.extend([format!("S{station}"), format!("M{marker}")]);
            rows.push(cells);
        }
        csv(&rows)
    }

    pub fn parse(&self, text: &str) -> Measurements {
        parse(&self.robot, text)
    }
}

pub fn parse(robot: &Robot, text: &str) -> Measurements {
    Measurements::parse(Path::new("m.csv"), text, robot).unwrap()
}

pub fn rms(robot: &Robot, state: &State, check: &Measurements) -> f64 {
    let residuals = truearm_host::evaluate::residuals(check, &Conditions::new(check, robot), state);
    (residuals.iter().map(|r| r.norm().powi(2)).sum::<f64>() / residuals.len() as f64).sqrt()
}

/// The identified state, stations and markers in the order of `check`.
pub fn state_of(found: &Identification, check: &Measurements) -> State {
    let base = |label: &String| found.model.stations.iter().find(|s| s.0 == *label).unwrap().1;
    let tool = |label: &String| found.model.markers.iter().find(|m| m.0 == *label).unwrap().1;
    State {
        bases: check.stations.iter().map(base).collect(),
        markers: check.markers.iter().map(tool).collect(),
        instruments: found.model.instruments.clone(),
        links: found.model.links(),
        terms: found.model.terms.clone(),
    }
}

/// A `measurements.csv` of points.
#[must_use]
pub fn csv_of(robot: &Robot, poses: &[Vec<f64>], points: &[Vector3<f64>]) -> String {
    // Degrees, and millimetres of a prismatic joint.
    let units = robot.joints.iter().map(|j| match j.link.kind {
        JointKind::Revolute => ("deg", 1_f64.to_degrees()),
        JointKind::Prismatic => ("mm", 1e3),
    });
    let units: Vec<_> = units.collect();
    let names = units.iter().enumerate().map(|(j, (unit, _))| format!("q{}_{unit}", j + 1));
    let header: Vec<String> = names.chain(["x_mm", "y_mm", "z_mm"].map(str::to_owned)).collect();
    let row = |(q, p): (&Vec<f64>, &Vector3<f64>)| {
        let joints = q.iter().zip(&units).map(|(q, (_, in_si))| format!("{:.4}", q * in_si));
        joints.chain(p.iter().map(|x| format!("{:.7}", x * 1e3))).collect()
    };
    csv(std::iter::once(header).chain(poses.iter().zip(points).map(row)))
}

/// The same, as read from a file of this name.
///
/// # Errors
/// As for [`Measurements::parse`].
pub fn measured(
    robot: &Robot,
    name: &str,
    poses: &[Vec<f64>],
    points: &[Vector3<f64>],
) -> Result<Measurements> {
    Measurements::parse(Path::new(name), &csv_of(robot, poses, points), robot)
}
