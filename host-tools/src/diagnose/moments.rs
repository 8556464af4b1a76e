//! Gravity torques of an arm whose masses nobody knows exactly: the first moments
//! of its links, found together with the springs that they bend.
//!
//! A torque is linear in the masses and first moments of all that follows the joint.
//! Where springs are in a model, they are unknowns like those of geometry, held
//! near what was stated, or assumed: what springs of the right joints leave with
//! masses that are a tenth off would otherwise get names of its own. Their common
//! size is known from the prior alone: the springs' coefficients take it up.

use std::sync::Arc;

use nalgebra::Vector3;
use truearm::effects::Term;
use truearm::{JointKind, Link};

use super::bending::{Bending, is_spring, of_arm};
use super::policy::POLICY;
use crate::identify::{Problem, State, Surroundings};
use crate::model::{LinkMass, Robot};

/// Masses and moments about x and y of each link, and how well they are known.
#[derive(Debug, Clone)]
pub struct Moments {
    /// As stated or assumed.
    stated: Robot,
    /// Nothing but the direction of gravity was stated.
    assumed: bool,
    /// Links that nobody weighed, see [`PLACEHOLDER`].
    unweighed: Vec<bool>,
    /// What hangs on the last link is not among them.
    hand: bool,
    /// Standard deviation of each, [`OF_A_LINK`] a link: kg m about x, about y, kg.
    units: Vec<f64>,
    /// What was found beyond what was stated, in units.
    found: Vec<f64>,
    /// Where the links are that weigh.
    links: Vec<Link<f64>>,
}

/// Unknowns of a link.
const OF_A_LINK: usize = 3;
/// No mass is found to be less than this share of what was stated.
const LEAST_MASS: f64 = 0.1;
/// A link of less than this share of the arm stands for one that nobody weighed: drawings
/// are exported with 1 g there, and the lightest link of the UR10 is sixty times as much.
const PLACEHOLDER: f64 = 1e-3;
/// Standard deviation of such a mass and its moments over those of the whole arm; of a hand
/// that is not among the links, too.
const UNWEIGHED: f64 = 0.1;
/// Stated masses of the wrist are refuted from so many standard deviations on.
const REFUTED: f64 = 2.5;

impl Moments {
    /// Of a robot with masses, stated or only assumed; `None` without.
    #[must_use]
    pub fn of(robot: &Robot, assumed: bool) -> Option<Self> {
        let (weight, all) = whole(&robot.links);
        let least = PLACEHOLDER * weight;
        // The first joint seldom feels its link.
        let light = |(k, link): (usize, &LinkMass)| !assumed && k > 0 && link.mass < least;
        let unweighed: Vec<bool> = robot.links.iter().enumerate().map(light).collect();
        let unit = |(link, unweighed): (&LinkMass, &bool)| match assumed {
            // What is common to all is the spring's.
            true => [POLICY.assumed_moments * all, POLICY.assumed_moments * all, 0.0],
            false if *unweighed => [UNWEIGHED * all, UNWEIGHED * all, UNWEIGHED * weight],
            false => {
                let [mass, centre] = [POLICY.stated_masses, POLICY.stated_centres];
                [centre * moment(link), centre * moment(link), mass * link.mass]
            }
        };
        let units: Vec<f64> = robot.links.iter().zip(&unweighed).flat_map(unit).collect();
        let known = robot.gravity.is_some() && all > 0.0;
        let found = vec![0.0; units.len()];
        let links = robot.nominal();
        let mut stated = robot.clone();
        for (link, _) in stated.links.iter_mut().zip(&unweighed).filter(|(_, light)| **light) {
            // Something to hang moments on.
            link.mass = least;
        }
        known.then_some(Self { stated, assumed, unweighed, hand: false, units, found, links })
    }

