//! First guesses: tool point by distance differences (paper Eq. 21), tracker
//! frame by SVD (Eq. 17). Both withstand gross errors: rows far off lose weight.

use nalgebra::{DMatrix, DVector, Vector3};
use truearm::Pose;

use super::instruments;
use super::rigid::rigid_transform;
use crate::error::{Error, ErrorKind, Result};
use crate::identify::problem::State;
use crate::model::arm::chain;
use crate::model::{Measurements, Row};
use crate::observations::kind;
use crate::statistics::{mad_scale, median};

/// Like [`rigid_transform`], rows far off weighed down (Cauchy weights on the
/// distance, scale from the median).
fn robust_transform(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> Option<(Pose<f64>, f64)> {
    let mut weights = vec![1.0; from.len()];
    let mut found = None;
    for _ in 0..20 {
        let pose = rigid_transform(from, to, &weights)?;
        let distances: Vec<f64> =
            from.iter().zip(to).map(|(a, b)| (pose.transform_point(a) - b).norm()).collect();
        let scale = median(&distances).max(1e-9);
        for (w, d) in weights.iter_mut().zip(&distances) {
            *w = (1.0 + (d / (2.0 * scale)).powi(2)).recip();
        }
        found = Some((pose, scale));
    }
    found
}

/// Share of its place by which a target moves, when it is put elsewhere on the flange, below
/// which nothing is learned of where it sits: errors of the model would put it metres away.
const HARDLY: f64 = 2e-2;

/// Tool point from distances alone, which need no tracker frame: for pairs of
/// rows the distance between the two measured points must equal that between
/// the two modelled ones (paper Eq. 21, Gauss-Newton from `start`).
fn tool_by_distances(
    flanges: &[Pose<f64>],
    points: &[Vector3<f64>],
    start: Vector3<f64>,
) -> Vector3<f64> {
    let n = points.len();
    let strides = [1, 2, 3, 5, 8, 13];
    let pairs: Vec<(usize, usize)> = strides
        .iter()
        .filter(|s| **s < n)
        .flat_map(|s| (0..n - s).map(move |i| (i, i + s)))
        .collect();
    let mut tool = start;
    for _ in 0..15 {
        let mut a = DMatrix::zeros(pairs.len(), 3);
        let mut b = DVector::zeros(pairs.len());
        for (k, (i, j)) in pairs.iter().enumerate() {
            let turn = flanges[*j].rotation - flanges[*i].rotation;
            let v = turn * tool + flanges[*j].translation - flanges[*i].translation;
            let length = v.norm().max(1e-9);
            a.row_mut(k).copy_from(&(v.transpose() * turn / length));
            b[k] = (points[*j] - points[*i]).norm() - length;
        }
        let scale = mad_scale(b.as_slice()).max(1e-9);
        for k in 0..pairs.len() {
            let weight = (1.0 + (b[k] / (2.0 * scale)).powi(2)).recip().sqrt();
            a.row_mut(k).scale_mut(weight);
            b[k] *= weight;
        }
        let svd = a.svd(true, true);
        // Where the flange hardly turns the tool stays where the file has it: about one axis
        // less than about others, or about none.
        let cut = HARDLY * svd.singular_values.max().max((pairs.len() as f64).sqrt());
        let Ok(step) = svd.solve(&b, cut) else { break };
        let step = Vector3::new(step[0], step[1], step[2]);
        tool += step * (0.5_f64).min(step.norm()) / step.norm().max(1e-12);
        if step.norm() < 1e-9 {
            break;
        }
    }
    tool
}

/// First state: nominal links; each marker from where a file says it is or from
/// distance differences, whichever fits better; each base by SVD. Rows that
/// measured no point say nothing here.
///
/// # Errors
/// Stations or markers with too few rows, or points on a line.
pub fn register(
    data: &Measurements,
    links: &[truearm::Link<f64>],
    tool: Vector3<f64>,
) -> Result<State> {
    let flange = chain(links, Pose::identity(), Vector3::zeros());
    let sight = |row: &Row| {
        let point = kind(row).point(row)?;
        let flange = flange.pose(&row.q);
        Some(Sight { station: row.station, marker: row.marker, flange, point })
    };
    // A row that was written twice was seen once.
    let sights: Vec<Sight> = data.distinct().iter().filter_map(|r| sight(&data.rows[*r])).collect();
    let sights = thinned(sights, data.markers.len());
    let of = |all: &[Option<Vector3<f64>>], m: usize| all.get(m).copied().flatten();
    let known = |m: usize| of(&data.known_markers, m);
    // Markers sit where they are said to, or else where the tool does.
    let stated = |m: usize| known(m).or(of(&data.guessed_markers, m)).unwrap_or(tool);
    let stated: Vec<_> = (0..data.markers.len()).map(stated).collect();
    // Distances within the station that saw the marker most.
    let by_distance = |marker: usize| {
        let of = |s: usize| sights.iter().filter(move |v| v.marker == marker && v.station == s);
        let most = (0..data.stations.len()).max_by_key(|s| of(*s).count()).unwrap_or_default();
        let (frames, points): (Vec<_>, Vec<_>) = of(most).map(|v| (v.flange, v.point)).unzip();
        let start = stated[marker];
        if points.len() < 4 { start } else { tool_by_distances(&frames, &points, start) }
    };
    let found = |m: usize| known(m).unwrap_or_else(|| by_distance(m));
    let found: Vec<_> = (0..data.markers.len()).map(found).collect();
    let mut best: Option<(f64, State)> = None;
    for markers in [stated, found] {
        let (mut worst, mut bases) = (0.0_f64, Vec::new());
        for station in 0..data.stations.len() {
            let (base, scale) = base_of(data, station, &sights, &markers)?;
            bases.push(base);
            worst = worst.max(scale);
        }
        if best.as_ref().is_none_or(|(scale, _)| worst < *scale) {
            let (links, instruments) = (links.to_vec(), data.instruments.clone());
            let state = State { bases, markers, instruments, links, terms: Vec::new() };
            best = Some((worst, state));
        }
    }
    best.map(|(_, state)| instruments::instruments(data, state))
        .ok_or_else(|| Error::data(ErrorKind::NoRows, "no measurements", "add rows"))
}

/// A measured point and the flange there, in the robot's frame.
struct Sight {
    station: usize,
    marker: usize,
    flange: Pose<f64>,
    point: Vector3<f64>,
}

/// Points of a marker from a station that a first guess is made of: more would not
/// bring the fit, which takes all rows, any nearer to where it ends.
const MOST: usize = 3000;

/// Evenly spread ones where there are more.
fn thinned(mut sights: Vec<Sight>, markers: usize) -> Vec<Sight> {
    let pair = |v: &Sight| v.station * markers + v.marker;
    let mut counts = vec![0_usize; sights.iter().map(pair).max().map_or(0, |last| last + 1)];
    sights.iter().for_each(|v| counts[pair(v)] += 1);
    let mut seen = vec![0; counts.len()];
    sights.retain(|v| {
        let (place, count) = (seen[pair(v)], counts[pair(v)]);
        seen[pair(v)] += 1;
        place % count.div_ceil(MOST) == 0
    });
    sights
}

/// The base that a station sees, and the scale of what is left.
fn base_of(
    data: &Measurements,
    station: usize,
    sights: &[Sight],
    markers: &[Vector3<f64>],
) -> Result<(Pose<f64>, f64)> {
    let here = sights.iter().filter(|v| v.station == station);
    let pointless = |row: &Row| row.station != station || kind(row).point(row).is_none();
    if data.rows.iter().all(pointless) {
        return Ok((data.base, 0.0));
    }
    let (from, to): (Vec<_>, Vec<_>) =
        here.map(|v| (v.flange.transform_point(&markers[v.marker]), v.point)).unzip();
    let label = if data.stations.len() > 1 {
        format!("station \"{}\"", data.stations[station])
    } else {
        "the measurements".to_owned()
    };
    if from.len() < 3 {
        return Err(Error::data(
            ErrorKind::FrameUndetermined,
            format!(
                "{label}: the number of different rows is {}, which cannot fix a tracker frame",
                from.len()
            ),
            "measure at least three points that are not on a line, better ten; equal rows count as \
             one",
        ));
    }
    robust_transform(&from, &to).ok_or_else(|| {
        Error::data(
            ErrorKind::FrameUndetermined,
            format!(
                "{label}: the points lie on a line or in one place, so that the tracker frame is \
                 undetermined"
            ),
            "measure poses spread over the workspace",
        )
    })
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Flanges that turn by up to so much about all axes, half a metre of work space, errors of
    /// a millimetre that no tool explains: how far off the tool is that was stated 30 mm off.
    fn off(turned: f64, seed: u64) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut vector = |size: f64| Vector3::from_fn(|_, _| rng.random_range(-size..size));
        let tool = Vector3::new(0.05, 0.03, 0.12);
        let flanges: Vec<_> =
            (0..200).map(|_| Pose::from_rotation_vector(vector(0.5), vector(turned))).collect();
        let points: Vec<_> =
            flanges.iter().map(|f| f.transform_point(&tool) + vector(1e-3)).collect();
        let stated = tool + Vector3::new(0.03, 0.0, 0.0);
        (tool_by_distances(&flanges, &points, stated) - tool).norm()
    }

    /// It had gone metres away, where turns of all axes were alike and small.
    #[test]
    fn a_flange_that_hardly_turns_says_nothing_of_the_tool() {
        for seed in 0..20 {
            for turned in [1e-9, 1e-4, 1e-3, 1e-2] {
                assert!((off(turned, seed) - 0.03).abs() < 1e-9, "{turned}: {}", off(turned, seed));
            }
            for (turned, most) in [(0.1, 0.01), (1.0, 0.001)] {
                assert!(off(turned, seed) < most, "{turned}: {}", off(turned, seed));
            }
        }
    }
}
