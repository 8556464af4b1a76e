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
    /// To the tool point in the last frame.
    pub tool: [Vector3<f64>; 3],
    /// To the parameters of each link.
    pub links: Vec<LinkColumns<f64>>,
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
            (term.action(&inputs, links, &self.links, &self.about), term.basis(&inputs))
        })
    }

    /// How the last frame is turned.
    #[must_use]
    pub fn rotation(&self) -> Matrix3<f64> {
        Matrix3::from_columns(&self.tool)
    }

    /// How the last frame turns with the parameters of each link, in their
    /// order, rad per unit: about the axes that the links' columns lie along.
    #[must_use]
    pub fn turns(&self) -> Vec<[Vector3<f64>; 5]> {
        let count = self.links.len();
        let turn = |i: usize| {
            let link = &self.links[i];
            // x behind the joint and its beta: that of the next link.
            let next = if i + 1 < count { self.links[i + 1].a } else { self.tool[0] };
            let y = link.d.cross(&next).normalize();
            [link.a, Vector3::zeros(), link.d, Vector3::zeros(), y]
        };
        (0..count).map(turn).collect()
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
    /// Tool point of the bent arm, its derivatives, and those to the terms'
    /// coefficients.
    fn derivatives(
        &self,
        q: &[f64],
        terms: &[Term<f64>],
        inputs: &RowInputs,
    ) -> (Derivatives, Vec<Vector3<f64>>);
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

    fn derivatives(
        &self,
        q: &[f64],
        terms: &[Term<f64>],
        inputs: &RowInputs,
    ) -> (Derivatives, Vec<Vector3<f64>>) {
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
        let about = [turn(0), turn(1), turn(2)];
        let columns = terms.iter().map(|t| t.column(&inputs, &self.links, &j.links, &about));
        let columns = columns.collect();
        let [rx, ry, rz] = j.base_rotation;
        let [tx, ty, tz] = j.base_translation;
        let links = j.links.to_vec();
        let point = self.chain.forward_deflected(&inputs.q, &deflection).translation;
        (Derivatives { point, base: [rx, ry, rz, tx, ty, tz], about, tool: j.tool, links }, columns)
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
