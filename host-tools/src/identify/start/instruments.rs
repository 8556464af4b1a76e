//! First guesses of what rows refer to, where the arm stands as it is known so
//! far: linear fits, a form each.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Unit, Vector3};
use truearm::Pose;

use super::rigid::rigid_transform;
use crate::identify::problem::State;
use crate::model::{Form, Instrument, Measurements, Row};
use crate::observations::kind;
use crate::observations::pixel::project;

/// A state with a first guess of every instrument that nothing is stated of.
#[must_use]
pub fn instruments(data: &Measurements, mut state: State) -> State {
    // What is mounted on the arm first: where it looks, planes are, and where up is.
    let mut order: Vec<usize> = (0..state.instruments.len()).collect();
    order.sort_by_key(|index| state.instruments[*index].form != Form::Turn);
    for index in order {
        if state.instruments[index].stated {
            continue;
        }
        let sights = sights(data, &state, index);
        if let Some(guess) = guess(&state.instruments[index], &sights) {
            state.instruments[index] = guess;
        }
    }
    state
}

/// A row that refers to an instrument, where the arm then stands.
struct Sight<'a> {
    row: &'a Row,
    /// The marker in the station's frame, m, and how the last frame is turned.
    at: Pose<f64>,
    /// The origin of the last frame, m.
    flange: Vector3<f64>,
    /// The axes of what is mounted on it, if anything is.
    axes: Option<Matrix3<f64>>,
    /// The camera that sees it.
    camera: Option<&'a Instrument>,
    /// Which way is up, where that is stated.
    up: Option<Vector3<f64>>,
}

impl Sight<'_> {
    /// Where its ray goes, if it has one.
    fn ray(&self) -> Option<Vector3<f64>> {
        self.axes.map(|axes| axes.column(2).into_owned())
    }

    /// The line of sight of a corner as the board's mounting sees it: the corner,
    /// the camera, and which way.
    fn line(&self, on_flange: bool) -> Option<[Vector3<f64>; 3]> {
        let (camera, (corner, seen)) = (self.camera?, kind(self.row).corner(self.row)?);
        let mut point = Vector3::z();
        for _ in 0..20 {
            let at = project(camera, &point).at;
            point.x += (seen[0] - at[0]) / (camera.numbers[0] * 1e3);
            point.y += (seen[1] - at[1]) / (camera.numbers[1] * 1e3);
        }
        let flange = Pose { translation: self.flange, ..self.at };
        let there = if camera.on_flange { flange.compose(&camera.place) } else { camera.place };
        let there = if on_flange { flange.inverse().compose(&there) } else { there };
        Some([corner, there.translation, (there.rotation * point).normalize()])
    }
}

fn sights<'a>(data: &'a Measurements, state: &'a State, index: usize) -> Vec<Sight<'a>> {
    let of = |row: &'a Row| {
        let at = state.chain(row.station, row.marker).pose(&row.q);
        let mut mounted = row.refers.iter().map(|i| &state.instruments[*i]);
        let turn = mounted.find(|i| i.form == Form::Turn);
        let axes = turn.map(|turn| at.rotation * turn.place.rotation);
        let flange = at.translation - at.rotation * state.markers[row.marker];
        let mut seen = row.refers.iter().map(|i| &state.instruments[*i]);
        let camera = seen.find(|i| i.form == Form::Camera);
        let stated = row.refers.iter().map(|i| &state.instruments[*i]);
        let up = stated.filter(|i| i.form == Form::Up && i.stated);
        let up = up.map(|up| up.place.rotation.column(2).into_owned()).next();
        Sight { row, at, flange, axes, camera, up }
    };
    data.rows.iter().filter(|row| row.refers.contains(&index)).map(of).collect()
}

