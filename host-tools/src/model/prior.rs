//! What is known of an arm's links before it is measured.

/// Corrections of a link that arms of its type have, as `tolerance` and `expected` of
/// robot.toml say: one value a parameter in the order of
/// [`LinkParameter::ALL`](truearm::LinkParameter::ALL), m and rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LinkPrior {
    /// Their mean: what the drawing has wrong.
    pub expected: [f64; 5],
    /// Their standard deviation about it; `None` where nobody says so.
    pub tolerance: [Option<f64>; 5],
}
