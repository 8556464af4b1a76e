//! Sessions with gross mistakes in them, as the files of their users: for the
//! tests of `check` and for its study. A mistake is made in the numbers that are
//! typed; nothing here knows how it is found.

#![allow(dead_code, reason = "each test takes what it needs")]

use std::path::Path;

use rand::{Rng, RngExt};
use truearm::JointKind;
use truearm_host::check::mend::{Mended, mend};
use truearm_host::check::{Finding, Verdict, check};
use truearm_host::model::{Measurements, Robot};
use truearm_simulate::{csv, vector};

use super::simulated::Truth;

/// Two parallel axes, a slide and a turn about it.
pub const SCARA: &str = r#"
name = "SCARA"
tool.xyz_mm = [30.0, 12.0, 40.0]
joints = [
  { alpha_deg = 0, a_mm = 0, d_mm = 380, theta_offset_deg = 0, limits_deg = [-130, 130] },
  { alpha_deg = 0, a_mm = 325, d_mm = 0, theta_offset_deg = 0, limits_deg = [-140, 140] },
  { kind = "prismatic", alpha_deg = 180, a_mm = 275, d_offset_mm = 60, theta_offset_deg = 0, limits_mm = [0, 200] },
  { alpha_deg = 0, a_mm = 0, d_mm = 0, theta_offset_deg = 0, limits_deg = [-170, 170] },
]
"#;

/// The numbers that somebody typed.
#[derive(Clone)]
pub struct Session {
    pub kinds: Vec<JointKind>,
    /// alpha in degrees, a in mm, theta offset in degrees, d in mm.
    pub table: Vec<[f64; 4]>,
    pub tool: [f64; 3],
    /// Joints in degrees or mm.
    pub joints: Vec<Vec<f64>>,
    /// mm
    pub points: Vec<[f64; 3]>,
    pub sigma_mm: f64,
}

/// What was typed wrong; joints are counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Mistake {
    Sense(usize),
    /// Degrees, or mm of a slide.
    Zero(usize, f64),
    Swapped(usize, usize),
    /// Joints sorted by their names in ROS.
    Alphabetical,
    Radians,
    SlideInMetres,
    /// The length of one of these in mm.
    PointsIn(f64),
    RobotIn(f64),
    RobotInRadians,
    StandardTable,
    /// A modified table moved on by a row as if it had been standard.
    ShiftedTable,
    /// Column of the table and what is added, mm or degrees.
    Number(usize, usize, f64),
    Sign(usize, usize),
    /// The sign of an axis.
    Mirrored(usize),
    AxesSwapped(usize, usize),
    OutOfStep(bool),
}

fn kind(robot: &Robot, joint: usize) -> JointKind {
    robot.joints[joint].link.kind
}

impl Session {
    /// A poorly made arm (three times the usual tolerances) at poses within its
    /// limits, the noise misstated by up to a factor of two.
    pub fn draw(robot: &Robot, rng: &mut impl Rng) -> Self {
        let truth = Truth::draw_sized(robot, 1, 1, 3.0, rng);
        let sigma_mm: f64 = rng.random_range(0.02..0.1);
        let count = rng.random_range(40..=120);
        let (mut joints, mut points) = (Vec::new(), Vec::new());
        for _ in 0..count {
            let mut q = Vec::new();
            let mut typed = Vec::new();
            for (j, joint) in robot.joints.iter().enumerate() {
                let (unit, usual) = match kind(robot, j) {
                    JointKind::Revolute => (1_f64.to_degrees(), 2.5),
                    JointKind::Prismatic => (1e3, 0.5),
                };
                let [low, high] = joint.limits.unwrap_or([-usual, usual]);
                let value: f64 = (rng.random_range(low..high) * unit * 1e4).round() / 1e4;
                typed.push(value);
                q.push(value / unit);
            }
            let p = truth.point(&q, 0, 0) * 1e3 + vector(rng) * sigma_mm;
            joints.push(typed);
            points.push([p.x, p.y, p.z]);
        }
        let row = |j: &truearm_host::model::Joint| {
            let [alpha, a, theta, d, _] = j.link.parameters.to_array();
            [alpha.to_degrees(), a * 1e3, theta.to_degrees(), d * 1e3]
        };
        Self {
            kinds: (0..robot.joints.len()).map(|j| kind(robot, j)).collect(),
            table: robot.joints.iter().map(row).collect(),
            tool: [robot.tool.x, robot.tool.y, robot.tool.z].map(|x| x * 1e3),
            joints,
            points,
            sigma_mm: sigma_mm * rng.random_range(0.5..2.0),
        }
    }

