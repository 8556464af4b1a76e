//! The law: the correction of a command, a function of the command and of the
//! state alone. Derivation and bounds: `docs/compensation.md`.

use nalgebra::Vector3;

use super::correction::Correction;
use super::damped::Rule;
use super::outcome::Joints;
use super::settings::Settings;
use crate::arm::{Arm, State};
use crate::kinematics::{Pose, Turn, Twist, axes, dot, rotate};
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
    /// Between these no limit is nearer than the largest correction, however they are rounded.
    free: [[T; 2]; N],
    /// By how much the identified joint angles are further than the nominal ones.
    beyond_nominal: [Turn<T>; N],
    /// From the frame that the identified arm's first joint turns in to that of the
    /// nominal one's. Tools are compared in the former, to which a walk leads: one
    /// change of the frame for the target in place of one for every look.
    first: Pose<T>,
}

impl<T: Scalar, const N: usize> Law<T, N> {
    pub fn new(arm: &Arm<'_, T, N>, settings: &Settings<T, N>) -> Self {
        let limits = arm.limits().map(|limit| limit.unwrap_or([-T::MAX, T::MAX]));
        Self {
            rule: settings.rule(),
            refinements: settings.refinements,
            most: settings.max_correction,
            free: free(&limits, &settings.max_correction),
            limits,
            beyond_nominal: arm.real().turned_from(arm.nominal()),
            first: arm.real().root().inverse().compose(arm.nominal().root()),
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
        let (joints, beyond) = (arm.nominal().joints(), &self.beyond_nominal);
        out.nominal.set_both(joints, command, &mut out.identified, beyond);
        out.target = arm.nominal().tool_jacobian(&out.nominal, &mut out.columns, &self.first);
        self.make_room(command, out);
        out.system.set(&out.columns, &self.rule);
        out.along = Twist::zero();
        let bends = arm.bends();
        let grows = arm.grows();
        if grows {
            arm.grow(state, &mut out.bent);
        }
        let frame = arm.rigid_axes(&out.identified, grows.then_some(&out.bent));
        self.look(&frame, false, out);
        for refinement in 0..self.refinements {
            if bends {
                out.near.set_moved(&out.identified, arm.real().joints(), &out.joints);
                let Correction { near, rigid, share, joints, bent, .. } = &mut *out;
                arm.bend(near, state, [command, rigid, share], joints, bent);
            }
            let limited = bends && !out.limited.is_empty();
            // At first nothing had bent: gravity was taken at the joints at which the rigid
            // chain stands.
            if !bends || refinement > 0 || limited {
                let mut stands = out.rigid;
                if limited {
                    out.bent.share_out(&out.share, &mut stands);
                }
                out.near.set_moved(&out.identified, arm.real().joints(), &stands);
            }
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
        let bends = arm.bends();
        let (nominal, beyond) = (arm.nominal().joints(), &self.beyond_nominal);
        work.nominal.set_both(nominal, joints, &mut work.identified, beyond);
        let mut stands = [T::ZERO; N];
        if bends {
            let Correction { identified, joints: offset, bent, .. } = &mut *work;
            let none = [T::ZERO; N];
            arm.bend(identified, state, [joints, &none, &none], offset, bent);
            stands = bent.deflection.joints;
        }
        work.near.set_moved(&work.identified, arm.real().joints(), &stands);
        let axes = arm.rigid_axes(&work.near, bends.then_some(&work.bent));
        let error = error_in_tool(&axes, &work.target, true);
        let turns = [&work.target.rotation, &arm.real().root().rotation];
        let [linear, angular] = [error.linear, error.angular]
            .map(|error| turns.iter().fold(error, |error, turn| rotate(turn, &error)));
        Twist { linear, angular }
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
            out.bent.take_back(&out.rigid, &mut out.joints);
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
        if !free || out.near_limit {
            out.near_limit = !free;
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
        let joints = command.iter().zip(&self.free).zip(&mut out.columns);
        let places = out.share.iter_mut().zip(&mut out.most);
        for (i, (((q, [low, high]), column), (share, most))) in joints.zip(places).enumerate() {
            // To the limits, drawn in by what roundings make of a correction.
            let (below, above) = ((*q - *low) + *most, (*high - *q) + *most);
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

/// Between which joint values no limit is nearer than the largest correction, however all are
/// rounded: four times the correction, once each of the sums here and in a tick.
// Not inlined: unrolled for every joint it would take half a kilobyte.
#[inline(never)]
fn free<T: Scalar, const N: usize>(limits: &[[T; 2]; N], most: &[T; N]) -> [[T; 2]; N] {
    let (half, roundings) = (T::from_f32(0.5), T::EPSILON * T::from_f32(16.0));
    let mut free = *limits;
    for ([low, high], most) in free.iter_mut().zip(most) {
        let size = *most + (low.abs() * half + high.abs() * half);
        let clear = *most + size * roundings;
        *low += clear;
        *high -= clear;
    }
    free
}

/// From the real to the nominal tool, in the frame of the nominal one: of the
/// point; and three entries of the rotation, which are its vector to first order in the
/// angle, or zero where only the position counts. For errors that a law takes back,
/// thousandths of a radian: from a right angle on they are too small, at half a turn none.
#[inline]
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
