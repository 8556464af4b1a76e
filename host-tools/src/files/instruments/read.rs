use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Vector3};
use toml::Spanned;
use truearm::Pose;

use super::Gathered;
use super::keys::{InstrumentsFile, MarkerFile, PlateFile, RayFile, SurfaceFile};
use crate::error::Result;
use crate::files::numbers::Numbers;
use crate::files::source::Source;
use crate::model::{Form, Instrument, Placement, Robot};
use crate::observations::{Registry, ray_of};
use crate::units::{from_mm, point_from_mm};

const HELP: &str = "see docs/instruments.md for the keys of this file";
/// The file that stands beside measurements, or beside the robot.
const NAME: &str = "instruments.toml";
/// Farther than any place of a cell, mm.
const FAR: f64 = 1e6;

type Triple = Spanned<Numbers<3>>;

impl Gathered {
    /// Reads an instruments.toml.
    ///
    /// # Errors
    /// As of [`Self::parse`], and what the system says.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path, &crate::files::read(path)?)
    }

    /// What the instruments.toml beside the measurements says, or else the one
    /// beside the robot; nothing where there is none.
    ///
    /// # Errors
    /// Names file, line, key and remedy.
    pub fn beside(data: &Path, robot: &Robot) -> Result<Self> {
        Self::place(data, robot).map_or_else(|| Ok(Self::default()), |file| Self::read(&file))
    }

    /// Which file that is.
    #[must_use]
    pub fn place(data: &Path, robot: &Robot) -> Option<PathBuf> {
        let there = [data, robot.path.as_path()].map(|file| file.with_file_name(NAME));
        there.into_iter().find(|file| file.is_file())
    }

    /// Reads and checks an instruments.toml.
    ///
    /// # Errors
    /// Names file, line, key and remedy.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let source = Source { path, text };
        source.refuse_table()?;
        let mut book = Self::default();
        let file: InstrumentsFile = source.toml(HELP, &mut book.warnings)?;
        let reader = Reader { source };
        reader.once("anchor", &file.anchors, |a| &a.label)?;
        reader.once("surface", &file.surfaces, |s| &s.label)?;
        reader.once("probe", &file.probes, |p| &p.marker)?;
        reader.once("plate", &file.plates, |p| &p.label)?;
        reader.once("camera", &file.cameras, |c| &c.label)?;
        reader.once("ray", &file.rays, |r| &r.marker)?;
        reader.once("marker", &file.markers, |m| &m.marker)?;
        for anchor in &file.anchors {
            reader.anchor(anchor, &mut book)?;
        }
        for surface in &file.surfaces {
            book.list.push(reader.surface(surface.get_ref())?);
        }
        for probe in &file.probes {
            let p = probe.get_ref();
            let radius = reader.radius(&p.radius_mm)?;
            let numbers = vec![radius];
            let probe = Instrument { numbers, ..Instrument::unknown(Form::Probe, &p.marker) };
            book.list.push(stated(probe, Pose::identity(), p.guess));
        }
        for plate in &file.plates {
            reader.plate(plate.get_ref(), &mut book)?;
        }
        for camera in &file.cameras {
            book.list.push(reader.camera(camera.get_ref())?);
            let image = reader.image(camera.get_ref())?;
            book.ranges.push((Form::Camera, camera.get_ref().label.clone(), image));
        }
        for ray in &file.rays {
            reader.ray(ray.get_ref(), &mut book)?;
        }
        for marker in &file.markers {
            reader.marker(marker.get_ref(), &mut book)?;
        }
        if let Some(up) = &file.up {
            let place = Pose { rotation: reader.towards(up)?, ..Pose::identity() };
            book.list.push(stated(Instrument::unknown(Form::Up, ""), place, false));
        }
        Ok(book)
    }
}

/// At a stated place: known, or where the search begins.
pub(super) fn stated(mut instrument: Instrument, place: Pose<f64>, guess: bool) -> Instrument {
    instrument.place = place;
    instrument.stated = true;
    if guess { instrument } else { instrument.known() }
}

