//! What a state has of candidates.

use nalgebra::DVector;

use crate::model::ModelTerm;

/// The coefficient of every column in a state of these terms. Variants of a candidate share
/// terms: what the state has of one stands in the first of its columns and nowhere else, as all
/// of them are added up to what was measured.
pub fn held(columns: &[Option<ModelTerm>], terms: &[ModelTerm]) -> DVector<f64> {
    let mut out = DVector::zeros(columns.len());
    for term in terms {
        let mut zero = term.clone();
        *zero.coefficient_mut() = 0.0;
        let of_term = |column: &Option<ModelTerm>| column.as_ref() == Some(&zero);
        if let Some(column) = columns.iter().position(of_term) {
            out[column] += term.coefficient();
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use truearm::effects::Effect;

    use super::*;
    use crate::effects::Offer;

    /// With it twice what a model without it leaves was four times too much.
    #[test]
    fn what_a_state_has_is_there_once() {
        let of = |orders: &[f64]| Offer::of_arm(Effect::EncoderEccentricity, &[2], orders, 1).terms;
        let variants = [of(&[1.0]), of(&[1.0, 2.0]), of(&[2.0])];
        let columns: Vec<_> = variants.concat().into_iter().map(Some).chain([None]).collect();
        for own in &variants {
            let mut terms = own.clone();
            for (k, term) in terms.iter_mut().enumerate() {
                *term.coefficient_mut() = 1.0 + k as f64;
            }
            let held = held(&columns, &terms);
            for term in &terms {
                let mut zero = term.clone();
                *zero.coefficient_mut() = 0.0;
                let same = (0..columns.len()).filter(|c| columns[*c].as_ref() == Some(&zero));
                let sum: f64 = same.map(|c| held[c]).sum();
                assert!((sum - term.coefficient()).abs() < 1e-15, "{held:?}");
            }
        }
    }
}
