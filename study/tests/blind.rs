//! A small seeded part of the blind study (`cargo xtask study blind`): what was
//! hidden is opened only after every verdict is in.

use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_study::blind::score::{Score, score};
use truearm_study::blind::sets::{BlindSet, LISTED, UNLISTED, Wanted};
use truearm_study::simulated::parse;

fn judged(sets: &[BlindSet]) -> Vec<Score> {
    let answer = |set: &BlindSet| {
        let (robot, data, holdout) = set.read();
        let options = DiagnoseOptions::default();
        diagnose(&robot, &data, Some(&holdout), &options, &|_| ()).unwrap().outcome
    };
    let answers: Vec<_> = sets.iter().map(answer).collect();
    let scores: Vec<Score> = sets.iter().zip(&answers).map(|(s, a)| score(s, a)).collect();
    for s in scores.iter().filter(|s| !s.names_right() || !s.joints_right()) {
        println!("{s:?}");
    }
    scores
}

fn count(scores: &[Score], good: impl Fn(&Score) -> bool) -> usize {
    scores.iter().filter(|s| good(s)).count()
}

#[test]
fn single_effects_are_named() {
    let draw =
        |i: usize| BlindSet::draw(7_000 + i as u64, &[(LISTED[i % LISTED.len()], [2.0, 10.0])]);
    let sets: Vec<BlindSet> = (0..24).map(draw).collect();
    let scores = judged(&sets);
    assert!(count(&scores, Score::names_right) >= 23);
    assert!(count(&scores, Score::joints_right) >= 23);
}

#[test]
fn pairs_are_named() {
    let draw = |i: usize| {
        let wanted: Vec<Wanted> =
            [i, 5 * i + 4].iter().map(|k| (LISTED[k % LISTED.len()], [2.0, 6.0])).collect();
        BlindSet::draw(7_100 + i as u64, &wanted)
    };
    let scores = judged(&(0..6).map(draw).collect::<Vec<_>>());
    assert!(count(&scores, Score::names_right) >= 5);
}

#[test]
fn clean_arms_get_no_name() {
    let sets: Vec<BlindSet> = (0..6).map(|i| BlindSet::draw(7_200 + i, &[])).collect();
    let scores = judged(&sets);
    assert_eq!(count(&scores, Score::verdict_right), 6);
}

#[test]
fn no_name_is_forced_on_the_unlisted() {
    let draw = |i: usize| BlindSet::draw(7_300 + i as u64, &[(UNLISTED[i], [2.0, 10.0])]);
    let scores = judged(&(0..3).map(draw).collect::<Vec<_>>());
    assert_eq!(count(&scores, Score::forced), 0);
}

/// A miss must be reproducible, and no column may say what is hidden.
#[test]
fn a_seed_is_a_set_and_every_column_varies() {
    for i in 0..LISTED.len() {
        let wanted = [(LISTED[i], [2.0, 10.0])];
        let [set, again] = [0, 1].map(|_| BlindSet::draw(7_400 + i as u64, &wanted));
        assert_eq!(set.measurements, again.measurements);
        assert_eq!(set.holdout, again.holdout);
        for file in [&set.measurements, &set.holdout] {
            let rows: Vec<Vec<&str>> = file.lines().map(|l| l.split(',').collect()).collect();
            for column in 0..rows[0].len() {
                let varies = rows[2..].iter().any(|r| r[column] != rows[1][column]);
                assert!(varies, "{} in {}", rows[0][column], LISTED[i]);
            }
        }
    }
}

/// Poses that can hardly tell two effects apart: where both are told, the poses
/// that the report proposes separate all but one. Where one is named alone it may be
/// the wrong one: a gain far from the joint's zero moves the zero by more than its
/// tolerance, which speaks for an eccentricity. With the tolerance itself as the
/// zero's prior two of these eight were told as ties, and two were named wrongly.
#[test]
fn ties_are_told_and_separated() {
    let (mut ties, mut separated, mut wrong) = (0, 0, 0);
    for seed in 7_500..7_508 {
        let set = BlindSet::tie(seed);
        let (robot, data, _) = set.read();
        let answer = |data: &_| {
            diagnose(&robot, data, None, &DiagnoseOptions::default(), &|_| ()).unwrap().outcome
        };
        let report = answer(&data);
        let truth = &set.open().arm.defects[0].kind;
        let right = |e: &truearm_host::diagnose::Effect| {
            e.name == truth.name() && e.joints == truth.joints()
        };
        let proposed = report.alternatives.iter().flat_map(|a| &a.separating_poses);
        let poses: Vec<Vec<f64>> = proposed.map(|p| p.joints.clone()).collect();
        if poses.is_empty() {
            wrong += usize::from(!report.effects.iter().all(right));
            continue;
        }
        ties += 1;
        let after = answer(&parse(&robot, &set.measured_further(&poses)));
        separated += usize::from(after.effects.len() == 1 && right(&after.effects[0]));
    }
    println!("{ties} ties, {separated} separated; {wrong} of the others named wrongly");
    assert!(ties >= 4 && separated + 1 >= ties && wrong <= 1);
}