    /// The same as it is in many cells: every joint within 50 degrees or 0.2 m,
    /// one row in thirty a gross error, the tool stated up to 0.1 m off.
    pub fn draw_hard(robot: &Robot, rng: &mut impl Rng) -> Self {
        let mut narrow = robot.clone();
        for joint in &mut narrow.joints {
            let (half, usual) = match joint.link.kind {
                JointKind::Revolute => (25_f64.to_radians(), 2.5),
                JointKind::Prismatic => (0.1, 0.5),
            };
            let [low, high] = joint.limits.unwrap_or([-usual, usual]);
            let middle = rng.random_range(low + half..(high - half).max(low + half + 1e-6));
            joint.limits = Some([middle - half, middle + half]);
        }
        let mut session = Self::draw(&narrow, rng);
        for point in session.points.iter_mut().step_by(30) {
            point[rng.random_range(0..3)] += rng.random_range(5.0..50.0);
        }
        let off = vector(rng);
        let off = off / off.norm() * rng.random_range(0.0..100.0);
        session.tool.iter_mut().zip(off.iter()).for_each(|(tool, off)| *tool += off);
        session
    }

    pub fn make(&mut self, mistake: &Mistake) {
        let n = self.table.len();
        match *mistake {
            Mistake::Sense(j) => self.joints.iter_mut().for_each(|q| q[j] = -q[j]),
            Mistake::Zero(j, by) => {
                let column = if self.kinds[j] == JointKind::Revolute { 2 } else { 3 };
                self.table[j][column] += by;
            }
            Mistake::Swapped(i, j) => self.joints.iter_mut().for_each(|q| q.swap(i, j)),
            Mistake::Alphabetical => self.joints.iter_mut().for_each(|q| q.swap(0, 2)),
            Mistake::Radians => {
                let turning = |j: usize| self.kinds[j] == JointKind::Revolute;
                for q in &mut self.joints {
                    (0..n).filter(|j| turning(*j)).for_each(|j| q[j] = q[j].to_radians());
                }
            }
            Mistake::SlideInMetres => {
                for q in &mut self.joints {
                    let sliding = |j: &usize| self.kinds[*j] == JointKind::Prismatic;
                    (0..n).filter(sliding).for_each(|j| q[j] *= 1e-3);
                }
            }
            Mistake::PointsIn(mm) => {
                self.points.iter_mut().flatten().for_each(|x| *x /= mm);
            }
            Mistake::RobotIn(mm) => {
                self.table.iter_mut().for_each(|row| (row[1], row[3]) = (row[1] / mm, row[3] / mm));
                self.tool = self.tool.map(|x| x / mm);
            }
            Mistake::RobotInRadians => self.table.iter_mut().for_each(|row| {
                (row[0], row[2]) = (row[0].to_radians(), row[2].to_radians());
            }),
            Mistake::StandardTable | Mistake::ShiftedTable => {
                let pairs: Vec<[f64; 2]> = self.table.iter().map(|row| [row[0], row[1]]).collect();
                let on = matches!(mistake, Mistake::ShiftedTable);
                for (i, row) in self.table.iter_mut().enumerate() {
                    let from = if on { i.checked_sub(1) } else { Some(i + 1) };
                    let pair = from.and_then(|from| pairs.get(from)).copied().unwrap_or_default();
                    (row[0], row[1]) = (pair[0], pair[1]);
                }
            }
            Mistake::Number(j, column, by) => self.table[j][column] += by,
            Mistake::Sign(j, column) => self.table[j][column] *= -1.0,
            Mistake::Mirrored(axis) => self.points.iter_mut().for_each(|p| p[axis] *= -1.0),
            Mistake::AxesSwapped(a, b) => self.points.iter_mut().for_each(|p| p.swap(a, b)),
            Mistake::OutOfStep(down) => {
                let rows = self.points.len();
                let (joints, points) =
                    if down { (0..rows - 1, 1..rows) } else { (1..rows, 0..rows - 1) };
                self.joints = self.joints[joints].to_vec();
                self.points = self.points[points].to_vec();
            }
        }
    }

    /// A mistake that was made in some rows only.
    pub fn make_in(&mut self, rows: impl IntoIterator<Item = usize>, mistake: &Mistake) {
        let mut whole = self.clone();
        whole.make(mistake);
        for row in rows {
            self.joints[row].clone_from(&whole.joints[row]);
            self.points[row] = whole.points[row];
        }
    }

