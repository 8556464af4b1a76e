use nalgebra::Vector3;
use truearm::Pose;
use urdf_rs::JointType;

use super::{Document, Serial, origin};
use crate::model::LinkMass;

/// The masses that hang on each joint of a chain, with all that is fixed to
/// them, each in the frame given of it. Empty where no mass is stated.
///
/// What hangs on moving joints beside the chain, such as fingers, is not
/// counted; their names are the second result.
pub(super) fn bodies(
    document: &Document,
    chain: &Serial,
    frames: &[Pose<f64>],
) -> (Vec<LinkMass>, Vec<String>) {
    let mut sums = vec![(0.0, Vector3::zeros()); chain.joints.len()];
    let mut beside = Vec::new();
    for (i, joint) in chain.joints.iter().enumerate() {
        let mut rigid = vec![(joint.child.as_str(), joint.frame)];
        while let Some((link, pose)) = rigid.pop() {
            let (mass, moment) = &mut sums[i];
            if let Some((m, com)) = mass_of(document, link, &pose) {
                *mass += m;
                *moment += com * m;
            }
            for below in document.robot.joints.iter().filter(|j| j.parent.link == link) {
                if below.joint_type == JointType::Fixed {
                    rigid.push((&below.child.link, pose.compose(&origin(&below.origin))));
                } else if !chain.joints.iter().any(|j| j.name == below.name) {
                    beside.push(below.name.clone());
                }
            }
        }
    }
    if sums.iter().all(|(mass, _)| *mass == 0.0) {
        return (Vec::new(), Vec::new());
    }
    // A picometre is the rounding of the way there.
    let plain = |x: f64| (x * 1e12).round() / 1e12;
    let link = |((mass, moment), frame): (&(f64, Vector3<f64>), &Pose<f64>)| LinkMass {
        mass: *mass,
        com: if *mass > 0.0 {
            frame.inverse().transform_point(&(moment / *mass)).map(plain)
        } else {
            Vector3::zeros()
        },
    };
    (sums.iter().zip(frames).map(link).collect(), beside)
}

/// Mass and centre of mass in the base.
fn mass_of(document: &Document, link: &str, pose: &Pose<f64>) -> Option<(f64, Vector3<f64>)> {
    let inertial = &document.robot.links.iter().find(|l| l.name == link)?.inertial;
    let com = Vector3::from(*inertial.origin.xyz);
    let mass = inertial.mass.value;
    let known = mass > 0.0 && mass.is_finite() && com.iter().all(|x| x.is_finite());
    known.then(|| (mass, pose.transform_point(&com)))
}