pub(super) struct Reader<'a> {
    pub(super) source: Source<'a>,
}

impl Reader<'_> {
    pub(super) fn point(&self, file: &Triple) -> Result<Vector3<f64>> {
        self.finite(file.span(), &**file.get_ref())?;
        Ok(point_from_mm(**file.get_ref()))
    }

    fn radius(&self, file: &Spanned<f64>) -> Result<f64> {
        self.finite(file.span(), &[*file.get_ref()])?;
        if *file.get_ref() < 0.0 {
            let help = "give the radius in mm; 0 of a point";
            return Err(self.source.at(file.span(), "a negative radius", help));
        }
        Ok(from_mm(*file.get_ref()))
    }

    /// A label names one thing: of two tables the rows would mean one.
    fn once<T>(&self, what: &str, all: &[Spanned<T>], label: fn(&T) -> &String) -> Result<()> {
        let mut known: Vec<&String> = Vec::new();
        for table in all {
            let own = label(table.get_ref());
            if known.contains(&own) {
                let message = format!("{what} \"{own}\" is stated twice");
                let help = "give it one table; of a plate all holes in one";
                return Err(self.source.at(table.span(), message, help));
            }
            known.push(own);
        }
        Ok(())
    }

    pub(super) fn finite(&self, span: std::ops::Range<usize>, values: &[f64]) -> Result<()> {
        match values.iter().find(|v| !v.is_finite() || v.abs() > FAR) {
            Some(v) => Err(self.source.at(span, format!("{v}"), "give a number, lengths in mm")),
            None => Ok(()),
        }
    }

    /// A frame whose z points that way.
    fn towards(&self, file: &Triple) -> Result<Matrix3<f64>> {
        self.finite(file.span(), &**file.get_ref())?;
        let way = Vector3::from(**file.get_ref());
        if way.norm() < 1e-9 {
            let help = "give the three components of a direction";
            return Err(self.source.at(file.span(), "a direction of no length", help));
        }
        Ok(along(&way))
    }

    /// `None` where neither key is given.
    pub(super) fn place(
        &self,
        xyz: Option<&Triple>,
        rpy: Option<&Triple>,
    ) -> Result<Option<Pose<f64>>> {
        let mut placement = Placement::default();
        if let Some(xyz) = xyz {
            placement.xyz = self.point(xyz)?;
        }
        if let Some(rpy) = rpy {
            self.finite(rpy.span(), &**rpy.get_ref())?;
            placement.rpy = Vector3::from(rpy.get_ref().map(f64::to_radians));
        }
        Ok((xyz.is_some() || rpy.is_some()).then(|| placement.pose()))
    }

    /// A known place has both its point and its turn; half of one is a guess at most.
    pub(super) fn whole(
        &self,
        label: &str,
        xyz: Option<&Triple>,
        rpy: Option<&Triple>,
        guess: bool,
    ) -> Result<()> {
        let (given, lacks) = match (xyz, rpy) {
            (Some(xyz), None) => (xyz, "rpy_deg"),
            (None, Some(rpy)) => (rpy, "xyz_mm"),
            _ => return Ok(()),
        };
        if guess {
            return Ok(());
        }
        let message = format!("the place of \"{label}\" lacks {lacks}");
        let help = "give xyz_mm and rpy_deg, or guess = true where they are a first guess";
        Err(self.source.at(given.span(), message, help))
    }

    pub(super) fn on_flange(&self, mounted: Option<&Spanned<String>>, usual: bool) -> Result<bool> {
        match mounted.map(|m| (m, m.get_ref().as_str())) {
            None => Ok(usual),
            Some((_, "flange")) => Ok(true),
            Some((_, "fixed")) => Ok(false),
            Some((key, other)) => {
                let help = "write \"flange\" or \"fixed\"";
                Err(self.source.at(key.span(), format!("mounted = \"{other}\""), help))
            }
        }
    }

    fn surface(&self, file: &SurfaceFile) -> Result<Instrument> {
        let form = match file.shape.as_ref().map(|s| (s, s.get_ref().as_str())) {
            None | Some((_, "plane")) => Form::Plane,
            Some((_, "sphere")) => Form::Sphere,
            Some((_, "cylinder")) => Form::Cylinder,
            Some((key, other)) => {
                let help = "write \"plane\", \"sphere\" or \"cylinder\"";
                return Err(self.source.at(key.span(), format!("shape = \"{other}\""), help));
            }
        };
        let mut out = Instrument::unknown(form, &file.label);
        let point = file.point_mm.as_ref().map(|p| self.point(p)).transpose()?;
        let normal = file.normal.as_ref().map(|n| self.towards(n)).transpose()?;
        let turned = form == Form::Sphere || normal.is_some();
        let rotation = normal.unwrap_or_else(Matrix3::identity);
        if let (Some(translation), true) = (point, turned) {
            out = stated(out, Pose { rotation, translation }, file.guess);
        }
        if let (Some(radius), false) = (&file.radius_mm, form.has_lengths()) {
            let help = "leave radius_mm out, or give shape = \"sphere\" or \"cylinder\"";
            return Err(self.source.at(radius.span(), "a plane has no radius", help));
        }
        if let (Some(radius), true) = (&file.radius_mm, form.has_lengths()) {
            // Less than nothing: touched from inside.
            self.finite(radius.span(), &[*radius.get_ref()])?;
            out.numbers[0] = from_mm(*radius.get_ref());
            out.free[6] = file.guess;
        }
        Ok(out)
    }

    fn plate(&self, file: &PlateFile, book: &mut Gathered) -> Result<()> {
        let mut plate = Instrument::unknown(Form::Plate, &file.label);
        plate.on_flange = self.on_flange(file.mounted.as_ref(), false)?;
        if let Some(place) = self.place(file.xyz_mm.as_ref(), file.rpy_deg.as_ref())? {
            self.whole(&file.label, file.xyz_mm.as_ref(), file.rpy_deg.as_ref(), file.guess)?;
            plate = stated(plate, place, file.guess);
        }
        book.list.push(plate);
        for (label, hole) in &file.holes {
            book.holes.insert((file.label.clone(), label.clone()), self.point(hole)?);
        }
        Ok(())
    }

    fn ray(&self, file: &RayFile, book: &mut Gathered) -> Result<()> {
        let rotation = self.towards(&file.direction)?;
        let label = ray_of(&file.marker);
        let mut ray = Instrument::unknown(Form::Turn, &label);
        ray.free[2] = false;
        book.list.push(stated(ray, Pose { rotation, ..Pose::identity() }, file.guess));
        let reach = self.reach(file.reach_mm.as_ref())?;
        book.ranges.extend(reach.map(|reach| (Form::Turn, label.clone(), reach)));
        book.markers.push((label, self.point(&file.origin_mm)?, file.guess));
        Ok(())
    }

    fn marker(&self, file: &MarkerFile, book: &mut Gathered) -> Result<()> {
        let xyz = file.xyz_mm.as_ref().map(|xyz| self.point(xyz)).transpose()?;
        let place = self.place(None, file.rpy_deg.as_ref())?;
        let ray = ray_of(&file.marker);
        // A marker of a name of its own may be a ray that no [[rays]] states.
        let also = !file.marker.is_empty() && book.known(Form::Turn, &ray).is_none();
        for label in std::iter::once(file.marker.clone()).chain(also.then_some(ray.clone())) {
            book.markers.extend(xyz.map(|xyz| (label.clone(), xyz, file.guess)));
            book.list.extend(place.map(|place| {
                let mut turn = Instrument::unknown(Form::Turn, &label);
                // A ray is as it is however it turns about itself.
                turn.free[2] = label != ray;
                stated(turn, place, file.guess)
            }));
        }
        Ok(())
    }
}

/// A rotation whose z points that way.
pub fn along(way: &Vector3<f64>) -> Matrix3<f64> {
    let z = way.normalize();
    // From the axis that is least like it.
    let least = z.iamin();
    let x = Vector3::ith(least, 1.0).cross(&z).normalize();
    Matrix3::from_columns(&[x, z.cross(&x), z])
}
