/// A row of a file that is to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRow {
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// What stands in the columns of labels.
    pub labels: Vec<(&'static str, String)>,
}
