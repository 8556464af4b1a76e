use std::path::Path;

use nalgebra::Vector3;

use super::bodies::bodies;
use super::{Document, Ends, Serial};
use crate::convert::axes::Convention;
use crate::convert::verified;
use crate::error::Result;
use crate::files::RobotDraft;
use crate::model::{Joint, LinkPrior, Placement};

/// A robot.toml of a URDF.
#[derive(Debug, Clone)]
pub struct FromUrdf {
    /// The text.
    pub text: String,
    /// The chain it is of.
    pub chain: Serial,
    /// The largest distance between the two arms' tips over the poses at which
    /// they were compared, m.
    pub deviation: f64,
    /// Remarks for the user.
    pub warnings: Vec<String>,
}

/// Standard gravity, m/s^2, down.
const DOWN: Vector3<f64> = Vector3::new(0.0, 0.0, -9.80665);

/// Makes the robot.toml of a chain of a URDF: the same joint values, zeros and
/// senses, coordinates in the frame of the base link. It is read again, and its
/// tips are compared with those of the URDF's own joints.
///
/// # Errors
/// What [`Document::read`] and [`Serial::of`] refuse.
pub fn robot_of_urdf(path: &Path, ends: &Ends) -> Result<FromUrdf> {
    let document = Document::read(path)?;
    let chain = Serial::of(&document, ends)?;
    let described = chain.axes().describe(Convention::Hayati);
    let (mut links, beside) = bodies(&document, &chain, &described.frames);
    let mut warnings = Vec::new();
    if !beside.is_empty() {
        let names = beside.join(", ");
        warnings.push(format!("masses behind joints beside the chain are not counted: {names}"));
    }
    let impossible = document.robot.links.iter().filter(|link| {
        let mass = link.inertial.mass.value;
        mass < 0.0 || !mass.is_finite()
    });
    let impossible: Vec<String> = impossible
        .map(|link| format!("{} has {} kg", link.name, link.inertial.mass.value))
        .collect();
    if !impossible.is_empty() {
        let names = impossible.join(", ");
        warnings.push(format!("no body has such a mass: link {names}; [[links]] is left out"));
        links.clear();
    }
    let massless = links.iter().zip(&chain.joints).filter(|(link, _)| link.mass == 0.0);
    let massless: Vec<&str> = massless.map(|(_, joint)| joint.name.as_str()).collect();
    if !massless.is_empty() {
        // A torque of part of the arm would be worse than none.
        let names = massless.join(", ");
        warnings.push(format!("no mass behind {names}: [[links]] is left out"));
        links.clear();
    }
    let joints = chain.joints.iter().zip(&described.links).map(|(joint, link)| {
        (
            joint.name.clone(),
            Joint {
                link: *link,
                limits: joint.limits,
                gear_ratio: None,
                prior: LinkPrior::default(),
            },
        )
    });
    let name = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let draft = RobotDraft {
        origin: vec![
            format!("Of {name}, from link {} to link {}.", chain.base, chain.tip),
            "Lengths mm, angles degrees; joint values as in the URDF.".to_owned(),
        ],
        name: document.robot.name.clone(),
        gravity: (!links.is_empty()).then_some(DOWN),
        base: Placement::of(&described.base),
        tool: Placement::of(&described.tool),
        joints: joints.collect(),
        links,
    };
    let text = draft.to_toml();
    let limits: Vec<_> = chain.joints.iter().map(|j| j.limits).collect();
    let deviation = verified(&text, &limits, |q| chain.pose(q))?;
    Ok(FromUrdf { text, chain, deviation, warnings })
}
