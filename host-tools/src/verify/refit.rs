//! Frames of stations that are fitted to the file under test itself.

use std::collections::{BTreeMap, HashMap};

use nalgebra::{Matrix3, Vector3};
use truearm::Pose;

use crate::error::{Error, ErrorKind, Result, count};
use crate::identify::Pairs;
use crate::model::Measurements;
use crate::model::near::Reach;
use crate::observations::kind;

/// By station and place, in this order.
type OfPlaces<T> = BTreeMap<(usize, usize), T>;

/// Fewer places of a station fix no frame for each of them by the others.
const LEAST_PLACES: usize = 4;
/// Poses this near to each other, in spreads of all, are one place: what one of them is off by
/// the others hold in the frame.
const ONE_PLACE: f64 = 0.05;

/// Each place of a file from a station of its own, whose frame is the one that the points of
/// the other places fix, and the variance of such a frame along a direction, m^2: in a frame
/// that its own points had a part in, an error would look smaller than it is, of four poses
/// by half.
///
/// # Errors
/// A place without which the others do not fix a frame.
pub fn refitted(
    data: &mut Measurements,
    targets: &[Vector3<f64>],
) -> Result<(Vec<Pose<f64>>, f64)> {
    let mut whole = vec![Pairs::default(); data.stations.len()];
    let mut own: OfPlaces<Pairs> = BTreeMap::new();
    let places = places(data, targets);
    for ((row, target), place) in data.rows.iter().zip(targets).zip(&places) {
        let of_place = own.entry((row.station, *place)).or_default();
        if let Some(point) = kind(row).point(row) {
            of_place.add(*target, point);
            whole[row.station].add(*target, point);
        }
    }
    let mut seen = vec![0; data.stations.len()];
    own.iter().filter(|(_, pairs)| pairs.count > 0.0).for_each(|((s, _), _)| seen[*s] += 1);
    let undetermined = |station: usize| {
        let (places, label) = (count(seen[station], "place"), &data.stations[station]);
        Error::data(
            ErrorKind::FrameUndetermined,
            format!(
                "{}: the points of {places} of station \"{label}\" do not fix a frame for each of \
                 them by the others",
                data.path.display()
            ),
            "measure at least four places that are not on a line, better twenty",
        )
    };
    let frame = |((station, _), of_place): (&(usize, usize), &Pairs)| {
        let enough = seen[*station] >= LEAST_PLACES;
        let frame = enough.then(|| whole[*station].less(of_place).transform()).flatten();
        frame.ok_or_else(|| undetermined(*station))
    };
    let frames: Vec<Pose<f64>> = own.iter().map(frame).collect::<Result<_>>()?;
    let variance = variance(&own, &frames).map_err(undetermined)?;
    data.stations = own.keys().map(|(station, _)| data.stations[*station].clone()).collect();
    let own: HashMap<(usize, usize), usize> =
        own.into_keys().enumerate().map(|(k, key)| (key, k)).collect();
    for (row, place) in data.rows.iter_mut().zip(places) {
        row.station = own[&(row.station, place)];
    }
    Ok((frames, variance))
}

/// A number a row: alike of poses that are at one place. All targets of a pose are at its.
fn places(data: &Measurements, targets: &[Vector3<f64>]) -> Vec<usize> {
    let mut sums: BTreeMap<usize, (Vector3<f64>, f64)> = BTreeMap::new();
    for (row, target) in data.rows.iter().zip(targets) {
        let (sum, count) = sums.entry(row.pose).or_insert((Vector3::zeros(), 0.0));
        *sum += target;
        *count += 1.0;
    }
    let means: Vec<Vector3<f64>> = sums.values().map(|(sum, count)| sum / *count).collect();
    let middle = means.iter().sum::<Vector3<f64>>() / means.len().max(1) as f64;
    let squares: f64 = means.iter().map(|mean| (mean - middle).norm_squared()).sum();
    let spread = (squares / means.len().max(1) as f64).sqrt();
    let reach = Reach::uniform(3, (ONE_PLACE * spread).max(f64::MIN_POSITIVE));
    let (numbers, _) = reach.number(means.iter().map(|mean| mean.as_slice()));
    let of_pose: HashMap<usize, usize> = sums.into_keys().zip(numbers).collect();
    data.rows.iter().map(|row| of_pose[&row.pose]).collect()
}

/// Of the frame that the errors of the other places turn and move most, whatever they are made
/// of; of the station that has the largest.
///
/// # Errors
/// The station whose places are on a line.
fn variance(own: &OfPlaces<Pairs>, frames: &[Pose<f64>]) -> std::result::Result<f64, usize> {
    let mut stations: BTreeMap<usize, Vec<Seen>> = BTreeMap::new();
    for (((station, _), pairs), frame) in own.iter().zip(frames) {
        if pairs.count > 0.0 {
            let [target, point] = pairs.sums.map(|sum| sum / pairs.count);
            let error = frame.inverse().transform_point(&point) - target;
            stations.entry(*station).or_default().push(Seen { target, error });
        }
    }
    stations.iter().try_fold(0.0, |most, (station, places)| {
        Ok(f64::max(most, of_station(places).ok_or(*station)?))
    })
}

/// A place in the frame of the others.
struct Seen {
    target: Vector3<f64>,
    error: Vector3<f64>,
}

/// The same of a station; `None` of places on a line.
fn of_station(poses: &[Seen]) -> Option<f64> {
    let shares = shares(poses)?;
    let squares: f64 = poses.iter().map(|pose| pose.error.norm_squared()).sum();
    // Errors that are left out are larger than they are by what the frame adds.
    let each = squares / 3.0 / shares.iter().map(|share| 1.0 + share).sum::<f64>();
    // Of so few a variance is not known itself: that of Student's t.
    let freedom = 3.0 * poses.len() as f64 - 6.0;
    let largest = shares.iter().copied().fold(0.0, f64::max);
    Some(largest * each * freedom / (freedom - 2.0).max(1.0))
}

/// Of each pose, the variance of a frame there that it was fitted without, over that of a
/// coordinate of the others, in the mean of three directions; `None` of places on a line.
fn shares(poses: &[Seen]) -> Option<Vec<f64>> {
    // About their middle, where less is lost in differences.
    let middle = poses.iter().map(|pose| pose.target).sum::<Vector3<f64>>() / poses.len() as f64;
    let targets: Vec<Vector3<f64>> = poses.iter().map(|pose| pose.target - middle).collect();
    let across = |d: &Vector3<f64>| Matrix3::identity() * d.norm_squared() - d * d.transpose();
    let (sum, whole): (Vector3<f64>, Matrix3<f64>) =
        (targets.iter().sum(), targets.iter().map(across).sum());
    let others = poses.len() as f64 - 1.0;
    let share = |target: &Vector3<f64>| {
        let centre = (sum - target) / others;
        let moments = whole - across(target) - across(&centre) * others;
        let turned = moments.try_inverse()?;
        Some(1.0 / others + (turned * across(&(target - centre))).trace() / 3.0)
    };
    targets.iter().map(share).collect()
}