    /// Where what was found refutes the masses stated of the last two links: those and a hand
    /// that nobody stated, which hangs on the last one and, by its distance along the last
    /// axis, on the one before.
    #[must_use]
    pub fn with_hand(&self) -> Option<Self> {
        let wrist = self.units.len().checked_sub(2 * OF_A_LINK)?;
        let refuted = self.found[wrist..].iter().any(|found| found.abs() > REFUTED);
        if self.assumed || self.hand || !refuted {
            return None;
        }
        let (weight, all) = whole(&self.stated.links);
        let (mass, moments) = (UNWEIGHED * weight, UNWEIGHED * all);
        let hand = [moments, moments, 0.0, moments, moments, mass];
        let mut with = Self { hand: true, ..self.clone() };
        with.found.fill(0.0);
        with.units[wrist..].iter_mut().zip(hand).for_each(|(unit, own)| *unit = unit.max(own));
        Some(with)
    }

    /// Whether masses were only assumed.
    #[must_use]
    pub fn are_assumed(&self) -> bool {
        self.assumed
    }

    /// The robot with the moments that were found; `None` where they are as stated.
    #[must_use]
    pub fn robot(&self) -> Option<Robot> {
        if self.found.iter().all(|m| *m == 0.0) {
            return None;
        }
        let found = self.with(&self.found);
        // What was stated is near enough.
        let light: Vec<usize> = (0..self.unweighed.len()).filter(|k| self.unweighed[*k]).collect();
        let far = self.assumed || self.hand || !light.is_empty();
        let mut robot = if far { within_reach(found, &self.links) } else { found };
        for k in light {
            robot.warnings.push(format!(
                "{}: link {} weighs less than a thousandth of the arm: taken for not weighed",
                robot.path.display(),
                k + 1
            ));
        }
        robot.warnings.push(format!(
            "{}: the masses of its links were fitted beside the springs{}",
            robot.path.display(),
            if self.hand {
                ", and what hangs on the last one: it is not among [[links]]"
            } else {
                ""
            }
        ));
        Some(robot)
    }

    fn with(&self, found: &[f64]) -> Robot {
        let mut robot = self.stated.clone();
        let more: Vec<f64> = found.iter().zip(&self.units).map(|(m, unit)| m * unit).collect();
        for (link, more) in robot.links.iter_mut().zip(more.chunks_exact(OF_A_LINK)) {
            if link.mass > 0.0 {
                link.mass = (link.mass + more[2]).max(LEAST_MASS * link.mass);
                link.com.x += more[0] / link.mass;
                link.com.y += more[1] / link.mass;
            }
        }
        robot
    }

    /// Of links that are where a state has them.
    pub fn stand_at(&mut self, state: &State) {
        self.links.clone_from(&state.links);
    }

    /// A problem at the loads that were found.
    #[must_use]
    pub fn loaded<'a>(&self, problem: &Problem<'a>) -> Problem<'a> {
        let robot = self.with(&self.found);
        let conditions = (*problem.conditions).clone();
        let conditions = conditions.with_loads(problem.data, &robot, &self.links);
        Problem { conditions: Arc::new(conditions), ..problem.clone() }
    }

    /// How the moments bend the springs of a state; `None` where it has none.
    #[must_use]
    pub fn bending(&self, state: &State) -> Option<Bending> {
        let spring = |t: &Term<f64>| is_spring(t.effect.name()) && t.coefficient != 0.0;
        let springs: Vec<_> = state.terms.iter().filter_map(of_arm).filter(spring).collect();
        if springs.is_empty() {
            return None;
        }
        let more = |k: usize| {
            let mut units = self.found.clone();
            units[k] += 1.0;
            Surroundings::at(&self.with(&units), &self.links)
        };
        let loads = (0..self.found.len()).map(more).collect();
        let (found, assumed) = (self.found.clone(), self.assumed);
        Some(Bending { springs, loads, found, assumed })
    }

    /// With what was found in units, nothing where no spring bends.
    pub fn find(&mut self, found: Vec<f64>) {
        self.found = if found.is_empty() { vec![0.0; self.found.len()] } else { found };
    }

    /// These, and a share of what others have found beyond.
    #[must_use]
    pub fn towards(&self, others: &Self, share: f64) -> Self {
        let between = |(own, other): (&f64, &f64)| own + share * (other - own);
        let found = self.found.iter().zip(&others.found).map(between).collect();
        Self { found, ..self.clone() }
    }

    /// Sum of squares of what was found, in units.
    #[must_use]
    pub fn norm_squared(&self) -> f64 {
        self.found.iter().map(|m| m * m).sum()
    }

    /// Whether any is other than these by a tenth of its unit.
    #[must_use]
    pub fn moved_from(&self, others: &Self) -> bool {
        self.found.iter().zip(&others.found).any(|(a, b)| (a - b).abs() > 0.1)
    }
}

