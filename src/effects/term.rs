use nalgebra::Vector3;

use super::Effect;
use super::descriptor::{ActsOn, NeedsLoad};
use super::inputs::TermInputs;
use crate::kinematics::{Deflection, JointKind, Link, LinkColumns};
use crate::scalar::Scalar;

/// One term of an arm's model: linear in its coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Term<T> {
    /// Which effect.
    pub effect: Effect,
    /// The joint it acts on, counted from 0, where the effect acts on a joint;
    /// the link, or [`Term::ALL`], where it acts on lengths.
    pub joint: u8,
    /// The joint it follows, counted from 0, where the effect is coupled.
    pub source: u8,
    /// Which of [`Effect::components`]; 0 where there is one coefficient only.
    pub component: u8,
    /// What [`Effect::order`] says: cycles per turn of the joint, a friction in
    /// N m (N for a prismatic joint), a time constant in s, or 0.
    pub order: T,
    /// The identified coefficient, unit of [`Term::unit`].
    pub coefficient: T,
}

impl<T: Scalar> Term<T> {
    /// `joint` of a term that acts on the lengths of all links.
    pub const ALL: u8 = u8::MAX;

    /// Whether it acts on the lengths of all links.
    #[must_use]
    pub const fn of_all_links(&self) -> bool {
        self.joint == Self::ALL && matches!(self.effect.acts_on(), ActsOn::Lengths)
    }

    /// The joint or link it acts on, counted from 0; none of one that acts on the
    /// base or on all links.
    #[must_use]
    pub const fn own_joint(&self) -> Option<u8> {
        match self.effect.acts_on() {
            ActsOn::Base => None,
            _ if self.of_all_links() => None,
            _ => Some(self.joint),
        }
    }

    /// Unit of the coefficient in an arm of joints of these kinds.
    #[must_use]
    pub fn unit(&self, kinds: &[JointKind]) -> &'static str {
        let of = |joint: u8| kinds.get(usize::from(joint)).copied().unwrap_or(JointKind::Revolute);
        self.effect.unit(of(self.joint), of(self.source))
    }

    /// Whether it depends on gravity, so that the arm's [`super::Masses`] are
    /// needed, or torques that are read, see [`Self::needs_masses`].
    #[must_use]
    #[inline(never)]
    pub fn needs_load(&self) -> bool {
        match self.effect.load() {
            NeedsLoad::Never => false,
            NeedsLoad::Torque | NeedsLoad::Moments => true,
            NeedsLoad::WithFriction => self.order > T::ZERO,
        }
    }

    /// Whether only masses tell it the load: [`State::torque`](crate::State::torque) does not.
    #[must_use]
    pub fn needs_masses(&self) -> bool {
        self.effect.load() == NeedsLoad::Moments
    }

    /// Whether it follows the torque of its joint, which masses give or
    /// [`State::torque`](crate::State::torque).
    #[must_use]
    pub fn needs_torque(&self) -> bool {
        self.needs_load() && !self.needs_masses()
    }

    /// Derivative of the tool point to the coefficient, m per unit: the basis
    /// times the [`Self::action`].
    #[must_use]
    pub fn column<const N: usize>(
        &self,
        inputs: &TermInputs<T, N>,
        links: &[Link<T>],
        columns: &[LinkColumns<T>],
        base_rotation: &[Vector3<T>; 3],
    ) -> Vector3<T> {
        self.action(inputs, links, columns, base_rotation) * self.basis(inputs)
    }

    /// Derivative of the tool point to what the term deflects: a geometric column
    /// (of the chain at the bent joint values). The columns of `base_rotation` are
    /// to rotations about the base's own axes.
    #[must_use]
    pub fn action<const N: usize>(
        &self,
        inputs: &TermInputs<T, N>,
        links: &[Link<T>],
        columns: &[LinkColumns<T>],
        base_rotation: &[Vector3<T>; 3],
    ) -> Vector3<T> {
        let tilts = |joint: usize| columns.get(joint).map(LinkColumns::tilts);
        self.action_by(inputs, links, columns, base_rotation, tilts)
    }

    /// The same of anything that moves with the links as these columns say, such as how
    /// the tool is turned: `tilts` says how it moves with those of a joint's axis, as
    /// [`LinkColumns::tilts`] does of the tool point.
    #[must_use]
    #[inline]
    pub fn action_by<const N: usize>(
        &self,
        inputs: &TermInputs<T, N>,
        links: &[Link<T>],
        columns: &[LinkColumns<T>],
        base_rotation: &[Vector3<T>; 3],
        tilts: impl FnOnce(usize) -> Option<[Vector3<T>; 2]>,
    ) -> Vector3<T> {
        let none = Vector3::new(T::ZERO, T::ZERO, T::ZERO);
        let joint = usize::from(self.joint);
        let column = match self.effect.acts_on() {
            ActsOn::Base => base_rotation.get(usize::from(self.component)).copied(),
            ActsOn::Axis => {
                let across = inputs.load.across_axis(joint);
                let along = |[about_x, about_y]: [Vector3<T>; 2], x, y| about_x * x + about_y * y;
                tilts(joint).zip(across).map(|(tilts, [_, x, y])| along(tilts, x, y))
            }
            ActsOn::Lengths => {
                let mut sum = none;
                for (i, (link, c)) in links.iter().zip(columns).enumerate() {
                    if self.joint == Self::ALL || i == joint {
                        sum += c.a * link.parameters.a + c.d * link.parameters.d;
                    }
                }
                Some(sum)
            }
            ActsOn::Joint => {
                columns.get(joint).zip(links.get(joint)).map(|(c, link)| *c.joint(link.kind))
            }
        };
        column.unwrap_or(none)
    }
}

/// What all terms together do to an arm, summed as they come. An [`crate::Arm`]
/// has them folded instead.
#[must_use]
pub fn deflection<T: Scalar, const N: usize>(
    terms: &[Term<T>],
    inputs: &TermInputs<T, N>,
) -> Deflection<T, N> {
    let mut out = Deflection::none();
    for term in terms {
        let amount = term.coefficient * term.basis(inputs);
        let slot = match term.effect.acts_on() {
            ActsOn::Base => out.base.get_mut(usize::from(term.component)),
            ActsOn::Axis => {
                let joint = usize::from(term.joint);
                let axes = out.axes.get_or_insert([[T::ZERO; 2]; N]);
                if let (Some(axis), Some([_, x, y])) =
                    (axes.get_mut(joint), inputs.load.across_axis(joint))
                {
                    *axis = [axis[0] + x * amount, axis[1] + y * amount];
                }
                None
            }
            ActsOn::Lengths if term.joint == Term::<T>::ALL => {
                for growth in &mut out.growth {
                    *growth += amount;
                }
                None
            }
            ActsOn::Lengths => out.growth.get_mut(usize::from(term.joint)),
            ActsOn::Joint => out.joints.get_mut(usize::from(term.joint)),
        };
        if let Some(slot) = slot {
            *slot += amount;
        }
    }
    out
}
