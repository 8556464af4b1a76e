//! A simulator of arms whose truth is known: kinematics of the 4x4 oracle of
//! the crate's tests, measurements written as text, as a user's would be.

#![allow(dead_code, reason = "each test file uses a part")]

#[path = "../../../tests/common/mod.rs"]
pub mod oracle;

pub mod arm;
pub mod coverage;
mod draw;
pub mod effects;
pub mod planning;
pub mod regret;
pub mod robots;
pub mod secret;
pub mod sets;

use std::path::Path;

use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::{Rng, RngExt};
use truearm::{JointKind, Link, MdhParameters, Pose};
use truearm_host::files::{Measurements, Robot};
use truearm_host::identify::{Conditions, Identification, State};
pub use truearm_host::simulate::normal;
pub use truearm_host::simulate::normal_vector as vector;

/// A UR10-like arm, tool off the last axis: 27 of 39 parameters identifiable.
pub const UR10_LIKE: &str = r#"
name = "simulated 6R"
measurement_sigma_mm = 0.02
tool.xyz_mm = [60.0, -25.0, 110.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 127.3, theta_offset_deg = 0 },
  { alpha_deg = 90, a_mm = 0, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = 0, a_mm = -612, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = 0, a_mm = -572.3, d_mm = 163.941, theta_offset_deg = 0 },
  { alpha_deg = 90, a_mm = 0, d_mm = 115.7, theta_offset_deg = 0 },
  { alpha_deg = -90, a_mm = 0, d_mm = 92.2, theta_offset_deg = 0 },
]
"#;

/// A 6R arm on a linear axis.
pub const ON_RAIL: &str = r#"
name = "simulated 6R on a rail"
measurement_sigma_mm = 0.02
tool.xyz_mm = [40.0, 30.0, 120.0]
joints = [
  { kind = "prismatic", alpha_deg = 90, a_mm = 0, d_offset_mm = 100, theta_offset_deg = 0, limits_mm = [0, 1500] },
  { alpha_deg = -90, a_mm = 50, d_mm = 400, theta_offset_deg = 0 },
  { alpha_deg = -90, a_mm = 100, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = 0, a_mm = 450, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = -90, a_mm = 60, d_mm = 420, theta_offset_deg = 0 },
  { alpha_deg = 90, a_mm = 0, d_mm = 0, theta_offset_deg = 0 },
  { alpha_deg = -90, a_mm = 0, d_mm = 80, theta_offset_deg = 0 },
]
"#;

pub fn robot(text: &str) -> Robot {
    Robot::parse(Path::new("robot.toml"), text).unwrap()
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
            let rotation = Rotation3::from_scaled_axis(vector(rng));
            let mut base = oracle::identity();
            for i in 0..3 {
                for j in 0..3 {
                    base[i][j] = rotation[(i, j)];
                }
                base[i][3] = rng.random_range(-3.0..3.0);
            }
            base
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
        let mut text = names.join(",") + "\n";
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
            text += &(cells.join(",") + "\n");
        }
        text
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
    (residuals.iter().map(|r| r.norm_squared()).sum::<f64>() / residuals.len() as f64).sqrt()
}

/// The identified state, stations and markers in the order of `check`.
pub fn state_of(found: &Identification, check: &Measurements) -> State {
    let base = |label: &String| found.model.stations.iter().find(|s| s.0 == *label).unwrap().1;
    let tool = |label: &String| found.model.markers.iter().find(|m| m.0 == *label).unwrap().1;
    State {
        bases: check.stations.iter().map(base).collect(),
        markers: check.markers.iter().map(tool).collect(),
        links: found.model.links(),
        terms: found.model.terms.clone(),
    }
}
