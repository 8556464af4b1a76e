use std::path::Path;

use truearm::JointKind;

use super::columns::{label, refuse_twins};
use super::instruments::Gathered;
use super::pieces::{Columnar, is_columnar};
use crate::error::{Result, listed};
use crate::model::near::{Reach, one_pose};
use crate::model::{Measurements, Robot, number_runs};
use crate::observations::refer_to_zeros;

impl Measurements {
    /// Reads and checks the measurements of `robot`.
    ///
    /// # Errors
    /// Names file, line, column and remedy.
    pub fn read(path: &Path, robot: &Robot) -> Result<Self> {
        if is_columnar(path)? {
            let book = Gathered::beside(path, robot)?;
            return Ok(Columnar::open(path)?.whole(robot, book)?.completed(robot));
        }
        Self::of_file(path, &super::read(path)?, robot)
    }

    /// The same of a file whose text is known; what is said of instruments stands beside it.
    ///
    /// # Errors
    /// As for [`Measurements::read`].
    pub fn of_file(path: &Path, text: &str, robot: &Robot) -> Result<Self> {
        Self::parsed(path, text, robot, Gathered::beside(path, robot)?)
    }

    /// Like [`Measurements::read`] from a text.
    ///
    /// # Errors
    /// As for [`Measurements::read`].
    pub fn parse(path: &Path, text: &str, robot: &Robot) -> Result<Self> {
        Self::parsed(path, text, robot, Gathered::default())
    }

    /// The same with the text of an instruments.toml.
    ///
    /// # Errors
    /// As for [`Measurements::read`], of either file.
    pub fn parse_with(path: &Path, text: &str, robot: &Robot, instruments: &str) -> Result<Self> {
        let book = Gathered::parse(&path.with_file_name("instruments.toml"), instruments)?;
        Self::parsed(path, text, robot, book)
    }

    fn parsed(path: &Path, text: &str, robot: &Robot, book: Gathered) -> Result<Self> {
        Ok(Self::table(path, text, robot, (Some("q"), true), book)?.completed(robot))
    }

    /// With what the order of the rows says, and what looks wrong.
    fn completed(mut self, robot: &Robot) -> Self {
        self.arrive(robot);
        self.remark(robot);
        self
    }

    /// Where no column says from which side joints came to rest, the order of the
    /// rows does: from the pose before.
    fn arrive(&mut self, robot: &Robot) {
        if self.rows.iter().any(|row| row.directions.iter().any(|side| *side != 0)) {
            return;
        }
        self.directions_from_order = true;
        let still: Vec<f64> = robot.joints.iter().map(|j| one_pose(j.link.kind)).collect();
        let before = self.before();
        for (row, before) in self.in_order().into_iter().filter_map(|row| Some((row, before[row]?)))
        {
            let old = &self.rows[before];
            let moved = self.rows[row].q.iter().zip(&old.q).map(|(new, old)| new - old);
            let sides =
                moved.zip(&still).zip(&old.directions).map(|((by, still), side)| match by {
                    by if by.abs() <= *still => *side,
                    by => by.signum() as i8,
                });
            self.rows[row].directions = sides.collect();
        }
    }

