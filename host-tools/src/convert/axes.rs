//! From the axes of an arm's joints to the parameters of its links.
//!
//! From the frame on one axis there are four conditions on the way to the next:
//! it must lie on that line. Five parameters lead there, so one is free:
//! Denavit and Hartenberg leave out beta and go along the common normal; where
//! axes are parallel, or almost, there is no normal to rely on and Hayati leaves
//! out d (S. Hayati, M. Mirmirani, *Improving the absolute positioning accuracy
//! of robot manipulators*, J. Robotic Systems 2, 1985).

use nalgebra::{Rotation3, Unit, Vector3};
use truearm::{JointKind, Link, MdhParameters, Pose};

use super::frames::{about_y, screw, twist};

/// The axis of a joint at joint value zero, in the frame that all are told in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Turns about it or slides along it.
    pub kind: JointKind,
    /// A point on it, m.
    pub point: Vector3<f64>,
    /// Its direction, of length one; the joint's sense is about it.
    pub direction: Vector3<f64>,
}

/// An arm at joint values zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Axes {
    /// The joints from base to tip.
    pub joints: Vec<Axis>,
    /// The tip.
    pub tip: Pose<f64>,
}

/// Which of the five parameters is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// Beta, and d where neighbouring axes are parallel or almost.
    Hayati,
    /// Beta always. Axes that are almost parallel then have their common normal
    /// far away; beyond [`FARTHEST`] they are made parallel.
    Dh,
}

/// Links with what stands before and behind them.
#[derive(Debug, Clone, PartialEq)]
pub struct Described {
    /// The frame before joint 1.
    pub base: Pose<f64>,
    /// The links.
    pub links: Vec<Link<f64>>,
    /// The frame of each link at joint value zero, behind its beta.
    pub frames: Vec<Pose<f64>>,
    /// The tip in the last link's frame.
    pub tool: Pose<f64>,
    /// Joints, counted from 0, whose axis was made parallel to the one before,
    /// and by how much it was turned for it, rad.
    pub straightened: Vec<(usize, f64)>,
}

/// Sine of the angle below which axes count as almost parallel: 5 degrees. No
/// drawing has such a twist, and no assembly error is as large.
const ALMOST_PARALLEL: f64 = 0.087;
/// Sine of the angle up to which an axis can be told by where it crosses the plane of the
/// frame before.
const ACROSS: f64 = 0.7;
/// Sine of the angle below which no normal can be computed.
const PARALLEL: f64 = 1e-9;
/// A common normal that meets the axis farther away than this is not used, m:
/// lengths of files end at 10 m.
pub const FARTHEST: f64 = 9.0;
/// Below this a length or an angle is the rounding of the input; m or rad.
const NOTHING: f64 = 1e-13;

/// The five parameters of the way from an axis to the next.
#[derive(Debug, Clone, Copy, Default)]
struct Step {
    theta: f64,
    d: f64,
    beta: f64,
    alpha: f64,
    a: f64,
    straightened: f64,
}

impl Axes {
    /// The links of this arm.
    #[must_use]
    pub fn describe(&self, convention: Convention) -> Described {
        let base = self.joints.first().map_or(Pose::identity(), first_frame);
        let mut out = Described {
            base,
            links: Vec::new(),
            frames: Vec::new(),
            tool: Pose::identity(),
            straightened: Vec::new(),
        };
        let (mut on_axis, mut alpha, mut a) = (base, 0.0, 0.0);
        for (i, joint) in self.joints.iter().enumerate() {
            let step = match self.joints.get(i + 1) {
                Some(next) => step(&on_axis, next, convention),
                None => last(&on_axis, &self.tip),
            };
            if step.straightened > 0.0 {
                out.straightened.push((i + 1, step.straightened));
            }
            let Step { theta, d, beta, .. } = step;
            let parameters = MdhParameters { alpha, a, theta, d, beta };
            out.links.push(Link { kind: joint.kind, parameters });
            let frame = on_axis.compose(&screw(theta, d)).compose(&about_y(beta));
            out.frames.push(frame);
            (alpha, a) = (step.alpha, step.a);
            on_axis = frame.compose(&twist(alpha, a));
        }
        // Behind the last link there is no twist, so `on_axis` is its frame.
        out.tool = clean(&on_axis.inverse().compose(&self.tip));
        out
    }
}

/// On the first axis, next to the origin, and turned no more than it must be.
fn first_frame(axis: &Axis) -> Pose<f64> {
    let u = axis.direction;
    let translation = axis.point - u * axis.point.dot(&u);
    // By the arc tangent: the cosine of a small angle does not know it.
    let across = Vector3::z().cross(&u);
    let axis = Unit::try_new(across, f64::MIN_POSITIVE).unwrap_or(Vector3::x_axis());
    let rotation = Rotation3::from_axis_angle(&axis, across.norm().atan2(u.z));
    clean(&Pose { rotation: rotation.into_inner(), translation })
}

