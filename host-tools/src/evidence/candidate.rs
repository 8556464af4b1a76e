/// An effect at a place: columns that enter and leave a model together.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Which effect: the caller's number of its name.
    pub name: usize,
    /// Where: the caller's number of a joint, a pair of joints, a series.
    pub place: usize,
    /// Which of several that one place may have at once, as lines of different
    /// order. Candidates of one name, place and part are variants: a model has
    /// at most one of them.
    pub part: usize,
    /// What all of one name in a model have in common, any number: one time constant of an
    /// arm. Candidates of one name that differ in it are variants, too.
    pub common: u64,
    /// Unit of each of its columns, any numbers: columns of one unit keep their
    /// relative size, as cosine and sine of one line do.
    pub units: Vec<usize>,
    /// Logarithm of the prior odds, see [`super::prior`].
    pub log_odds: f64,
}

impl Candidate {
    /// Whether both cannot stand in one model.
    #[must_use]
    pub fn excludes(&self, other: &Self) -> bool {
        let one = (self.place, self.part) == (other.place, other.part);
        self.name == other.name && (one || self.common != other.common)
    }
}
