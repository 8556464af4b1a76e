//! The crate's kinematics for a joint count known only at run time: the same
//! `Chain<f64, N>` that the controller links, chosen by N.

use nalgebra::{Matrix3, Vector3};
use truearm::effects::{Load, Masses, Term, TermInputs, deflection};
use truearm::kinematics::{Deflection, LinkColumns, LinkTurns};
use truearm::{Approach, Chain, Link, Pose};

/// Calls `$body` with the constant `N` equal to the run-time `$n`.
macro_rules! with_joints {
    ($n:expr, $N:ident => $body:expr) => {{
        macro_rules! arm {
            ($count:literal) => {{
                const $N: usize = $count;
                $body
            }};
        }
        match $n {
            1 => arm!(1),
            2 => arm!(2),
            3 => arm!(3),
            4 => arm!(4),
            5 => arm!(5),
            6 => arm!(6),
            7 => arm!(7),
            8 => arm!(8),
            9 => arm!(9),
            10 => arm!(10),
            11 => arm!(11),
            12 => arm!(12),
            13 => arm!(13),
            14 => arm!(14),
            15 => arm!(15),
            16 => arm!(16),
            n => unreachable!("robot files have 1 to 16 joints, not {n}"),
        }
    }};
}
pub(crate) use with_joints;

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
    axes: [Vector3<f64>; 3],
    /// To the tool point in the last frame.
    pub tool: [Vector3<f64>; 3],
    /// To the parameters of each link.
    pub links: Vec<LinkColumns<f64>>,
    /// To tilts of each joint's axis, where they do not follow from the links'.
    tilts: Option<Vec<[Vector3<f64>; 2]>>,
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
        let (action, basis) = self.action_and_basis(term, row, q, links);
        action * basis
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
        self.action_and_basis(term, row, q, links).0
    }

    fn action_and_basis(
        &self,
        term: &Term<f64>,
        row: &RowInputs,
        q: &[f64],
        links: &[Link<f64>],
    ) -> (Vector3<f64>, f64) {
        with_joints!(q.len(), N => {
            let inputs = row.fixed::<N>(q);
            let tilts = |joint: usize| (joint < self.links.len()).then(|| self.tilts(joint));
            let action = term.action_by(&inputs, links, &self.links, &self.about, tilts);
            (action, term.basis(&inputs))
        })
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

/// What terms depend on at one row, for any number of joints; SI units.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RowInputs {
    /// Gravity torque of each joint; empty without masses.
    pub torque: Vec<f64>,
    /// Overturning moment about the base's x and y.
    pub moment: [f64; 2],
    /// Moment across each joint's axis; empty without masses.
    pub across: Vec<[f64; 2]>,
    /// How each joint came to rest; empty if unknown.
    pub approach: Vec<Approach>,
    /// Temperature above reference, K.
    pub warmth: f64,
    /// What the curves of a model add to each joint here, rad; empty without.
    pub curves: Vec<f64>,
}

impl RowInputs {
    /// For so many joints; what is not known is zero or [`Approach::Unknown`].
    pub(crate) fn fixed<const N: usize>(&self, q: &[f64]) -> TermInputs<f64, N> {
        let or_zero = |v: &[f64]| v.try_into().unwrap_or([0.0; N]);
        TermInputs {
            q: fixed(q),
            load: Load {
                torque: or_zero(&self.torque),
                moment: self.moment,
                across: self.across.as_slice().try_into().ok(),
            },
            approach: self.approach.as_slice().try_into().unwrap_or([Approach::Unknown; N]),
            warmth: self.warmth,
        }
    }

    /// What terms and curves do to an arm.
    fn deflection<const N: usize>(
        &self,
        terms: &[Term<f64>],
        inputs: &TermInputs<f64, N>,
    ) -> Deflection<f64, N> {
        let mut out = deflection(terms, inputs);
        out.joints.iter_mut().zip(&self.curves).for_each(|(joint, curve)| *joint += curve);
        out
    }
}

impl RowInputs {
    /// Basis of a term at joint values `q`.
    #[must_use]
    pub fn basis(&self, q: &[f64], term: &Term<f64>) -> f64 {
        with_joints!(q.len(), N => term.basis(&self.fixed::<N>(q)))
    }
}

