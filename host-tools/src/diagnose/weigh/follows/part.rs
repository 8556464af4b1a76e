//! A part of the cell that may err, and how the target then moves.

use nalgebra::Vector3;

use super::covariate::ENOUGH;
use crate::identify::Problem;
use crate::model::Form;
use crate::model::arm::Derivatives;

/// A part; joints are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The value of a joint is off.
    Joint(usize),
    /// The base leans about its x and y.
    Lean,
    /// The base shifts.
    Shift,
    /// The target moves on the flange.
    Target,
    /// The azimuth of the instrument, about the z axis of the frame it measures in.
    Azimuth,
    /// Its elevation.
    Elevation,
    /// Its distance.
    Distance,
    /// A surface that is touched, by its place in the list of instruments, is not where it
    /// should be.
    Surface(usize),
    /// Lengths to an anchor, by its place in the list of instruments, or to all.
    Length(Option<usize>),
}

/// How everything moves that turns about an axis through the origin of the frame it is
/// measured in, as the base turns and shifts: linear in the derivatives, so that it holds of
/// orientations, too.
fn turned(d: &Derivatives, axis: &Vector3<f64>) -> Vector3<f64> {
    let [rx, ry, rz, ..] = d.base;
    // From the base's origin, about which it turns, to the target: x * r = (0, -z, y).
    let from_base = Vector3::new(-ry.z, rx.z, -rx.y);
    let base = d.point - from_base;
    rx * axis.x + ry * axis.y + rz * axis.z + shifted(d, &axis.cross(&base))
}

/// The same of what shifts.
fn shifted(d: &Derivatives, way: &Vector3<f64>) -> Vector3<f64> {
    let [.., x, y, z] = d.base;
    x * way.x + y * way.y + z * way.z
}

impl Part {
    /// All of a cell in which an instrument sees points, or not.
    pub fn all(problem: &Problem, seen: bool) -> impl Iterator<Item = Self> {
        let joints = (0..problem.nominal.len()).map(Self::Joint);
        joints.chain([Self::Shift, Self::Target]).chain(Self::apart(problem, seen))
    }

    /// Those that are looked at for nothing else.
    pub fn apart(problem: &Problem, seen: bool) -> impl Iterator<Item = Self> {
        let instrument = [Self::Azimuth, Self::Elevation, Self::Distance];
        let instrument = instrument.into_iter().filter(move |_| seen);
        let lean = std::iter::once(Self::Lean);
        lean.chain(instrument).chain(Self::against(problem))
    }

    /// What rows are measured against.
    fn against(problem: &Problem) -> Vec<Self> {
        let (cell, data) = (&problem.cell, problem.data);
        let enough = |part: &Self| {
            let own = |row: &usize| part.of_row(problem, *row).is_some();
            (0..data.rows.len()).filter(own).take(ENOUGH).count() == ENOUGH
        };
        let each = 0..cell.instruments().len();
        let mut out: Vec<Self> =
            each.flat_map(|k| [Self::Surface(k), Self::Length(Some(k))]).filter(enough).collect();
        let lengths = |part: &&Self| matches!(part, Self::Length(_));
        if out.iter().filter(lengths).count() > 1 {
            out.push(Self::Length(None));
        }
        out
    }

    /// What a row is measured against, if it is this.
    fn of_row(self, problem: &Problem, row: usize) -> Option<usize> {
        let (cell, data) = (&problem.cell, problem.data);
        match self {
            Self::Surface(k) => cell.surface(data, row).filter(|own| *own == k),
            Self::Length(k) => cell.anchor(data, row).filter(|own| k.is_none_or(|k| *own == k)),
            _ => None,
        }
    }

    /// Whether what goes in proportion to a place is geometry's: of a plane that is found its
    /// tilt, of a sphere where it is. A cylinder may be a cone.
    #[must_use]
    pub fn has_slope(self, problem: &Problem) -> bool {
        let Self::Surface(k) = self else { return false };
        let own = &problem.data.instruments[k];
        own.form != Form::Cylinder && own.free.contains(&true)
    }