fn guess(instrument: &Instrument, sights: &[Sight]) -> Option<Instrument> {
    match instrument.form {
        Form::Turn => turn(sights)
            .or_else(|| level(sights))
            .map(|place| Instrument { place, ..instrument.clone() }),
        Form::Anchor => anchor(sights).map(|point| at(instrument, point, Matrix3::identity())),
        Form::Plane => plane(sights).map(|(point, turn)| at(instrument, point, turn)),
        Form::Sphere => {
            let points: Vec<_> = sights.iter().map(|s| s.at.translation).collect();
            let (centre, radius, _) = round(&points, &DMatrix::identity(3, 3))?;
            let sphere =
                at(instrument, Vector3::from_iterator(centre.iter().copied()), Matrix3::identity());
            Some(of_radius(sphere, radius, sights, |v| v))
        }
        Form::Cylinder => cylinder(instrument, sights),
        Form::Plate => {
            let hole = |s: &Sight| Some((kind(s.row).hole(s.row)?, s.at.translation));
            let (mut holes, mut points): (Vec<_>, Vec<_>) = sights.iter().filter_map(hole).unzip();
            if holes.is_empty() {
                (holes, points) = corners(sights, instrument.on_flange).into_iter().unzip();
            }
            let place = rigid_transform(&holes, &points, &vec![1.0; holes.len()])?;
            Some(Instrument { place, ..instrument.clone() })
        }
        Form::Up => up(sights).map(|turn| at(instrument, Vector3::zeros(), turn)),
        Form::Camera | Form::Probe | Form::Zero => None,
    }
}

fn at(instrument: &Instrument, translation: Vector3<f64>, rotation: Matrix3<f64>) -> Instrument {
    Instrument { place: Pose { rotation, translation }, ..instrument.clone() }
}

/// The mean of measured orientations in the last frame.
fn turn(sights: &[Sight]) -> Option<Pose<f64>> {
    let measured = sights.iter().filter_map(|s| Some((s, kind(s.row).turn(s.row)?)));
    let sum: Matrix3<f64> = measured.map(|(s, turn)| s.at.rotation.transpose() * turn).sum();
    let rotation = nearest_rotation(&sum)?;
    Some(Pose { rotation, translation: Vector3::zeros() })
}

fn nearest_rotation(of: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let svd = of.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut sign = Matrix3::identity();
    sign[(2, 2)] = (u * v_t).determinant().signum();
    (of.norm() > 0.0).then(|| u * sign * v_t)
}

/// How a level sits on the last frame, whatever its turn: the sine of what its axis s leans
/// by is `s' R' u`, linear in the products of s and up, u. Both reversed read the same; up
/// is then where the station's z points.
fn level(sights: &[Sight]) -> Option<Pose<f64>> {
    /// A direction that leans this much less than the best seen is not seen.
    const SEEN: f64 = 1e-3;
    let leaning: Vec<_> =
        sights.iter().filter_map(|s| Some((s, kind(s.row).lean(s.row)?))).collect();
    let sines = DMatrix::from_fn(leaning.len(), 2, |k, c| leaning[k].1[c].sin());
    let solved = |a: DMatrix<f64>| {
        let unknowns = a.ncols();
        let svd = a.svd(true, true);
        let seen = svd.rank(SEEN * svd.singular_values.max()) == unknowns;
        seen.then(|| svd.solve(&sines, 0.0).ok()).flatten()
    };
    let stated = leaning.first()?.0.up;
    let axes: [Vector3<f64>; 2] = match stated {
        Some(up) => {
            let seen = |k: usize| leaning[k].0.at.rotation.tr_mul(&up);
            let found = solved(DMatrix::from_fn(leaning.len(), 3, |k, c| seen(k)[c]))?;
            [0, 1].map(|c| found.fixed_view::<3, 1>(0, c).into_owned())
        }
        None => {
            let turn = |k: usize| leaning[k].0.at.rotation;
            let found = solved(DMatrix::from_fn(leaning.len(), 9, |k, c| turn(k)[(c / 3, c % 3)]))?;
            let products = DMatrix::from_fn(3, 6, |i, j| found[(3 * i + j % 3, j / 3)]);
            let svd = products.svd(true, true);
            let (first, v_t) = (svd.singular_values.imax(), svd.v_t?);
            let up = svd.u?.column(first)[2].signum();
            [0, 3].map(|c| v_t.fixed_view::<1, 3>(first, c).transpose() * up)
        }
    };
    let [x, y] = axes;
    let rotation = nearest_rotation(&Matrix3::from_columns(&[x, y, x.cross(&y)]))?;
    Some(Pose { rotation, translation: Vector3::zeros() })
}