/// An arm of any number of joints, seen from a station.
pub trait Kinematics: Send + Sync {
    /// Tool pose at joint values `q`.
    fn pose(&self, q: &[f64]) -> Pose<f64>;
    /// How the tool moves with each joint, as [`truearm::kinematics::Jacobian`]
    /// has it: its point, m per rad or m, and its turn, rad per rad or m.
    fn jacobian(&self, q: &[f64]) -> Vec<[Vector3<f64>; 2]>;
    /// Tool pose with the arm bent by `terms`.
    fn bent(&self, q: &[f64], terms: &[Term<f64>], inputs: &RowInputs) -> Pose<f64>;
    /// Tool point of the bent arm, and its derivatives.
    fn derivatives(&self, q: &[f64], terms: &[Term<f64>], inputs: &RowInputs) -> Derivatives;
    /// Those to the coefficient of a term, by derivatives of this arm at `q`.
    fn column(
        &self,
        of: &Derivatives,
        q: &[f64],
        term: &Term<f64>,
        inputs: &RowInputs,
    ) -> Vector3<f64>;
    /// What gravity does, and nothing else that terms depend on; the base must be the
    /// frame of gravity.
    fn load(&self, masses: &ArmMasses, q: &[f64], payload: f64) -> RowInputs;
}

/// Masses for any number of joints.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmMasses {
    /// Gravity in the base frame, m/s^2.
    pub gravity: Vector3<f64>,
    /// Mass and centre of mass of each link, kg and m.
    pub links: Vec<(f64, Vector3<f64>)>,
    /// Payload point in the last frame, m.
    pub payload: Vector3<f64>,
}

struct SizedArm<const N: usize> {
    links: [Link<f64>; N],
    chain: Chain<f64, N>,
    /// Taken once: every row of an identification needs them.
    turns: [LinkTurns<f64>; N],
}

impl<const N: usize> Kinematics for SizedArm<N> {
    fn pose(&self, q: &[f64]) -> Pose<f64> {
        self.chain.forward(&fixed(q))
    }

    fn jacobian(&self, q: &[f64]) -> Vec<[Vector3<f64>; 2]> {
        self.chain.jacobian(&fixed(q)).columns.map(|c| [c.linear, c.angular]).to_vec()
    }

    fn bent(&self, q: &[f64], terms: &[Term<f64>], inputs: &RowInputs) -> Pose<f64> {
        let deflection = inputs.deflection(terms, &inputs.fixed::<N>(q));
        self.chain.forward_deflected(&fixed(q), &deflection)
    }

    fn derivatives(&self, q: &[f64], terms: &[Term<f64>], inputs: &RowInputs) -> Derivatives {
        let row = inputs;
        let inputs = row.fixed::<N>(q);
        let deflection = row.deflection(terms, &inputs);
        let j =
            self.chain.identification_jacobian_with(&self.turns, &deflection.deflected(&inputs.q));
        // Base compliance turns about the axes of the robot, not the tracker.
        let r = &self.chain.base().rotation;
        let turn = |k: usize| {
            j.base_rotation[0] * r[(0, k)]
                + j.base_rotation[1] * r[(1, k)]
                + j.base_rotation[2] * r[(2, k)]
        };
        let [rx, ry, rz] = j.base_rotation;
        let [tx, ty, tz] = j.base_translation;
        Derivatives {
            point: self.chain.forward_deflected(&inputs.q, &deflection).translation,
            base: [rx, ry, rz, tx, ty, tz],
            about: [turn(0), turn(1), turn(2)],
            axes: [0, 1, 2].map(|k| r.column(k).into_owned()),
            tool: j.tool,
            links: j.links.to_vec(),
            tilts: None,
        }
    }

    fn column(
        &self,
        of: &Derivatives,
        q: &[f64],
        term: &Term<f64>,
        inputs: &RowInputs,
    ) -> Vector3<f64> {
        of.column(term, inputs, q, &self.links)
    }

    fn load(&self, masses: &ArmMasses, q: &[f64], payload: f64) -> RowInputs {
        let links: [(f64, Vector3<f64>); N] = fixed(&masses.links);
        let masses = Masses {
            gravity: masses.gravity,
            mass: links.map(|l| l.0),
            com: links.map(|l| l.1),
            payload_com: masses.payload,
        };
        let Load { torque, moment, across } = masses.load(&self.chain, &fixed(q), payload);
        let across = across.map_or_else(Vec::new, Vec::from);
        RowInputs { torque: torque.to_vec(), moment, across, ..RowInputs::default() }
    }
}

/// A slice whose length the file reader has checked.
pub(crate) fn fixed<T: Copy, const N: usize>(q: &[T]) -> [T; N] {
    q.try_into().unwrap_or_else(|_| unreachable!("every row has a value for every joint"))
}

/// The arm of these links with this base and tool point.
#[must_use]
pub fn chain(links: &[Link<f64>], base: Pose<f64>, tool: Vector3<f64>) -> Box<dyn Kinematics> {
    let tool = Pose { translation: tool, ..Pose::identity() };
    with_joints!(links.len(), N => {
        let links: [Link<f64>; N] = fixed(links);
        let chain = Chain::new(&links, base, tool);
        Box::new(SizedArm { turns: chain.link_turns(), chain, links })
    })
}
