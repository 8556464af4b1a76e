//! The law: the correction of a command, a function of the command and of the
//! state alone. Derivation and bounds: `docs/compensation.md`.

use nalgebra::Vector3;

use super::damped::{Rule, System};
use super::outcome::Joints;
use super::settings::Settings;
use crate::arm::{Arm, Bent, State};
use crate::kinematics::{Pose, Turn, Turns, Twist, axes, dot, rotate};
use crate::scalar::Scalar;

/// What one arm and its settings fix of the law.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Law<T, const N: usize> {
    rule: Rule<T>,
    refinements: u8,
    /// Largest correction of each joint, rad or m.
    most: [T; N],
    /// Joint limits, rad or m; those of the number type where there are none.
    pub limits: [[T; 2]; N],
    /// Between these no limit is nearer than the largest correction.
    free: [[T; 2]; N],
    /// By how much the identified joint angles are further than the nominal ones.
    beyond_nominal: [Turn<T>; N],
}

/// A correction and how it came about; and what is computed on the way, which
/// stays in place, for a tick has no time for copies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Correction<T, const N: usize> {
    /// To be added to the command, rad or m.
    pub joints: [T; N],
    /// Where the nominal arm has its tool at the command.
    pub target: Pose<T>,
    /// Joints at their largest correction, to which all were scaled.
    pub bound: Joints,
    /// Joints so near a limit that they correct less than their share.
    pub limited: Joints,
    /// Weight of each joint in the solution: 1, falling to 0 at a limit.
    share: [T; N],
    /// Largest correction of each joint.
    most: [T; N],
    /// Jacobian of the nominal arm at the command, weighed.
    columns: [Twist<T>; N],
    system: System<T>,
    /// The nominal arm at the command, the identified one there, and either
    /// somewhere near.
    nominal: Turns<T, N>,
    identified: Turns<T, N>,
    near: Turns<T, N>,
    bent: Bent<T, N>,
    /// The solution in the directions of the task.
    along: Twist<T>,
    /// What it makes of the angles of the rigid chain.
    rigid: [T; N],
}

impl<T: Scalar, const N: usize> Correction<T, N> {
    /// None yet, of joints that may be corrected by so much at most.
    pub fn none(most: [T; N]) -> Self {
        let none = [T::ZERO; N];
        Self {
            joints: none,
            target: Pose::identity(),
            bound: Joints::default(),
            limited: Joints::default(),
            share: [T::ONE; N],
            most,
            columns: [Twist::zero(); N],
            system: System::none(),
            nominal: Turns::none(),
            identified: Turns::none(),
            near: Turns::none(),
            bent: Bent::none(),
            along: Twist::zero(),
            rigid: none,
        }
    }

    /// mu, 0 away from singular poses, m^2.
    pub fn damping(&self) -> T {
        self.system.damping[0]
    }

    /// A number times zero is zero; an infinity or a NaN is NaN.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.joints.iter().fold(T::ZERO, |zero, x| zero + *x * T::ZERO) == T::ZERO
    }
}

impl<T: Scalar, const N: usize> Law<T, N> {
    pub fn new(arm: &Arm<'_, T, N>, settings: &Settings<T, N>) -> Self {
        let limits = arm.limits().map(|limit| limit.unwrap_or([-T::MAX, T::MAX]));
        let mut free = limits;
        for ([low, high], most) in free.iter_mut().zip(&settings.max_correction) {
            *low += *most;
            *high -= *most;
        }
        Self {
            rule: settings.rule(),
            refinements: settings.refinements,
            most: settings.max_correction,
            limits,
            free,
            beyond_nominal: arm.real().turned_from(arm.nominal()),
        }
    }

    /// The correction of a command; not finite where an input is not, or is
    /// beyond the range of the sine. Of `out` nothing that was there counts.
    // Not inlined: with the caller around it the optimiser would compute every
    // address ahead.
    #[inline(never)]
    pub fn correct(
        &self,
        arm: &Arm<'_, T, N>,
        command: &[T; N],
        state: &State<T, N>,
        out: &mut Correction<T, N>,
    ) {
        out.nominal.set(arm.nominal().joints(), command);
        out.target = arm.nominal().tool_jacobian(&out.nominal, &mut out.columns);
        self.make_room(command, out);
        out.system.set(&out.columns, &self.rule);
        out.identified.set_turned(&out.nominal, &self.beyond_nominal);
        out.along = Twist::zero();
        let bends = !arm.terms().is_empty();
        if bends {
            arm.grow(state, &mut out.bent);
        }
        let frame = arm.rigid_axes(&out.identified, bends.then_some(&out.bent));
        self.look(&frame, false, out);
        for _ in 0..self.refinements {
            if bends {
                out.near.set_moved(&out.nominal, arm.nominal().joints(), &out.joints);
                let Correction { near, rigid, share, joints, bent, .. } = &mut *out;
                arm.bend(near, state, [command, rigid, share], joints, bent);
            }
            let stands = if bends && !out.limited.is_empty() { out.stands() } else { out.rigid };
            out.near.set_moved(&out.identified, arm.real().joints(), &stands);
            let frame = arm.rigid_axes(&out.near, bends.then_some(&out.bent));
            self.look(&frame, bends, out);
        }
    }