/// Where up is by how far axes lean from the level: a sine is linear in it.
fn up(sights: &[Sight]) -> Option<Matrix3<f64>> {
    let leaning = |s: &Sight| Some((s.axes?, kind(s.row).lean(s.row)?));
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (axes, lean) in sights.iter().filter_map(leaning) {
        for (c, angle) in lean.into_iter().enumerate() {
            let axis = axes.column(c);
            normal += axis * axis.transpose();
            right += axis * angle.sin();
        }
    }
    let up = normal.cholesky()?.solve(&right).try_normalize(1e-9)?;
    // Any frame whose z it is.
    let aside = Vector3::ith(up.iamin(), 1.0).cross(&up).normalize();
    Some(Matrix3::from_columns(&[aside, up.cross(&aside), up]))
}

/// The point that is so far from the targets: of `|p - a|^2 = d^2`, linear in a
/// and its square. Of targets that are all there, their mean; of too few, one of those that
/// are as far off, aside: from between the targets no step leads there.
fn anchor(sights: &[Sight]) -> Option<Vector3<f64>> {
    let far: Vec<_> =
        sights.iter().filter_map(|s| Some((s, kind(s.row).distance(s.row)?))).collect();
    let mean = sights.iter().map(|s| s.at.translation).sum::<Vector3<f64>>() / sights.len() as f64;
    let p = |k: usize| far[k].0.at.translation - mean;
    if far.len() < 4 {
        let square = |k: usize| far[k].1.powi(2) - p(k).norm_squared();
        let aside = (0..far.len()).map(square).sum::<f64>().max(0.0) / far.len().max(1) as f64;
        let spread: Matrix3<f64> = (0..far.len()).map(|k| p(k) * p(k).transpose()).sum();
        let eigen = spread.symmetric_eigen();
        let way = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
        return (!sights.is_empty()).then_some(mean + way * aside.sqrt());
    }
    let a = DMatrix::from_fn(far.len(), 4, |k, c| if c < 3 { 2.0 * p(k)[c] } else { -1.0 });
    let b = DVector::from_fn(far.len(), |k, _| p(k).norm_squared() - far[k].1.powi(2));
    let found = a.svd(true, true).solve(&b, 1e-9).ok()?;
    Some(mean + Vector3::new(found[0], found[1], found[2]))
}

/// Where rays end, or targets are; z to where the last frame is.
fn plane(sights: &[Sight]) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let end = |s: &Sight| {
        let range = s.ray().zip(kind(s.row).distance(s.row));
        s.at.translation + range.map_or_else(Vector3::zeros, |(way, range)| way * range)
    };
    let points: Vec<_> = sights.iter().map(end).collect();
    let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let spread: Matrix3<f64> = points.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
    let eigen = spread.symmetric_eigen();
    let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    let back: f64 = sights.iter().zip(&points).map(|(s, p)| (s.flange - p).dot(&normal)).sum();
    (points.len() >= 3).then(|| (middle, frame_along(&(normal * back.signum()))))
}

