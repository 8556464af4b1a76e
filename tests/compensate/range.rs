//! How far commands may go in `f32`.

use truearm::compensate::Refusal;
use truearm::effects::Order;
use truearm::{Arm, Compensator, Settings, Task};

use super::arms::{UR10_TERMS, shipped};

/// Within 8192 rad over the highest order of a joint's waves; 100 rad alone would be too much
/// of the shipped arm.
#[test]
fn a_wave_of_a_high_order_ends_the_range_of_its_joint() {
    let arm = Arm::new(&shipped::<f32>(UR10_TERMS));
    let compensator =
        Compensator::new(arm.clone(), Settings::new(Task::Position), &[0.0; 6]).unwrap();
    let mut below_100 = 0;
    for joint in 0..6 {
        let waves = arm.terms().iter().filter(|term| {
            usize::from(term.joint) == joint
                && matches!(term.effect.order(), Order::Cycles | Order::Harmonic)
        });
        let highest = waves.map(|term| term.order).fold(1.0, f32::max);
        let at = |part: f32| {
            let mut command = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
            command[joint] = part * 8192.0 / highest;
            compensator.correction(&command, &arm.state())
        };
        assert!(at(0.999).is_ok() && at(-0.999).is_ok(), "joint {joint}, order {highest}");
        assert_eq!(at(1.001), Err(Refusal::OutOfRange), "joint {joint}, order {highest}");
        below_100 += usize::from(8192.0 / highest < 100.0);
    }
    assert!(below_100 > 0);
}
