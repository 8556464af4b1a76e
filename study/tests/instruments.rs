//! Small seeded parts of `cargo xtask study instruments`.

use truearm_study::instruments::cases::{CASES, OTHERS};
use truearm_study::instruments::scanner::{Setup, means};
use truearm_study::instruments::{held, mixed};
use truearm_study::simulated::{UR10_LIKE, robot};

/// Intervals of every kind but images, which take longest: 60 arms each. Four
/// standard errors, were the intervals of an arm one.
#[test]
fn intervals_of_every_kind_hold_the_truth() {
    let robot = robot(UR10_LIKE);
    for (what, wanted) in CASES.into_iter().chain(OTHERS) {
        if wanted[0].0 == "pixel" {
            continue;
        }
        let shares = held::shares(&robot, wanted, 60);
        println!("{what}: {:.3} of parameters, {:.3} of combinations", shares[0], shares[1]);
        for share in shares {
            assert!((0.91..=0.985).contains(&share), "{what}: {share:.3}");
        }
    }
}

#[test]
fn points_and_touches_beat_either() {
    let errors = mixed::compared(&robot(UR10_LIKE), 12).unwrap();
    println!("{errors:?}");
    assert_eq!(mixed::hurt(&errors), None);
    // What is estimated is why: sigmas as stated would hurt.
    assert!((3..errors.len()).any(|fit| errors[fit][1] > 1.2 * errors[2][0]));
}

#[test]
fn the_published_range_finder_is_beaten() {
    let [before, after] = means(Setup { sigma: 5e-5, poses: 40 }, 3).unwrap();
    println!("{before:?} {after:?}");
    assert!(before[0] > 5e-3 && before[1] > 0.03);
    assert!(after[0] < 9e-5 && after[1] < 0.02_f64.to_radians());
}
