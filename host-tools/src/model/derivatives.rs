//! How the tool point moves, and how the last frame turns, with everything.

use nalgebra::{Matrix3, Vector3};
use truearm::effects::{Term, TermInputs};
use truearm::kinematics::LinkColumns;
use truearm::{Link, Pose};
use truearm_sized::with_joints;

use super::row_inputs::RowInputs;

/// The tool point and its derivatives at one pose.
#[derive(Debug, Clone)]
pub struct Derivatives {
    /// The tool point.
    pub point: Vector3<f64>,
    /// To rotation and translation of the base, in the outer frame.
    pub base: [Vector3<f64>; 6],
    /// To rotations about the robot's own base axes.
    pub about: [Vector3<f64>; 3],
    /// These axes.
    pub(super) axes: [Vector3<f64>; 3],
    /// To the tool point in the last frame.
    pub tool: [Vector3<f64>; 3],
    /// To the parameters of each link.
    pub links: Vec<LinkColumns<f64>>,
    /// To tilts of each joint's axis, where they do not follow from the links'.
    pub(super) tilts: Option<Vec<[Vector3<f64>; 2]>>,
}

impl Derivatives {
    /// To the coefficient of a term at a row, at joint values `q`, in an arm of these
    /// links.
    #[must_use]
    pub fn column(
        &self,
        term: &Term<f64>,
        row: &RowInputs,
        q: &[f64],
        links: &[Link<f64>],
    ) -> Vector3<f64> {
        with_joints!(q.len(), N => {
            let (action, basis) = self.action_and_basis(term, &row.fixed_for::<N>(q, term), links);
            action * basis
        })
    }

    /// The same to what the term deflects.
    #[must_use]
    pub fn action(
        &self,
        term: &Term<f64>,
        row: &RowInputs,
        q: &[f64],
        links: &[Link<f64>],
    ) -> Vector3<f64> {
        with_joints!(q.len(), N => self.action_and_basis(term, &row.fixed::<N>(q), links).0)
    }

    /// To the coefficients of some terms.
    #[must_use]
    pub fn columns(
        &self,
        terms: &[Term<f64>],
        row: &RowInputs,
        q: &[f64],
        links: &[Link<f64>],
    ) -> Vec<Vector3<f64>> {
        with_joints!(q.len(), N => {
            let mut inputs = row.fixed::<N>(q);
            let of = |term| {
                inputs.warmth = row.warmth_of(term);
                let (action, basis) = self.action_and_basis(term, &inputs, links);
                action * basis
            };
            terms.iter().map(of).collect()
        })
    }

    fn action_and_basis<const N: usize>(
        &self,
        term: &Term<f64>,
        inputs: &TermInputs<f64, N>,
        links: &[Link<f64>],
    ) -> (Vector3<f64>, f64) {
        let tilts = |joint: usize| (joint < self.links.len()).then(|| self.tilts(joint));
        let action = term.action_by(inputs, links, &self.links, &self.about, tilts);
        (action, term.basis(inputs))
    }

    /// To tilts of a joint's axis about the x and y of the frame that it turns in.
    #[must_use]
    pub fn tilts(&self, joint: usize) -> [Vector3<f64>; 2] {
        self.tilts.as_ref().map_or_else(|| self.links[joint].tilts(), |tilts| tilts[joint])
    }

    /// How the last frame is turned.
    #[must_use]
    pub fn rotation(&self) -> Matrix3<f64> {
        Matrix3::from_columns(&self.tool)
    }

    /// The same of how the last frame is turned, rad: a column of an effect is linear
    /// in these, so that what it moves and what it turns are one function of them.
    #[must_use]
    pub fn turning(&self) -> Self {
        let none = Vector3::zeros();
        let count = self.links.len();
        // Links turn about the axes that their columns lie along.
        let turn = |i: usize| {
            let link = &self.links[i];
            // x behind the joint and its beta: that of the next link.
            let next = if i + 1 < count { self.links[i + 1].a } else { self.tool[0] };
            let beta = link.d.cross(&next).normalize();
            LinkColumns { alpha: link.a, a: none, theta: link.d, d: none, beta }
        };
        let [x, y, z] = [0, 1, 2].map(|k| Vector3::ith(k, 1.0));
        Self {
            base: [x, y, z, none, none, none],
            about: self.axes,
            tool: [none; 3],
            links: (0..count).map(turn).collect(),
            tilts: Some(self.links.iter().map(|l| [l.a, l.d.cross(&l.a)]).collect()),
            ..self.clone()
        }
    }

    /// The same of the arm on another base, where nothing but joints moves it.
    #[must_use]
    pub fn rebased(&self, own: &Pose<f64>, other: &Pose<f64>) -> Self {
        let turn = other.rotation * own.rotation.transpose();
        let arm = turn * (self.point - own.translation);
        let about = |axis: Vector3<f64>| axis.cross(&arm);
        let [x, y, z] = [0, 1, 2].map(|k| Vector3::ith(k, 1.0));
        let axes = [0, 1, 2].map(|k| other.rotation.column(k).into_owned());
        let link = |link: &LinkColumns<f64>| LinkColumns {
            alpha: turn * link.alpha,
            a: turn * link.a,
            theta: turn * link.theta,
            d: turn * link.d,
            beta: turn * link.beta,
        };
        Self {
            point: other.translation + arm,
            base: [about(x), about(y), about(z), x, y, z],
            about: axes.map(about),
            axes,
            tool: self.tool.map(|axis| turn * axis),
            links: self.links.iter().map(link).collect(),
            tilts: self
                .tilts
                .as_ref()
                .map(|tilts| tilts.iter().map(|t| t.map(|t| turn * t)).collect()),
        }
    }

    /// The same of a point of the last frame that is so far behind the tool point, m;
    /// `turning` is of these.
    #[must_use]
    pub fn behind(&self, lever: &Vector3<f64>, turning: &Self) -> Self {
        let at = |moved: &Vector3<f64>, turned: &Vector3<f64>| moved - turned.cross(lever);
        let link = |(own, turn): (&LinkColumns<f64>, &LinkColumns<f64>)| LinkColumns {
            alpha: at(&own.alpha, &turn.alpha),
            a: own.a,
            theta: at(&own.theta, &turn.theta),
            d: own.d,
            beta: at(&own.beta, &turn.beta),
        };
        Self {
            point: self.point - lever,
            base: core::array::from_fn(|k| at(&self.base[k], &turning.base[k])),
            about: core::array::from_fn(|k| at(&self.about[k], &turning.about[k])),
            tool: [Vector3::zeros(); 3],
            links: self.links.iter().zip(&turning.links).map(link).collect(),
            axes: self.axes,
            tilts: None,
        }
    }
}
