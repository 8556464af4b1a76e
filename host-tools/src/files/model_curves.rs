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
    /// One standard deviation where it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gap_band_rad: Option<f64>,
    /// Where it is not known: from one node to another.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    gaps_deg: Vec<[f64; 2]>,
    /// Coefficients of a periodic cubic B-spline, the first at angle 0.
    nodes_rad: Vec<f64>,
}

/// A gap's end is at a node if it is as near to it, in nodes.
const AT_NODE: f64 = 1e-6;

pub(super) fn to_file(curves: &[ErrorCurve]) -> Vec<CurveFile> {
    let mut sorted: Vec<&ErrorCurve> = curves.iter().collect();
    sorted.sort_by_key(|curve| curve.joint());
    let file = |curve: &&ErrorCurve| CurveFile {
        joint: usize::from(curve.joint()) + 1,
        band_rad: curve.band(),
        step_rad: Some(curve.step()),
        gap_band_rad: curve.gap_band(),
        gaps_deg: curve.gap_ranges().iter().map(|range| range.map(degrees)).collect(),
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
    let curve = match file.step_rad {
        Some(step) => ErrorCurve::with_step(place as u8, &file.nodes_rad, step, file.band_rad),
        None => ErrorCurve::new(place as u8, &file.nodes_rad, file.band_rad),
    }?;
    match (file.gap_band_rad, &file.gaps_deg[..]) {
        (None, []) => Ok(curve),
        (Some(band), gaps @ [_, ..]) => {
            curve.with_gaps(band, &stretches(gaps, file.nodes_rad.len())?)
        }
        _ => Err("gap_band_rad and gaps_deg belong together".to_owned()),
    }
}

/// Ends of gaps are whole numbers of nodes: no more digits than they have.
fn degrees(angle: f64) -> f64 {
    (angle.to_degrees() * 1e9).round() / 1e9
}

/// Stretches between so many nodes that lie in these gaps, degrees.
fn stretches(gaps: &[[f64; 2]], nodes: usize) -> Result<Vec<usize>, String> {
    let mut out = Vec::new();
    for [low, high] in gaps {
        let [from, to] = [low, high].map(|angle| angle / 360.0 * nodes as f64);
        let at_node = |x: f64| (x - x.round()).abs() < AT_NODE;
        if !(at_node(from) && at_node(to) && 0.0 <= from.round() && from < to)
            || to.round() > nodes as f64
        {
            return Err(format!(
                "gaps_deg [{low}, {high}]: from node to node, {} degrees apart, of 0 to 360",
                360.0 / nodes as f64
            ));
        }
        out.extend(from.round() as usize..to.round() as usize);
    }
    Ok(out)
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
    fn gaps_are_written_in_degrees_and_read() {
        for nodes in [32, 256, 512] {
            let stretches = [0, 1, 5, nodes / 2, nodes - 1];
            let gapped = some(0, nodes).with_gaps(3e-4, &stretches).unwrap();
            let text = toml::to_string(&File { curves: to_file(std::slice::from_ref(&gapped)) });
            let text = text.unwrap();
            assert_eq!(read(&text), Ok(vec![gapped]), "{text}");
            assert!(text.contains("gap_band_rad = 0.0003\n"), "{text}");
        }
        let whole = toml::to_string(&File { curves: to_file(&[some(0, 32)]) }).unwrap();
        assert!(!whole.contains("gap"), "{whole}");
        let with = |more: &str| {
            read(&whole.replace("joint = 1\n", &format!("joint = 1\n{more}\n"))).unwrap_err()
        };
        assert!(with("gap_band_rad = 1e-4").contains("belong together"));
        assert!(with("gaps_deg = [[0.0, 11.25]]").contains("belong together"));
        for bad in [
            "[[1.0, 11.25]]",
            "[[-11.25, 0.0]]",
            "[[11.25, 0.0]]",
            "[[0.0, 371.25]]",
            "[[0.0, nan]]",
        ] {
            let message = with(&format!("gap_band_rad = 1e-4\ngaps_deg = {bad}"));
            assert!(message.contains("11.25 degrees apart"), "{bad}: {message}");
        }
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
