//! What a fleet teaches, a small part of `cargo xtask study fleet`.

use truearm_study::fleet::{Case, Errors, Spreads, Trial, trial};

fn trials(case: &Case, seeds: std::ops::Range<u64>) -> (Vec<Trial>, f64) {
    let trials: Vec<Trial> = seeds.map(|seed| trial(seed, case, 6)).collect();
    let errors: Vec<Errors> = trials.iter().flat_map(|t| t.errors.clone()).collect();
    let square = |of: &dyn Fn(&Errors) -> f64| errors.iter().map(|e| of(e).powi(2)).sum::<f64>();
    let ratio = (square(&|e| e.learned) / square(&|e| e.without[0])).sqrt();
    println!("{}: {ratio:.3}", case.name);
    (trials, ratio)
}

/// A crash is named, and its arm does not teach.
#[test]
fn unequal_spreads_are_worth_learning() {
    let case = Case { crashed: true, ..Case::of("machined", Spreads::Machined, 8) };
    let (trials, ratio) = trials(&case, 100..103);
    assert!(ratio < 0.92, "{ratio}");
    assert!(trials.iter().all(|t| t.crashed_named));
}

/// Neither where there is nothing to learn nor where the next arm is not of the type.
#[test]
fn what_was_learned_does_no_harm() {
    let (_, ratio) = trials(&Case::of("usual", Spreads::Usual, 3), 200..203);
    assert!(ratio < 1.03, "{ratio}");
    let crashed = Case::of("next arm crashed", Spreads::Machined, 6);
    let (_, ratio) = trials(&Case { next_crashed: true, ..crashed }, 300..303);
    assert!(ratio < 1.02, "{ratio}");
}
