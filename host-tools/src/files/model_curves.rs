//! The curves of a model.toml: `[[curves]]`.

use serde::{Deserialize, Serialize};
use truearm::JointKind;

use crate::model::ErrorCurve;

/// A smooth error of a joint's angle over a turn.
#[derive(Serialize, Deserialize)]
pub(super) struct CurveFile {
    /// Counted from 1.
    joint: usize,
    /// One standard deviation.
    band_rad: f64,
    /// What the nodes are whole multiples of, where they come from a table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    step_rad: Option<f32>,
    /// Coefficients of a periodic cubic B-spline, the first at angle 0.
    nodes_rad: Vec<f64>,
}

pub(super) fn to_file(curves: &[ErrorCurve]) -> Vec<CurveFile> {
    let mut sorted: Vec<&ErrorCurve> = curves.iter().collect();
    sorted.sort_by_key(|curve| curve.joint());
    let file = |curve: &&ErrorCurve| CurveFile {
        joint: usize::from(curve.joint()) + 1,
        band_rad: curve.band(),
        step_rad: Some(curve.step()),
        nodes_rad: curve.nodes().collect(),
    };
    sorted.iter().map(file).collect()
}

/// Reads a curve beside those `before` it; what is wrong with it, in words.
pub(super) fn curve(
    file: &CurveFile,
    kinds: &[JointKind],
    before: &[ErrorCurve],
) -> Result<ErrorCurve, String> {
    let place = file.joint.checked_sub(1).filter(|place| *place < kinds.len());
    let place = place
        .ok_or_else(|| format!("joint {} where joints are 1 to {}", file.joint, kinds.len()))?;
    if kinds[place] != JointKind::Revolute {
        return Err(format!("joint {} slides: it has no turn to err over", file.joint));
    }
    if before.iter().any(|other| usize::from(other.joint()) == place) {
        return Err(format!("a second curve of joint {}", file.joint));
    }
    match file.step_rad {
        Some(step) => ErrorCurve::with_step(place as u8, &file.nodes_rad, step, file.band_rad),
        None => ErrorCurve::new(place as u8, &file.nodes_rad, file.band_rad),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [JointKind; 3] = [JointKind::Revolute, JointKind::Prismatic, JointKind::Revolute];

    #[derive(Serialize, Deserialize)]
    struct File {
        curves: Vec<CurveFile>,
    }

    fn some(joint: u8, nodes: usize) -> ErrorCurve {
        let f = |q: f64| 2e-4 * (3.0 * q + f64::from(joint)).sin() + 1e-4 * q.cos();
        ErrorCurve::of_function(joint, nodes, 1.5e-5, f).unwrap().0
    }

    fn read(text: &str) -> Result<Vec<ErrorCurve>, String> {
        let file: File = toml::from_str(text).unwrap();
        let mut curves = Vec::new();
        for entry in &file.curves {
            curves.push(curve(entry, &KINDS, &curves)?);
        }
        Ok(curves)
    }

    #[test]
    fn what_is_written_is_read() {
        let curves = [some(2, 256), some(0, 32)];
        let text = toml::to_string(&File { curves: to_file(&curves) }).unwrap();
        let [second, first] = curves;
        assert_eq!(read(&text), Ok(vec![first, second]));
        assert!(text.contains("band_rad = 0.000015") && text.contains("step_rad = "), "{text}");
    }

    #[test]
    fn nonsense_is_named() {
        let zeros = |count: usize| "0.0, ".repeat(count);
        let entry = |joint: i32, more: &str, nodes: &str| {
            format!("[[curves]]\njoint = {joint}\nband_rad = 1e-5\n{more}nodes_rad = [{nodes}]\n")
        };
        let good = entry(1, "", &zeros(32));
        assert_eq!(read(&good).unwrap().len(), 1);
        for (text, words) in [
            (entry(0, "", &zeros(32)), "joint 0 where joints are 1 to 3"),
            (entry(4, "", &zeros(32)), "joint 4"),
            (entry(2, "", &zeros(32)), "joint 2 slides"),
            (good.clone() + &good, "a second curve of joint 1"),
            (entry(1, "", &zeros(33)), "33 nodes"),
            (entry(1, "", &("nan, ".to_owned() + &zeros(31))), "node 1 is not finite"),
            (entry(1, "step_rad = 1e-9\n", &("1e-3, ".to_owned() + &zeros(31))), "32767 steps"),
        ] {
            let message = read(&text).unwrap_err();
            assert!(message.contains(words), "{words} in {message}");
        }
    }
}
