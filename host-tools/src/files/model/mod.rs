mod finite;
mod keys;
mod read;
mod write;

use nalgebra::Vector3;
use truearm::{MdhParameters, Pose};

use crate::units::{from_mm, point_from_mm, point_to_mm, to_mm};
use keys::FrameFile;

/// First line of every model.toml.
const SCHEMA: &str = "truearm-model-1";

/// Angles in degrees, lengths in mm, in the order of [`truearm::LinkParameter::ALL`].
fn to_file(p: &MdhParameters<f64>) -> [f64; 5] {
    let MdhParameters { alpha, a, theta, d, beta } = p;
    [alpha.to_degrees(), to_mm(*a), theta.to_degrees(), to_mm(*d), beta.to_degrees()]
}

fn from_file([alpha, a, theta, d, beta]: [f64; 5]) -> MdhParameters<f64> {
    MdhParameters {
        alpha: alpha.to_radians(),
        a: from_mm(a),
        theta: theta.to_radians(),
        d: from_mm(d),
        beta: beta.to_radians(),
    }
}

/// A small transform of the frame before joint 1, told in the coordinates of
/// the file, which `base` leads from.
fn frame_to_file(translation: &Vector3<f64>, turn: &Vector3<f64>, base: &Pose<f64>) -> FrameFile {
    let (translation, turn) = if *base == Pose::identity() {
        (*translation, *turn)
    } else {
        let moved = Pose::from_rotation_vector(*translation, *turn);
        let told = base.compose(&moved).compose(&base.inverse());
        (told.translation, base.rotation * turn)
    };
    FrameFile {
        xyz_mm: point_to_mm(&translation),
        rotation_vector_deg: [turn.x, turn.y, turn.z].map(f64::to_degrees),
    }
}

/// Translation and rotation vector of the same.
fn frame_from_file(file: &FrameFile, base: &Pose<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let translation = point_from_mm(file.xyz_mm);
    let turn = Vector3::from(file.rotation_vector_deg.map(f64::to_radians));
    if *base == Pose::identity() {
        return (translation, turn);
    }
    let told = Pose::from_rotation_vector(translation, turn);
    let moved = base.inverse().compose(&told).compose(base);
    (moved.translation, base.rotation.tr_mul(&turn))
}