    pub fn robot_text(&self) -> String {
        let mut text = format!(
            "name = \"arm\"\nmeasurement_sigma_mm = {:.4}\ntool.xyz_mm = {:?}\n",
            self.sigma_mm, self.tool
        );
        for (kind, [alpha, a, theta, d]) in self.kinds.iter().zip(&self.table) {
            text += "\n[[joints]]\n";
            let along = match kind {
                JointKind::Revolute => "d_mm",
                JointKind::Prismatic => {
                    text += "kind = \"prismatic\"\n";
                    "d_offset_mm"
                }
            };
            text += &format!(
                "alpha_deg = {alpha:?}\na_mm = {a:?}\n{along} = {d:?} # along z\ntheta_offset_deg = {theta:?}\n"
            );
        }
        text
    }

    pub fn rows_text(&self) -> String {
        let unit = |kind: &JointKind| if *kind == JointKind::Revolute { "deg" } else { "mm" };
        let names = self.kinds.iter().enumerate().map(|(j, k)| format!("q{}_{}", j + 1, unit(k)));
        let more = ["x_mm", "y_mm", "z_mm", "remark"].map(str::to_owned);
        let header: Vec<String> = names.chain(more).collect();
        let row = |(i, (q, p)): (usize, (&Vec<f64>, &[f64; 3]))| {
            let numbers = q.iter().chain(p).map(|x| format!("{x:.7}"));
            numbers.chain([format!("row {i}")]).collect::<Vec<_>>()
        };
        let rows = self.joints.iter().zip(&self.points).enumerate().map(row);
        csv(std::iter::once(header).chain(rows))
    }

    pub fn read(&self) -> (Robot, Measurements) {
        read(&self.robot_text(), &self.rows_text())
    }

    pub fn checked(&self) -> Finding {
        let (robot, data) = self.read();
        check(&robot, &data)
    }

    pub fn mended(&self, finding: &Finding) -> Mended {
        let texts = (self.robot_text(), self.rows_text());
        let (robot, data) = read(&texts.0, &texts.1);
        mend((&robot, &texts.0), (&data, &texts.1), finding).unwrap()
    }
}

pub fn read(robot: &str, rows: &str) -> (Robot, Measurements) {
    let robot = Robot::parse(Path::new("robot.toml"), robot).unwrap();
    let data = Measurements::parse(Path::new("measurements.csv"), rows, &robot).unwrap();
    (robot, data)
}

/// A random mistake that an arm of these joints can have, as large as gross
/// mistakes are: 3 degrees or 30 mm and more.
pub fn drawn(session: &Session, rng: &mut impl Rng) -> Mistake {
    let n = session.table.len();
    let turning: Vec<usize> = (0..n).filter(|j| session.kinds[*j] == JointKind::Revolute).collect();
    let either = |rng: &mut _, by: f64| if Rng::next_u32(rng) % 2 == 0 { by } else { -by };
    loop {
        let j = rng.random_range(0..n);
        let turns = turning.contains(&j);
        let (column, other) = (1 + 2 * rng.random_range(0..2), rng.random_range(0..n));
        let [_, a, _, d] = session.table[j];
        let length = if column == 1 { a } else { d };
        return match rng.random_range(0..20) {
            0 | 1 => Mistake::Sense(j),
            2 | 3 if turns => Mistake::Zero(j, [90.0, -90.0, 180.0][rng.random_range(0..3)]),
            4 | 5 if turns => {
                let by = rng.random_range(3.0..180.0_f64);
                Mistake::Zero(j, either(rng, by))
            }
            6 if j != other => Mistake::Swapped(j, other),
            7 => Mistake::Alphabetical,
            8 if turning.len() == n || rng.random_bool(0.5) => Mistake::Radians,
            8 => Mistake::SlideInMetres,
            9 => Mistake::PointsIn([1000.0, 25.4, 10.0][rng.random_range(0..3)]),
            10 => Mistake::RobotIn([1000.0, 25.4, 10.0][rng.random_range(0..3)]),
            11 => Mistake::StandardTable,
            12 => Mistake::ShiftedTable,
            13 | 14 if length.abs() >= 15.0 => Mistake::Sign(j, column),
            15 => {
                let by = rng.random_range(30.0..400.0_f64);
                Mistake::Number(j, column, either(rng, by).round())
            }
            16 if session.table[j][0].abs() == 90.0 => Mistake::Sign(j, 0),
            17 => Mistake::Number(j, 0, either(rng, 90.0)),
            18 if rng.random_bool(0.5) => Mistake::Mirrored(rng.random_range(0..3)),
            18 => Mistake::AxesSwapped(0, rng.random_range(1..3)),
            19 => Mistake::OutOfStep(rng.random_bool(0.5)),
            _ => continue,
        };
    }
}

