use nalgebra::Vector3;

/// How far an identification by parts has come (`truearm gram`): what every part of a round
/// must know alike of the rows that it weighs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GramState {
    /// Rounds taken.
    pub stage: u32,
    /// Whether the last step no longer mattered.
    pub settled: bool,
    /// Largest step of an unknown in the last round, in tolerances; `None` before the first.
    pub step: Option<f64>,
    /// Scale of the residuals in stated sigmas, 1 at least.
    pub k: f64,
    /// Rows with a component beyond so many stated sigmas do not count.
    pub weights: f64,
    /// Rows that did not count in the last round.
    pub flagged: usize,
    /// Where each marker was when it began, m: the place that it is held near.
    pub targets: Vec<Vector3<f64>>,
}
