use std::path::Path;

use nalgebra::{DMatrix, Quaternion, UnitQuaternion};
use toml::Spanned;
use truearm::Pose;

use super::finite::unlike_a_number;
use super::keys::{CorrectionFile, GramFile, InstrumentFile, ModelPart, StationFile};
use super::{SCHEMA, frame_from_file, from_file};
use crate::error::{Error, Result};
use crate::files::covariance::CovarianceFile;
use crate::files::digest::digest;
use crate::files::identified::is_identified;
use crate::files::source::Source;
use crate::files::{model_curves, model_terms};
use crate::model::{ErrorCurve, Form, GramState, Instrument, Model, ModelTerm, Robot};
use crate::units::{from_mm, point_from_mm};

/// Degrees or mm that no joint covers, and none is corrected by.
const FAR: f64 = 1e6;
const HELP: &str = "give a model.toml as written by `truearm identify`";

impl Model {
    /// Reads a model.toml.
    ///
    /// # Errors
    /// Names file, line and remedy.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path, &crate::files::read(path)?)
    }

    /// Reads the text of a model.toml; `path` is for messages.
    ///
    /// # Errors
    /// As for [`read`](Self::read).
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let mut robot = Robot::parse(path, text)?;
        robot.warnings.clear();
        let source = Source { path, text };
        let table: toml::Table = text.parse().unwrap_or_default();
        if !table.contains_key("schema") {
            let what = match is_identified(text) {
                true => "a model without its key `schema`",
                false => "a robot as it was drawn, no identified model",
            };
            return Err(source.whole(what, HELP));
        }
        if let Some((key, value)) = unlike_a_number(&table) {
            return Err(source.whole(format!("{key} is {value}"), "give a finite number"));
        }
        let part: ModelPart = source.toml(HELP, &mut Vec::new())?;
        Part { source, robot: &robot }.check(&part)?;
        let base = robot.base.pose();
        let (frame_translation, frame_rotation) = frame_from_file(&part.frame, &base);
        let reader = Part { source, robot: &robot };
        let not_measured = part.markers.iter().filter(|m| !m.measured);
        Ok(Self {
            corrections: part.corrections.iter().map(|c| correction(c.get_ref())).collect(),
            uncertainties: part.corrections.iter().filter_map(|c| sigma(c.get_ref())).collect(),
            covered: part.corrections.iter().map(|c| covered(c.get_ref())).collect(),
            orientation_identified: part.orientation_identified,
            robot_id: part.robot_id.as_ref().map(|id| reader.robot_id(id)).transpose()?,
            changed: part.digest != digest(text),
            gram: part.gram.as_ref().map(|g| reader.gram(g)).transpose()?,
            covariance: part.covariance.as_ref().map(|file| reader.covariance(file)).transpose()?,
            terms: reader.terms(&part)?,
            curves: reader.curves(&part)?,
            stations: part
                .stations
                .iter()
                .map(|s| reader.station(s, &base))
                .collect::<Result<_>>()?,
            markers: part
                .markers
                .iter()
                .map(|m| (m.label.clone(), point_from_mm(m.xyz_mm)))
                .collect(),
            not_measured: not_measured.map(|m| m.label.clone()).collect(),
            instruments: part
                .instruments
                .iter()
                .map(|i| reader.instrument(i))
                .collect::<Result<_>>()?,
            frame_translation,
            frame_rotation,
            provenance: part.provenance,
            unidentifiable: part.unidentifiable,
            robot,
        })
    }
}

fn correction(c: &CorrectionFile) -> truearm::MdhParameters<f64> {
    from_file(c.numbers())
}

fn sigma(c: &CorrectionFile) -> Option<truearm::MdhParameters<f64>> {
    let s = c.sigma.as_ref()?;
    Some(from_file([s.alpha_deg, s.a_mm, s.theta_offset_deg, s.d_mm, s.beta_deg]))
}

fn covered(c: &CorrectionFile) -> Option<[f64; 2]> {
    let degrees = c.covered_deg.map(|range| range.map(f64::to_radians));
    degrees.or(c.covered_mm.map(|range| range.map(from_mm)))
}

/// What is read on top of the robot.
struct Part<'a> {
    source: Source<'a>,
    robot: &'a Robot,
}

