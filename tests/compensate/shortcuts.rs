//! What a tick leaves out, against the same tick with nothing left out, over the whole
//! joint space: growth of links that do not grow; sines taken anew where others are at hand.

use proptest::array::uniform7;
use proptest::prelude::*;
use truearm::effects::{Effect, Term};
use truearm::{Approach, Arm, ArmParameters, Compensator, JointKind, Link, Scalar, Settings};
use truearm::{State, Task};

use super::arms::{Terms, parameters, rail, seven};
use super::common::{puma, scara, ur10};

/// A command of as many joints as an arm has and what it is in.
#[derive(Debug, Clone)]
struct Case {
    /// Three quarters of a turn either way; of a joint that slides a fifth of that, m.
    q: [f64; 7],
    approach: [f64; 7],
    payload: f64,
    temperature: f64,
    torque: Option<[f64; 7]>,
}

fn case() -> impl Strategy<Value = Case> {
    let (q, approach) = (uniform7(-4.7..4.7), uniform7(-1.0..1.0));
    let torque = proptest::option::weighted(0.3, uniform7(-150.0..150.0));
    (q, approach, 0.0..10.0, 5.0..45.0, torque).prop_map(
        |(q, approach, payload, temperature, torque)| Case {
            q,
            approach,
            payload,
            temperature,
            torque,
        },
    )
}

impl Case {
    fn command<T: Scalar, const N: usize>(&self, links: &[Link<f64>; N]) -> [T; N] {
        core::array::from_fn(|i| match links[i].kind {
            JointKind::Revolute => T::from_f64(self.q[i]),
            JointKind::Prismatic => T::from_f64(self.q[i] / 5.0),
        })
    }

    fn state<T: Scalar, const N: usize>(&self) -> State<T, N> {
        State {
            approach: core::array::from_fn(|i| Approach::of_motion(self.approach[i])),
            payload: T::from_f64(self.payload),
            temperature: T::from_f64(self.temperature),
            torque: self.torque.map(|torque| core::array::from_fn(|i| T::from_f64(torque[i]))),
        }
    }
}

/// An arm that bends, whose links grow by so much a kelvin; without a coefficient no term
/// says that they do. Gravity decides no side of a gap: there a correction jumps.
fn arm<T: Scalar, const N: usize>(
    links: &[Link<f64>; N],
    growth: Option<f64>,
) -> ArmParameters<'static, T, N> {
    let mut p = parameters(links, 5e-4, Terms::All);
    p.terms.retain(|term| term.effect != Effect::ThermalExpansion);
    p.terms.iter_mut().filter(|t| t.effect == Effect::Backlash).for_each(|t| t.order = T::ZERO);
    if let Some(growth) = growth {
        let term = Term { effect: Effect::ThermalExpansion, joint: Term::<T>::ALL, ..p.terms[0] };
        p.terms.push(Term { coefficient: T::from_f64(growth), ..term }).unwrap();
    }
    p
}

/// Goes all the way in one tick.
fn compensator<'t, T: Scalar, const N: usize>(
    p: &ArmParameters<'t, T, N>,
    (task, refinements): (Task, u8),
) -> Compensator<'t, T, N> {
    let most = [T::from_f64(0.2); N];
    let settings = Settings { refinements, ramp_ticks: 0, max_change: most, ..Settings::new(task) };
    let mut out = Compensator::new(Arm::new(p), settings, &[T::ZERO; N]).unwrap();
    out.set_active(true);
    out
}

/// A term that says that links grow, by nothing, changes no bit of a tick.
fn growth_of_none<T: Scalar, const N: usize>(
    links: &[Link<f64>; N],
    how: (Task, u8),
    case: &Case,
) -> Result<(), TestCaseError> {
    let (command, state) = (case.command(links), case.state());
    let [without, with] =
        [None, Some(0.0)].map(|growth| compensator(&arm::<T, N>(links, growth), how));
    let [without, with] = [without, with].map(|mut c| c.tick(&command, &state));
    prop_assert_eq!(without, with, "{} joints", N);
    Ok(())
}

/// Near a limit all is computed anew; where a limit is nearer than the largest correction by
/// a trifle only, that gives the same but for it, in parts of the largest correction.
fn sines_anew<T: Scalar, const N: usize>(
    links: &[Link<f64>; N],
    how: (Task, u8),
    case: &Case,
    [trifle, most]: [f64; 2],
) -> Result<(), TestCaseError> {
    let (command, state) = (case.command::<T, N>(links), case.state());
    for growth in [None, Some(2e-5)] {
        let mut p = arm::<T, N>(links, growth);
        let free = compensator(&p, how).correction(&command, &state).unwrap();
        let low = T::from_f64(0.03 * (1.0 - trifle));
        p.limits[N - 1] = Some([command[N - 1] - low, T::from_f64(9.0)]);
        let mut compensator = compensator(&p, how);
        prop_assert!(compensator.tick(&command, &state).clamped.limit.contains(N - 1));
        let anew = compensator.correction(&command, &state).unwrap();
        for (free, anew) in free.iter().zip(&anew) {
            let off = (*free - *anew).abs().to_f64() / 0.03;
            prop_assert!(off < most, "{N} joints, {how:?}, {growth:?}: {off:.1e}");
        }
    }
    Ok(())
}

/// What one tick leaves in place does not count in the next, with another arm in it.
fn ticks_after_ticks<T: Scalar, const N: usize>(
    links: &[Link<f64>; N],
    how: (Task, u8),
    cases: &[Case],
) -> Result<(), TestCaseError> {
    let arms = [Some(2e-5), None, Some(0.0)].map(|growth| arm::<T, N>(links, growth));
    let mut used = compensator(&arms[0], how);
    for (case, p) in cases.iter().zip(arms.iter().cycle()) {
        used.set_arm(Arm::new(p)).unwrap();
        let (command, state) = (case.command(links), case.state());
        let fresh = compensator(p, how).tick(&command, &state);
        prop_assert_eq!(used.tick(&command, &state), fresh, "{} joints", N);
    }
    Ok(())
}

/// Of four joints to seven, turning and sliding.
macro_rules! each_arm {
    ($check:ident::<$scalar:ty>($($argument:expr),*)) => {
        $check::<$scalar, 4>(&scara(), $($argument),*)?;
        $check::<$scalar, 6>(&ur10(), $($argument),*)?;
        $check::<$scalar, 6>(&puma(), $($argument),*)?;
        $check::<$scalar, 7>(&seven(), $($argument),*)?;
        $check::<$scalar, 7>(&rail(), $($argument),*)?;
    };
}

fn how() -> impl Strategy<Value = (Task, u8)> {
    (prop_oneof![Just(Task::Position), Just(Task::Pose)], 1..=4_u8)
}

proptest! {
    #[test]
    fn links_that_do_not_grow_are_walked_as_if_they_could(how in how(), case in case()) {
        each_arm!(growth_of_none::<f32>(how, &case));
        each_arm!(growth_of_none::<f64>(how, &case));
    }

    #[test]
    fn sines_at_hand_are_those_taken_anew(how in how(), case in case()) {
        each_arm!(sines_anew::<f32>(how, &case, [1e-4, 1e-2]));
        each_arm!(sines_anew::<f64>(how, &case, [1e-9, 1e-6]));
    }

    #[test]
    fn nothing_of_a_tick_counts_in_the_next(
        how in how(), cases in proptest::collection::vec(case(), 2..6),
    ) {
        each_arm!(ticks_after_ticks::<f32>(how, &cases));
        each_arm!(ticks_after_ticks::<f64>(how, &cases));
    }
}
