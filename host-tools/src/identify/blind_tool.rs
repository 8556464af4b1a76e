//! Where a target sits on a flange that hardly turns no row says: the robot file does.

use nalgebra::{Matrix3, Vector3};
use truearm::{JointKind, Pose};

use super::problem::{Problem, Turns, spreads, spreads_of};
use crate::model::arm::chain;
use crate::model::{Robot, Row};
use crate::observations::kind;

/// How far joints are turned to see what an arm could do, rad.
const TRIED: f64 = 0.5;

/// A target that moves by less than this share when it is put elsewhere on the flange stays
/// about where it is stated: errors of a few tenths of a millimetre that the model lacks are a
/// decimetre of it. From twice as much on it is found to a millimetre or two.
const BLIND: f64 = 3e-3;

/// A sentence for each target of which some direction on the flange is not told by the rows,
/// though the arm could turn its flange so that it were.
#[must_use]
pub fn remarks(robot: &Robot, problem: &Problem) -> Vec<String> {
    let data = problem.data;
    let spreads = spreads_of(data, &problem.nominal);
    let sentence = |(m, label): (usize, &String)| {
        let own: Vec<&Row> = data.rows.iter().filter(|row| row.marker == m).collect();
        let known = data.known_markers.get(m).copied().flatten().is_some();
        // Of an inclinometer, a ray or a camera in the hand it is another question.
        let points = own.iter().all(|row| kind(row).point(row).is_some());
        let first = own.first().filter(|_| points && !known)?;
        let blind = blind(&spreads[m]);
        if blind.is_empty() || blind.len() <= could_not(problem, &first.q) {
            return None;
        }
        let place = data.guessed_markers.get(m).copied().flatten().unwrap_or(robot.tool);
        let target = match label.as_str() {
            "" => "the target".to_owned(),
            label => format!("marker \"{label}\""),
        };
        let place = match place == Vector3::zeros() {
            true => "the origin of the last frame, as no other place is stated".to_owned(),
            false => {
                let [x, y, z] = (place * 1e3).into();
                format!("its stated place, {x:.1}, {y:.1}, {z:.1} mm")
            }
        };
        let file = data.path.display();
        let poses = "state it as well as you know it, or measure poses that turn the flange";
        Some(match blind[..] {
            [way] => format!(
                "{file}: poses turn the flange about ({:.2}, {:.2}, {:.2}) of its own alone: where \
                 {target} sits along that is hardly told, and stays near {place}; {poses} about \
                 other axes",
                way.x, way.y, way.z
            ),
            _ => format!(
                "{file}: poses hardly turn the flange ({:.2} degrees RMS): where {target} sits on it \
                 is hardly told, and stays near {place}; what that is off the tool is off wherever \
                 the flange is turned: {poses}",
                turned(&spreads[m]).to_degrees()
            ),
        })
    };
    data.markers.iter().enumerate().filter_map(sentence).collect()
}

/// Directions of the last frame along which a target may sit anywhere: the one that poses
/// turn about, all three where they do not turn.
fn blind(spread: &Matrix3<f64>) -> Vec<Vector3<f64>> {
    let eigen = spread.symmetric_eigen();
    let pairs = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
    let blind = pairs.filter(|(moved, _)| moved.max(0.0).sqrt() < BLIND);
    // An axis has no sense: its largest coordinate is positive.
    let along = |way: Vector3<f64>| {
        (way * way[way.iamax()].signum()).map(|x| if x.abs() < 5e-3 { 0.0 } else { x })
    };
    blind.map(|(_, way)| along(way.into_owned())).collect()
}

/// Root mean square of the angles of small turns about all axes, rad.
fn turned(spread: &Matrix3<f64>) -> f64 {
    (spread.trace().max(0.0) / 2.0).sqrt()
}

/// Directions that are not told either where each joint turns.
fn could_not(problem: &Problem, at: &[f64]) -> usize {
    let flange = chain(&problem.nominal, Pose::identity(), Vector3::zeros());
    let mut turns = Turns::default();
    for (j, link) in problem.nominal.iter().enumerate() {
        let by = if link.kind == JointKind::Revolute { TRIED } else { 0.0 };
        for by in [-by, by] {
            let mut q = at.to_vec();
            q[j] += by;
            turns.add(&flange.pose(&q).rotation);
        }
    }
    blind(&spreads(&[turns], 1, &|_| false)[0]).len()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::identify::Scaling;
    use crate::model::Measurements;
    use crate::observations::tests::{cell, read, robot};

    /// What is said where the joints stand so at row k.
    fn said(q: impl Fn(usize) -> [f64; 6], change: impl Fn(&mut Measurements)) -> Vec<String> {
        let robot = robot();
        let cell = cell(&robot, &mut ChaCha8Rng::seed_from_u64(3));
        let mut data = read(&robot, &cell, &[("point", 40)], 4);
        data.rows.iter_mut().enumerate().for_each(|(k, row)| row.q = q(k).to_vec());
        change(&mut data);
        remarks(&robot, &Problem::new(&data, &robot, Scaling::Prior))
    }

    /// Joints 2, 3 and 4 of a UR10 are parallel.
    #[test]
    fn a_flange_that_does_not_turn_is_said_with_what_is_taken() {
        let spread = |k: usize, j: usize| ((k * (7 + j)) as f64).sin();
        let level = |k: usize, first: f64, tilt: f64| {
            let [a, b] = [0.4 * spread(k, 1), 0.4 * spread(k, 2)];
            [first, a - 1.0, b + 1.5, -a - b, 1.2 + tilt * spread(k, 3), tilt * spread(k, 4)]
        };
        let nothing = |_: &mut Measurements| ();
        let found = said(|k| level(k, 0.3, 0.0), nothing);
        assert!(
            found.len() == 1 && found[0].contains("hardly turn the flange (0.00 degrees RMS)"),
            "{found:?}"
        );
        // Turned about one axis.
        let found = said(|k| level(k, spread(k, 5), 0.0), nothing);
        assert!(found.len() == 1 && found[0].contains("of its own alone"), "{found:?}");
        // On both sides of the border.
        assert_eq!(said(|k| level(k, spread(k, 5), 0.001), nothing).len(), 1);
        assert_eq!(said(|k| level(k, spread(k, 5), 0.02), nothing), Vec::<String>::new());
        // One orientation in each of two stations, which have their own frames.
        let two = |data: &mut Measurements| {
            data.stations = vec!["a".to_owned(), "b".to_owned()];
            data.rows.iter_mut().enumerate().for_each(|(k, row)| row.station = k % 2);
        };
        let found = said(|k| level(k, (k % 2) as f64, 0.0), two);
        assert!(found.len() == 1 && found[0].contains("(0.00 degrees RMS)"), "{found:?}");
        // What is known is not asked for.
        let known = |data: &mut Measurements| {
            data.known_markers = vec![Some(nalgebra::Vector3::zeros()); data.markers.len()];
        };
        assert_eq!(said(|k| level(k, 0.3, 0.0), known), Vec::<String>::new());
    }
}
