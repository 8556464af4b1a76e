//! What the controller does about an alarm of its drift watch: finds which
//! groups of parameters moved, and identifies these anew.
//!
//! The watch names one group, the one that explains most by itself; a crash may
//! have moved two joints. So the ten points decide: from the group that the
//! watch suspects on, the set of groups is changed by the one that comes, goes
//! or takes another's place and lowers
//!
//! `|residuals|^2 / sigma^2 + 16 * degrees of freedom`
//!
//! most, until none does. Every set is fitted whole: parameters of groups outside
//! of it are held by a prior of a nanometre. The price of a degree of freedom is
//! what the evidence makes it cost, `2 ln(prior sigma / posterior sigma)`: by the
//! usual prior the tool may have moved by 20 mm, and ten points tell it to
//! 0.007 mm.

use truearm::check_point::CheckPoint;
use truearm::drift::Group;
use truearm::parameters::Parameter;
use truearm::reidentify::{Reidentified, Reidentify, ReidentifyError};
use truearm::{ArmParameters, Scalar};

/// Joints of the arm.
pub const JOINTS: usize = 6;
/// Points to be taken after an alarm.
pub const POINTS: usize = 10;

/// Parameters of all groups.
const PARAMETERS: usize = JOINTS + 3 + 6;
/// Of a degree of freedom.
const PRICE: f32 = 16.0;
/// Prior of what is not in the set, rad or m.
const HELD: f32 = 1e-9;

/// Everything that may move together.
pub const GROUPS: [Group; JOINTS + 2] = [
    Group::JointOffset(0),
    Group::JointOffset(1),
    Group::JointOffset(2),
    Group::JointOffset(3),
    Group::JointOffset(4),
    Group::JointOffset(5),
    Group::Tool,
    Group::Base,
];

/// Of each of [`GROUPS`], whether it moved.
pub type Moved = [bool; JOINTS + 2];

/// A point.
pub type Point = CheckPoint<f32, JOINTS>;

type Found<'t> = Reidentified<'t, f32, JOINTS, PARAMETERS>;

/// What is to be stored.
#[derive(Debug, Clone)]
pub struct Mended<'t> {
    /// The new parameters.
    pub parameters: ArmParameters<'t, f32, JOINTS>,
    /// What was identified anew.
    pub moved: Moved,
}

/// From the suspect of the watch and ten points to new parameters; `sigma` is
/// that of the watch, m.
///
/// # Errors
/// As for [`Reidentify::run`]; [`ReidentifyError::Inconsistent`] where no set of groups explains
/// the points.
pub fn mend<'t>(
    stored: &ArmParameters<'t, f32, JOINTS>,
    suspect: Option<Group>,
    points: &[Point; POINTS],
    sigma: f32,
) -> Result<Mended<'t>, ReidentifyError> {
    let fitted = |moved: &Moved| fit(stored, moved, points, sigma);
    let mut moved = GROUPS.map(|group| suspect == Some(group));
    let (mut found, mut cost, mut degrees) = fitted(&moved)?;
    loop {
        let mut best = None;
        for other in neighbours(&moved) {
            // Groups that the points do not tell apart may not settle together.
            let Ok((fit, price, degrees)) = fitted(&other) else { continue };
            if price < cost {
                cost = price;
                best = Some((other, fit, degrees));
            }
        }
        match best {
            Some(better) => (moved, found, degrees) = better,
            None => break,
        }
    }
    // The best may be as wrong as one of the points.
    let mut parameters = found.judged()?.parameters;
    // What points will scatter by from here on, which the watch counts with: as before, and
    // at other poses the new parameters add their own uncertainty, on average so much.
    let equations = 3.0 * POINTS as f32;
    parameters.rms_after = stored.rms_after * Scalar::sqrt(1.0 + degrees / equations);
    Ok(Mended { parameters, moved })
}

/// One group more, one less, or one for another.
fn neighbours(moved: &Moved) -> impl Iterator<Item = Moved> {
    let pairs = (0..GROUPS.len()).flat_map(|first| (first..GROUPS.len()).map(move |k| (first, k)));
    pairs.filter_map(|(first, second)| {
        let mut other = *moved;
        for (k, flag) in other.iter_mut().enumerate() {
            *flag ^= k == first || k == second;
        }
        let count = |moved: &Moved| moved.iter().filter(|moved| **moved).count();
        (first == second || count(&other) == count(moved)).then_some(other)
    })
}

/// With these groups identified anew; what is to be low, and degrees of freedom.
fn fit<'t>(
    stored: &ArmParameters<'t, f32, JOINTS>,
    moved: &Moved,
    points: &[Point; POINTS],
    sigma: f32,
) -> Result<(Found<'t>, f32, f32), ReidentifyError> {
    let mut all = Reidentify::new(stored, core::array::from_fn(parameter), sigma);
    let mut degrees = 0.0;
    for (k, scale) in all.scale.iter_mut().enumerate() {
        // Six offsets, three of the tool, six of the base.
        let group = if k < JOINTS { k } else { JOINTS + usize::from(k >= JOINTS + 3) };
        if moved.get(group) == Some(&true) {
            degrees += 1.0;
        } else {
            *scale = HELD;
        }
    }
    let all: Reidentify<f32, PARAMETERS> = all;
    // Sets that leave the cause out contradict the points, and are compared by how much.
    let found = all.fit(stored, points)?;
    let cost = found.misfit.chi_square + PRICE * degrees;
    Ok((found, cost, degrees))
}

/// All that may have moved, in the order of [`GROUPS`].
fn parameter(index: usize) -> Parameter {
    let frames = Parameter::TOOL.iter().chain(&Parameter::BASE);
    let frame = index.checked_sub(JOINTS).and_then(|k| frames.copied().nth(k));
    frame.unwrap_or(Parameter::JointOffset(index as u8))
}
