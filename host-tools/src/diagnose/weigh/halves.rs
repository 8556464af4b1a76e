//! Whether a claim survives in the data's other half: coefficients of both
//! halves agree, and what one half says helps to predict the other.

use super::partial_fits::{Explained, Part};
use super::row_parts::{Parts, joined};
use crate::diagnose::chi_square::chi_square;
use crate::diagnose::policy::POLICY;
use crate::evidence::{Claim, Explanation, Gram};

/// Half of the rows.
pub struct Half {
    /// Their sums.
    pub part: Part,
    /// The same with moments of the links as stated, where they are unknown.
    pub stated: Option<Part>,
    /// Which they are.
    pub rows: Vec<usize>,
}

/// Both halves at random, and both in time.
#[must_use]
pub fn all(of: &Explained, scale: f64, parts: &Parts, grams: &[Gram]) -> [[Half; 2]; 2] {
    let held = of.sheet.holding_moments(of.precision);
    let stated = Explained { precision: &held, ..*of };
    let unknown = held != *of.precision;
    let half = |kind: usize, h: usize| {
        let own = (0..grams.len()).filter(|p| parts.half[*p][kind] == h);
        let rows = own.clone().flat_map(|p| parts.rows[p].clone()).collect();
        let unknowns = grams.first().map_or([0; 2], |g| [g.unknowns(), g.columns()]);
        let sum = joined(own.map(|p| &grams[p]), unknowns);
        let stated = unknown.then(|| stated.part(sum.clone(), scale));
        Half { part: of.part(sum, scale), stated, rows }
    };
    [0, 1].map(|kind| [0, 1].map(|h| half(kind, h)))
}

/// Fall of the error of each half by the claim fitted to the other one, at
/// random halves; and whether halves at random and in time agree.
pub fn of_claim(
    of: &Explained,
    claim: Claim,
    found: &Explanation,
    halves: &[[Half; 2]; 2],
) -> ([f64; 2], bool) {
    let holds = |m: &usize| Claim::from(&of.possible[*m].entry) == claim;
    // The most probable model with the claim.
    let with = found.posterior.models.iter().find(|(members, _)| members.iter().any(holds));
    let Some((members, _)) = with else { return ([0.0; 2], false) };
    let without: Vec<usize> = members.iter().copied().filter(|m| !holds(m)).collect();
    // What a spring bends the moments would bend in its place.
    let bends = of.possible.iter().zip(0..).any(|(p, m)| holds(&m) && p.is_spring());
    let of_time = of.possible.iter().zip(0..).any(|(p, m)| holds(&m) && p.is_of_time());
    let mut gains = [[0.0; 2]; 2];
    let mut agree = true;
    for (kind, halves) in halves.iter().enumerate() {
        if halves.iter().any(|half| half.rows.is_empty()) {
            return ([0.0; 2], false);
        }
        let mut coefficients = Vec::new();
        for h in 0..2 {
            let (Half { part, stated, .. }, other) = (&halves[h], &halves[1 - h].rows);
            let (own, _) = of.refitted(part, found, members);
            let judged = stated.as_ref().filter(|_| bends).unwrap_or(part);
            let [solution, bare] = [members, &without].map(|m| of.refitted(judged, found, m).1);
            let rms = |s| of.sheet.misfit(other, s).sqrt();
            gains[kind][h] = 1.0 - rms(&solution) / rms(&bare).max(f64::MIN_POSITIVE);
            let each = members.iter().zip(own).filter(|(m, _)| holds(m));
            coefficients.push(each.flat_map(|(_, c)| c).collect::<Vec<_>>());
        }
        let pairs = coefficients[0].iter().zip(&coefficients[1]);
        let apart: f64 = pairs
            .map(|(a, b)| {
                let variance = a.sigma.powi(2) + b.sigma.powi(2);
                (a.value - b.value).powi(2) / variance.max(f64::MIN_POSITIVE)
            })
            .sum();
        // In one half of the time other poses were measured, at other loads and temperatures
        // that a sigma does not know of; at random, a sigma of a hundredth of the effect does
        // not know what is left of others: what is small beside the effect is no disagreement.
        let size: f64 = coefficients[0]
            .iter()
            .zip(&coefficients[1])
            .map(|(a, b)| {
                let variance = a.sigma.powi(2) + b.sigma.powi(2);
                ((a.value + b.value) / 2.0).powi(2) / variance.max(f64::MIN_POSITIVE)
            })
            .sum();
        let near = apart < POLICY.halves_apart[kind].powi(2) * size;
        // How a base moves with time is another thing at the begin of a session than
        // at its end, unless the course is known exactly.
        let alike = chi_square(apart, coefficients[0].len()) > POLICY.halves_disagree;
        agree &= alike || near || kind == 1 && of_time;
        // A series or a temperature may be in one half of the time only.
        agree &= kind == 1 || gains[kind][0] + gains[kind][1] > 0.0;
    }
    (gains[0], agree)
}
