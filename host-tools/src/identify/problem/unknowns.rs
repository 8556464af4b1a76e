//! What is identified: base per station, tool point per marker, what is not
//! known of instruments, five MD-H parameters per link; their order, units and
//! names.

use nalgebra::{DVector, Vector3};
use truearm::{Link, LinkParameter, MdhParameters, Pose};

use crate::model::arm::{Kinematics, chain};
use crate::model::{Instrument, Measurements, ModelTerm};
use crate::observations::kind;

/// Manufacturing tolerance of a length, m: the prior of every link parameter
/// unless the user knows better.
pub const TOLERANCE_LENGTH: f64 = 1e-3;
/// Manufacturing tolerance of an angle, rad.
pub const TOLERANCE_ANGLE: f64 = 1e-3;

/// What a number of an instrument is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// m
    Length,
    /// rad, or a plain number
    Angle,
}

/// One unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// Rotation (0..3) or translation (3..6) of a station's base.
    Station(usize, usize),
    /// Coordinate of a marker.
    Marker(usize, usize),
    /// A number of an instrument: those of its place, then its own.
    Instrument(usize, usize, Unit),
    /// Coefficient of a term; an angle or a length is its tolerance unit.
    Term(usize),
    /// Parameter of a link.
    Link(usize, LinkParameter),
}

/// What of a data set is unknown beside links and terms.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Layout {
    /// Stations whose base is.
    pub stations: Vec<bool>,
    /// Markers whose point is.
    pub markers: Vec<bool>,
    /// Of each instrument its numbers that are.
    pub instruments: Vec<Vec<(usize, Unit)>>,
}

impl Layout {
    /// So many stations and markers, all unknown, and nothing else.
    #[must_use]
    pub fn frames(stations: usize, markers: usize) -> Self {
        let [stations, markers] = [stations, markers].map(|count| vec![true; count]);
        Self { stations, markers, instruments: Vec::new() }
    }

    /// Of a data set: stations whose frame something is known in, markers whose
    /// point some row depends on, and what is not known of instruments.
    #[must_use]
    pub fn of(data: &Measurements) -> Self {
        let mut out = Self::frames(data.stations.len(), data.markers.len());
        if data.rows.iter().all(|row| kind(row).point(row).is_some()) && data.instruments.is_empty()
        {
            return out;
        }
        out.stations.fill(false);
        out.markers.fill(false);
        for row in &data.rows {
            let kind = kind(row);
            let known = |i: &usize| data.instruments[*i].holds_station();
            out.stations[row.station] |= kind.point(row).is_some() || row.refers.iter().any(known);
            out.markers[row.marker] |= kind.of_marker(row);
        }
        for (unknown, known) in out.markers.iter_mut().zip(&data.known_markers) {
            *unknown &= known.is_none();
        }
        let unit = |instrument: &Instrument, k: usize| match instrument.is_length(k) {
            true => Unit::Length,
            false => Unit::Angle,
        };
        let unknown = |i: &Instrument| i.unknowns().into_iter().map(|k| (k, unit(i, k))).collect();
        out.instruments = data.instruments.iter().map(unknown).collect();
        out
    }
}

/// The unknowns of a data set: free ones first, then the penalised links.
#[derive(Debug, Clone)]
pub struct Unknowns {
    list: Vec<Unknown>,
    free: usize,
    terms: usize,
    /// First column of each.
    stations: Vec<Option<usize>>,
    markers: Vec<Option<usize>>,
    instruments: Vec<usize>,
}

impl Unknowns {
    /// For so many stations, markers, terms and joints.
    #[must_use]
    pub fn new(stations: usize, markers: usize, terms: usize, joints: usize) -> Self {
        Self::of(&Layout::frames(stations, markers), terms, joints)
    }

    /// For what is unknown, so many terms and joints.
    #[must_use]
    pub fn of(layout: &Layout, terms: usize, joints: usize) -> Self {
        let mut list = Vec::new();
        let mut place = |unknown: bool, all: &mut dyn Iterator<Item = Unknown>| {
            let first = list.len();
            unknown.then(|| list.extend(all)).map(|()| first)
        };
        let of = |s: usize| (0..6).map(move |k| Unknown::Station(s, k));
        let stations = layout.stations.iter().enumerate();
        let stations = stations.map(|(s, unknown)| place(*unknown, &mut of(s))).collect();
        let of = |m: usize| (0..3).map(move |k| Unknown::Marker(m, k));
        let markers = layout.markers.iter().enumerate();
        let markers = markers.map(|(m, unknown)| place(*unknown, &mut of(m))).collect();
        let mut instruments = Vec::new();
        for (i, numbers) in layout.instruments.iter().enumerate() {
            instruments.push(list.len());
            list.extend(numbers.iter().map(|(k, unit)| Unknown::Instrument(i, *k, *unit)));
        }
        list.extend((0..terms).map(Unknown::Term));
        let free = list.len();
        list.extend((0..joints).flat_map(|i| LinkParameter::ALL.map(|p| Unknown::Link(i, p))));
        Self { free, terms, list, stations, markers, instruments }
    }

