//! No joint beyond its limit, to the last bit, whatever was commanded before.

use proptest::prelude::*;
use truearm::{Arm, ArmParameters, Compensator, Settings, Task};

use super::arms::{UR10_TERMS, shipped, state};

fn limited(limits: [f32; 2]) -> ArmParameters<'static, f32, 6> {
    ArmParameters { limits: [Some(limits); 6], ..shipped(UR10_TERMS) }
}

const INSIDE: [f32; 6] = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];

/// As found: a command of 1e6 rad swallowed its correction, and the next tick, commanded to the
/// limit, took the joint for one that an arm with narrower limits had left outside: 1.36 mrad
/// beyond.
#[test]
fn after_a_command_that_is_absurd_a_joint_is_not_beyond_its_limit() {
    let p = limited([-3.0, 2.0]);
    for glitch in [3e4_f32, 1e6, 3e38] {
        for joint in 0..6 {
            for (glitch, limit) in [(glitch, 2.0), (-glitch, -3.0)] {
                let settings = Settings { max_change: [1e-4; 6], ..Settings::new(Task::Pose) };
                let mut compensator = Compensator::new(Arm::new(&p), settings, &INSIDE).unwrap();
                compensator.set_active(true);
                for _ in 0..600 {
                    let _ = compensator.tick(&INSIDE, &state());
                }
                let mut q = INSIDE;
                q[joint] = glitch;
                let _ = compensator.tick(&q, &state());
                q[joint] = limit;
                let stands = compensator.tick(&q, &state()).joints[joint];
                assert!((-3.0..=2.0).contains(&stands), "{glitch}: {stands}");
            }
        }
    }
}

/// Any number, near the limits often.
fn any_place() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => -3.2_f32..2.2,
        3 => (prop_oneof![Just(-3.0_f32), Just(2.0)], -6..=6_i32).prop_map(|(limit, ulps)| {
            f32::from_bits(limit.to_bits().wrapping_add_signed(ulps))
        }),
        2 => (prop_oneof![Just(-3.0_f32), Just(2.0)], -0.03_f32..0.03).prop_map(|(l, by)| l + by),
        1 => any::<f32>(),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn no_joint_is_ever_beyond_a_limit_by_its_correction(
        commands in proptest::collection::vec(proptest::array::uniform6(any_place()), 1..12),
        held in 1..8_usize,
        change in prop_oneof![Just(6e-9_f32), Just(1e-4), Just(1e-3), Just(0.1)],
        ramp_ticks in prop_oneof![Just(0_u32), Just(1), Just(5)],
        bad in 0..40_u64,
        toggled in any::<u16>(),
        pose in any::<bool>(),
    ) {
        let most = if change < 1e-6 { [2e-3; 6] } else { [0.03; 6] };
        let task = if pose { Task::Pose } else { Task::Position };
        let settings =
            Settings { max_change: [change; 6], max_correction: most, ramp_ticks, ..Settings::new(task) };
        let p = limited([-3.0, 2.0]);
        let mut compensator = Compensator::new(Arm::new(&p), settings, &INSIDE).unwrap();
        compensator.set_active(true);
        let mut number = 0;
        for q in &commands {
            for _ in 0..held {
                number += 1;
                compensator.set_active(toggled >> (number % 16) & 3 != 0);
                let mut state = state();
                if number as u64 % 41 == bad {
                    state.temperature = f32::NAN;
                }
                let tick = compensator.tick(q, &state);
                for ((q, joint), applied) in q.iter().zip(tick.joints).zip(compensator.applied()) {
                    if !q.is_finite() {
                        continue;
                    }
                    let [low, high] = [q.min(-3.0), q.max(2.0)];
                    prop_assert!((low..=high).contains(&joint), "{joint} of {q}, {tick:?}");
                    // Nor is there one that waits for a command that does not swallow it.
                    prop_assert!(*q <= 2.0 || *applied <= 0.0, "{applied} at {q}");
                    prop_assert!(*q >= -3.0 || *applied >= 0.0, "{applied} at {q}");
                }
                if q.iter().any(|q| !q.is_finite()) {
                    break;
                }
            }
        }
    }
}