    /// By how much the arm at encoder readings `joints` misses the target of
    /// `work`, of which nothing else stays; in the base frame.
    pub fn error(
        &self,
        arm: &Arm<'_, T, N>,
        joints: &[T; N],
        state: &State<T, N>,
        work: &mut Correction<T, N>,
    ) -> Twist<T> {
        let bends = !arm.terms().is_empty();
        work.nominal.set(arm.nominal().joints(), joints);
        work.identified.set_turned(&work.nominal, &self.beyond_nominal);
        let mut stands = [T::ZERO; N];
        if bends {
            let Correction { nominal, joints: offset, bent, .. } = &mut *work;
            let none = [T::ZERO; N];
            arm.bend(nominal, state, [joints, &none, &none], offset, bent);
            stands = bent.deflection.joints;
        }
        work.near.set_moved(&work.identified, arm.real().joints(), &stands);
        let axes = arm.rigid_axes(&work.near, bends.then_some(&work.bent));
        let error = error_in_tool(&axes, &work.target, true);
        let turn = &work.target.rotation;
        Twist { linear: rotate(turn, &error.linear), angular: rotate(turn, &error.angular) }
    }

    /// Solves for the error of the rigid chain, whose tool has these axes and
    /// this point; and, if terms bend the joints, takes that back at each.
    #[inline(never)]
    fn look(&self, frame: &[Vector3<T>; 3], bends: bool, out: &mut Correction<T, N>) {
        let mut error = error_in_tool(frame, &out.target, self.rule.pose);
        let along = &mut out.along;
        let [mu, mu_angular] = out.system.damping;
        if mu > T::ZERO {
            error.linear -= along.linear * mu;
            error.angular -= along.angular * mu_angular;
        }
        let step = out.system.solve(&error, self.rule.pose);
        along.linear += step.linear;
        along.angular += step.angular;
        for (rigid, column) in out.rigid.iter_mut().zip(&out.columns) {
            *rigid = dot(&column.linear, &along.linear);
            if self.rule.pose {
                *rigid += dot(&column.angular, &along.angular);
            }
        }
        if !out.limited.is_empty() {
            out.share_out();
        }
        if bends {
            out.bent.take_back(&out.rigid, &out.share, &mut out.joints);
        } else {
            out.joints = out.rigid;
        }
        out.bound = Joints::default();
        // NaN is not within, either.
        let within = out.joints.iter().zip(&out.most).all(|(x, most)| x.abs() <= *most);
        if !within {
            out.shrink();
        }
    }

    /// How far joints may be corrected at a command, and which are near a limit.
    #[inline]
    fn make_room(&self, command: &[T; N], out: &mut Correction<T, N>) {
        let mut joints = command.iter().zip(&self.free);
        let free = joints.all(|(q, [low, high])| *q >= *low && *q <= *high);
        if !(free && out.limited.is_empty()) {
            self.near_limits(command, out);
        }
    }

    /// Where a limit is nearer than the largest correction, a joint's weight
    /// falls to zero towards it, and it may never be corrected beyond.
    // Cold: what rarely happens must not cost a tick in which it does not.
    #[cold]
    #[inline(never)]
    fn near_limits(&self, command: &[T; N], out: &mut Correction<T, N>) {
        out.share = [T::ONE; N];
        out.most = self.most;
        out.limited = Joints::default();
        let joints = command.iter().zip(&self.limits).zip(&mut out.columns);
        let places = out.share.iter_mut().zip(&mut out.most);
        for (i, (((q, [low, high]), column), (share, most))) in joints.zip(places).enumerate() {
            let (below, above) = (*q - *low, *high - *q);
            let left = if below < above { below } else { above };
            if left < *most {
                let left = if left > T::ZERO { left } else { T::ZERO };
                *share = left / *most;
                *most = left;
                column.linear *= *share;
                column.angular *= *share;
                out.limited.insert(i);
            }
        }
    }
}

impl<T: Scalar, const N: usize> Correction<T, N> {
    /// By how much the rigid chain stands further than at the command: as wanted,
    /// and by that of a joint's bend which is not taken back at the joint.
    #[cold]
    #[inline(never)]
    fn stands(&self) -> [T; N] {
        let mut stands = self.rigid;
        let bends = self.bent.deflection.joints.iter().zip(&self.share);
        for (stands, (bend, share)) in stands.iter_mut().zip(bends) {
            *stands += *bend * (T::ONE - *share);
        }
        stands
    }

    #[cold]
    #[inline(never)]
    fn share_out(&mut self) {
        for (rigid, share) in self.rigid.iter_mut().zip(&self.share) {
            *rigid *= *share;
        }
    }

    /// Scales all so that no joint is corrected by more than it may be.
    #[cold]
    #[inline(never)]
    fn shrink(&mut self) {
        let mut scale = T::ONE;
        for (i, (x, most)) in self.joints.iter().zip(&self.most).enumerate() {
            let size = x.abs();
            if size > *most {
                self.bound.insert(i);
                let fits = *most / size;
                if fits < scale {
                    scale = fits;
                }
            }
        }
        for x in self.joints.iter_mut().chain(&mut self.rigid) {
            *x *= scale;
        }
        self.along.linear *= scale;
        self.along.angular *= scale;
    }
}

/// From the real to the nominal tool, in the frame of the nominal one: of the
/// point, and the rotation vector, to second order in the angle, or zero where
/// only the position counts.
#[inline(never)]
fn error_in_tool<T: Scalar>(
    [x, y, p]: &[Vector3<T>; 3],
    nominal: &Pose<T>,
    pose: bool,
) -> Twist<T> {
    let [a, b, c] = axes(&nominal.rotation);
    let left = nominal.translation - p;
    let linear = Vector3::new(dot(&a, &left), dot(&b, &left), dot(&c, &left));
    if !pose {
        return Twist { linear, ..Twist::zero() };
    }
    Twist { linear, angular: Vector3::new(-dot(&c, y), dot(&c, x), -dot(&b, x)) }
}
