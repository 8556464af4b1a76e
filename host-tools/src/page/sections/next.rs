//! What to do next: poses to measure, commands to type.

use std::path::{Path, PathBuf};

use truearm::effects::MAX_TERMS;

use super::super::document::Section;
use super::{table, typed};
use crate::diagnose::{Alternative, Outcome, otherwise};
use crate::markup::{Node, element};

/// What the next command is about.
#[derive(Debug, Clone, Default)]
pub struct Next {
    /// robot.toml
    pub robot: PathBuf,
    /// measurements.csv, and what else was measured.
    pub data: Vec<PathBuf>,
    /// Folder of model.toml, if it was written.
    pub out: Option<PathBuf>,
    /// Terms of the arm that the model has.
    pub terms: usize,
    /// Poses that no fit saw are missed by more than with less of a model.
    pub worse: bool,
}

/// A path as a shell takes it for one word and no option.
fn word(path: &Path) -> String {
    let text = path.display().to_string();
    let text = if text.starts_with('-') { format!("./{text}") } else { text };
    let plain = |c: char| c.is_ascii_alphanumeric() || "_./-+=:@%,~".contains(c) || !c.is_ascii();
    match !text.is_empty() && text.chars().all(plain) {
        true => text,
        false => format!("'{}'", text.replace('\'', "'\\''")),
    }
}

/// The commands that follow, the next first, each with what it is for.
#[must_use]
pub fn commands(verb: &str, alternatives: &[Alternative], next: &Next) -> Vec<(String, String)> {
    let (robot, files) = (word(&next.robot), next.data.iter().map(|path| word(path)));
    let files: Vec<String> = files.collect();
    let data = files.join(" --data ");
    let mut out = Vec::new();
    // `plan` reads one file.
    if !alternatives.is_empty() && files.len() == 1 {
        out.push((
            "poses that tell the alternatives apart".to_owned(),
            format!("truearm plan {robot} --poses 6 --discriminate {data} --out poses.csv"),
        ));
    }
    if next.terms > MAX_TERMS {
        out.push((
            format!("a model that a controller has room for, {MAX_TERMS} terms"),
            format!("truearm {verb} {robot} {data} --most-terms {MAX_TERMS} --out out"),
        ));
        return out;
    }
    if next.worse {
        let first = files.first().map_or("", String::as_str);
        out.push((
            "wrong rows, if any, that make the model worse".to_owned(),
            format!("truearm check {robot} {first}"),
        ));
        return out;
    }
    let Some(folder) = &next.out else {
        out.push((
            "the model and this report as files".to_owned(),
            format!("truearm {verb} {robot} {data} --out out"),
        ));
        return out;
    };
    let model = word(&folder.join("model.toml"));
    out.push((
        "the blob that is flashed".to_owned(),
        format!("truearm pack {model} --out params.bin"),
    ));
    out.push((
        "poses to verify the flashed arm at".to_owned(),
        format!(
            "truearm verify {model} --test-poses verify.csv --apart-from {}",
            files.join(" --apart-from ")
        ),
    ));
    out
}

/// What follows when planned poses were measured and their points stand in the file of
/// the poses: with `data`, together with what was diagnosed before.
#[must_use]
pub fn after_measuring(robot: &Path, poses: &Path, data: Option<&Path>) -> String {
    let (robot, poses) = (word(robot), word(poses));
    match data {
        None => format!("truearm identify {robot} {poses} --out out"),
        Some(data) => format!("truearm diagnose {robot} {} --data {poses} --out out", word(data)),
    }
}

/// Poses to measure next, if explanations are to be told apart.
pub fn poses(outcome: &Outcome) -> Option<Section> {
    if outcome.alternatives.is_empty() {
        return None;
    }
    let mut section = Section::new("poses", "Poses to measure next").say(
        "The data leave more than one explanation. The poses below are those at which their \
         predictions are furthest apart, within the limits of the joints and beyond what was \
         measured as well; nothing is known here of the floor and the cell.",
    );
    let named = [outcome.effects.clone(), outcome.suspected.clone()].concat();
    for a in outcome.alternatives.iter().filter(|a| !a.is_told_by_poses()) {
        section = section.say(format!(
            "Worse by {:.1} in chi-square: {}. No pose tells them apart, but rows while the arm warms \
             up and while it cools down do.",
            a.worse_by,
            otherwise(a, &named)
        ));
    }
    for a in outcome.alternatives.iter().filter(|a| a.is_told_by_poses()) {
        let joints = a.separating_poses.first().map_or(0, |p| p.joints.len());
        let names: Vec<String> = (1..=joints).map(|j| format!("q{j}")).collect();
        let mut head: Vec<&str> = names.iter().map(String::as_str).collect();
        head.push("apart, mm");
        let rows = a.separating_poses.iter().map(|p| {
            let mut cells: Vec<String> = p.joints.iter().map(|q| format!("{q:.2}")).collect();
            cells.push(format!("{:.3}", p.difference_mm));
            cells
        });
        section = section
            .say(format!(
                "Worse by {:.1} in chi-square: {}. Joint values in degrees (mm where a joint \
                 slides):",
                a.worse_by,
                otherwise(a, &named)
            ))
            .node(table(&head, rows));
    }
    Some(section)
}

/// The commands as a section, behind what to do in a sentence.
pub fn steps(advice: Option<&str>, commands: &[(String, String)]) -> Section {
    let line = |(what, line): &(String, String)| -> [Node; 2] {
        let mut what = what.clone();
        what[..1].make_ascii_uppercase();
        [element("p").text(format!("{what}:")).into(), typed(std::slice::from_ref(line)).into()]
    };
    let section = Section::new("next", "What to do next");
    let section = advice.into_iter().fold(section, Section::say);
    commands.iter().flat_map(line).fold(section, Section::node)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_single_words() {
        assert_eq!(word(Path::new("out/model.toml")), "out/model.toml");
        assert_eq!(word(Path::new("my arm.toml")), "'my arm.toml'");
        assert_eq!(word(Path::new("it's")), "'it'\\''s'");
        assert_eq!(word(Path::new("-x.csv")), "./-x.csv");
        assert_eq!(word(Path::new("$(rm).csv")), "'$(rm).csv'");
    }
}
