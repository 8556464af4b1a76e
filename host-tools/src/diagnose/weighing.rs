//! What an arm weighs, by the torques that were read.
//!
//! Torques tell what every joint holds, and so what gives way by its own load. What a base, or
//! the bearing of a joint, gives way by is another moment: that takes the first moments of the
//! links, of which gravity's torques are linear functions.

use nalgebra::{DMatrix, DVector};

use super::moments::within_reach;
use crate::identify::Surroundings;
use crate::model::{Measurements, Mounting, Robot};

/// Share of the variance of torques that moments must explain: those of other loads, of
/// friction and of motion say nothing of a base.
const EXPLAINED: f64 = 0.9;
/// Rows that are looked at, at most.
const ROWS: usize = 2000;
/// Share of the squares of the moment that torques tell best by which all are held to what was
/// assumed: those that move no torque stay there.
const HELD: f64 = 1e-6;

/// A robot of which nobody stated the masses, with moments that explain the torques of a file,
/// an offset of each reading apart; `None` where they do not, or where nothing was read.
#[must_use]
pub fn weighed(robot: &Robot, data: &Measurements, mounting: Mounting) -> Option<Robot> {
    if !robot.links.is_empty() || !data.has_torques() {
        return None;
    }
    let mut found = robot.with_assumed_loads(mounting)?;
    let reading = Surroundings::new(&found).reading(data, &found);
    let every = data.rows.len().div_ceil(ROWS).max(1);
    let rows: Vec<_> = data.rows.iter().step_by(every).collect();
    let joints = robot.joints.len();
    let read = |row: usize, joint: usize| reading.torques(rows[row]).map(|all| all[joint]);
    let torques = |robot: &Robot| {
        let at = Surroundings::new(robot);
        let each = rows.iter().flat_map(|row| at.inputs(row, &row.q).torque);
        DVector::from_iterator(rows.len() * joints, each)
    };
    let assumed = torques(&found);
    let mut left = DVector::zeros(assumed.len());
    for k in 0..left.len() {
        left[k] = read(k / joints, k % joints)? - assumed[k];
    }
    let unknowns = 3 * joints;
    let mut columns = DMatrix::zeros(left.len(), unknowns + 1);
    for k in 0..unknowns {
        let mut with = found.clone();
        with.links[k / 3].com[k % 3] += 1.0 / with.links[k / 3].mass;
        columns.set_column(k, &(torques(&with) - &assumed));
    }
    let all = &left + &assumed;
    columns.set_column(unknowns, &left);
    // What a sensor adds to all its readings.
    let centred = |values: DVector<f64>| {
        let mean = |joint: usize| values.iter().skip(joint).step_by(joints).sum::<f64>();
        let means: Vec<f64> = (0..joints).map(|j| mean(j) / rows.len() as f64).collect();
        DVector::from_fn(values.len(), |k, _| values[k] - means[k % joints])
    };
    for k in 0..=unknowns {
        let own = centred(columns.column(k).into_owned());
        columns.set_column(k, &own);
    }
    let (a, b) = (columns.columns(0, unknowns), columns.column(unknowns));
    let mut normal = a.tr_mul(&a);
    let held = HELD * normal.diagonal().max();
    (0..unknowns).for_each(|k| normal[(k, k)] += held);
    let moments = normal.cholesky()?.solve(&a.tr_mul(&b));
    let rest = (b - a * &moments).norm_squared();
    if rest > (1.0 - EXPLAINED) * centred(all).norm_squared() {
        return None;
    }
    for (k, moment) in moments.iter().enumerate() {
        let link = &mut found.links[k / 3];
        link.com[k % 3] += moment / link.mass;
    }
    found.warnings.clone_from(&robot.warnings);
    found.warnings.push(format!(
        "{}: no [[links]]: what a base gives way by is computed from moments of the links that \
         explain the torques that were read",
        robot.path.display()
    ));
    Some(within_reach(found, &robot.nominal()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{LinkMass, Row};

    /// The moments of an arm whose torques are those of masses come back as far as torques
    /// tell: the arm overturns its base by as much, but for moments along the parallel axes of
    /// joints 2 to 4, which move no torque.
    #[test]
    fn torques_weigh_an_arm() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/ur10-ipa/robot.toml");
        let mut robot = Robot::read(path.as_ref()).unwrap();
        assert!(robot.is_weighed());
        let heavy = robot.clone();
        robot.links = Vec::<LinkMass>::new();
        let truth = Surroundings::new(&heavy);
        let mut next = 1_u64;
        let mut angle = || {
            next = next.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (next >> 33) as f64 / (1_u64 << 31) as f64 * 4.0 - 2.0
        };
        let mut text =
            "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm,torque1_nm,torque2_nm,\
                        torque3_nm,torque4_nm,torque5_nm,torque6_nm\n"
                .to_owned();
        for k in 0..200 {
            let row = Row::at((0..6).map(|_| angle()).collect());
            text += &row.q.iter().map(|q| format!("{},", q.to_degrees())).collect::<String>();
            text += &format!("{k},0,0");
            // A sensor reads what the joint holds, and something of its own.
            let held = truth.inputs(&row, &row.q).torque;
            text += &held
                .iter()
                .zip(0..)
                .map(|(t, j)| format!(",{}", 0.3 * f64::from(j) - t))
                .collect::<String>();
            text += "\n";
        }
        let data = Measurements::parse("m.csv".as_ref(), &text, &robot).unwrap();
        let found = weighed(&robot, &data, Mounting::Upright).unwrap();
        let by = Surroundings::new(&found);
        let (mut apart, mut all) = (0.0, 0.0);
        let mean = |of: &Surroundings, k: usize| {
            let each = data.rows.iter().map(|row| of.inputs(row, &row.q).moment[k]);
            each.sum::<f64>() / data.rows.len() as f64
        };
        for row in &data.rows {
            let [own, other] = [&truth, &by].map(|of| of.inputs(row, &row.q).moment);
            for k in 0..2 {
                let [a, b] = [own[k] - mean(&truth, k), other[k] - mean(&by, k)];
                (apart, all) = (apart + (a - b).powi(2), all + a * a);
            }
        }
        assert!(apart < 0.1 * all, "{apart} of {all}");
        // Torques of something else weigh nothing.
        let mut other = data.clone();
        other.rows.iter_mut().for_each(|row| row.torques.rotate_left(1));
        assert!(weighed(&robot, &other, Mounting::Upright).is_none());
    }
}