impl Part<'_> {
    fn fail(&self, message: String) -> Error {
        self.source.whole(message, HELP)
    }

    fn covariance(&self, file: &Spanned<CovarianceFile>) -> Result<Vec<f32>> {
        file.get_ref().factor().map_err(|e| self.source.at(file.span(), e, HELP))
    }

    /// The state of an identification by parts.
    fn gram(&self, file: &Spanned<GramFile>) -> Result<GramState> {
        let GramFile { stage, settled, step_tolerances, k, weights, flagged, targets_mm } =
            file.get_ref();
        if !(*k >= 1.0 && *weights > 0.0) {
            let message = format!("[gram] k = {k} and weights = {weights}: 1 and 0 at least");
            return Err(self.source.at(
                file.span(),
                message,
                "give it as `truearm gram step` wrote it",
            ));
        }
        let targets = targets_mm.iter().map(|place| point_from_mm(*place)).collect();
        let (stage, settled, step, k) = (*stage, *settled, *step_tolerances, *k);
        Ok(GramState { stage, settled, step, k, weights: *weights, flagged: *flagged, targets })
    }

    /// Whether the parts of the file belong together.
    fn check(&self, part: &ModelPart) -> Result<()> {
        if part.schema.get_ref() != SCHEMA {
            let message = format!("schema {} where {SCHEMA} is read", part.schema.get_ref());
            return Err(self.source.at(part.schema.span(), message, HELP));
        }
        let n = self.robot.joints.len();
        let numbered = part.corrections.iter().enumerate().all(|(i, c)| c.get_ref().joint == i + 1);
        if part.corrections.len() != n || !numbered {
            let message = format!("[[corrections]] do not match the {n} joints in order");
            return Err(self.fail(message));
        }
        for c in &part.corrections {
            if let Some(far) = c.get_ref().numbers().into_iter().find(|x| x.abs() > FAR) {
                let message = format!("joint {} corrected by {far:e}", c.get_ref().joint);
                return Err(self.source.at(c.span(), message, HELP));
            }
            let covered = c.get_ref().covered_deg.or(c.get_ref().covered_mm);
            if let Some([low, high]) =
                covered.filter(|[low, high]| !(-FAR..=*high).contains(low) || *high > FAR)
            {
                let message =
                    format!("joint {} covered from {low:?} to {high:?}", c.get_ref().joint);
                return Err(self.source.at(c.span(), message, HELP));
            }
        }
        let known = part.corrections.iter().filter(|c| c.get_ref().sigma.is_some()).count();
        if ![0, n].contains(&known) {
            return Err(self.fail("some corrections have a sigma and some have none".to_owned()));
        }
        if part.markers.is_empty() {
            return Err(self.fail("a model needs a marker".to_owned()));
        }
        Ok(())
    }

    fn robot_id(&self, id: &Spanned<String>) -> Result<u64> {
        let digits = id.get_ref().strip_prefix("0x");
        digits.and_then(|digits| u64::from_str_radix(digits, 16).ok()).ok_or_else(|| {
            let message = format!("robot_id \"{}\" is not 0x and 16 hex digits", id.get_ref());
            self.source.at(id.span(), message, HELP)
        })
    }

    /// The frame before joint 1 as a station sees it.
    fn station(&self, s: &Spanned<StationFile>, base: &Pose<f64>) -> Result<(String, Pose<f64>)> {
        let StationFile { label, xyz_mm, quaternion_xyzw } = s.get_ref();
        let pose = self.pose(xyz_mm, quaternion_xyzw).ok_or_else(|| {
            let message = format!("station \"{label}\": not a unit quaternion");
            self.source.at(s.span(), message, HELP)
        })?;
        let pose = if *base == Pose::identity() { pose } else { pose.compose(base) };
        Ok((label.clone(), pose))
    }

    /// `None` if the quaternion is not one of a rotation.
    fn pose(&self, xyz_mm: &[f64; 3], [x, y, z, w]: &[f64; 4]) -> Option<Pose<f64>> {
        let q = Quaternion::new(*w, *x, *y, *z);
        let rotation = UnitQuaternion::new_normalize(q).to_rotation_matrix().into_inner();
        let unit = (q.norm() - 1.0).abs() <= 1e-6;
        unit.then_some(Pose { rotation, translation: point_from_mm(*xyz_mm) })
    }

    /// What was measured with and on, as it was found.
    fn instrument(&self, file: &Spanned<InstrumentFile>) -> Result<Instrument> {
        let InstrumentFile { form, label, on_flange, xyz_mm, quaternion_xyzw, numbers, covariance } =
            file.get_ref();
        let known = Form::ALL.into_iter().find(|f| f.name() == form);
        let pose = self.pose(xyz_mm, quaternion_xyzw);
        let (Some(form), Some(place)) = (known, pose) else {
            let message = format!("{form} \"{label}\": not a form, or no unit quaternion");
            return Err(self.source.at(file.span(), message, HELP));
        };
        if numbers.len() != form.numbers().len() {
            let message = format!("{} numbers of a {}", numbers.len(), form.name());
            return Err(self.source.at(file.span(), message, HELP));
        }
        let number = |value: &f64| if form.has_lengths() { from_mm(*value) } else { *value };
        let numbers = numbers.iter().map(number).collect();
        let unknown = Instrument::unknown(form, label);
        let spread = factor(covariance, unknown.free.len()).ok_or_else(|| {
            let message = format!("{} \"{label}\": covariance is no triangle", form.name());
            self.source.at(file.span(), message, HELP)
        })?;
        let on_flange = *on_flange;
        let found = Instrument { place, numbers, on_flange, stated: true, spread, ..unknown };
        Ok(found.known())
    }

    /// By joint, whatever their order in the file.
    fn curves(&self, part: &ModelPart) -> Result<Vec<ErrorCurve>> {
        let kinds: Vec<_> = self.robot.joints.iter().map(|j| j.link.kind).collect();
        let mut curves = Vec::new();
        for (i, curve) in part.curves.iter().enumerate() {
            let read = model_curves::curve(curve.get_ref(), &kinds, &curves);
            curves.push(read.map_err(|e| {
                self.source.at(curve.span(), format!("[[curves]] entry {}: {e}", i + 1), HELP)
            })?);
        }
        curves.sort_by_key(ErrorCurve::joint);
        Ok(curves)
    }

    /// Those of the arm, then those of the measurement.
    fn terms(&self, part: &ModelPart) -> Result<Vec<ModelTerm>> {
        let kinds: Vec<_> = self.robot.joints.iter().map(|j| j.link.kind).collect();
        let mut terms = Vec::new();
        for (i, term) in part.terms.iter().enumerate() {
            let read = model_terms::arm_term(term.get_ref(), &kinds);
            let read = read.and_then(|read| one_time_constant(&terms, read));
            terms.push(read.map_err(|e| {
                self.source.at(term.span(), format!("[[terms]] entry {}: {e}", i + 1), HELP)
            })?);
        }
        for (i, term) in part.measurement_terms.iter().enumerate() {
            let read = model_terms::measurement_term(term.get_ref(), &kinds);
            terms.push(read.map_err(|e| {
                let message = format!("[[measurement_terms]] entry {}: {e}", i + 1);
                self.source.at(term.span(), message, HELP)
            })?);
        }
        Ok(terms)
    }
}