    /// All, in column order.
    #[must_use]
    pub fn list(&self) -> &[Unknown] {
        &self.list
    }

    /// How many are never penalised: frames and instruments, which come first,
    /// and terms.
    #[must_use]
    pub fn free(&self) -> usize {
        self.free
    }

    /// First column of a station; `None` where its base is known.
    #[must_use]
    pub fn station(&self, station: usize) -> Option<usize> {
        self.stations[station]
    }

    /// Columns of the terms: none when the state's terms are held.
    #[must_use]
    pub fn terms(&self) -> std::ops::Range<usize> {
        self.free - self.terms..self.free
    }

    /// First column of a marker; `None` where its point is known.
    #[must_use]
    pub fn marker(&self, marker: usize) -> Option<usize> {
        self.markers[marker]
    }

    /// Columns of an instrument's unknown numbers, and which they are.
    pub fn instrument(&self, index: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let first = self.instruments.get(index).copied().unwrap_or(self.free);
        let columns = self.list.iter().enumerate().skip(first);
        columns.map_while(move |(column, unknown)| match unknown {
            Unknown::Instrument(i, k, _) if *i == index => Some((column, *k)),
            _ => None,
        })
    }
}

impl Unknown {
    /// Whether it is a length (m) rather than an angle (rad).
    #[must_use]
    pub fn is_length(self) -> bool {
        match self {
            Self::Station(_, k) => k >= 3,
            Self::Marker(..) | Self::Instrument(_, _, Unit::Length) => true,
            Self::Instrument(..) => false,
            Self::Term(_) => false,
            Self::Link(_, p) => p.is_length(),
        }
    }

    /// The tolerance of arms of which nothing else is known, m or rad.
    #[must_use]
    pub fn tolerance(self) -> f64 {
        // Free unknowns: only keeps their columns of one size with the others.
        if matches!(self, Self::Term(_)) {
            return 1e-4;
        }
        if self.is_length() { TOLERANCE_LENGTH } else { TOLERANCE_ANGLE }
    }

    /// Short name; joints count from 1, as the `[[joints]]` entries of robot.toml;
    /// station and marker labels where there is more than one.
    #[must_use]
    pub fn name(self, data: &Measurements) -> String {
        let of = |labels: &[String], i: usize| {
            if labels.len() > 1 { format!(" {}", labels[i]) } else { String::new() }
        };
        match self {
            Self::Station(s, k) => {
                let axis = ["rx", "ry", "rz", "x", "y", "z"][k];
                format!("base{} {axis}", of(&data.stations, s))
            }
            Self::Marker(m, k) => format!("tool{} {}", of(&data.markers, m), ["x", "y", "z"][k]),
            Self::Instrument(i, k, _) => data.instruments[i].name_of(k),
            Self::Term(k) => format!("term {}", k + 1),
            Self::Link(i, p) => format!("joint {} {}", i + 1, p.name()),
        }
    }
}

/// Values of all unknowns.
#[derive(Debug, Clone)]
pub struct State {
    /// Robot base in each station's frame.
    pub bases: Vec<Pose<f64>>,
    /// Each marker in the flange frame, m.
    pub markers: Vec<Vector3<f64>>,
    /// What rows refer to beside the arm.
    pub instruments: Vec<Instrument>,
    /// Links as identified.
    pub links: Vec<Link<f64>>,
    /// Terms beyond geometry.
    pub terms: Vec<ModelTerm>,
}

impl State {
    /// Adds a step in SI units, in column order.
    #[must_use]
    pub fn stepped(&self, unknowns: &Unknowns, step: &DVector<f64>) -> Self {
        let mut out = self.clone();
        let v = |at: usize| Vector3::new(step[at], step[at + 1], step[at + 2]);
        for (s, base) in out.bases.iter_mut().enumerate() {
            let Some(at) = unknowns.station(s) else { continue };
            let turn = Pose::from_rotation_vector(Vector3::zeros(), v(at));
            base.rotation = turn.rotation * base.rotation;
            base.translation += v(at + 3);
        }
        for (m, marker) in out.markers.iter_mut().enumerate() {
            *marker += unknowns.marker(m).map_or_else(Vector3::zeros, v);
        }
        for (i, instrument) in out.instruments.iter_mut().enumerate() {
            let mut own = vec![0.0; instrument.free.len()];
            unknowns.instrument(i).for_each(|(column, k)| own[k] = step[column]);
            *instrument = instrument.moved(&own);
        }
        for (term, k) in out.terms.iter_mut().zip(unknowns.terms()) {
            *term.coefficient_mut() += step[k];
        }
        for (i, link) in out.links.iter_mut().enumerate() {
            let at = unknowns.free() + 5 * i;
            let d = core::array::from_fn(|k| step[at + k]);
            *link = link.corrected(&MdhParameters::from_array(d));
        }
        out
    }

    /// The chain to a marker, seen from a station.
    #[must_use]
    pub fn chain(&self, station: usize, marker: usize) -> Box<dyn Kinematics> {
        chain(&self.links, self.bases[station], self.markers[marker])
    }
}
