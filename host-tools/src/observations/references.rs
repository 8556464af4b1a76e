//! What rows refer to beside the arm, as labels say it.

use nalgebra::Vector3;

use crate::model::Form;

/// What a row of a file says in words.
pub struct Told<'a> {
    /// Label of its marker.
    pub marker: &'a str,
    /// The cell of a column, empty where there is none.
    pub text: &'a dyn Fn(&str) -> &'a str,
}

/// What rows of a file refer to, as it is gathered.
pub trait Registry {
    /// An instrument of one of these forms, the first one if it is new.
    fn instrument(&mut self, forms: &[Form], label: &str) -> usize;
    /// One that only files of instruments make.
    fn known(&self, form: Form, label: &str) -> Option<usize>;
    /// Coordinates of a hole, ball or corner of a plate, m.
    fn hole(&self, plate: &str, hole: &str) -> Option<Vector3<f64>>;
    /// Says that nothing depends on these numbers of an instrument.
    fn without(&mut self, instrument: usize, unneeded: &[usize]);
}

/// What a row refers to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bound {
    /// Instruments, in the order in which the kind looks for them.
    pub refers: Vec<usize>,
    /// Numbers to stand behind those of the columns, SI.
    pub known: Vec<f64>,
}

/// What keeps a row from being understood: a column, what is wrong, what to do.
pub type Unclear = (&'static str, String, String);