    /// With the rows of another file behind these: stations, markers and what rows
    /// refer to are the same where their labels are.
    ///
    /// # Errors
    /// Labels that differ in case only.
    pub fn joined(mut self, other: Self, robot: &Robot) -> Result<Self> {
        let stations: Vec<usize> =
            other.stations.iter().map(|text| label(&mut self.stations, text)).collect();
        let markers: Vec<usize> =
            other.markers.iter().map(|text| label(&mut self.markers, text)).collect();
        refuse_twins(&other.path, &self.stations, &self.markers)?;
        for (own, others) in [
            (&mut self.known_markers, &other.known_markers),
            (&mut self.guessed_markers, &other.guessed_markers),
        ] {
            own.resize(self.markers.len(), None);
            for (marker, place) in markers.iter().zip(others) {
                own[*marker] = own[*marker].or(*place);
            }
        }
        let mut instruments = Vec::new();
        for instrument in other.instruments {
            let same = |i: &crate::model::Instrument| {
                (i.form, &i.label) == (instrument.form, &instrument.label)
            };
            let place = self.instruments.iter().position(same);
            let known = place.map(|place| &self.instruments[place]);
            if known.is_some_and(|known| known.stated && instrument.stated && *known != instrument)
            {
                self.warnings.push(format!(
                    "{}: {} \"{}\" is stated otherwise than for {}, and that counts",
                    other.path.display(),
                    instrument.form.name(),
                    instrument.label,
                    self.path.display()
                ));
            }
            instruments.push(place.unwrap_or_else(|| {
                self.instruments.push(instrument);
                self.instruments.len() - 1
            }));
        }
        let before = self.rows.len();
        self.behind.push((other.path, before));
        for mut row in other.rows {
            row.station = stations[row.station];
            row.marker = markers[row.marker];
            row.refers.iter_mut().for_each(|i| *i = instruments[*i]);
            row.partner = row.partner.map(|partner| partner + before);
            self.rows.push(row);
        }
        let files: Vec<usize> = self.behind.iter().map(|(_, first)| *first).collect();
        number_runs(&mut self.rows, &files);
        refer_to_zeros(&mut self);
        self.directions_from_order |= other.directions_from_order;
        // An instruments.toml beside several files is remarked upon once.
        let new = other.warnings.into_iter().filter(|text| !self.warnings.contains(text));
        let new: Vec<String> = new.collect();
        self.warnings.extend(new);
        self.number(robot);
        Ok(self)
    }

    /// Numbers the poses by their joint values.
    pub(super) fn number(&mut self, robot: &Robot) {
        let reach = Reach::of_pose(robot);
        let numbers;
        (numbers, self.poses) = reach.number(self.rows.iter().map(|row| row.q.as_slice()));
        self.rows.iter_mut().zip(numbers).for_each(|(row, number)| row.pose = number);
    }

    /// Things that look wrong but may be meant.
    pub(super) fn remark(&mut self, robot: &Robot) {
        self.remark_unused();
        let mut warn =
            |text: String| self.warnings.push(format!("{}: {text}", self.path.display()));
        let unread = self.rows.iter().filter(|row| row.temperature.is_none());
        let lines: Vec<usize> = unread.map(|row| row.line).collect();
        if let Some(first) = lines.first().filter(|_| lines.len() < self.rows.len()) {
            warn(format!(
                "{} of {} rows without temperature_c, first in line {first}: {} degrees is taken",
                lines.len(),
                self.rows.len(),
                robot.reference_temperature
            ));
        }
        self.remark_joints(robot);
    }

    /// Columns without a meaning.
    pub(super) fn remark_unused(&mut self) {
        if !self.extra_columns.is_empty() {
            let (path, names) = (self.path.display(), listed(&self.extra_columns));
            self.warnings.push(format!("{path}: columns not used: {names}"));
        }
    }

    /// Joint values that look wrong.
    pub(super) fn remark_joints(&mut self, robot: &Robot) {
        let mut warn =
            |text: String| self.warnings.push(format!("{}: {text}", self.path.display()));
        let revolute = |j: usize| robot.joints[j].link.kind == JointKind::Revolute;
        let seven = 7_f64.to_radians();
        let mut angles = self.rows.iter().flat_map(|r| {
            r.q.iter().enumerate().filter(|(j, _)| revolute(*j)).map(|(_, q)| q.abs())
        });
        if (0..robot.joints.len()).any(revolute) && angles.all(|q| q < seven) {
            warn(
                "all joint angles are below 7 degrees: are they radians? The columns are degrees"
                    .to_owned(),
            );
        }
        for (j, joint) in robot.joints.iter().enumerate() {
            let Some([low, high]) = joint.limits else { continue };
            let outside = self.rows.iter().filter(|r| r.q[j] < low || r.q[j] > high);
            let lines: Vec<_> = outside.map(|r| r.line).collect();
            if let Some(first) = lines.first() {
                let count = lines.len();
                warn(format!(
                    "joint {} outside its limits in {count} rows, first in line {first}",
                    j + 1
                ));
            }
        }
    }
}
