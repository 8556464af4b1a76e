//! Rows of a file as they are read under one header, whatever its format.

use std::path::Path;

use super::columns::{Cells, Columns, Labels, Record, label};
use super::instruments::Gathered;
use super::pairs;
use super::source::Source;
use crate::error::{Error, Result};
use crate::model::{Measurements, Robot, Row, find_sessions, number_runs};

/// What is asked of a file: what its joint columns begin with, if it has any, and whether it
/// says what was measured.
pub(super) type Asked<'p> = (Option<&'p str>, bool);

/// A header and the rows read under it so far.
pub(super) struct Reading<'a> {
    source: Source<'a>,
    robot: &'a Robot,
    names: &'a [String],
    columns: Columns,
    with_joints: bool,
    /// Whether no row refers to another one.
    apart: bool,
    labels: Labels,
    rows: Vec<Row>,
}

impl<'a> Reading<'a> {
    /// Of these columns; no row yet.
    pub fn begin(
        source: Source<'a>,
        names: &'a [String],
        robot: &'a Robot,
        asked: Asked,
        book: Gathered,
    ) -> Result<Self> {
        let columns = Columns::find(source, names, robot, asked)?;
        let labels = Labels { book, ..Labels::default() };
        Ok(Self {
            source,
            robot,
            names,
            columns,
            with_joints: asked.0.is_some(),
            apart: false,
            labels,
            rows: Vec::new(),
        })
    }

    /// Room for so many rows, once for all: what grows by doubling is in memory twice. Where
    /// there is none they grow.
    pub fn expect(&mut self, rows: usize) {
        let _ = self.rows.try_reserve_exact(rows);
    }

    /// Columns without a meaning.
    #[cfg(feature = "parquet")]
    pub fn unread(&self) -> &[usize] {
        &self.columns.extra
    }

    /// Of some rows of many: none is joined with another in a pair.
    #[must_use]
    pub fn each_by_itself(self) -> Self {
        Self { apart: true, ..self }
    }

    /// Rows so far.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// One more row: where it stands, and its cells. A first row of units is none.
    pub fn row(
        &mut self,
        (line, start): (usize, Option<usize>),
        record: &dyn Record,
    ) -> Result<()> {
        let cells = Cells { source: self.source, line, start, names: self.names, record };
        if !(start.is_some() && self.rows.is_empty() && cells.unit_row()?) {
            self.rows.push(self.columns.row(&cells, self.robot, &mut self.labels)?);
        }
        Ok(())
    }

    /// The measurements.
    pub fn end(self) -> Result<Measurements> {
        let Self { source, robot, names, columns, with_joints, apart, labels, rows } = self;
        if rows.is_empty() {
            return Err(source.whole("no data rows", "add rows below the headings"));
        }
        labels.refuse_twins(source.path)?;
        let extra = columns.extra.iter().map(|c| names[*c].clone()).collect();
        let mut data =
            Measurements { extra_columns: extra, ..Measurements::bare(source.path, rows, robot) };
        data.stations = labels.stations;
        data.markers = labels.markers;
        if !columns.of_poses() && data.rows.iter().any(|row| row.orientation.is_some()) {
            data.warnings.push(format!(
                "{}: orientations are not used: state how good they are, measurement_sigma_deg in \
                 {} or a column sigma_deg, or write `pose` in a column `kind`",
                source.path.display(),
                robot.path.display()
            ));
        }
        labels.book.hand_over(&mut data, robot);
        if !apart {
            pairs::join(&mut data, &labels.pairs, source)?;
        }
        if with_joints {
            data.number(robot);
        }
        find_sessions(&mut data.rows);
        number_runs(&mut data.rows, &[]);
        Ok(data)
    }

