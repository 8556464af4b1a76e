use std::ops::Range;

use truearm::effects::{ActsOn, Effect, Term};

use crate::identify::Conditions;
use crate::model::{ModelTerm, Robot};

/// An effect as the diagnosis knows it.
#[derive(Debug, Clone)]
pub struct Family {
    /// Name in reports and files.
    pub name: &'static str,
    /// What the data can test, or what is missing in the files for it.
    pub offers: fn(&Data) -> Result<Vec<Offer>, &'static str>,
    /// Signs and sizes of a coefficient that physics allows, SI.
    pub plausible: Range<f64>,
    /// Whether a joint may have several of it, of different orders.
    pub several: bool,
}

/// What candidates are drawn from.
#[derive(Debug, Clone, Copy)]
pub struct Data<'a> {
    /// The nominal arm.
    pub robot: &'a Robot,
    /// What is known of the rows.
    pub conditions: &'a Conditions,
    /// Its masses are only assumed.
    pub assumed: bool,
}

impl Data<'_> {
    /// Joints that may have the effect, counted from 0.
    pub fn joints(&self, effect: Effect) -> Vec<usize> {
        let joints = self.robot.joints.iter().enumerate();
        joints.filter(|(_, joint)| effect.suits(joint.link.kind)).map(|(j, _)| j).collect()
    }

    /// One offer a joint, each a single coefficient or one a component.
    pub fn one_a_joint(&self, effect: Effect) -> Vec<Offer> {
        let joints = self.joints(effect);
        joints.iter().map(|j| Offer::of_arm(effect, &[*j], &[0.0], joints.len())).collect()
    }

    /// An error where the load of the joints is not known.
    pub fn loaded(&self) -> Result<(), &'static str> {
        let known = self.conditions.masses || self.conditions.torques;
        if known { Ok(()) } else { Err("gravity_m_s2 and [[links]], or columns torque1_nm..") }
    }

    /// An error where the load of the base is not known.
    pub fn massive(&self) -> Result<(), &'static str> {
        if self.conditions.masses { Ok(()) } else { Err("gravity_m_s2 and [[links]]") }
    }

    /// An error where moments in all directions are not known: masses that are only
    /// assumed take the shape of what turns the joints.
    pub fn weighed(&self) -> Result<(), &'static str> {
        self.massive().and(if self.assumed { Err("[[links]]") } else { Ok(()) })
    }
}

/// Terms that may be missing together, an effect at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Offer {
    /// Coefficients zero.
    pub terms: Vec<ModelTerm>,
    /// How many alternatives of its kind are tried: the price of choosing.
    pub tried: f64,
}

impl Offer {
    /// The same of an arm that follows its temperature with this time constant, s, of so many
    /// that are tried.
    #[must_use]
    pub fn late(&self, time_constant: f64, tried: f64) -> Self {
        let mut out = Self { tried: self.tried * tried, ..self.clone() };
        for term in &mut out.terms {
            if let ModelTerm::Arm(term) = term {
                term.order = time_constant;
            }
        }
        out
    }

    /// An effect of the arm at joints counted from 0 (source and target of a
    /// coupling, none of the base and of all links): every component of each
    /// order.
    #[must_use]
    pub fn of_arm(effect: Effect, joints: &[usize], orders: &[f64], tried: usize) -> Self {
        let at = |k: usize| joints.get(k).map_or(0, |joint| *joint as u8);
        let (source, joint) = match (effect.acts_on(), joints) {
            (ActsOn::Lengths, []) => (0, Term::<f64>::ALL),
            _ if effect.is_coupled() => (at(0), at(1)),
            _ => (0, at(0)),
        };
        let components = effect.components().len().max(1) as u8;
        let term = |component, order| {
            ModelTerm::Arm(Term { effect, joint, source, component, order, coefficient: 0.0 })
        };
        let each = |order: &f64| (0..components).map(|k| term(k, *order)).collect::<Vec<_>>();
        Self { terms: orders.iter().flat_map(each).collect(), tried: tried as f64 }
    }
}
