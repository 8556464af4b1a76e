//! Counterparts of Figures 4 to 14, and three that the paper does not have.

mod seeds;
mod shown;

use super::example::Example;
use super::section_v::NinePoses;
use super::study::Study;

/// File names and SVG texts.
pub fn all(study: &Study, example: &Example, nine: &NinePoses) -> Vec<(String, String)> {
    let mut out = vec![("table-5.svg".to_owned(), shown::nine_poses(nine))];
    let own = [
        ("figure-04-frames", shown::frames(example)),
        ("figure-05-registered", shown::registered(example)),
        ("figure-06-error-per-pose", shown::before(example)),
        ("figure-07-l-curve", shown::l_curve(example)),
        ("figure-08-simulated-points", shown::simulated(example)),
        ("figure-09-error-against-lambda", shown::against_lambda(example)),
        ("figure-10-error-per-point-and-lambda", shown::per_point(example)),
        ("figure-11-methods-52-points", shown::methods(&example.held, false)),
        ("figure-12-validation-points", shown::validation(example)),
        ("figure-13-errors-per-axis", shown::axes(example)),
        ("figure-14-methods-18-points", shown::methods(&example.held, true)),
        ("figure-15-seeds", seeds::seeds(study)),
        ("figure-16-number-of-poses", seeds::sweep(study)),
        ("figure-17-cramer-rao", seeds::efficiency(study)),
    ];
    out.extend(own.into_iter().map(|(name, text)| (format!("{name}.svg"), text)));
    out
}
