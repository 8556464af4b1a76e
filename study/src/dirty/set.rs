//! A set as a user would bring it, from an arm with several effects at once;
//! what was hidden stays sealed until [`DirtySet::open`].

use std::path::Path;
use std::{fs, io};

use nalgebra::{Rotation3, Vector3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::files::csv_text;
use truearm_host::model::{LinkMass, Measurements, Robot};
use truearm_host::units::{joint_column, joint_to_file};
use truearm_simulate::arm::Arm;
use truearm_simulate::body::{Body, Moment};
use truearm_simulate::dirty::effects::{Hidden, draw, spring};
use truearm_simulate::dirty::noise::Noise;
use truearm_simulate::dirty::{Columns, moments, outside};
use truearm_simulate::{normal, rigid, robots, vector};

use crate::simulated::{parse, robot, stated};

/// Fewest and most rows; log-uniform between.
pub const ROWS: [f64; 2] = [20.0, 5000.0];
/// The same where one thing is asked for.
const ROWS_OF_ONE: [f64; 2] = [100.0, 2000.0];

/// What is wrong with an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    /// Several effects at once.
    Session,
    /// Nothing but geometry.
    Clean,
    /// A few effects and one thing outside the repertoire, of six kinds in turn.
    Outside,
    /// One spring, under loads that nobody states.
    Spring,
}

/// What a user would have.
pub struct DirtySet {
    pub seed: u64,
    /// `robot.toml`
    pub robot: String,
    /// `measurements.csv`
    pub measurements: String,
    /// `holdout.csv`: poses of the same session that no fit sees.
    pub holdout: String,
    secret: Secret,
}

/// What was hidden.
pub struct Secret {
    pub arm: Arm,
    pub hidden: Hidden,
    pub noise: Noise,
    /// Of the measurements.
    pub moments: Vec<Moment>,
}

/// Poses kept for judging.
const HELD_OUT: usize = 200;

impl DirtySet {
    /// The set of a seed.
    pub fn draw(seed: u64, sort: Sort) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let masses = rng.random_bool(0.7) && sort != Sort::Spring;
        let noise = Noise::draw(&mut rng);
        let whole = file(&noise, &mut rng);
        let text = if masses { whole.clone() } else { without_masses(&whole) };
        let (nominal, whole) = (robot(&text), robot(&whole));
        let mut arm = real(&nominal, &mut rng);
        if sort == Sort::Spring {
            arm.body.masses = loads(&whole, &mut rng);
        }
        let mut columns = Columns::draw(&mut rng);
        let (kind, apart) = (seed as usize % outside::KINDS, sort == Sort::Outside);
        columns.temperature |= apart && outside::needs_temperature(kind);
        let [fewest, most] = match sort {
            Sort::Session | Sort::Clean => ROWS,
            Sort::Outside | Sort::Spring => ROWS_OF_ONE,
        };
        let rows = fewest * (most / fewest).powf(rng.random_range(0.0..1.0));
        let repeats = if rng.random_bool(0.2) { rng.random_range(2..=5) } else { 1 };
        let rows = rows as usize + HELD_OUT * repeats;
        let moments = moments(&stated(&nominal), &columns, rows, repeats, &mut rng);
        let hidden = match sort {
            Sort::Clean => Hidden::default(),
            Sort::Session => draw(&arm, &columns, masses, &mut rng),
            Sort::Outside => outside::draw(&arm, &columns, masses, kind, &mut rng),
            Sort::Spring => spring(&stated(&whole), &arm, &moments, &mut rng),
        };
        let unlisted = hidden.unlisted.iter().flat_map(|u| u.1.iter());
        arm.defects = hidden.listed.iter().chain(unlisted).cloned().collect();
        let points = measured(&arm, &moments, &noise, &mut rng);
        let held = held_out(&moments, &mut rng);
        let part = |which: bool| {
            let own = (0..moments.len()).filter(|i| held[*i] == which);
            let rows = own.map(|i| (moments[i].clone(), points[i]));
            let (moments, points): (Vec<_>, Vec<_>) = rows.unzip();
            (table(&nominal, &columns, &moments, &points), moments)
        };
        let ((measurements, moments), (holdout, _)) = (part(false), part(true));
        let secret = Secret { arm, hidden, noise, moments };
        Self { seed, robot: text, measurements, holdout, secret }
    }

    /// What was hidden.
    pub fn open(&self) -> &Secret {
        &self.secret
    }

    /// Its files, and what was hidden, in a folder.
    ///
    /// # Errors
    /// The file system's.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        fs::create_dir_all(folder)?;
        let hidden = format!("{:#?}\n{:#?}\n", self.secret.hidden, self.secret.noise);
        let files = [
            ("robot.toml", &self.robot),
            ("measurements.csv", &self.measurements),
            ("holdout.csv", &self.holdout),
            ("hidden.txt", &hidden),
        ];
        files.into_iter().try_for_each(|(name, text)| fs::write(folder.join(name), text))
    }

    /// Files as the program reads them.
    pub fn read(&self) -> (Robot, [Measurements; 2]) {
        let robot = robot(&self.robot);
        let files = [&self.measurements, &self.holdout].map(|text| parse(&robot, text));
        (robot, files)
    }
}

/// Which readings are kept for judging: all of a pose or none.
fn held_out(moments: &[Moment], rng: &mut ChaCha8Rng) -> Vec<bool> {
    let same = |a: &Moment, b: &Moment| a.q == b.q;
    let poses: Vec<usize> = moments.chunk_by(same).map(<[Moment]>::len).collect();
    let mut order: Vec<usize> = (0..poses.len()).collect();
    order.shuffle(rng);
    order.truncate(HELD_OUT);
    let mut held = vec![false; poses.len()];
    order.into_iter().for_each(|pose| held[pose] = true);
    poses.iter().zip(held).flat_map(|(readings, held)| vec![held; *readings]).collect()
}