/// What became of a session with mistakes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// What was typed before the mistakes stands there again.
    Named,
    /// Another change that undoes them as well: nothing measured tells it from
    /// what was typed before.
    Equivalent,
    /// Nothing can be seen of them, and it is said what cannot be.
    Absorbed,
    /// Called sound.
    Missed,
    /// Called something that undoes nothing.
    Wrong,
    /// Not understood, and said so.
    NotUnderstood,
}

/// Whether a mistake is among what is said to be absorbed by base or tool.
fn said_absorbed(mistake: &Mistake, kinds: &[JointKind], finding: &Finding) -> bool {
    let number = |j: usize, column: usize| {
        format!("{} of joint {}", ["alpha", "a", "theta_offset", "d"][column], j + 1)
    };
    let words = match *mistake {
        Mistake::Zero(j, _) if kinds[j] == JointKind::Revolute => number(j, 2),
        Mistake::Zero(j, _) => number(j, 3),
        Mistake::Number(j, column, _) | Mistake::Sign(j, column) => number(j, column),
        Mistake::Sense(j) => format!("sense of joint {}", j + 1),
        Mistake::Mirrored(_) | Mistake::AxesSwapped(..) => "handedness".to_owned(),
        Mistake::Swapped(..) | Mistake::Alphabetical => "order of the joints".to_owned(),
        _ => return false,
    };
    finding.absorbed.iter().any(|said| said.starts_with(&words))
}

/// Judges a finding about `typed`, which was `clean` before these mistakes.
pub fn judged(clean: &Session, typed: &Session, made: &[Mistake], finding: &Finding) -> Outcome {
    let untouched = clean.checked().rms_before;
    // A tenth: the mended file may lack a row.
    let as_good = |rms: f64| rms < 1.1 * untouched + 2e-5;
    match finding.verdict {
        Verdict::Sound if made.iter().all(|m| said_absorbed(m, &typed.kinds, finding)) => {
            Outcome::Absorbed
        }
        Verdict::Sound => Outcome::Missed,
        Verdict::NotUnderstood => Outcome::NotUnderstood,
        Verdict::Mendable => {
            let mended = typed.mended(finding);
            let (robot, data) = read(&mended.robot, &mended.measurements);
            if restored(clean, &robot, &data, finding) {
                return Outcome::Named;
            }
            let again = check(&robot, &data);
            let equal = again.verdict == Verdict::Sound && as_good(again.rms_before);
            if equal { Outcome::Equivalent } else { Outcome::Wrong }
        }
    }
}

/// Whether the numbers of a mended file are those from before, a fitted one
/// within what the arm is off by.
fn restored(clean: &Session, robot: &Robot, data: &Measurements, finding: &Finding) -> bool {
    let (was_robot, was_data) = clean.read();
    let near = |a: f64, b: f64, turn: bool| {
        let far = (a - b).abs();
        let far = if turn { far.min((far - std::f64::consts::TAU).abs()) } else { far };
        far < 0.02
    };
    let links = robot.joints.iter().zip(&was_robot.joints).all(|(now, was)| {
        let pairs = now.link.parameters.to_array().into_iter().zip(was.link.parameters.to_array());
        pairs.enumerate().all(|(k, (now, was))| near(now, was, k == 0 || k == 2))
    });
    // Which axis of the tracker, and which row at the end is lost.
    let hand = finding.said.iter().any(|said| said.what == "tracker-handedness");
    let same = |now: &truearm_host::model::Row, was: &truearm_host::model::Row| {
        let joints = now.q.iter().zip(&was.q).all(|(a, b)| near(*a, *b, false));
        joints && (hand || (now.measured.point() - was.measured.point()).norm() < 1e-3)
    };
    let skipped = was_data.rows.len() - data.rows.len().min(was_data.rows.len());
    let rows = (0..=skipped)
        .any(|skip| data.rows.iter().zip(&was_data.rows[skip..]).all(|(a, b)| same(a, b)));
    links && rows
}
