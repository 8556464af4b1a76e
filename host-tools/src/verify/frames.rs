//! Where a file's stations see the frame that was commanded in.

use nalgebra::Vector3;
use truearm::Pose;

use crate::error::{Error, ErrorKind, Place, Result};
use crate::model::arm::chain;
use crate::model::{Commanded, Measurements, Model};

/// Places of the markers of a file in the last frame, m; of commanded points nothing.
///
/// # Errors
/// One that the model does not know.
pub fn markers(model: &Model, commanded: &Commanded) -> Result<Vec<Vector3<f64>>> {
    if !commanded.points.is_empty() {
        // A point is a point, whatever target it was measured with.
        return Ok(vec![Vector3::zeros(); commanded.data.markers.len()]);
    }
    let known = || model.markers.iter().map(|m| format!("\"{}\"", m.0)).collect::<Vec<_>>();
    let find = |label: &String| {
        model.markers.iter().find(|m| m.0 == *label).map(|m| m.1).ok_or_else(|| {
            Error::data(
                ErrorKind::UnknownMarker,
                format!(
                    "{}: marker \"{label}\" is unknown to the model, which knows {}",
                    commanded.data.path.display(),
                    known().join(", ")
                ),
                "measure with a target of the identification, or give commanded points",
            )
        })
    };
    commanded.data.markers.iter().map(find).collect()
}

/// Refuses commanded points that are in the tracker's frame: there they agree
/// with what was measured, and in the robot's they do not.
///
/// # Errors
/// That they are.
pub fn in_tracker_frame(commanded: &Commanded, frames: &[Pose<f64>], model: &Model) -> Result<()> {
    let base = model.robot.base.pose();
    let distances = |to: &dyn Fn(&crate::model::Row) -> Vector3<f64>, from: &Pose<f64>| {
        let rows = commanded.data.rows.iter().zip(&commanded.points);
        let mut all: Vec<f64> =
            rows.map(|(r, p)| (to(r) - from.transform_point(p)).norm()).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let measured = |row: &crate::model::Row| row.measured.point();
    let robot =
        |row: &crate::model::Row| frames[row.station].inverse().transform_point(&measured(row));
    let as_told = distances(&robot, &Pose::identity());
    let as_seen = distances(&measured, &base);
    // No arm misses by a decimetre, and none is right in both frames by chance.
    if as_told > 0.1 && as_seen < 0.1 * as_told {
        let (told, seen) = (as_told * 1e3, as_seen * 1e3);
        return Err(Error::file(
            &commanded.data.path,
            Place::default(),
            format!(
                "commanded points are {told:.0} mm from the measured ones in the robot's frame, \
                 {seen:.2} mm in the tracker's"
            ),
            "give cmd_x_mm, cmd_y_mm, cmd_z_mm as the controller was told, in the robot's frame; \
             what the tracker measured stays in the tracker's",
        ));
    }
    Ok(())
}

/// Where the target was told to be, in the commanded frame, m.
pub fn targets(
    model: &Model,
    commanded: &Commanded,
    markers: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    if !commanded.points.is_empty() {
        return commanded.points.clone();
    }
    let nominal = model.robot.nominal();
    let arms: Vec<_> = markers.iter().map(|m| chain(&nominal, Pose::identity(), *m)).collect();
    let rows = commanded.data.rows.iter();
    rows.map(|row| arms[row.marker].pose(&row.q).translation).collect()
}

/// The commanded frame seen from each station.
///
/// # Errors
/// An unknown station.
pub fn frames(model: &Model, data: &Measurements) -> Result<Vec<Pose<f64>>> {
    let file = data.path.display();
    let small = Pose::from_rotation_vector(model.frame_translation, model.frame_rotation);
    let known = || model.stations.iter().map(|s| format!("\"{}\"", s.0)).collect::<Vec<_>>();
    let frame = |label: &String| {
        let station = model.stations.iter().find(|(l, _)| l == label);
        station.map(|(_, base)| base.compose(&small.inverse())).ok_or_else(|| {
            Error::data(
                ErrorKind::UnknownStation,
                format!(
                    "{file}: station \"{label}\" is unknown to the model, which knows {}",
                    known().join(", ")
                ),
                "a new station has its own frame; --reregister base fits it on this file, which \
                 also takes up to six directions of the error out",
            )
        })
    };
    data.stations.iter().map(frame).collect()
}