/// From the frame on an axis to the next axis.
fn step(on_axis: &Pose<f64>, next: &Axis, convention: Convention) -> Step {
    let to_frame = on_axis.rotation.transpose();
    let u = to_frame * next.direction;
    let p = to_frame * (next.point - on_axis.translation);
    // The point of the line that is nearest to the frame's origin.
    let foot = p - u * p.dot(&u);
    let sine = u.x.hypot(u.y);
    let d = foot.z / (sine * sine);
    // From the next joint to where the normal meets its axis: what follows, the
    // tip too, is told from there, and must stay within the lengths of files.
    let on_next = d * u.z - p.dot(&u);
    let far = d.abs() > FARTHEST;
    // Hayati's way is for axes that cross the plane of the frame, none that lie in it.
    let crosses = sine < ACROSS && (far || on_next.abs() > 0.5 * FARTHEST);
    match convention {
        Convention::Hayati if sine < ALMOST_PARALLEL || crosses => hayati(&foot, &u),
        Convention::Dh if sine < PARALLEL || far => Step {
            straightened: if sine < PARALLEL { 0.0 } else { sine.asin() },
            ..hayati(&(p - Vector3::z() * p.z), &Vector3::new(0.0, 0.0, u.z.signum()))
        },
        _ => common_normal(&foot, &u, d),
    }
}

/// Along the common normal.
fn common_normal(foot: &Vector3<f64>, u: &Vector3<f64>, d: f64) -> Step {
    let normal = Vector3::new(-u.y, u.x, 0.0).normalize();
    let (x, a) = nearer(normal, foot.dot(&normal));
    let y = Vector3::new(-x.y, x.x, 0.0);
    Step {
        theta: clean_angle(x.y.atan2(x.x)),
        d: clean_length(d),
        alpha: clean_angle((-u.dot(&y)).atan2(u.z)),
        a: clean_length(a),
        ..Step::default()
    }
}

/// To the point of the next axis nearest to the frame's origin.
fn hayati(foot: &Vector3<f64>, u: &Vector3<f64>) -> Step {
    let a = foot.norm();
    let (theta, beta, a) = if a < 1e-12 {
        // The axis goes through the origin: the turn about z is free.
        (0.0, (u.x / u.z).atan(), 0.0)
    } else {
        let normal = foot / a;
        let (x, a) = nearer((normal - u * normal.dot(u)).normalize(), a);
        (clean_angle(x.y.atan2(x.x)), clean_angle((-x.z).atan2(x.x.hypot(x.y))), a)
    };
    let frame = screw(theta, 0.0).compose(&about_y(beta)).rotation;
    let v = frame.tr_mul(u);
    let alpha = clean_angle((-v.y).atan2(v.z));
    Step { theta, d: 0.0, beta, alpha, a: clean_length(a), ..Step::default() }
}

/// A normal and the distance along it, or both reversed: the one that turns x
/// less; of two quarter turns that with a positive distance.
fn nearer(normal: Vector3<f64>, distance: f64) -> (Vector3<f64>, f64) {
    let reversed = if normal.x.abs() > 1e-9 { normal.x < 0.0 } else { distance < 0.0 };
    if reversed { (-normal, -distance) } else { (normal, distance) }
}

/// Along the last axis to the tip, if that leads there; else the tool says all.
fn last(on_axis: &Pose<f64>, tip: &Pose<f64>) -> Step {
    let rest = on_axis.inverse().compose(tip);
    let theta = clean_angle(rest.rotation[(1, 0)].atan2(rest.rotation[(0, 0)]));
    let d = clean_length(rest.translation.z);
    let left = clean(&screw(theta, d).inverse().compose(&rest));
    if left == Pose::identity() { Step { theta, d, ..Step::default() } } else { Step::default() }
}

fn clean_length(value: f64) -> f64 {
    if value.abs() < NOTHING { 0.0 } else { value }
}

/// Quarter turns without their rounding.
fn clean_angle(value: f64) -> f64 {
    let quarter = std::f64::consts::FRAC_PI_2;
    let near = (value / quarter).round() * quarter;
    if (value - near).abs() < NOTHING { near } else { value }
}

/// Zeros and ones without their rounding.
fn clean(pose: &Pose<f64>) -> Pose<f64> {
    let entry = |x: f64| if (x - x.round()).abs() < NOTHING { x.round() + 0.0 } else { x };
    Pose { rotation: pose.rotation.map(entry), translation: pose.translation.map(clean_length) }
}