impl Model {
    /// Reads a model.toml, or a robot.toml as an arm without any correction.
    ///
    /// # Errors
    /// As for [`Model::read`] and [`Robot::read`].
    pub fn read_or_nominal(path: &Path) -> Result<Self> {
        let text = crate::files::read(path)?;
        let keys = text.parse::<toml::Table>().unwrap_or_default();
        if ["schema", "corrections"].iter().any(|key| keys.contains_key(*key)) {
            return Self::read(path);
        }
        Ok(Self::nominal(Robot::parse(path, &text)?))
    }
}

/// A term, unless it follows the temperature otherwise than those before it: a controller's
/// state holds one temperature.
fn one_time_constant(
    before: &[ModelTerm],
    term: ModelTerm,
) -> std::result::Result<ModelTerm, String> {
    let of_warmth = |t: &&ModelTerm| matches!(t, ModelTerm::Arm(t) if t.effect.needs_warmth());
    let other = before.iter().find(of_warmth).filter(|_| of_warmth(&&term));
    match other.filter(|other| other.time_constant() != term.time_constant()) {
        Some(_) => Err(format!("all of {} have one time_constant_s", term.effect_name())),
        None => Ok(term),
    }
}

/// A lower triangle of so many columns, or of none; `None` of anything else.
fn factor(columns: &[Vec<f64>], count: usize) -> Option<DMatrix<f64>> {
    let complete = columns.len() == count && (0..count).all(|j| columns[j].len() == count - j);
    let at = |i: usize, j: usize| if i < j { 0.0 } else { columns[j][i - j] };
    match columns.is_empty() {
        true => Some(DMatrix::zeros(0, 0)),
        false => complete.then(|| DMatrix::from_fn(count, count, at)),
    }
}
