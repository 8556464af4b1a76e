//! Whether the data say how large the arm is. Known planes that share a point, one known
//! point: an arm twice as large about that point touches the same, and only the equations
//! tell which lengths hold it.

use nalgebra::{DMatrix, DVector};
use truearm::JointKind;

use crate::identify::problem::accumulate::{CHUNK, tree};
use crate::identify::problem::{Problem, Scaling, State, Unknown};
use crate::observations::{equations_of, kind};
use crate::tikhonov::{Factorised, Triangle};

/// What is said of a file that holds no length against the arm.
pub const SCALE_OPEN: &str = "the overall scale: all lengths of the arm, and of where what it touches \
                              stands, times one number move no measured value; a plate of known \
                              coordinates, or one known length, closes it (known planes do only where \
                              they share no point, one known point does not)";

/// Sine of a twist below which two axes are parallel as drawn.
const PARALLEL: f64 = 1e-6;

/// Whether a file leaves the overall scale open: all lengths of the arm times one number,
/// with frames and instruments free to follow, change what is measured by less than the
/// tolerances of these lengths count. Nothing but the tolerances then holds it.
#[must_use]
pub fn is_open(problem: &Problem, near: &State) -> bool {
    let data = problem.data;
    if data.rows.iter().all(|row| kind(row).point(row).is_some()) {
        return false;
    }
    let problem = Problem { scaling: Scaling::Prior, ..problem.with_terms(0) };
    let state = State { links: problem.nominal.clone(), terms: Vec::new(), ..near.clone() };
    let lengths = lengths(&problem);
    told(&problem, &state, &lengths) < lengths.norm()
}

/// The lengths of the drawing in units of the link parameters. Where all axes are parallel
/// those across them: those along them move the base, and a slide measures along them.
fn lengths(problem: &Problem) -> DVector<f64> {
    let across = problem.nominal.iter().skip(1).any(|link| {
        let p = &link.parameters;
        p.alpha.sin().hypot(p.beta.sin()) > PARALLEL
    });
    let slides = problem.nominal.iter().any(|link| link.kind == JointKind::Prismatic);
    let links = problem.unknowns.list().iter().skip(problem.unknowns.free());
    let length = |unknown: &Unknown| match unknown {
        Unknown::Link(i, parameter) if parameter.is_length() => {
            let along = *parameter == truearm::LinkParameter::D;
            let value = problem.nominal[*i].parameters.to_array()[*parameter as usize];
            if along && slides && !across { 0.0 } else { value / problem.unit(*unknown) }
        }
        _ => 0.0,
    };
    DVector::from_vec(links.map(length).collect())
}

/// By how many standard deviations the equations change with these lengths, for the whole
/// of them, when frames and instruments have followed as far as they can. Infinity where
/// no reading has a length in it, as of an inclinometer: every length is then open, and
/// one known closes none of the others.
fn told(problem: &Problem, state: &State, lengths: &DVector<f64>) -> f64 {
    let (data, free) = (problem.data, problem.unknowns.free());
    let at = problem.linearise(state);
    let leaf = |rows: &[usize]| {
        let all = at.rows(rows, None);
        let (a, b) = (all.columns(0, all.ncols() - 1), all.column(all.ncols() - 1));
        let residual = b - a * at.corrections();
        let mut scaled = a.columns(free, lengths.len()) * lengths;
        let mut first = 0;
        for row in rows.iter().map(|row| &data.rows[*row]) {
            let count = equations_of(row);
            // What is held against nothing measured is a length itself: times a number, it
            // is off by that number of what it is off already.
            if row.measured.is_empty() {
                let mut own = scaled.rows_mut(first, count);
                own += residual.rows(first, count);
            }
            first += count;
        }
        let mut out = DMatrix::zeros(all.nrows(), free + 1);
        out.columns_mut(0, free).copy_from(&a.columns(0, free));
        out.column_mut(free).copy_from(&scaled);
        Triangle::new(&out)
    };
    let join = |a: Triangle, b: Triangle| Triangle::join([&a, &b].into_iter());
    let triangle = tree(&problem.counted(), CHUNK.max(2 * free + 2), &leaf, &join);
    if triangle.residual_square(&DVector::zeros(free)) == 0.0 {
        return f64::INFINITY;
    }
    Factorised::new(&triangle, free).residual_square(0.0).sqrt()
}
