//! Links that follow the temperature late, and what may be taken for that; the long form is
//! `cargo xtask study warming`.

use rayon::prelude::*;
use truearm_study::warming::{Hidden, Told, WarmSet};

fn told(hidden: Hidden, seeds: std::ops::Range<u64>) -> Vec<Told> {
    let seeds: Vec<u64> = seeds.collect();
    seeds.par_iter().map(|s| WarmSet::draw(*s, hidden).diagnosed().unwrap()).collect()
}

#[test]
fn links_that_are_late_have_their_time_constant() {
    for t in told(Hidden::Late, 7000..7004) {
        assert!(t.is_named() && t.false_names().is_empty(), "{}: {:?}", t.set.seed, t.outcome);
        let [z, log] = t.time_constant_off().unwrap();
        assert!(z.abs() < 3.0 && log.abs() < 0.5, "{}: {z} deviations, {log}", t.set.seed);
    }
}

#[test]
fn links_that_are_not_late_have_none() {
    for t in told(Hidden::AtOnce, 7100..7103) {
        assert!(t.is_named() && t.false_names().is_empty(), "{}: {:?}", t.set.seed, t.outcome);
        assert_eq!(t.thermal().unwrap().time_constant_s, None, "{}", t.set.seed);
    }
}

#[test]
fn what_settles_and_what_is_clean_does_not_grow() {
    for hidden in [Hidden::Settling, Hidden::Nothing] {
        for t in told(hidden, 7200..7202) {
            assert!(t.thermal().is_none() && t.false_names().is_empty(), "{:?}", t.outcome);
        }
    }
}
