//! How many measurements are planned.

use super::design::Design;
use super::{Imagined, PlanOptions, kinds, name};
use crate::error::{Error, ErrorKind, Result};
use crate::identify::{Problem, fewest};
use crate::model::KindId;

/// The fewest measurements that determine what their kind can, and that `identify` takes.
pub fn least(design: &Design, imagined: &Imagined, problem: &Problem) -> usize {
    let determined = design.parameters().div_ceil(design.width());
    determined.max(fewest(problem.unknowns.list().len(), imagined.fewest_equations(), 1))
}

/// How many are tried first: all, or the fewest that may reach the target.
///
/// # Errors
/// Fewer than the least.
pub fn first(
    design: &Design,
    (imagined, problem): (&Imagined, &Problem),
    options: &PlanOptions,
    sigma: f64,
) -> Result<usize> {
    let least = least(design, imagined, problem);
    if options.poses < least {
        let equations = imagined.fewest_equations() * options.poses;
        let unknowns = problem.unknowns.list().len();
        let (poses, plural) = (options.poses, kinds::plural(name(options.kind)));
        let what = match equations < unknowns {
            true => format!("{unknowns} unknowns of `truearm identify`"),
            false => format!("{} parameters that they can determine", design.parameters()),
        };
        let equations = equations.min(design.width() * poses);
        return Err(Error::data(
            ErrorKind::TooFewEquations,
            format!("{poses} {plural} give {equations} equations for {what}"),
            format!("plan at least {least} {plural}, better {}", 2 * least),
        ));
    }
    Ok(match options.target {
        // The prior may beat the bound by a little.
        Some(target) => {
            // More than points may need far fewer.
            let of_points = 0.9 * design.parameters() as f64 * (sigma / target).powi(2);
            let is_point = options.kind == KindId::default();
            let fewest = if is_point { of_points } else { 0.0 };
            (fewest as usize).clamp(least, options.poses)
        }
        None => options.poses,
    })
}
