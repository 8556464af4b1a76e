//! How far the x and the y of a marker's frame lean from the level, upwards
//! positive. How the frame sits on the last one, and where up is in the frame of
//! the station, are unknowns unless they are stated.

use nalgebra::{DMatrix, Vector3};

use super::{ArmPart, Body, Bound, Column, Kind, Measure, Partials, Registry, Seen, Told, Unclear};
use crate::model::{Form, Row, Values};

/// Two angles, each of one axis of the inclinometer.
pub struct Inclination;

const AT: &str = "an inclination needs incl_x_deg and incl_y_deg";
const FAR: &str = "give in degrees how far the axis leans from the level, -90 to 90: the arc sine of what \
                   of gravity lies along it";

impl Kind for Inclination {
    fn name(&self) -> &'static str {
        "inclination"
    }

    fn columns(&self) -> &'static [Column] {
        &[
            Column { name: "incl_x_deg", within: [-1.6, 1.6], missing: AT, wrong: FAR },
            Column { name: "incl_y_deg", within: [-1.6, 1.6], missing: AT, wrong: FAR },
        ]
    }

    fn bind(&self, told: &Told, book: &mut dyn Registry) -> Result<Bound, Unclear> {
        let mount = book.instrument(&[Form::Turn], told.marker);
        let up = book.instrument(&[Form::Up], "");
        Ok(Bound { refers: vec![up, mount], known: Vec::new() })
    }

    fn components(&self) -> &'static [&'static str] {
        &["incl_x", "incl_y"]
    }

    fn measure(&self, _component: usize) -> Measure {
        Measure::Angle
    }

    fn check(&self) -> &'static str {
        "that incl_x_deg and incl_y_deg are degrees, both positive upwards, \
         and how the inclinometer sits ([[markers]])"
    }

    fn leaves(&self) -> &'static str {
        "every length, where the arm stands, and turns about the vertical"
    }

    fn lean(&self, row: &Row) -> Option<[f64; 2]> {
        Some([row.measured[0], row.measured[1]])
    }

    fn of_marker(&self, _row: &Row) -> bool {
        false
    }

    fn turns(&self) -> bool {
        true
    }

    fn partials(&self, index: usize, seen: &dyn Seen) -> Partials {
        let (row, pose) = (seen.row(index), seen.pose(index));
        let (up, mount) = (seen.instrument(row.refers[0]), seen.instrument(row.refers[1]));
        let axes = pose.rotation * mount.place.rotation;
        let vertical = up.place.rotation.column(2).into_owned();
        let mut modelled = [0.0; 2];
        let mut pull = DMatrix::zeros(2, 6);
        let (mut of_up, mut of_mount) = (DMatrix::zeros(2, 6), DMatrix::zeros(2, 6));
        for (c, angle) in modelled.iter_mut().enumerate() {
            let axis: Vector3<f64> = axes.column(c).into_owned();
            let sine = vertical.dot(&axis).clamp(-1.0, 1.0);
            *angle = sine.asin();
            let steep = (1.0 - sine * sine).max(1e-12).sqrt().recip();
            // A turn w takes the axis a to a + w x a: the sine moves by w . (a x up).
            let with_turn = axis.cross(&vertical) * steep;
            let own = axes.tr_mul(&with_turn);
            let tilted = up.place.rotation.tr_mul(&-with_turn);
            for k in 0..3 {
                pull[(c, 3 + k)] = with_turn[k];
                of_mount[(c, k)] = own[k];
                of_up[(c, k)] = tilted[k];
            }
        }
        Partials {
            residual: Values::from_fn(2, |c| row.measured[c] - modelled[c]),
            arm: vec![ArmPart { row: index, body: Body::Target, pull }],
            instruments: vec![(row.refers[0], of_up), (row.refers[1], of_mount)],
        }
    }
}
