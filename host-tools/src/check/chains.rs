//! The arm as seen from every station at every marker.

use crate::identify::State;
use crate::model::arm::Kinematics;

/// Chains of all stations and markers.
pub struct Chains {
    all: Vec<Box<dyn Kinematics>>,
    markers: usize,
}

impl Chains {
    pub fn new(state: &State) -> Self {
        let markers = state.markers.len();
        let pairs = (0..state.bases.len()).flat_map(|s| (0..markers).map(move |m| (s, m)));
        Self { all: pairs.map(|(s, m)| state.chain(s, m)).collect(), markers }
    }

    pub fn of(&self, station: usize, marker: usize) -> &dyn Kinematics {
        self.all[station * self.markers + marker].as_ref()
    }
}
