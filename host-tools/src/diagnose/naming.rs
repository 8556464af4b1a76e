//! What may be named, and what is only suspected.

use super::policy::POLICY;
use super::weigh::{Curved, Named};

/// Whether an effect is named: probable, and nothing speaks against it.
#[must_use]
pub fn is_named(claim: &Named) -> bool {
    claim.probability >= POLICY.named && claim.doubt.is_none()
}

/// The same of a curve: probable, and both halves of the poses speak for it.
#[must_use]
pub fn is_curve_named(curve: &Curved) -> bool {
    curve_probability(curve) >= POLICY.named && curve.half_gain.iter().all(|gain| *gain > 0.0)
}

/// That a joint has a curve, and neither nothing nor a few waves, given the data.
#[must_use]
pub fn curve_probability(curve: &Curved) -> f64 {
    1.0 / (1.0 + (-curve.log_odds).exp() + curve.few.exp())
}

/// Whether a few waves in its place are why a curve is not named.
#[must_use]
pub fn is_few(curve: &Curved) -> bool {
    1.0 / (1.0 + curve.few.exp()) < POLICY.named
}

/// A probability in words: never said to be certain.
#[must_use]
pub fn said(probability: f64) -> String {
    match probability {
        p if p > 0.99 => "> 0.99".to_owned(),
        p if p < 0.01 => "< 0.01".to_owned(),
        p => format!("{p:.2}"),
    }
}
