//! A robot.toml to be written: of a URDF, a table or a data sheet.

use nalgebra::Vector3;
use truearm::JointKind;

use super::super::columns::USUAL_SIGMA_MM;
use super::super::comment::on_one_line;
use super::super::number;
use super::prior::prior_tables;
use crate::model::{Joint, LinkMass, Placement};
use crate::units::{joint_to_file, point_to_mm, to_mm};

/// What a robot.toml says, in SI units. Texts stand in it as remarks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RobotDraft {
    /// What it was made of, a line each.
    pub origin: Vec<String>,
    /// Model name.
    pub name: String,
    /// Gravity in the coordinates of the files, m/s^2.
    pub gravity: Option<Vector3<f64>>,
    /// The frame before joint 1 in the coordinates of the files.
    pub base: Placement,
    /// The target in the last frame.
    pub tool: Placement,
    /// The joints, each with its name where it was made; empty if it has none.
    pub joints: Vec<(String, Joint)>,
    /// Masses of the links, one a joint; empty if unknown.
    pub links: Vec<LinkMass>,
}

impl RobotDraft {
    /// The text of a robot.toml. Numbers are the shortest decimals within a few
    /// roundings of what they were made of.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text: String =
            self.origin.iter().map(|line| format!("# {}\n", on_one_line(line))).collect();
        text += &format!("name = {}\n", toml::Value::String(self.name.clone()));
        text += &format!(
            "# Standard deviation of a measured coordinate; say what your tracker has.\n\
             # measurement_sigma_mm = {USUAL_SIGMA_MM}\n"
        );
        if let Some(gravity) = &self.gravity {
            text += "# Of an arm that stands upright; it is another on a wall or a ceiling.\n";
            text += &format!("gravity_m_s2 = {}\n", vector((*gravity).into()));
        }
        for (name, placement) in [("base", &self.base), ("tool", &self.tool)] {
            if *placement != Placement::default() {
                text += &format!("\n[{name}]\n{}", frame(placement));
            }
        }
        for (name, link) in &self.joints {
            let remark =
                if name.is_empty() { String::new() } else { format!("  # {}", on_one_line(name)) };
            text += &format!("\n[[joints]]{remark}\n{}", joint(link));
        }
        for LinkMass { mass, com } in &self.links {
            text += &format!(
                "\n[[links]]\nmass_kg = {}\ncom_mm = {}\n",
                number(*mass),
                vector(point_to_mm(com))
            );
        }
        text
    }
}

fn vector(values: [f64; 3]) -> String {
    format!("[{}]", values.map(number).join(", "))
}

fn frame(placement: &Placement) -> String {
    let mut text = format!("xyz_mm = {}\n", vector(point_to_mm(&placement.xyz)));
    if placement.rpy != Vector3::zeros() {
        let rpy: [f64; 3] = placement.rpy.into();
        text += &format!("rpy_deg = {}\n", vector(rpy.map(f64::to_degrees)));
    }
    text
}

fn joint(joint: &Joint) -> String {
    let p = &joint.link.parameters;
    let kind = joint.link.kind;
    let (d, limits) = match kind {
        JointKind::Revolute => ("d_mm", "limits_deg"),
        JointKind::Prismatic => ("d_offset_mm", "limits_mm"),
    };
    let mut text = String::new();
    if kind == JointKind::Prismatic {
        text += "kind = \"prismatic\"\n";
    }
    text += &format!("alpha_deg = {}\n", number(p.alpha.to_degrees()));
    text += &format!("a_mm = {}\n", number(to_mm(p.a)));
    text += &format!("theta_offset_deg = {}\n", number(p.theta.to_degrees()));
    text += &format!("{d} = {}\n", number(to_mm(p.d)));
    if p.beta != 0.0 {
        text += &format!("beta_deg = {}\n", number(p.beta.to_degrees()));
    }
    if let Some(range) = joint.limits {
        let [low, high] = range.map(|limit| number(joint_to_file(kind, limit)));
        text += &format!("{limits} = [{low}, {high}]\n");
    }
    if let Some(ratio) = joint.gear_ratio {
        text += &format!("gear_ratio = {}\n", number(ratio));
    }
    for (key, table) in prior_tables(joint).iter().filter(|(_, table)| !table.is_empty()) {
        let entries: Vec<String> =
            table.iter().map(|(key, value)| format!("{key} = {}", number(*value))).collect();
        text += &format!("{key} = {{ {} }}\n", entries.join(", "));
    }
    text
}
