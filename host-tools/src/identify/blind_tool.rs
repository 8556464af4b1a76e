//! Where a target sits on a flange that hardly turns no row says: the robot file does.

use truearm::JointKind;

use super::problem::{Problem, Turns};
use crate::model::Robot;

/// How far joints are turned to see what an arm could do, rad.
const TRIED: f64 = 0.5;

/// A sentence for each target of which some direction on the flange is not told by the rows,
/// though the arm could turn its flange so that it were.
#[must_use]
pub fn remarks(robot: &Robot, problem: &Problem) -> Vec<String> {
    let data = problem.data;
    let sentence = |(m, label): (usize, &String)| {
        if data.known_markers.get(m).copied().flatten().is_some() {
            return None;
        }
        let own: Vec<&[f64]> =
            data.rows.iter().filter(|row| row.marker == m).map(|row| &row.q[..]).collect();
        let blind = Turns::of(&problem.nominal, own.iter().copied()).blind();
        if blind.is_empty() || blind.len() <= could_not(problem, own[0]) {
            return None;
        }
        let guessed = data.guessed_markers.get(m).copied().flatten();
        let (place, from) = match guessed {
            Some(place) => (place, "as guessed".to_owned()),
            None => (robot.tool, format!("[tool] of {}", robot.path.display())),
        };
        let target = match label.as_str() {
            "" => "the target".to_owned(),
            label => format!("marker \"{label}\""),
        };
        let at = place.map(|x| format!("{:.1}", x * 1e3));
        let rows = format!("{}: no pose turns the flange", data.path.display());
        let advice = "state it as well as you know it, or measure poses that turn the flange";
        Some(match blind[..] {
            [way] => format!(
                "{rows} about another axis than ({:.2}, {:.2}, {:.2}) of its own: how far along it \
                 {target} sits is not found but taken as it is stated ({from}: {}, {}, {} mm); \
                 {advice} about others",
                way.x, way.y, way.z, at[0], at[1], at[2]
            ),
            _ => format!(
                "{rows} by more than a degree: where {target} sits on it is not found but taken as \
                 it is stated ({from}: {}, {}, {} mm), and where the flange is turned, the tool is \
                 off by as much as that is; {advice}",
                at[0], at[1], at[2]
            ),
        })
    };
    data.markers.iter().enumerate().filter_map(sentence).collect()
}

/// Directions that are not told either where each joint turns.
fn could_not(problem: &Problem, at: &[f64]) -> usize {
    let turned = |(j, link): (usize, &truearm::Link<f64>)| {
        let by = if link.kind == JointKind::Revolute { TRIED } else { 0.0 };
        [-by, by].map(|by| {
            let mut q = at.to_vec();
            q[j] += by;
            q
        })
    };
    let values: Vec<Vec<f64>> = problem.nominal.iter().enumerate().flat_map(turned).collect();
    Turns::of(&problem.nominal, values.iter().map(|q| &q[..])).blind().len()
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
        assert!(found.len() == 1 && found[0].contains("by more than a degree"), "{found:?}");
        // Turned about one axis.
        let found = said(|k| level(k, spread(k, 5), 0.0), nothing);
        assert!(found.len() == 1 && found[0].contains("about another axis than"), "{found:?}");
        // On both sides of the border.
        assert_eq!(said(|k| level(k, spread(k, 5), 0.01), nothing).len(), 1);
        assert_eq!(said(|k| level(k, spread(k, 5), 0.2), nothing), Vec::<String>::new());
        // What is known is not asked for.
        let known = |data: &mut Measurements| {
            data.known_markers = vec![Some(nalgebra::Vector3::zeros()); data.markers.len()];
        };
        assert_eq!(said(|k| level(k, 0.3, 0.0), known), Vec::<String>::new());
    }
}
