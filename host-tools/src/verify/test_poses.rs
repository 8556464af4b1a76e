use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::error::{Error, ErrorKind, Result};
use crate::model::near::Reach;
use crate::model::{Measurements, Model, Workspace};

/// Poses are apart when a joint differs by more than this, rad (5 degrees).
const APART_ANGLE: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// The same for a prismatic joint, m.
const APART_LENGTH: f64 = 0.05;

/// Random poses of a workspace to verify at (the test poses of ISO 9283), none of them near one of `used`.
///
/// # Errors
/// As for [`Workspace::sample`], or where the used poses leave no room.
pub fn test_poses(
    model: &Model,
    workspace: &Workspace,
    used: Option<&Measurements>,
    count: usize,
    seed: u64,
) -> Result<Vec<Vec<f64>>> {
    let robot = &model.robot;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let reach = Reach::of_joints(robot, APART_ANGLE, APART_LENGTH);
    let mut out: Vec<Vec<f64>> = Vec::new();
    for _ in 0..100 {
        for q in workspace.sample(robot, count, &mut rng)? {
            let taken = used.is_some_and(|data| data.rows.iter().any(|r| reach.near(&r.q, &q)));
            if out.len() < count && !taken {
                out.push(q);
            }
        }
        if out.len() == count {
            return Ok(out);
        }
    }
    Err(Error::data(
        ErrorKind::NoPoses,
        format!(
            "only {} of {count} test poses are apart from those of the identification",
            out.len()
        ),
        "widen the workspace, or ask for fewer poses",
    ))
}