    /// Number of the kind.
    #[must_use]
    pub fn number(self) -> usize {
        match self {
            Self::Joint(_) => 0,
            Self::Lean => 1,
            Self::Shift => 2,
            Self::Target => 3,
            Self::Azimuth => 4,
            Self::Elevation => 5,
            Self::Distance => 6,
            Self::Length(None) => 7,
            Self::Length(Some(k)) => 8 + 2 * k,
            Self::Surface(k) => 9 + 2 * k,
        }
    }

    /// Its joint, counted from 0.
    #[must_use]
    pub fn joint(self) -> Option<usize> {
        if let Self::Joint(joint) = self { Some(joint) } else { None }
    }

    /// How many ways it can go.
    #[must_use]
    pub fn ways(self) -> usize {
        match self {
            Self::Lean => 2,
            Self::Shift | Self::Target => 3,
            _ => 1,
        }
    }

    /// How the target moves along each, m per rad or m.
    #[must_use]
    pub fn moves(self, problem: &Problem, row: usize, d: &Derivatives) -> Vec<Vector3<f64>> {
        let p = d.point;
        let flat = Vector3::new(p.x, p.y, 0.0);
        let out = flat.try_normalize(0.0).unwrap_or_default();
        match self {
            Self::Joint(joint) => vec![*d.links[joint].joint(problem.nominal[joint].kind)],
            Self::Lean => d.about[..2].to_vec(),
            Self::Shift => d.base[3..].to_vec(),
            Self::Target => d.tool.to_vec(),
            Self::Azimuth => vec![turned(d, &Vector3::z())],
            // Right above the instrument no direction is up.
            Self::Elevation => vec![turned(d, &out.cross(&Vector3::z()))],
            Self::Distance => vec![shifted(d, &p.try_normalize(0.0).unwrap_or_default())],
            Self::Surface(_) | Self::Length(_) => {
                let own = self.of_row(problem, row);
                let away = own.map_or_else(Vector3::zeros, |k| problem.cell.away(k, &p));
                vec![shifted(d, &away)]
            }
        }
    }

    /// As in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Joint(_) => "joint",
            Self::Lean => "base tilt",
            Self::Shift => "base",
            Self::Target => "target",
            Self::Azimuth => "azimuth",
            Self::Elevation => "elevation",
            Self::Distance => "distance",
            Self::Surface(_) => "surface",
            Self::Length(_) => "length",
        }
    }

    /// What it does, in a sentence.
    #[must_use]
    pub fn words(self, problem: &Problem) -> String {
        let label = |k: usize| match problem.data.instruments[k].label.as_str() {
            "" => String::new(),
            label => format!(" \"{label}\""),
        };
        match self {
            Self::Joint(joint) => format!("joint {} is off", joint + 1),
            Self::Lean => "the base leans".to_owned(),
            Self::Shift => "the base shifts".to_owned(),
            Self::Target => "the target moves on the flange".to_owned(),
            Self::Azimuth => "the azimuth of the instrument errs".to_owned(),
            Self::Elevation => "the elevation of the instrument errs".to_owned(),
            Self::Distance => "the distance of the instrument errs".to_owned(),
            Self::Surface(k) => format!("the surface{} that is touched is off", label(k)),
            Self::Length(None) => "all lengths are off".to_owned(),
            Self::Length(Some(k)) => format!("lengths to the anchor{} are off", label(k)),
        }
    }

    /// The axis of each way, and its unit in reports with what SI is multiplied by.
    #[must_use]
    pub fn axes(self, slides: bool) -> (&'static [&'static str], f64, &'static str) {
        match self {
            Self::Joint(_) if slides => (&[""], 1e3, "mm"),
            Self::Joint(_) | Self::Azimuth | Self::Elevation => (&[""], 1e3, "mrad"),
            Self::Lean => (&["x", "y"], 1e3, "mrad"),
            Self::Shift | Self::Target => (&["x", "y", "z"], 1e3, "mm"),
            Self::Distance | Self::Surface(_) | Self::Length(_) => (&[""], 1e3, "mm"),
        }
    }
}
