use quick_xml::escape::escape;
use truearm::{JointKind, Pose};

use crate::convert::Identified;
use crate::convert::frames::about_y;
use crate::model::{Model, Placement};

/// The identified geometry as a URDF without its first line: links `base_link`,
/// `link_1` to `link_N` and `target`, every joint about or along its z. The base
/// link is the frame that all coordinates of truearm's files are in.
#[must_use]
pub fn urdf_text(model: &Model, arm: &Identified) -> String {
    let robot = &model.robot;
    let mut text = format!(
        "<!-- Identified geometry, m and rad. Speeds, efforts and inertia tensors are not known\n     \
         to truearm: zeros stand in their place. -->\n<robot name=\"{}\">\n  \
         <link name=\"base_link\"/>\n",
        escape(&robot.name)
    );
    for (i, (step, joint)) in arm.steps().iter().zip(&robot.joints).enumerate() {
        let n = i + 1;
        let parent = if i == 0 { "base_link".to_owned() } else { format!("link_{i}") };
        let (kind, limit) = match (joint.link.kind, joint.limits) {
            (JointKind::Revolute, None) => ("continuous", String::new()),
            (kind, limits) => {
                let [low, high] = limits.unwrap_or([-10.0, 10.0]);
                let name = if kind == JointKind::Revolute { "revolute" } else { "prismatic" };
                let limit = format!(
                    "<limit lower=\"{low:?}\" upper=\"{high:?}\" effort=\"0\" velocity=\"0\"/>"
                );
                (name, format!("    {limit}\n"))
            }
        };
        text += &format!(
            "  <joint name=\"joint_{n}\" type=\"{kind}\">\n    {}\n    <parent link=\"{parent}\"/>\n    \
             <child link=\"link_{n}\"/>\n    <axis xyz=\"0 0 1\"/>\n{limit}  </joint>\n",
            origin_tag(step, "/>")
        );
        text += &link(model, arm, i);
    }
    text += &target(&format!("link_{}", robot.joints.len()), "target", &arm.tip());
    text + "</robot>\n"
}

/// A link, with its mass where it is known. Its frame is the one of the MD-H
/// link without beta.
fn link(model: &Model, arm: &Identified, i: usize) -> String {
    let name = format!("link_{}", i + 1);
    let Some(body) = model.robot.links.get(i) else {
        return format!("  <link name=\"{name}\"/>\n");
    };
    let com = about_y(arm.links[i].parameters.beta).transform_point(&body.com);
    let at = Pose { translation: com, ..Pose::identity() };
    format!(
        "  <link name=\"{name}\">\n    <inertial>\n      {}\n      <mass value=\"{:?}\"/>\n      \
         <inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/>\n    </inertial>\n  </link>\n",
        origin_tag(&at, "/>"),
        body.mass
    )
}

/// A link fixed to another.
pub(super) fn target(parent: &str, name: &str, at: &Pose<f64>) -> String {
    format!(
        "  <link name=\"{name}\"/>\n  <joint name=\"{name}_joint\" type=\"fixed\">\n    {}\n    \
         <parent link=\"{}\"/>\n    <child link=\"{name}\"/>\n  </joint>\n",
        origin_tag(at, "/>"),
        escape(parent)
    )
}

/// `<origin .../>`, or with another end of the tag.
pub(super) fn origin_tag(pose: &Pose<f64>, end: &str) -> String {
    let Placement { xyz, rpy } = Placement::of(pose);
    let three = |[x, y, z]: [f64; 3]| format!("{:?} {:?} {:?}", x + 0.0, y + 0.0, z + 0.0);
    format!("<origin xyz=\"{}\" rpy=\"{}\"{end}", three(xyz.into()), three(rpy.into()))
}
