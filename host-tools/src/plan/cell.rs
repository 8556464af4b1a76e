//! The nominal arm among what instruments.toml states, and poses that bring it somewhere.

use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use truearm::Pose;

use crate::files::Gathered;
use crate::model::arm::chain;
use crate::model::{Form, Placement, Robot, Row, Target, Workspace};
use crate::paths::{Forward, Inverse};

/// Least sine by which whatever carries the target stands above the surface that it
/// touches, of 15 degrees: a stem that is flatter touches first.
const STEEP: f64 = 0.258_819_045_102_520_76;
/// A carrier that is nearer to the target than this points nowhere, m.
const NO_STEM: f64 = 1e-3;

/// An arm, where it may go, and what stands around it.
pub struct Cell<'a> {
    /// What is stated of instruments.
    pub book: &'a Gathered,
    robot: Robot,
    workspace: &'a Workspace,
    forward: Forward,
}

impl<'a> Cell<'a> {
    /// Around the nominal arm, in the frame that its `[base]` is stated in.
    #[must_use]
    pub fn new(robot: &Robot, workspace: &'a Workspace, book: &'a Gathered) -> Self {
        let tool = book.marker("").unwrap_or(robot.tool);
        let robot = Robot { tool, ..robot.clone() };
        Self { forward: Forward::of_robot(&robot), book, robot, workspace }
    }

    /// Where the target is, turned as its frame.
    #[must_use]
    pub fn target(&self, q: &[f64]) -> Pose<f64> {
        self.forward.pose(&Row::at(q.to_vec()), q)
    }

    /// The last frame.
    #[must_use]
    pub fn flange(&self, q: &[f64]) -> Pose<f64> {
        self.frame(q, q.len())
    }

    /// The frame behind so many joints.
    fn frame(&self, q: &[f64], joints: usize) -> Pose<f64> {
        let links = &self.robot.nominal()[..joints];
        chain(links, self.robot.base.pose(), Vector3::zeros()).pose(&q[..joints])
    }

    /// Where something that is mounted in the last frame, or not, is at joint values.
    #[must_use]
    pub fn mounted(&self, on_flange: bool, place: &Pose<f64>, q: &[f64]) -> Pose<f64> {
        if on_flange { self.flange(q).compose(place) } else { *place }
    }

    /// A random pose, if it is within the workspace.
    #[must_use]
    pub fn anywhere(&self, rng: &mut ChaCha8Rng) -> Option<Vec<f64>> {
        self.admitted(self.workspace.draw(&self.robot, rng))
    }

    /// Joint values near these at which the target is at a point, if there are any in the
    /// workspace.
    #[must_use]
    pub fn at(&self, point: &Vector3<f64>, start: &[f64]) -> Option<Vec<f64>> {
        let found = self.inverse().solve(
            &Row::at(start.to_vec()),
            &Target { point: *point, rotation: None },
            start,
        );
        if found.is_reached() { self.admitted(found.joints) } else { None }
    }

    /// The same from the side that a direction points to: what carries the target stands
    /// there, the last of the frames that is not where the target is.
    #[must_use]
    pub fn at_from(
        &self,
        point: &Vector3<f64>,
        side: &Vector3<f64>,
        start: &[f64],
    ) -> Option<Vec<f64>> {
        self.at(point, start).filter(|q| {
            let stems = (1..=q.len()).rev().map(|k| self.frame(q, k).translation - point);
            let carrier = stems.into_iter().find(|stem| stem.norm() > NO_STEM);
            carrier.is_none_or(|stem| stem.dot(side) >= STEEP * stem.norm() * side.norm())
        })
    }

    /// Joint values near these at which the last frame comes nearest to a pose, if the
    /// workspace holds them: arms of few joints do not come there.
    #[must_use]
    pub fn near(&self, flange: &Pose<f64>, start: &[f64]) -> Option<Vec<f64>> {
        let tool = Pose { translation: self.robot.tool, ..self.turn() };
        let target = flange.compose(&tool);
        let target = Target { point: target.translation, rotation: Some(target.rotation) };
        let found = self.inverse().solve(&Row::at(start.to_vec()), &target, start);
        self.admitted(found.joints)
    }

    /// How something that measures sits in the last frame, of the label of its marker: where
    /// nothing is stated, as the tool does.
    #[must_use]
    pub fn ray(&self, label: &str) -> Pose<f64> {
        let mut turns = self.book.of(&[Form::Turn]).filter(|turn| turn.label == label);
        let rotation =
            turns.next().map_or_else(|| self.turn().rotation, |turn| turn.place.rotation);
        Pose { rotation, translation: self.book.marker(label).unwrap_or(self.robot.tool) }
    }

    /// Joint values to start from, wherever the target then is.
    #[must_use]
    pub fn start(&self, rng: &mut ChaCha8Rng) -> Vec<f64> {
        self.workspace.draw(&self.robot, rng)
    }

    /// Radius of the ball on the target, m; 0 where none is stated.
    #[must_use]
    pub fn probe(&self) -> f64 {
        self.book.of(&[Form::Probe]).find(|i| i.label.is_empty()).map_or(0.0, |i| i.numbers[0])
    }

    /// How the frame of the target is turned in the last one.
    fn turn(&self) -> Pose<f64> {
        Placement { xyz: Vector3::zeros(), rpy: self.robot.tool_rpy }.pose()
    }

    fn inverse(&self) -> Inverse<'_> {
        Inverse::new(&self.forward, &self.robot).limited(&self.workspace.limits)
    }

    /// Joint values, if they are within the workspace.
    #[must_use]
    pub fn admitted(&self, q: Vec<f64>) -> Option<Vec<f64>> {
        let mut limits = q.iter().zip(&self.workspace.limits);
        let within = limits.all(|(q, [low, high])| (*low..=*high).contains(q));
        (within && self.workspace.admits(&self.target(&q))).then_some(q)
    }
}

/// A direction, all alike.
#[must_use]
pub fn direction(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    loop {
        let v = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        if (0.01..1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}

/// A direction across another.
#[must_use]
pub fn across(way: &Vector3<f64>) -> Vector3<f64> {
    Vector3::ith(way.iamin(), 1.0).cross(way).normalize()
}
