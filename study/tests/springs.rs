//! One spring under loads that nobody states: its joint is named, and nothing beside it.

use truearm_study::dirty::springs::answer;

/// What moments of links do, they do to a spring: weighed as if they did it in every model, an
/// eccentricity in the spring's place was as probable in all of these, in two of them by more
/// than a thousand nats too much.
#[test]
fn a_model_without_the_spring_has_none_of_its_moments() {
    for seed in [41_003, 41_009, 41_012, 41_021] {
        let answer = answer(seed).unwrap();
        assert!(answer.right && answer.second.is_empty(), "{answer:#?}");
    }
}
