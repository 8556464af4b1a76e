//! What is identified: base per station, tool point per marker, five MD-H
//! parameters per link; their order, units and names.

use nalgebra::{DVector, Vector3};
use truearm::{Link, LinkParameter, MdhParameters, Pose};

use crate::model::ModelTerm;
use crate::model::arm::{Kinematics, chain};

/// Manufacturing tolerance of a length, m: the prior of every link parameter
/// unless the user knows better.
pub const TOLERANCE_LENGTH: f64 = 1e-3;
/// Manufacturing tolerance of an angle, rad.
pub const TOLERANCE_ANGLE: f64 = 1e-3;

/// One unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// Rotation (0..3) or translation (3..6) of a station's base.
    Station(usize, usize),
    /// Coordinate of a marker.
    Marker(usize, usize),
    /// Coefficient of a term; an angle or a length is its tolerance unit.
    Term(usize),
    /// Parameter of a link.
    Link(usize, LinkParameter),
}

/// The unknowns of a data set: free ones first, then the penalised links.
#[derive(Debug, Clone)]
pub struct Unknowns {
    list: Vec<Unknown>,
    free: usize,
    terms: usize,
}

impl Unknowns {
    /// For so many stations, markers, terms and joints.
    #[must_use]
    pub fn new(stations: usize, markers: usize, terms: usize, joints: usize) -> Self {
        let station = (0..stations).flat_map(|s| (0..6).map(move |k| Unknown::Station(s, k)));
        let marker = (0..markers).flat_map(|m| (0..3).map(move |k| Unknown::Marker(m, k)));
        let links = (0..joints).flat_map(|i| LinkParameter::ALL.map(|p| Unknown::Link(i, p)));
        let terms_of = (0..terms).map(Unknown::Term);
        let list: Vec<_> = station.chain(marker).chain(terms_of).chain(links).collect();
        Self { free: 6 * stations + 3 * markers + terms, terms, list }
    }

    /// All, in column order.
    #[must_use]
    pub fn list(&self) -> &[Unknown] {
        &self.list
    }

    /// How many are never penalised: bases and markers, which come first.
    #[must_use]
    pub fn free(&self) -> usize {
        self.free
    }

    /// First column of a station.
    #[must_use]
    pub fn station(&self, station: usize) -> usize {
        6 * station
    }

    /// Columns of the terms: none when the state's terms are held.
    #[must_use]
    pub fn terms(&self) -> std::ops::Range<usize> {
        self.free - self.terms..self.free
    }

    /// First column of a marker, among so many stations.
    #[must_use]
    pub fn marker(&self, marker: usize, stations: usize) -> usize {
        6 * stations + 3 * marker
    }
}

impl Unknown {
    /// Whether it is a length (m) rather than an angle (rad).
    #[must_use]
    pub fn is_length(self) -> bool {
        match self {
            Self::Station(_, k) => k >= 3,
            Self::Marker(..) => true,
            Self::Term(_) => false,
            Self::Link(_, p) => p.is_length(),
        }
    }

    /// One tolerance of it, m or rad.
    #[must_use]
    pub fn tolerance(self) -> f64 {
        // Free unknowns: only keeps their columns of one size with the others.
        if matches!(self, Self::Term(_)) {
            return 1e-4;
        }
        if self.is_length() { TOLERANCE_LENGTH } else { TOLERANCE_ANGLE }
    }

    /// Short name; joints count from 1, as the [[joints]] entries of robot.toml;
    /// station and marker labels where there
    /// is more than one.
    #[must_use]
    pub fn name(self, stations: &[String], markers: &[String]) -> String {
        let of = |labels: &[String], i: usize| {
            if labels.len() > 1 { format!(" {}", labels[i]) } else { String::new() }
        };
        match self {
            Self::Station(s, k) => {
                let axis = ["rx", "ry", "rz", "x", "y", "z"][k];
                format!("base{} {axis}", of(stations, s))
            }
            Self::Marker(m, k) => format!("tool{} {}", of(markers, m), ["x", "y", "z"][k]),
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
        for (s, base) in out.bases.iter_mut().enumerate() {
            let at = unknowns.station(s);
            let v = |k: usize| Vector3::new(step[at + k], step[at + k + 1], step[at + k + 2]);
            let turn = Pose::from_rotation_vector(Vector3::zeros(), v(0));
            base.rotation = turn.rotation * base.rotation;
            base.translation += v(3);
        }
        for (m, marker) in out.markers.iter_mut().enumerate() {
            let at = unknowns.marker(m, self.bases.len());
            *marker += Vector3::new(step[at], step[at + 1], step[at + 2]);
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
