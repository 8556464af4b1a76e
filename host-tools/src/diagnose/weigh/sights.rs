//! Where an instrument stands whose line of sight may scatter, in its angles or in its distance, as
//! trackers and cameras do: at the origin of the coordinates, or, where those are the robot's, as
//! programs of trackers are often told to write them, somewhere around it.

use nalgebra::Vector3;

use crate::evidence::directed::{self, Seen};
use crate::identify::{Place, Problem, Scatterer, State};
use crate::model::Row;
use crate::observations::kind;
use crate::statistics::median;

/// Distance of an origin from the base, as a share of that of targets. No study set it.
const APART: f64 = 0.5;
/// Distances from the base that are tried, in those of the farthest target. No study set them.
const DISTANCES: [f64; 4] = [1.5, 2.5, 4.0, 7.0];
/// No instrument stands within the reach of an arm, and from farther away all lines are parallel.
const NEAREST: f64 = 1.0;
const FARTHEST: f64 = 10.0;
/// Rows that a place is looked for with, at most.
const LOOKS: usize = 500;
/// Steps of a search, as shares of the distance: from a part of what is tried to what no row tells.
const FIRST_STEP: f64 = 0.3;
const LAST_STEP: f64 = 0.02;

/// Lines of sight that may scatter, across and along, where what a fit leaves of its rows is
/// `left`: from the origin or from where it is likeliest. Of other kinds of measurement than points
/// and poses their own noise was found beside that of points.
#[must_use]
pub fn possible(
    problem: &Problem,
    state: &State,
    kept: &[usize],
    left: &[Vec<f64>],
) -> Vec<Scatterer> {
    instruments(problem, state, kept, left).unwrap_or_default()
}

fn instruments(
    problem: &Problem,
    state: &State,
    kept: &[usize],
    left: &[Vec<f64>],
) -> Option<Vec<Scatterer>> {
    let rows = &problem.data.rows;
    let base_of = |row: &Row| state.bases[row.station].translation;
    let far = |row: &Row| {
        let base = base_of(row);
        kind(row).point(row).map(|point| base.norm() / (point - base).norm())
    };
    let far: Vec<f64> = rows.iter().map(far).collect::<Option<_>>()?;
    // An arm does not let one stand so near its base, whose frame these coordinates are then. There
    // joints 1 and 2 together turn a target across the line from the origin, as a sight does.
    let is_origin = median(&far) > APART;
    let several = rows.iter().any(|row| row.station != rows[0].station);
    let every = kept.len().div_ceil(LOOKS).max(1);
    let look = |(row, left): (&usize, &Vec<f64>)| {
        let point = kind(&rows[*row]).point(&rows[*row])?;
        Some((point, Vector3::from_column_slice(left.get(..3)?)))
    };
    let looks: Vec<Look> = kept.iter().zip(left).step_by(every).filter_map(look).collect();
    let base = base_of(&rows[0]);
    let likeliest = |way: Way| {
        let origin = is_origin.then_some(Place::ORIGIN);
        let found = (!several).then(|| Place::near(&around(&base, &looks, way)));
        let worth = |place: &Place| {
            let likelihood = likelihood(&place.point(), &looks, way) * every as f64;
            likelihood - price(way.of(*place), kept.len())
        };
        let places = origin.into_iter().chain(found);
        places.max_by(|a, b| worth(a).total_cmp(&worth(b))).map(|place| way.of(place))
    };
    Some([Way::Across, Way::Along].into_iter().filter_map(likeliest).collect())
}

/// What scatters of a line of sight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Across,
    Along,
}

impl Way {
    fn of(self, place: Place) -> Scatterer {
        match self {
            Self::Across => Scatterer::Sight(place),
            Self::Along => Scatterer::Range(place),
        }
    }
}

/// What the place of an instrument costs that was looked for: as much as three numbers that a fit
/// of so many rows finds (Schwarz, Annals of Statistics 6 (1978) 461).
#[must_use]
pub fn price(source: Scatterer, rows: usize) -> f64 {
    let looked_for = source.instrument().is_some_and(|place| place != Place::ORIGIN);
    if looked_for { 1.5 * (rows.max(1) as f64).ln() } else { 0.0 }
}

/// A point, m, and what a fit leaves of it, in sigmas.
type Look = (Vector3<f64>, Vector3<f64>);

/// The likeliest place of an instrument around an arm that stands at `base`.
fn around(base: &Vector3<f64>, looks: &[Look], way: Way) -> Vector3<f64> {
    let reach = looks.iter().map(|(point, _)| (point - base).norm()).fold(0.0, f64::max);
    let allowed = |place: &Vector3<f64>| {
        (NEAREST * reach..=FARTHEST * reach).contains(&(place - base).norm())
    };
    // To the corners, edges and faces of a cube.
    let step = |k: i32, axis: u32| f64::from(k / 3_i32.pow(axis) % 3 - 1);
    let ways = (0..27).map(|k| Vector3::new(step(k, 0), step(k, 1), step(k, 2)));
    let ways: Vec<Vector3<f64>> = ways.filter(|way| way.norm() > 0.0).collect();
    let best_of = |places: &mut dyn Iterator<Item = Vector3<f64>>| {
        let rated = places.map(|place| (likelihood(&place, looks, way), place));
        rated.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut tried = ways
        .iter()
        .flat_map(|way| DISTANCES.map(|distance| base + way.normalize() * (distance * reach)));
    let Some((mut most, mut best)) = best_of(&mut tried) else { return *base };
    let mut step = FIRST_STEP;
    while step > LAST_STEP {
        let far = (best - base).norm();
        let mut tried = ways.iter().map(|way| best + way * (step * far)).filter(allowed);
        match best_of(&mut tried).filter(|other| other.0 > most) {
            Some(other) => (most, best) = other,
            None => step *= 0.5,
        }
    }
    best
}

/// Log likelihood of points that scatter so about their lines from a place, as much as is
/// likeliest.
fn likelihood(place: &Vector3<f64>, looks: &[Look], way: Way) -> f64 {
    let seen = |(point, left): &Look| {
        let line = point - place;
        // A target may have been read at the origin itself.
        let square = line.norm_squared().max(f64::MIN_POSITIVE);
        let along = left.dot(&line).powi(2) / square;
        let across = left.norm_squared() - along;
        match way {
            // Two ways across, as large in the mean.
            Way::Across => {
                let half = Seen { square, along: 0.5 * across, across: 0.0, equations: 0 };
                vec![Seen { across: along, equations: 3, ..half }, half]
            }
            Way::Along => vec![Seen { square, along, across, equations: 3 }],
        }
    };
    let seen: Vec<Seen> = looks.iter().flat_map(seen).collect();
    Seen::log_likelihood(&seen, directed::ratio(&seen))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// A tracker is found where it stands, wherever coordinates begin.
    #[test]
    fn an_instrument_is_found_where_it_stands() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
        for stands in [[3.0, -1.0, 0.4], [-2.0, 2.5, 1.0], [0.3, -3.5, -0.5]] {
            let stands = Vector3::from(stands);
            let look = |_| {
                let point = Vector3::from_fn(|_, _| normal() * 0.6);
                let line = point - stands;
                let noise = Vector3::from_fn(|_, _| normal());
                let turned = Vector3::from_fn(|_, _| normal()).cross(&line);
                (point, noise + turned)
            };
            let looks: Vec<Look> = (0..400).map(look).collect();
            let found = around(&Vector3::zeros(), &looks, Way::Across);
            let off = found.normalize().dot(&stands.normalize());
            assert!(off > 0.97, "{found} for {stands}");
        }
    }
}
