//! Effects outside the repertoire: what errs is said, and with what, and nothing else is
//! named in its place.

use truearm_host::diagnose::Verdict;
use truearm_study::dirty::outside::{Answer, answer};

fn told(seed: u64) -> Answer {
    let answer = answer(seed).unwrap();
    assert!(answer.right, "{answer:#?}");
    assert_eq!(answer.wrong, [], "{answer:#?}");
    assert_eq!(answer.verdict, Verdict::Unexplained, "{answer:#?}");
    answer
}

/// One of each kind, and nothing beside it.
#[test]
fn each_kind_is_described() {
    let kinds: Vec<&str> = SEEDS.iter().map(|seed| told(*seed).kind).collect();
    let mut different = kinds.clone();
    different.sort_unstable();
    different.dedup();
    assert_eq!(different.len(), 6, "{kinds:?}");
}

const SEEDS: [u64; 6] = [9032, 9102, 9112, 9121, 9123, 30011];

/// By weights that the last fit did not have, what geometry imitates explained thousands of
/// times too much, and of a distance that errs in waves six false names were left.
#[test]
fn what_geometry_imitates_explains_nothing() {
    told(9058);
}