/// A `robot.toml`.
fn file(noise: &Noise, rng: &mut ChaCha8Rng) -> String {
    let text = robots::ALL[rng.random_range(0..robots::ALL.len())];
    format!("measurement_sigma_mm = {:.4}\n{GRAVITY}{text}", noise.stated * 1e3)
}

const GRAVITY: &str = "gravity_m_s2 = [0.0, 0.0, -9.81]\n";

/// The same of who does not know what its links weigh.
fn without_masses(text: &str) -> String {
    let before = text.find("links = [").map_or(text, |at| &text[..at]);
    before.replace(GRAVITY, "")
}

/// What links really weigh, and where, of an arm whose file is right within a sixth.
fn loads(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<(f64, Vector3<f64>)> {
    let mut of = |l: &LinkMass| (l.mass * rng.random_range(0.85..1.15), l.com);
    robot.links.iter().map(&mut of).collect()
}

/// The arm behind a nominal one: errors of half a tolerance to three, the tool
/// and the base where nobody knows exactly.
fn real(nominal: &Robot, rng: &mut ChaCha8Rng) -> Arm {
    let scale = 0.5 * 6.0_f64.powf(rng.random_range(0.0..1.0));
    let mut off = |p: [f64; 5]| p.map(|x| x + normal(rng) * 1e-3 * scale);
    let links = nominal.nominal().iter().map(|l| off(l.parameters.to_array())).collect();
    let turn = vector(rng) * 2.0;
    let station = rigid(&turn, &Vector3::from_fn(|_, _| rng.random_range(-3.0..3.0)));
    // Masses are known to a tenth; where none are stated, they pull all the same.
    let given = nominal.links.iter().map(|l| (l.mass, l.com));
    let mut masses: Vec<_> = given.collect();
    masses.resize(nominal.joints.len(), (5.0, Vector3::new(0.1, 0.0, 0.05)));
    let masses = masses.into_iter().map(|(m, com)| (m * rng.random_range(0.9..1.1), com));
    let masses = masses.collect();
    let lean = Rotation3::from_scaled_axis(vector(rng).normalize() * 0.05_f64.to_radians());
    Arm {
        body: Body {
            kinds: nominal.joints.iter().map(|j| j.link.kind).collect(),
            links,
            gear_ratios: nominal.joints.iter().map(|j| j.gear_ratio.unwrap_or(100.0)).collect(),
            masses,
            gravity: lean * Vector3::new(0.0, 0.0, -9.81),
            station,
            tool: nominal.tool + vector(rng) * 3e-3,
        },
        defects: Vec::new(),
    }
}

/// Where the tracker sees the target.
fn measured(
    arm: &Arm,
    moments: &[Moment],
    noise: &Noise,
    rng: &mut ChaCha8Rng,
) -> Vec<Vector3<f64>> {
    let mut of_pose = Vector3::zeros();
    let mut last: &[f64] = &[];
    let mut out = Vec::with_capacity(moments.len());
    for moment in moments {
        if moment.q != last {
            of_pose = noise.pose(rng);
            last = &moment.q;
        }
        let point = arm.point(moment);
        out.push(point + of_pose + noise.reading(point.norm(), rng));
    }
    out
}

fn table(robot: &Robot, columns: &Columns, moments: &[Moment], points: &[Vector3<f64>]) -> String {
    let kind = |j: usize| robot.joints[j].link.kind;
    let joints = 0..robot.joints.len();
    let mut names: Vec<String> = joints.clone().map(|j| joint_column("q", j, kind(j))).collect();
    names.extend(["x_mm", "y_mm", "z_mm"].map(str::to_owned));
    let optional = [
        (columns.time, "time_s"),
        (columns.temperature, "temperature_c"),
        (columns.payload, "payload_kg"),
        (columns.series, "series"),
    ];
    names.extend(optional.iter().filter(|o| o.0).map(|o| o.1.to_owned()));
    if columns.directions {
        names.extend(joints.map(|j| format!("dir{}", j + 1)));
    }
    let row = |(m, p): (&Moment, &Vector3<f64>)| {
        let joints = m.q.iter().enumerate();
        let mut cells: Vec<String> =
            joints.map(|(j, q)| format!("{:.5}", joint_to_file(kind(j), *q))).collect();
        cells.extend(p.iter().map(|x| format!("{:.5}", x * 1e3)));
        let values = [
            (columns.time, format!("{:.1}", m.time)),
            (columns.temperature, format!("{:.2}", m.temperature)),
            (columns.payload, format!("{:.1}", m.payload)),
            (columns.series, if m.later { "B" } else { "A" }.to_owned()),
        ];
        cells.extend(values.into_iter().filter(|v| v.0).map(|v| v.1));
        if columns.directions {
            cells.extend(m.directions.iter().map(|d| d.to_string()));
        }
        cells
    };
    csv_text(names.iter().map(String::as_str), moments.iter().zip(points).map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_is_a_set() {
        for seed in 0..12 {
            let (a, b) = (DirtySet::draw(seed, Sort::Session), DirtySet::draw(seed, Sort::Session));
            assert!(a.robot == b.robot && a.measurements == b.measurements, "{seed}");
            let (_, [data, holdout]) = a.read();
            assert_eq!(data.rows.len(), a.open().moments.len());
            assert!(holdout.rows.len() >= HELD_OUT);
            assert!((3..=8).contains(&a.open().hidden.listed.len()));
        }
    }
}