    /// Reads the rows of a text behind its header, whose lines are counted from `lines` before
    /// it.
    pub fn lines(&mut self, reader: &mut csv::Reader<&[u8]>, lines: usize) -> Result<()> {
        for record in reader.records() {
            let record = record.map_err(|e| unreadable(&self.source, &e))?;
            let (line, start) = record
                .position()
                .map_or((0, 0), |p| self.source.begin(p.line() as usize, p.byte() as usize));
            let line = line + lines;
            if record.len() != self.names.len() {
                return Err(self.source.in_line(
                    line,
                    start,
                    format!("{} cells where the header has {}", record.len(), self.names.len()),
                    "give every row a cell for every column; leave unknown ones empty",
                ));
            }
            self.row((line, Some(start)), &record)?;
        }
        Ok(())
    }
}

impl Measurements {
    /// The rows of a text.
    pub(super) fn table(
        path: &Path,
        text: &str,
        robot: &Robot,
        asked: Asked,
        book: Gathered,
    ) -> Result<Self> {
        let source = Source { path, text };
        source.refuse_toml()?;
        let names = headings(&source)?;
        let mut reader = super::csv_reader(text, true);
        let mut reading = Reading::begin(source, &names, robot, asked, book)?;
        reading.expect(text.bytes().filter(|byte| *byte == b'\n').count());
        reading.lines(&mut reader, 0)?;
        reading.end()
    }

    /// Rows that were read before, with the labels of their stations and markers.
    pub(super) fn drawn(
        path: &Path,
        rows: impl Iterator<Item = (String, String, Row)>,
        robot: &Robot,
        book: &Gathered,
    ) -> Result<Self> {
        let mut labels = Labels::default();
        let labelled = |(station, marker, row): (String, String, Row)| Row {
            station: label(&mut labels.stations, &station),
            marker: label(&mut labels.markers, &marker),
            ..row
        };
        let rows = rows.map(labelled).collect();
        labels.refuse_twins(path)?;
        let Labels { stations, markers, .. } = labels;
        let mut data = Self { stations, markers, ..Self::bare(path, rows, robot) };
        book.clone().hand_over(&mut data, robot);
        data.number(robot);
        find_sessions(&mut data.rows);
        number_runs(&mut data.rows, &[]);
        data.remark(robot);
        Ok(data)
    }

    /// Rows of which nothing else is known.
    fn bare(path: &Path, rows: Vec<Row>, robot: &Robot) -> Self {
        Self {
            path: path.to_owned(),
            behind: Vec::new(),
            rows,
            stations: Vec::new(),
            markers: Vec::new(),
            poses: 0,
            extra_columns: Vec::new(),
            directions_from_order: false,
            order_from_rows: false,
            sides_found: Vec::new(),
            instruments: Vec::new(),
            known_markers: Vec::new(),
            guessed_markers: Vec::new(),
            base: robot.base.pose(),
            warnings: Vec::new(),
        }
    }
}

/// The cells of the rows that were read, as they stand in the file.
pub(super) fn cells(source: &Source, rows: &[Row]) -> Vec<Vec<String>> {
    let mut reader = super::csv_reader(source.text, true);
    // What could not be read was an error before; a row of units is no row.
    let mut rows = rows.iter().peekable();
    let records = reader.records().filter_map(std::result::Result::ok);
    let read = records.filter(|record| {
        let line = record.position().map_or(0, |p| {
            // As the rows have it: behind empty lines and remarks.
            source.begin(p.line() as usize, p.byte() as usize).0
        });
        rows.next_if(|row| row.line == line).is_some()
    });
    read.map(|record| record.iter().map(str::to_owned).collect()).collect()
}

/// The headings of a table.
pub(super) fn headings(source: &Source) -> Result<Vec<String>> {
    let mut reader = super::csv_reader(source.text, true);
    let headers = reader.headers().map_err(|e| unreadable(source, &e))?;
    Ok(headers.iter().map(str::to_owned).collect())
}

fn unreadable(source: &Source, error: &csv::Error) -> Error {
    let help = "write one comma-separated row a measurement";
    match error.position() {
        Some(at) => source.in_line(at.line() as usize, at.byte() as usize, error.to_string(), help),
        None => source.whole(error.to_string(), help),
    }
}
