//! Values that are numbers and make no plausible: refused by name.

use nalgebra::Vector3;
use toml::Spanned;
use truearm::JointKind;

use super::check::Checker;
use super::keys::{LinkFile, RobotFile};
use crate::error::Result;
use crate::files::numbers::Numbers;
use crate::model::{Joint, LinkMass};
use crate::units::{point_from_mm, to_mm};

/// Limits in radians are within a turn and a bit.
const TURN: f64 = 6.4;
/// No arm is as small, m: desktop arms have 0.2 m, cranes in metres 30 mm.
const TINY: f64 = 0.03;

impl Checker<'_> {
    /// A point in mm, to m.
    pub fn centre(&self, key: &str, value: &Spanned<Numbers<3>>) -> Result<Vector3<f64>> {
        self.finite(value.span(), key, &**value.get_ref())?;
        if let Some(x) = value.get_ref().iter().find(|x| x.abs() > 10_000.0) {
            let help = "lengths are mm, up to 10 m";
            return Err(self.source.at(value.span(), format!("{key} has {x}"), help));
        }
        Ok(point_from_mm(**value.get_ref()))
    }

    pub fn link(&self, link: &LinkFile) -> Result<LinkMass> {
        let mass = *link.mass_kg.get_ref();
        if !self.plausible.mass.contains(&mass) {
            let help =
                "give the mass of the link in kg, or leave [[links]] out if masses are unknown";
            return Err(self.source.at(link.mass_kg.span(), format!("mass_kg = {mass}"), help));
        }
        Ok(LinkMass { mass, com: self.centre("com_mm", &link.com_mm)? })
    }

    pub fn gear_ratio(&self, ratio: &Spanned<f64>) -> Result<f64> {
        let value = *ratio.get_ref();
        if value > 0.0 && value <= 1e5 {
            return Ok(value);
        }
        let help = "give the turns of the motor for one of the joint, such as 101; its sense does \
                    not matter; leave it out if it is unknown";
        Err(self.source.at(ratio.span(), format!("gear_ratio = {value}"), help))
    }

    /// m/s^2, in the coordinates of the file.
    pub fn gravity(&self, gravity: &Spanned<Numbers<3>>) -> Result<Vector3<f64>> {
        let g = Vector3::from(**gravity.get_ref());
        self.finite(gravity.span(), "gravity_m_s2", &**gravity.get_ref())?;
        if self.plausible.gravity.contains(&g.norm()) {
            return Ok(g);
        }
        let message = format!("gravity_m_s2 of {:.3} m/s^2", g.norm());
        let help = "Earth's is 9.81: give its direction times that, such as [0.0, 0.0, -9.81], or \
                    leave it out if it is unknown";
        Err(self.source.at(gravity.span(), message, help))
    }

    /// Degrees Celsius.
    pub fn temperature(&self, temperature: &Spanned<f64>) -> Result<f64> {
        let value = *temperature.get_ref();
        if self.plausible.temperature.contains(&value) {
            return Ok(value);
        }
        let help = if (200.0..400.0).contains(&value) {
            format!("degrees Celsius are expected; {value} K are {:.2}", value - 273.15)
        } else {
            "give degrees Celsius, such as 20".to_owned()
        };
        Err(self.source.at(temperature.span(), format!("reference_temperature_c = {value}"), help))
    }

    /// An arm whose lengths together are a few millimetres is one in metres.
    pub fn lengths_in_metres(&mut self, joints: &[Joint]) {
        let all = joints.iter().map(|j| j.link.parameters.a.abs() + j.link.parameters.d.abs());
        let sum: f64 = all.sum();
        if sum > 0.0 && sum < TINY {
            self.warn(format!(
                "all a_mm and d_mm together are {:.3} mm: are they metres? Lengths are mm",
                to_mm(sum)
            ));
        }
    }

    /// Limits within a turn of zero in all joints at once are radians.
    pub fn limits_in_radians(&self, file: &RobotFile, joints: &[Joint]) -> Result<()> {
        let turning =
            file.joints.iter().zip(joints).filter(|(_, j)| j.link.kind == JointKind::Revolute);
        let limits: Vec<_> = turning.filter_map(|(j, _)| j.get_ref().limits_deg.as_ref()).collect();
        let small = limits.iter().all(|l| l.get_ref().iter().all(|x| x.abs() <= TURN));
        let moves = limits.iter().find(|l| l.get_ref()[0] < l.get_ref()[1]);
        match moves {
            Some(first) if self.plausible.limits && limits.len() > 1 && small => {
                let [low, high] = **first.get_ref();
                let message =
                    format!("limits_deg = [{low}, {high}]: the limits of all joints are radians");
                let [low, high] = [low, high].map(f64::to_degrees);
                let help = format!("give degrees: [{low:.1}, {high:.1}]");
                Err(self.source.at(first.span(), message, help))
            }
            _ => Ok(()),
        }
    }
}