/// First moment of a link about its joint's origin, kg m.
fn moment(link: &LinkMass) -> f64 {
    link.mass * link.com.norm()
}

/// Mass of all links, kg, and the sum of their moments, kg m.
fn whole(links: &[LinkMass]) -> (f64, f64) {
    (links.iter().map(|link| link.mass).sum(), links.iter().map(moment).sum())
}

/// No centre of mass is farther from its joint, m: a link of the same moment has
/// more mass instead.
const FARTHEST: f64 = 0.5;

/// The same loads by links whose centres of mass are near their joints. Mass that
/// is added on a joint's axis is fixed in the link before it, and is taken back from
/// the moments of all links before; on the first axis it does nothing but press on
/// the base, or on the rail that it stands on. Another joint that slides feels every mass
/// behind it: there nothing is changed.
pub(super) fn within_reach(mut robot: Robot, links: &[Link<f64>]) -> Robot {
    if robot.joints.iter().skip(1).any(|j| j.link.kind == JointKind::Prismatic) {
        return robot;
    }
    for k in (0..robot.links.len()).rev() {
        let link = &mut robot.links[k];
        let mass = (link.mass * link.com.norm() / FARTHEST).max(link.mass);
        // What weighs nothing has no moment to keep.
        if mass <= 0.0 {
            continue;
        }
        let more = mass - link.mass;
        link.com *= link.mass / mass;
        link.mass = mass;
        for i in (1..=k).rev() {
            let p = &links[i].parameters;
            let origin = Vector3::new(p.a, -p.d * p.alpha.sin(), p.d * p.alpha.cos());
            let before = &mut robot.links[i - 1];
            if before.mass > 0.0 {
                before.com -= origin * (more / before.mass);
            }
        }
    }
    robot
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Row;

    /// Links below a thousandth of the arm are not held where they were stated, others are;
    /// the first one is, however light.
    #[test]
    fn what_nobody_weighed_is_not_held() {
        let text = include_str!("../../../tests/data/ur10-ipa/robot.toml");
        let mut robot = Robot::parse("robot.toml".as_ref(), text).unwrap();
        robot.gravity = Some(Vector3::new(0.0, 0.0, -9.81));
        let others: f64 = robot.links[1..5].iter().map(|l| l.mass).sum();
        let with = |first: f64, last: f64| {
            let mut robot = robot.clone();
            (robot.links[0].mass, robot.links[5].mass) = (first, last);
            Moments::of(&robot, false).unwrap()
        };
        for (share, light) in [(1.01e-3, false), (0.99e-3, true), (1e-9, true)] {
            let own = with(1e-6, share * others);
            assert_eq!(own.unweighed, [false, false, false, false, false, light], "{share}");
            let mass = own.units[OF_A_LINK * 6 - 1] / others;
            let held = POLICY.stated_masses * share;
            let expected = if light { UNWEIGHED } else { held };
            assert!((mass / expected - 1.0).abs() < 0.01, "{share}: {mass}");
            assert_eq!(own.units[OF_A_LINK - 1], POLICY.stated_masses * 1e-6);
        }
        assert!(!Moments::of(&robot, true).unwrap().unweighed.contains(&true));
    }

    /// A hand is looked for where a mass or moment of the wrist was found too far from what was
    /// stated, once, and where something was stated.
    #[test]
    fn a_hand_is_looked_for_where_the_wrist_is_refuted() {
        let text = include_str!("../../../tests/data/ur10-ipa/robot.toml");
        let robot = Robot::parse("robot.toml".as_ref(), text).unwrap();
        let own = Moments::of(&robot, false).unwrap();
        let found = |k: usize, found: f64| {
            let mut own = own.clone();
            own.found[k] = found;
            own
        };
        for k in 0..OF_A_LINK * 6 {
            assert!(found(k, 0.99 * REFUTED).with_hand().is_none(), "{k}");
            for off in [-1.01 * REFUTED, 1.01 * REFUTED] {
                assert_eq!(found(k, off).with_hand().is_some(), k >= OF_A_LINK * 4, "{k}");
            }
        }
        let with = found(OF_A_LINK * 6 - 1, 3.0).with_hand().unwrap();
        assert!(with.found.iter().all(|found| *found == 0.0));
        let wider: Vec<bool> = with.units.iter().zip(&own.units).map(|(a, b)| a > b).collect();
        let hand = [12, 13, 15, 16, 17];
        assert!(wider.iter().enumerate().all(|(k, wider)| *wider == hand.contains(&k)));
        let again = Moments { found: vec![9.0; 18], ..with };
        assert!(again.with_hand().is_none());
        let assumed = Moments { assumed: true, ..found(17, 9.0) };
        assert!(assumed.with_hand().is_none());
    }

    /// On a rail, too: the same torques in all joints that turn.
    #[test]
    fn loads_stay_on_a_rail() {
        let text = include_str!("../../../tests/data/ur10-ipa/robot.toml");
        let mut robot = Robot::parse("robot.toml".as_ref(), text).unwrap();
        robot.joints[0].link.kind = JointKind::Prismatic;
        robot.links[3].com = Vector3::new(31.0, 2.0, 0.0);
        let near = within_reach(robot.clone(), &robot.nominal());
        assert!(near.links.iter().all(|l| l.com.norm() <= FARTHEST * (1.0 + 1e-12)));
        let [far, near] = [robot, near].map(|robot| Surroundings::new(&robot));
        for k in 0..30 {
            let q: Vec<f64> = (0..6).map(|j| (k * (j + 3)) as f64 % 5.0 - 2.5).collect();
            let [a, b] = [&far, &near].map(|of| of.inputs(&Row::at(q.clone()), &q).torque);
            assert!(a.iter().zip(&b).skip(1).all(|(a, b)| (a - b).abs() < 1e-9), "{k}");
        }
    }

    /// The same torques in every joint, and the same overturning moment but for a
    /// constant, by links whose centres are near.
    #[test]
    fn loads_stay_when_centres_are_brought_near() {
        let text = include_str!("../../../tests/data/ur10-ipa/robot.toml");
        let mut robot = Robot::parse("robot.toml".as_ref(), text).unwrap();
        for (k, link) in robot.links.iter_mut().enumerate() {
            link.com += Vector3::new(4.0, -3.0 + k as f64, 0.3) / (1.0 + k as f64);
        }
        let near = within_reach(robot.clone(), &robot.nominal());
        assert!(near.links.iter().all(|l| l.com.norm() <= FARTHEST * (1.0 + 1e-12)));
        let [far, near] = [robot, near].map(|robot| Surroundings::new(&robot));
        let inputs = |of: &Surroundings, k: usize| {
            let q: Vec<f64> = (0..6).map(|j| (k * (j + 3)) as f64 % 5.0 - 2.5).collect();
            of.inputs(&Row::at(q.clone()), &q)
        };
        let first = |k: usize| [inputs(&far, k), inputs(&near, k)];
        let [a, b] = first(0);
        let constant = [0, 1].map(|i| a.moment[i] - b.moment[i]);
        for k in 1..30 {
            let [a, b] = first(k);
            assert!(a.torque.iter().zip(&b.torque).all(|(a, b)| (a - b).abs() < 1e-9), "{k}");
            let moments = [0, 1].map(|i| a.moment[i] - b.moment[i] - constant[i]);
            assert!(moments.iter().all(|m| m.abs() < 1e-9), "{k}: {moments:?}");
        }
    }
}
