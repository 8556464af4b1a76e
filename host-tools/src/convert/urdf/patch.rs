use std::collections::HashMap;
use std::ops::Range;

use nalgebra::{UnitQuaternion, Vector3};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use truearm::{JointKind, Pose};

use super::write::{origin_tag, target};
use super::{Document, Ends, Moving, Serial};
use crate::convert::Identified;
use crate::error::Result;
use crate::model::Model;
use crate::units::to_mm;

/// How far an axis of the URDF may be from the model's nominal one, m and rad.
const SAME: f64 = 1e-5;
/// The link that is added.
const TARGET: &str = "truearm_target";

/// The user's own URDF with the identified geometry in the origins of its moving
/// joints, and a link `truearm_target` where the measured target is. All else of
/// the file stays as it was: names, meshes, masses, fixed joints. Without the
/// line `<?xml ...?>`.
///
/// # Errors
/// A URDF of another arm, or in other coordinates, than the model's.
pub fn calibrated_like(
    document: &Document,
    ends: &Ends,
    model: &Model,
    arm: &Identified,
) -> Result<String> {
    let chain = Serial::of(document, ends)?;
    let origins = origins(document, &chain, model, arm)?;
    if document.robot.links.iter().any(|l| l.name == TARGET) {
        return Err(document.at("link", TARGET, "is there already", "give the URDF as it was"));
    }
    let mut edits = Vec::new();
    for (joint, pose) in &origins.joints {
        let Some(place) = places(document)?.remove(joint.as_str()) else {
            return Err(document.at(
                "joint",
                joint,
                "could not be found again",
                "indent the file anew",
            ));
        };
        edits.push(match place.origin {
            Some((span, end)) => (span, origin_tag(pose, end)),
            None => (place.inside..place.inside, format!("\n    {}", origin_tag(pose, "/>"))),
        });
    }
    let last = chain.joints.last().map_or(chain.base.as_str(), |joint| joint.child.as_str());
    let end = document.text.rfind("</robot").unwrap_or(document.text.len());
    edits.push((end..end, target(last, TARGET, &origins.target)));
    edits.sort_by_key(|(span, _)| span.start);
    let mut text = document.text.clone();
    for (span, new) in edits.into_iter().rev() {
        text.replace_range(span, &new);
    }
    let body = match text.trim_start().strip_prefix("<?xml") {
        Some(rest) => rest.split_once("?>").map_or("", |(_, body)| body).trim_start().to_owned(),
        None => text,
    };
    Ok(body)
}

/// New origins of the moving joints, and the target in the last link.
struct Origins {
    joints: Vec<(String, Pose<f64>)>,
    target: Pose<f64>,
}

/// Every link's frame keeps its place on the axis of its joint and its turn
/// about it; the axis moves.
fn origins(
    document: &Document,
    chain: &Serial,
    model: &Model,
    arm: &Identified,
) -> Result<Origins> {
    let robot = &model.robot;
    let (ours, theirs) = (robot.joints.len(), chain.joints.len());
    if ours != theirs {
        let message = format!("{theirs} joints move in it, {ours} in the model");
        return Err(
            document.whole(message, "give the URDF of this arm, with --base-link and --tip-link")
        );
    }
    let nominal = Identified {
        base: robot.base.pose(),
        links: robot.nominal(),
        tool: Pose::identity(),
        marker: String::new(),
    };
    let mut before = Pose::identity();
    let mut joints = Vec::new();
    for (i, joint) in chain.joints.iter().enumerate() {
        let on_axis = on_axis(document, joint, &nominal.frames()[i], robot.joints[i].link.kind)?;
        let frame = arm.frames()[i].compose(&on_axis);
        let origin = before.compose(&joint.before).inverse().compose(&frame);
        joints.push((joint.name.clone(), origin));
        before = frame;
    }
    let target = before.inverse().compose(&arm.axes().tip);
    Ok(Origins { joints, target })
}

/// The frame of a joint's link in the model's frame on that axis.
fn on_axis(
    document: &Document,
    joint: &Moving,
    model: &Pose<f64>,
    kind: JointKind,
) -> Result<Pose<f64>> {
    let help =
        "give the URDF that robot.toml was made of, with the same --base-link and --tip-link";
    if joint.kind != kind {
        return Err(document.at(
            "joint",
            &joint.name,
            &format!("is not {kind:?} as in the model"),
            help,
        ));
    }
    let mut at = model.inverse().compose(&joint.frame);
    let along = at.rotation * joint.axis;
    let tilt = along.x.hypot(along.y).atan2(along.z);
    let aside = match kind {
        JointKind::Revolute => at.translation.x.hypot(at.translation.y),
        JointKind::Prismatic => 0.0,
    };
    if tilt > SAME || aside > SAME {
        let message = format!(
            "has its axis {:.3} mm and {:.4} degrees from the model's nominal one",
            to_mm(aside),
            tilt.to_degrees()
        );
        return Err(document.at("joint", &joint.name, &message, help));
    }
    // What is left of the tilt is rounding of the file.
    if let Some(turn) = UnitQuaternion::rotation_between(&along, &Vector3::z()) {
        at.rotation = turn.to_rotation_matrix().into_inner() * at.rotation;
    }
    if kind == JointKind::Revolute {
        at.translation = Vector3::new(0.0, 0.0, at.translation.z);
    }
    Ok(at)
}

/// Where a joint of the robot has its origin in the text.
struct Place {
    /// Behind its start tag.
    inside: usize,
    /// The tag of its origin and how that ends.
    origin: Option<(Range<usize>, &'static str)>,
}

/// Of every joint that is a child of `<robot>`, by name; others, such as those
/// of a transmission, are not meant.
fn places(document: &Document) -> Result<HashMap<String, Place>> {
    let fail =
        |e: &dyn std::fmt::Display| document.whole(format!("not XML: {e}"), "correct it there");
    let mut reader = Reader::from_str(&document.text);
    let mut places: HashMap<String, Place> = HashMap::new();
    let mut open: Vec<(Vec<u8>, String)> = Vec::new();
    loop {
        let start = reader.buffer_position() as usize;
        let event = reader.read_event().map_err(|e| fail(&e))?;
        let span = start..reader.buffer_position() as usize;
        match &event {
            Event::Start(tag) | Event::Empty(tag) => {
                let name = name_of(tag);
                let empty = matches!(event, Event::Empty(_));
                match open.as_slice() {
                    [_] if tag.name().as_ref() == b"joint" => {
                        let place = Place { inside: span.end, origin: None };
                        places.insert(name.clone(), place);
                    }
                    [_, (kind, joint)] if kind == b"joint" && tag.name().as_ref() == b"origin" => {
                        if let Some(place) = places.get_mut(joint) {
                            place.origin = Some((span, if empty { "/>" } else { ">" }));
                        }
                    }
                    _ => {}
                }
                if !empty {
                    open.push((tag.name().as_ref().to_vec(), name));
                }
            }
            Event::End(_) => drop(open.pop()),
            Event::Eof => return Ok(places),
            _ => {}
        }
    }
}

/// The attribute `name`; empty without it.
fn name_of(tag: &BytesStart) -> String {
    let name = tag.attributes().flatten().find(|a| a.key.as_ref() == b"name");
    name.and_then(|a| a.unescape_value().ok()).map(|v| v.into_owned()).unwrap_or_default()
}