/// Corners of a board and where the lines of sight of each come nearest to each
/// other.
fn corners(sights: &[Sight], on_flange: bool) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let mut sums: Vec<(Vector3<f64>, Matrix3<f64>, Vector3<f64>)> = Vec::new();
    for [corner, eye, way] in sights.iter().filter_map(|s| s.line(on_flange)) {
        let across = Matrix3::identity() - way * way.transpose();
        let place = sums.iter().position(|(known, ..)| *known == corner).unwrap_or_else(|| {
            sums.push((corner, Matrix3::zeros(), Vector3::zeros()));
            sums.len() - 1
        });
        sums[place].1 += across;
        sums[place].2 += across * eye;
    }
    let nearest = |(corner, a, b): (Vector3<f64>, Matrix3<f64>, Vector3<f64>)| {
        let inverse = a.try_inverse().filter(|_| a.determinant() > 1e-6)?;
        Some((corner, inverse * b))
    };
    sums.into_iter().filter_map(nearest).collect()
}

/// A rotation whose z points that way.
fn frame_along(way: &Vector3<f64>) -> Matrix3<f64> {
    let turn = Rotation3::rotation_between(&Vector3::z(), way);
    let half =
        || Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::x()), std::f64::consts::PI);
    turn.unwrap_or_else(half).into_inner()
}

/// Centre and radius of points on a sphere, or on a circle once they are seen
/// along an axis (`axes`: 3 x 3 or 3 x 2), and how far off the worst is.
fn round(points: &[Vector3<f64>], axes: &DMatrix<f64>) -> Option<(DVector<f64>, f64, f64)> {
    let flat: Vec<DVector<f64>> = points.iter().map(|p| axes.tr_mul(p)).collect();
    let size = axes.ncols();
    let column = |k: usize, c: usize| if c < size { 2.0 * flat[k][c] } else { 1.0 };
    let a = DMatrix::from_fn(flat.len(), size + 1, column);
    let b = DVector::from_fn(flat.len(), |k, _| flat[k].norm_squared());
    let found = a.svd(true, true).solve(&b, 1e-12).ok()?;
    let centre = found.rows(0, size).into_owned();
    let radius = (found[size] + centre.norm_squared()).max(0.0).sqrt();
    let off = |p: &DVector<f64>| ((p - &centre).norm() - radius).powi(2);
    let miss = flat.iter().map(off).sum::<f64>();
    (flat.len() > size).then_some((centre, radius, miss))
}

/// With the radius that was found, unless it is known: less than nothing where
/// the arm touches from inside.
fn of_radius(
    mut found: Instrument,
    radius: f64,
    sights: &[Sight],
    seen: impl Fn(Vector3<f64>) -> Vector3<f64>,
) -> Instrument {
    let far = |p: &Vector3<f64>| seen(p - found.place.translation).norm();
    let out: f64 = sights.iter().map(|s| far(&s.flange) - far(&s.at.translation)).sum();
    if found.free[6] {
        found.numbers[0] = radius * out.signum();
    }
    found
}

/// The best of many directions of the axis.
fn cylinder(instrument: &Instrument, sights: &[Sight]) -> Option<Instrument> {
    const DIRECTIONS: usize = 500;
    let points: Vec<_> = sights.iter().map(|s| s.at.translation).collect();
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let fit = |k: usize| {
        let z = (k as f64 + 0.5) / DIRECTIONS as f64;
        let (flat, turn) = ((1.0 - z * z).sqrt(), golden * k as f64);
        let frame = frame_along(&Vector3::new(flat * turn.cos(), flat * turn.sin(), z));
        let axes = DMatrix::from_column_slice(3, 2, &frame.as_slice()[..6]);
        let (centre, radius, miss) = round(&points, &axes)?;
        Some((miss, frame, axes * centre, radius))
    };
    let best = (0..DIRECTIONS).filter_map(fit).min_by(|a, b| a.0.total_cmp(&b.0));
    let (_, frame, centre, radius) = best?;
    let axis = frame.column(2).into_owned();
    let middle = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let centre = Vector3::new(centre[0], centre[1], centre[2]) + axis * axis.dot(&middle);
    let found = at(instrument, centre, frame);
    Some(of_radius(found, radius, sights, |v| v - axis * axis.dot(&v)))
}
