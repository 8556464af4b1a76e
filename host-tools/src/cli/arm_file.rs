use truearm_host::error::count;
use truearm_host::model::{Model, Path, Robot};
use truearm_host::units::joint_from_file;
use truearm_host::{Error, Result};

/// What is said where the configuration was chosen for the user.
pub const CHOSEN: &str = "the configuration of the first row was chosen: the one found that keeps most rows \
                          within the joint ranges of the identification, of a nominal arm the nearest \
                          to mid-range. Give the joints to begin at with --start";

/// What is said of rows that a robot does not come to without changing its
/// configuration; nothing where there are none.
pub fn jumps(path: &Path, rows: &[usize]) -> Option<String> {
    let first = path.data.rows.get(*rows.first()?)?.line;
    Some(format!(
        "{}: {} in another configuration than the row before, first in line {first}: give --start, \
         or mend the path",
        path.data.path.display(),
        count(rows.len(), "row"),
    ))
}

/// Joint values of an option, degrees or mm, within the limits: rad or m.
pub fn start(text: &str, model: &Model) -> Result<Vec<f64>> {
    let Robot { joints, .. } = &model.robot;
    let cells: Vec<Option<f64>> =
        text.split(',').map(|c| c.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    let given: Option<Vec<f64>> = cells.into_iter().collect();
    let given = given.filter(|given| given.len() == joints.len()).ok_or_else(|| {
        Error::usage(
            format!("--start {text}"),
            format!(
                "give {} joint values separated by commas, degrees (mm for prismatic joints)",
                joints.len()
            ),
        )
    })?;
    let values = given.iter().zip(joints).enumerate().map(|(j, (value, joint))| {
        let q = joint_from_file(joint.link.kind, *value);
        match joint.limits {
            Some([low, high]) if q < low || q > high => Err(Error::usage(
                format!("--start {text}: joint {} is outside its limits", j + 1),
                "give where the robot stands before its first row",
            )),
            _ => Ok(q),
        }
    });
    values.collect()
}
