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
        (self.name, self.place, self.part) == (other.name, other.place, other.part)
    }
}
