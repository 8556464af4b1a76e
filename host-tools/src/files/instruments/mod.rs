//! What rows refer to beside the arm, as it is gathered from instruments.toml
//! and from the labels of the rows.

mod anchors;
mod keys;
mod read;
mod sight;

use std::collections::HashMap;

use nalgebra::Vector3;
use truearm::Pose;

use crate::model::{Form, Instrument, Measurements, Placement, Robot};
use crate::observations::Registry;

/// What is known so far: of an instruments.toml, and of what rows refer to.
#[derive(Debug, Clone, Default)]
pub struct Gathered {
    /// Instruments, stated ones first.
    pub list: Vec<Instrument>,
    /// Coordinates of holes, balls and corners by plate and label, m.
    pub holes: HashMap<(String, String), Vector3<f64>>,
    /// Markers whose place in the last frame is stated, m, and whether it is
    /// only a guess.
    pub markers: Vec<(String, Vector3<f64>, bool)>,
    /// What an instrument can measure, for planning: of an anchor or a ray the
    /// shortest and the longest length, m; of a camera width and height of its image, px.
    pub ranges: Vec<(Form, String, [f64; 2])>,
    /// Remarks for the user.
    pub warnings: Vec<String>,
}

impl Gathered {
    /// Instruments of these forms.
    pub fn of<'a>(&'a self, forms: &'a [Form]) -> impl Iterator<Item = &'a Instrument> {
        self.list.iter().filter(|i| forms.contains(&i.form))
    }

    /// What an instrument can measure, where it is stated; see [`Self::ranges`].
    #[must_use]
    pub fn range_of(&self, form: Form, label: &str) -> Option<[f64; 2]> {
        let stated = self.ranges.iter().find(|(f, l, _)| *f == form && l == label);
        stated.map(|(.., range)| *range)
    }

    /// Where the marker of a label sits in the last frame, m, where that is stated.
    #[must_use]
    pub fn marker(&self, label: &str) -> Option<Vector3<f64>> {
        self.markers.iter().find(|(l, ..)| l == label).map(|(_, place, _)| *place)
    }

    /// The holes, balls or corners of a plate, by label, and where they are in its frame, m.
    #[must_use]
    pub fn holes_of(&self, plate: &str) -> Vec<(String, Vector3<f64>)> {
        let own = self.holes.iter().filter(|((of, _), _)| of == plate);
        let mut all: Vec<_> = own.map(|((_, hole), at)| (hole.clone(), *at)).collect();
        all.sort_by(|a, b| a.0.cmp(&b.0));
        all
    }

    /// Takes over what was found of places and numbers that are not stated.
    pub fn known_to(&mut self, found: &[Instrument]) {
        for own in found {
            let same = |i: &&mut Instrument| (i.form, &i.label) == (own.form, &own.label);
            match self.list.iter_mut().find(same) {
                Some(stated) if stated.unknowns().is_empty() => {}
                Some(open) => *open = own.clone(),
                None => self.list.push(own.clone()),
            }
        }
    }

    /// Hands over to the rows that were read with it. Markers sit as the tool
    /// does until something says otherwise; what no row refers to is left out.
    pub fn hand_over(self, data: &mut Measurements, robot: &Robot) {
        let tool = Placement { xyz: Vector3::zeros(), rpy: robot.tool_rpy }.pose();
        let places = |guessed: bool| {
            let place = |label: &String| {
                let stated =
                    self.markers.iter().find(|(l, _, guess)| l == label && *guess == guessed);
                stated.map(|(_, place, _)| *place)
            };
            data.markers.iter().map(place).collect()
        };
        (data.known_markers, data.guessed_markers) = (places(false), places(true));
        let mut places = vec![None; self.list.len()];
        for row in &mut data.rows {
            for refer in &mut row.refers {
                let next = data.instruments.len();
                let place = *places[*refer].get_or_insert(next);
                if place == next {
                    data.instruments.push(self.list[*refer].clone());
                }
                *refer = place;
            }
        }
        for instrument in data.instruments.iter_mut().filter(|i| !i.stated) {
            if instrument.form == Form::Turn {
                instrument.place = Pose { translation: Vector3::zeros(), ..tool };
            }
        }
        for (stated, _) in self.list.iter().zip(&places).filter(|(_, used)| used.is_none()) {
            let is_surface = |form| matches!(form, Form::Plane | Form::Sphere | Form::Cylinder);
            let like = |other: &&Instrument| {
                let same =
                    other.form == stated.form || is_surface(other.form) && is_surface(stated.form);
                let label = plain(&stated.label);
                same && !other.stated && !label.is_empty() && plain(&other.label) == label
            };
            if let Some(used) = data.instruments.iter().find(like) {
                data.warnings.push(format!(
                    "instruments.toml states {} \"{}\", which no row refers to, and nothing of {} \
                     \"{}\", which rows do: if they are one, write both labels alike",
                    stated.form.name(),
                    stated.label,
                    used.form.name(),
                    used.label
                ));
            }
        }
        data.warnings.extend(self.warnings);
    }
}

/// What a label is without regard to case and separators.
fn plain(label: &str) -> String {
    label.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

impl Registry for Gathered {
    fn instrument(&mut self, forms: &[Form], label: &str) -> usize {
        forms.iter().find_map(|form| self.known(*form, label)).unwrap_or_else(|| {
            self.list.push(Instrument::unknown(forms[0], label));
            self.list.len() - 1
        })
    }

    fn known(&self, form: Form, label: &str) -> Option<usize> {
        self.list.iter().position(|i| i.form == form && i.label == label)
    }

    fn hole(&self, plate: &str, hole: &str) -> Option<Vector3<f64>> {
        self.holes.get(&(plate.to_owned(), hole.to_owned())).copied()
    }

    fn without(&mut self, instrument: usize, unneeded: &[usize]) {
        unneeded.iter().for_each(|k| self.list[instrument].free[*k] = false);
    }
}
