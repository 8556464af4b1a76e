use truearm::effects::Effect;
use truearm::{JointKind, Link, MdhParameters};

use super::*;
use crate::identify::Conditions;
use crate::model::arm::RowInputs;
use crate::model::{Joint, Robot};

/// Every effect of the crate has its half here, under one name, and those of the
/// measurement follow.
#[test]
fn names_are_those_of_the_crate() {
    let (arm, measurement) = ALL.split_at(Effect::ALL.len());
    let names: Vec<_> = arm.iter().map(|family| family.name).collect();
    assert_eq!(names, Effect::ALL.iter().map(|effect| effect.name()).collect::<Vec<_>>());
    for (family, effect) in arm.iter().zip(Effect::ALL) {
        // What diagnosis may find a controller takes.
        let most = 1.000_001 * f64::from(effect.plausible());
        let range = &family.plausible;
        assert!(range.start <= 0.0 && range.end <= most && range.start >= -most, "{range:?}");
    }
    for family in measurement {
        assert!(Effect::from_name(family.name).is_none());
        assert_eq!(ALL.iter().filter(|other| other.name == family.name).count(), 1);
    }
}

/// Joint 2 slides.
fn robot() -> Robot {
    let joint = |kind| Joint {
        link: Link { kind, parameters: MdhParameters::from_array([0.0, 0.3, 0.0, 0.2, 0.0]) },
        limits: None,
        gear_ratio: Some(101.0),
        prior: crate::model::LinkPrior::default(),
    };
    Robot {
        path: "robot.toml".into(),
        name: "on a rail".into(),
        serial: String::new(),
        sigma_angle: None,
        sigma: 2e-5,
        gravity: None,
        reference_temperature: 20.0,
        joints: [JointKind::Revolute, JointKind::Prismatic, JointKind::Revolute].map(joint).into(),
        base: crate::model::Placement::default(),
        tool: nalgebra::Vector3::zeros(),
        tool_rpy: nalgebra::Vector3::zeros(),
        links: Vec::new(),
        payload: nalgebra::Vector3::zeros(),
        warnings: Vec::new(),
    }
}

fn conditions(known: bool) -> Conditions {
    Conditions {
        rows: Vec::new(),
        masses: known,
        torques: false,
        torques_of_either_sign: false,
        temperature: known,
        warming: known.then_some([60.0, 7200.0]),
        direction: known,
        direction_from_order: false,
        sides_found: Vec::new(),
        before: Vec::new(),
        time: known,
        ordered: known,
        series: if known { vec!["A".into(), "B".into()] } else { Vec::new() },
    }
}

#[test]
fn what_counts_turns_is_not_offered_to_a_rail() {
    let (offers, missing) =
        offers(&Data { robot: &robot(), conditions: &conditions(true), assumed: false });
    assert_eq!(missing, Vec::<String>::new());
    let at = |effect: Effect| {
        let of = |offer: &&Offer| offer.terms[0].effect_name() == effect.name();
        let mut joints: Vec<_> =
            offers.iter().filter(of).flat_map(|offer| offer.terms[0].joints()).collect();
        joints.sort_unstable();
        joints.dedup();
        joints
    };
    assert_eq!(at(Effect::EncoderEccentricity), [1, 3]);
    assert_eq!(at(Effect::GearTransmissionError), [1, 3]);
    assert_eq!(at(Effect::LateralCompliance), [3]);
    for effect in [Effect::JointGain, Effect::JointCoupling, Effect::Backlash] {
        assert_eq!(at(effect), [1, 2, 3], "{}", effect.name());
    }
    // One term a component and order; its coefficient is not chosen yet.
    for offer in &offers {
        assert!(offer.tried >= 1.0 && !offer.terms.is_empty());
        assert!(offer.terms.iter().all(|term| term.coefficient() == 0.0));
    }
}

#[test]
fn assumed_masses_do_not_tell_moments_across() {
    let known = conditions(true);
    let data = Data { robot: &robot(), conditions: &known, assumed: true };
    let (offers, missing) = offers(&data);
    assert_eq!(missing, ["lateral-compliance: needs [[links]]"]);
    let name = Effect::LateralCompliance.name();
    assert!(offers.iter().all(|offer| offer.terms[0].effect_name() != name));
}

/// A spring that nobody weighed may be what an oval disc alone is taken for: of joints that are
/// loaded it is not offered.
#[test]
fn an_oval_disc_alone_is_no_spring() {
    let row = |torque: f64| RowInputs { torque: vec![0.0, 0.0, torque], ..RowInputs::default() };
    let known = Conditions { rows: vec![row(-2.0), row(3.0)], ..conditions(true) };
    let at = |assumed| {
        let (offers, _) = offers(&Data { robot: &robot(), conditions: &known, assumed });
        let alone = |o: &&Offer| {
            o.terms[0].effect_name() == Effect::EncoderEccentricity.name()
                && o.terms.iter().all(|term| term.order() == Some(2.0))
        };
        offers.iter().filter(alone).flat_map(|o| o.terms[0].joints()).collect::<Vec<_>>()
    };
    assert_eq!(at(true), [1]);
    assert_eq!(at(false), [1, 3]);
}

#[test]
fn what_is_missing_is_said() {
    let mut robot = robot();
    robot.joints.iter_mut().for_each(|joint| joint.gear_ratio = None);
    let (_, missing) =
        offers(&Data { robot: &robot, conditions: &conditions(false), assumed: false });
    assert_eq!(
        missing,
        [
            "joint-compliance, joint-stiffening: need gravity_m_s2 and [[links]], or columns \
             torque1_nm..",
            "base-compliance, lateral-compliance: need gravity_m_s2 and [[links]]",
            "gear-transmission-error: needs gear_ratio",
            "backlash: needs columns dir1..",
            "thermal-expansion: needs a column temperature_c that varies",
            "measurement-drift: needs a column time_s or order",
            "tool-remount: needs a column series with several labels",
        ]
    );
}
