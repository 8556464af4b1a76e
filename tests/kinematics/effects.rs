//! Effects against independent formulas: potential energy and scaled links of
//! the 4x4 oracle, difference quotients.

use crate::common::{self, Matrix, identity, link, product, puma, rotation, scara, ur10};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::Approach::{self, Negative, Positive, Unknown};
use truearm::blob::{Blob, encode, encoded_len};
use truearm::effects::{
    ActsOn, Effect, Load, Masses, NeedsLoad, Order, Term, TermInputs, deflection,
};
use truearm::kinematics::Deflection;
use truearm::{Arm, ArmParameters, Chain, Curves, JointKind, Link, MdhParameters, Pose, State};

const TOOL: [f64; 3] = [0.05, -0.03, 0.12];

fn tool() -> Pose<f64> {
    Pose::translation(TOOL[0], TOOL[1], TOOL[2])
}

fn joints<const N: usize>(rng: &mut ChaCha8Rng, links: &[Link<f64>; N]) -> [f64; N] {
    links.map(|link| match link.kind {
        JointKind::Revolute => rng.random_range(-6.2..6.2),
        JointKind::Prismatic => rng.random_range(-0.2..0.3),
    })
}

/// Masses of all links; gravity of a robot that hangs askew.
fn masses<const N: usize>(rng: &mut ChaCha8Rng) -> Masses<f64, N> {
    let mut point = || Vector3::from_fn(|_, _| rng.random_range(-0.3..0.3));
    let (com, payload_com) = ([0; N].map(|_| point()), point());
    let mass = [0; N].map(|_| rng.random_range(0.5..15.0));
    Masses { gravity: Vector3::new(3.1, -4.2, -8.3), mass, com, payload_com }
}

/// The transform of a link whose axis is turned about x and y of the frame before.
fn tilted(base: &Link<f64>, [x, y]: [f64; 2], q: f64) -> Matrix<f64> {
    let [alpha, a, theta, d, beta] = base.parameters.to_array();
    let before = link(JointKind::Revolute, [alpha, a, 0.0, 0.0, 0.0], 0.0);
    let tilt = product(&rotation(0, x), &rotation(1, y));
    product(&product(&before, &tilt), &link(base.kind, [0.0, 0.0, theta, d, beta], q))
}

/// Potential energy, J, of an arm on a base, the axis of one joint tilted.
fn potential<const N: usize>(
    base: &Matrix<f64>,
    (links, axis, tilt): (&[Link<f64>; N], usize, [f64; 2]),
    masses: &Masses<f64, N>,
    payload: f64,
    q: &[f64; N],
) -> f64 {
    let mut frame = *base;
    let height = |frame: &Matrix<f64>, p: &Vector3<f64>| {
        let along =
            |i: usize| frame[i][0] * p.x + frame[i][1] * p.y + frame[i][2] * p.z + frame[i][3];
        -(0..3).map(|i| along(i) * masses.gravity[i]).sum::<f64>()
    };
    let mut energy = 0.0;
    for i in 0..N {
        let own = if i == axis { tilt } else { [0.0; 2] };
        frame = product(&frame, &tilted(&links[i], own, q[i]));
        energy += masses.mass[i] * height(&frame, &masses.com[i]);
    }
    energy + payload * height(&frame, &masses.payload_com)
}

/// Largest error of joint torques, of base moments and of those across axes, N m or N.
fn load_errors<const N: usize>(links: &[Link<f64>; N]) -> [f64; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let chain = Chain::new(links, Pose::identity(), tool());
    let h = 1e-5;
    let mut worst = [0.0_f64; 3];
    for payload in [0.0, 7.5] {
        for _ in 0..50 {
            let masses = masses(&mut rng);
            let q = joints(&mut rng, links);
            let load = masses.load(&chain, &q, payload);
            for j in 0..N {
                let energy = |step: f64| {
                    let mut moved = q;
                    moved[j] += step;
                    potential(&identity(), (links, 0, [0.0; 2]), &masses, payload, &moved)
                };
                let torque = -(energy(h) - energy(-h)) / (2.0 * h);
                worst[0] = worst[0].max((torque - load.torque[j]).abs());
                for axis in 0..2 {
                    let energy = |turn: f64| {
                        let tilt = [[turn, 0.0], [0.0, turn]][axis];
                        potential(&identity(), (links, j, tilt), &masses, payload, &q)
                    };
                    let moment = -(energy(h) - energy(-h)) / (2.0 * h);
                    worst[2] = worst[2].max((moment - load.across.unwrap()[j][axis]).abs());
                }
            }
            for axis in 0..2 {
                let energy = |turn: f64| {
                    let rigid = (links, 0, [0.0; 2]);
                    potential(&rotation(axis, turn), rigid, &masses, payload, &q)
                };
                let moment = -(energy(h) - energy(-h)) / (2.0 * h);
                worst[1] = worst[1].max((moment - load.moment[axis]).abs());
            }
        }
    }
    worst
}

#[test]
fn gravity_loads_are_the_slope_of_the_potential_energy() {
    for (name, worst) in [
        ("UR10", load_errors(&ur10())),
        ("spherical wrist", load_errors(&puma())),
        ("SCARA, prismatic", load_errors(&scara())),
    ] {
        println!("{name}: torque, base moment, moment across {worst:?} N m");
        assert!(worst.iter().all(|w| *w < 1e-6), "{name}: {worst:?}");
    }
}

fn term(effect: Effect, joint: u8, component: u8) -> Term<f64> {
    let order = match effect.order() {
        Order::Harmonic => 2.0,
        Order::Cycles => 7.25 + 193.75 * f64::from(joint % 2),
        Order::None | Order::Friction => 0.0,
        Order::TimeConstant => 1500.0,
    };
    Term { effect, joint, source: 1 - u8::from(joint == 1), component, order, coefficient: 0.0 }
}

/// Every effect on every joint, both components; a friction that gravity
/// exceeds at times.
fn all_terms<const N: usize>() -> Vec<Term<f64>> {
    let mut terms = Vec::new();
    for effect in Effect::ALL {
        if effect.acts_on() == ActsOn::Lengths {
            terms.push(term(*effect, Term::<f64>::ALL, 0));
        }
        for joint in 0..N as u8 {
            for component in 0..2 {
                terms.push(term(*effect, joint, component));
            }
            if effect.order() == Order::Friction {
                terms.push(Term { order: 12.5, ..term(*effect, joint, 0) });
            }
        }
    }
    terms
}

/// Largest relative error of `Term::column`, and of how many columns.
fn column_error<const N: usize>(links: &[Link<f64>; N]) -> (f64, usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let base =
        Pose::from_rotation_vector(Vector3::new(0.3, -1.2, 0.4), Vector3::new(0.4, -0.7, 1.9));
    let chain = Chain::new(links, base, tool());
    let nominal = Chain::new(links, Pose::identity(), tool());
    let (mut worst, mut count) = (0.0_f64, 0);
    for _ in 0..10 {
        let q = joints(&mut rng, links);
        let load = masses(&mut rng).load(&nominal, &q, 3.0);
        let approach = [0; N].map(|_| if rng.random_bool(0.5) { Positive } else { Negative });
        let inputs = TermInputs { q, load, approach, warmth: 8.0 };
        for term in all_terms::<N>() {
            let basis = term.basis(&inputs);
            let bent =
                |bend: f64| deflection(&[Term { coefficient: bend / basis, ..term }], &inputs);
            let point = |bend: f64| chain.forward_deflected(&q, &bent(bend)).translation;
            // Base and axes turn by a rotation vector: their columns are those of small ones.
            let turns = matches!(term.effect.acts_on(), ActsOn::Base | ActsOn::Axis);
            let bends = if turns { vec![0.0] } else { vec![0.0, 2e-3] };
            for bend in bends {
                let jacobian = chain.identification_jacobian(&bent(bend).deflected(&q));
                let about = |axis: usize| {
                    let own = base.rotation.column(axis);
                    (0..3).map(|i| jacobian.base_rotation[i] * own[i]).sum::<Vector3<f64>>()
                };
                let column =
                    term.column(&inputs, links, &jacobian.links, &[about(0), about(1), about(2)]);
                let h = 1e-5;
                let difference = (point(bend + h) - point(bend - h)) / (2.0 * h) * basis;
                if column.norm() < 1e-9 * basis.abs() {
                    // A link without length does not grow.
                    assert!(difference.norm() < 1e-9 * basis.abs(), "{term:?}");
                    continue;
                }
                worst = worst.max((difference - column).norm() / column.norm());
                count += 1;
            }
        }
    }
    (worst, count)
}

#[test]
fn columns_are_the_slope_of_the_bent_chain() {
    for (name, (error, count)) in [
        ("UR10", column_error(&ur10())),
        ("spherical wrist", column_error(&puma())),
        ("SCARA, prismatic", column_error(&scara())),
    ] {
        println!("{name}: {count} columns, relative error {error:.1e}");
        assert!(error < 1e-6 && count > 1000, "{name}: {error:e}");
    }
}

/// To first order in the tilts, axes tilt where they stand: 0.1 mrad of every one.
#[test]
fn axes_tilt_where_they_stand() {
    fn check<const N: usize>(links: &[Link<f64>; N]) {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let chain = Chain::new(links, Pose::identity(), tool());
        for _ in 0..50 {
            let q = joints(&mut rng, links);
            let tilts = [0; N].map(|_| [0; 2].map(|_| rng.random_range(-1e-4..1e-4)));
            let bent = Deflection { axes: Some(tilts), ..Deflection::none() };
            let pose = chain.forward_deflected(&q, &bent);
            let mut exact = identity();
            for ((l, q), tilt) in links.iter().zip(q).zip(tilts) {
                exact = product(&exact, &tilted(l, tilt, q));
            }
            exact = product(&exact, &common::translation(TOOL));
            for i in 0..3 {
                assert!((exact[i][3] - pose.translation[i]).abs() < 5e-7);
                for j in 0..3 {
                    assert!((exact[i][j] - pose.rotation[(i, j)]).abs() < 5e-7);
                }
            }
        }
    }
    check(&ur10());
    check(&puma());
    check(&scara());
    // A beta next to parallel axes turns the frames that the chain works in.
    check(&ur10().map(|mut link| {
        link.parameters.beta = 1e-3;
        link
    }));
}

#[test]
fn growth_of_all_links_scales_their_lengths() {
    fn check<const N: usize>(links: &[Link<f64>; N]) {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let chain = Chain::new(links, Pose::identity(), tool());
        let coefficient = 1.2e-5;
        let term = Term { coefficient, ..term(Effect::ThermalExpansion, Term::<f64>::ALL, 0) };
        for _ in 0..50 {
            let q = joints(&mut rng, links);
            let warmth = rng.random_range(-30.0..30.0);
            let inputs = TermInputs { q, load: Load::none(), approach: [Unknown; N], warmth };
            let pose = chain.forward_deflected(&q, &deflection(&[term], &inputs));
            let mut exact = identity();
            for (l, q) in links.iter().zip(q) {
                let mut p = l.parameters;
                p.a *= 1.0 + coefficient * warmth;
                p.d *= 1.0 + coefficient * warmth;
                exact = product(&exact, &link(l.kind, p.to_array(), q));
            }
            exact = product(&exact, &common::translation(TOOL));
            for i in 0..3 {
                assert!((exact[i][3] - pose.translation[i]).abs() < 1e-14);
                for j in 0..3 {
                    assert!((exact[i][j] - pose.rotation[(i, j)]).abs() < 1e-14);
                }
            }
        }
    }
    check(&ur10());
    check(&puma());
    check(&scara());
}

/// Approach, gravity torque, friction, and the side of the gap.
#[test]
fn sides_of_a_gap() {
    for (approach, torque, friction, side) in [
        // Approach only.
        (Positive, 0.0, 0.0, 1.0),
        (Negative, 0.0, 0.0, -1.0),
        (Positive, 50.0, 0.0, 1.0),
        (Negative, -50.0, 0.0, -1.0),
        // Gravity below friction leaves the joint where it came to rest.
        (Positive, 4.9, 5.0, 1.0),
        (Negative, -4.9, 5.0, -1.0),
        // Beyond it, a torque in +q carries the link to the side on which a
        // motion in -q would have left it, wherever it came from.
        (Positive, 5.1, 5.0, -1.0),
        (Negative, 5.1, 5.0, -1.0),
        (Positive, -5.1, 5.0, 1.0),
        (Negative, -5.1, 5.0, 1.0),
        // Unknown: the middle, unless gravity decides.
        (Unknown, 4.9, 5.0, 0.0),
        (Unknown, 50.0, 0.0, 0.0),
        (Unknown, 5.1, 5.0, -1.0),
        (Unknown, -5.1, 5.0, 1.0),
    ] {
        let load = Load { torque: [0.0, torque], ..Load::none() };
        let approaches = [Unknown, approach];
        let inputs = TermInputs { q: [0.3, 0.4], load, approach: approaches, warmth: 0.0 };
        let term = Term { order: friction, ..term(Effect::Backlash, 1, 0) };
        // The link lags on the other side of the gap.
        assert_eq!(term.basis(&inputs), -side, "{approach:?} {torque} {friction}");
        assert_eq!(term.needs_load(), friction > 0.0);
    }
}

fn parameters(terms: &[Term<f64>]) -> ArmParameters<'static, f64, 6> {
    let nominal = ur10();
    let zero = MdhParameters::from_array([0.0; 5]);
    let mut corrections = [zero; 6];
    corrections[2].a = 1e-3;
    ArmParameters {
        robot_id: 0,
        sequence: 0,
        created: 0,
        nominal,
        corrections,
        base_translation: Vector3::new(1e-3, 0.0, 2e-3),
        base_rotation: Vector3::new(0.0, 1e-3, 0.0),
        tool: Vector3::from(TOOL),
        terms: heapless::Vec::from_slice(terms).unwrap(),
        curves: Curves::NONE,
        masses: Some(masses(&mut ChaCha8Rng::seed_from_u64(8))),
        reference_temperature: 21.0,
        limits: [None; 6],
        covered: [None; 6],
        rms_before: 0.0,
        rms_after: 0.0,
        orientation_identified: false,
    }
}

const Q: [f64; 6] = [0.3, -1.1, 0.8, 2.0, -0.4, 1.0];

#[test]
fn an_arm_bends_by_its_terms_and_its_state() {
    let soft = Term { coefficient: 1e-5, ..term(Effect::JointCompliance, 1, 0) };
    let warm = Term { coefficient: 1e-5, ..term(Effect::ThermalExpansion, Term::<f64>::ALL, 0) };
    let gap = Term { coefficient: 1e-4, ..term(Effect::Backlash, 2, 0) };
    let p = parameters(&[soft, warm, gap]);
    let arm = Arm::new(&p);
    let torque = |payload| p.masses.unwrap().load(arm.real(), &Q, payload).torque[1];
    let state = State { approach: [Positive; 6], payload: 5.0, temperature: 31.0, torque: None };
    let deflection = arm.deflection(&Q, &state);
    assert_eq!(deflection.joints, [0.0, 1e-5 * torque(5.0), -1e-4, 0.0, 0.0, 0.0]);
    assert!(deflection.growth.iter().all(|g| (g - 1e-4).abs() < 1e-18));
    assert_eq!(arm.real_pose_in(&Q, &state), arm.real().forward_deflected(&Q, &deflection));

    // Without a state: gravity acts, payload, warmth and approach do not.
    let at_rest = arm.deflection(&Q, &State::at(21.0));
    assert_eq!(at_rest.joints, [0.0, 1e-5 * torque(0.0), 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(at_rest.growth, [0.0; 6]);
    assert_eq!(arm.real_pose(&Q), arm.real().forward_deflected(&Q, &at_rest));

    let longer = arm.with_tool(Pose::translation(0.0, 0.0, 0.5));
    assert_eq!(longer.deflection(&Q, &state), deflection);
    assert_ne!(longer.real_pose(&Q), longer.real().forward(&Q));
}

/// What a joint is bent by does not depend on which part of an angle is called its zero.
#[test]
fn loads_are_those_of_the_identified_arm() {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    let soft = [1, 2, 4]
        .map(|joint| Term { coefficient: 1e-5, ..term(Effect::JointCompliance, joint, 0) });
    let tilting = Term { coefficient: 1e-5, ..term(Effect::BaseCompliance, 0, 0) };
    let bearing = Term { coefficient: 1e-5, ..term(Effect::LateralCompliance, 3, 0) };
    let mut most: f64 = 0.0;
    for _ in 0..200 {
        let mut drawn = parameters(&[soft[0], soft[1], soft[2], tilting, bearing]);
        for correction in &mut drawn.corrections {
            correction.theta = rng.random_range(-0.1..0.1);
            correction.a = rng.random_range(-0.01..0.01);
            correction.alpha = rng.random_range(-0.01..0.01);
        }
        drawn.base_rotation = Vector3::new(0.3, -0.2, 1.0);
        let links = *Arm::new(&drawn).real().links();
        let exact =
            ArmParameters { nominal: links, corrections: Default::default(), ..drawn.clone() };
        let ignorant = ArmParameters { corrections: Default::default(), ..drawn.clone() };
        let q = [0; 6].map(|_| rng.random_range(-3.1..3.1));
        let state = State { payload: rng.random_range(0.0..9.0), ..State::at(21.0) };
        let [found, exact, ignorant] =
            [drawn, exact, ignorant].map(|p| Arm::new(&p).deflection(&q, &state));
        assert_eq!(found, exact);
        let apart = |k: usize| (found.joints[k] - ignorant.joints[k]).abs();
        most = most.max(apart(1)).max(apart(2));
    }
    assert!(most > 5e-5, "a zero that is degrees off counts: {most:e} rad");
}

#[test]
fn an_arm_without_terms_is_rigid() {
    let arm = Arm::new(&parameters(&[]));
    let state = State { approach: [Positive; 6], payload: 5.0, temperature: 40.0, torque: None };
    assert_eq!(arm.real_pose(&Q), arm.real().forward(&Q));
    assert_eq!(arm.real_pose_in(&Q, &state), arm.real().forward(&Q));
    // Without masses a term that only they tell does nothing; a blob with such a term is
    // refused. One that follows torques has no pose until they are read.
    let tilting = Term { coefficient: 1e-5, ..term(Effect::BaseCompliance, 0, 0) };
    let weightless = Arm::new(&ArmParameters { masses: None, ..parameters(&[tilting]) });
    assert_eq!(weightless.real_pose_in(&Q, &state), weightless.real().forward(&Q));
    let soft = Term { coefficient: 1e-5, ..term(Effect::JointCompliance, 1, 0) };
    let unread = Arm::new(&ArmParameters { masses: None, ..parameters(&[soft]) });
    assert!(unread.real_pose_in(&Q, &state).translation.iter().all(|x| x.is_nan()));
    let read = State { torque: Some([3.0; 6]), ..state };
    let bent = Deflection { joints: [0.0, 3e-5, 0.0, 0.0, 0.0, 0.0], ..Deflection::none() };
    assert_eq!(unread.real_pose_in(&Q, &read), unread.real().forward_deflected(&Q, &bent));
}

#[test]
fn folded_terms_give_the_sum_of_the_terms() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let repertoire = all_terms::<6>();
    for _ in 0..200 {
        let mut terms = heapless::Vec::new();
        while !terms.is_full() {
            let any = repertoire[rng.random_range(0..repertoire.len())];
            let most = f64::from(any.effect.usual());
            terms.push(Term { coefficient: rng.random_range(-most..most), ..any }).unwrap();
        }
        let q = [0; 6].map(|_| rng.random_range(-6.2..6.2));
        let state = State {
            approach: [0; 6].map(|_| Approach::of_motion(f64::from(rng.random_range(-1..=1)))),
            payload: rng.random_range(0.0..9.0),
            temperature: rng.random_range(10.0..30.0),
            torque: None,
        };
        let parameters = ArmParameters { terms, ..parameters(&[]) };
        let (arm, masses) = (Arm::new(&parameters), parameters.masses.unwrap());
        let inputs = TermInputs {
            q,
            load: masses.load(arm.real(), &q, state.payload),
            approach: state.approach,
            warmth: state.temperature - parameters.reference_temperature,
        };
        let folded = arm.deflection(&q, &state);
        let sum = deflection(&parameters.terms, &inputs);
        let parts = |d: &Deflection<f64, 6>| {
            let axes = d.axes.unwrap_or([[0.0; 2]; 6]);
            [&d.joints[..], &d.base[..], axes.as_flattened(), &d.growth[..]].concat()
        };
        for (folded, sum) in parts(&folded).into_iter().zip(parts(&sum)) {
            assert!((folded - sum).abs() < 1e-14, "{folded} {sum}");
        }
    }
}

#[test]
fn descriptors_are_consistent() {
    for (place, effect) in Effect::ALL.iter().enumerate() {
        let name = effect.name();
        assert_eq!(usize::from(effect.code()), place, "{name}");
        // A name stands once, so that it is found again.
        assert_eq!(Effect::from_name(name), Some(*effect));
        assert!(name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{name}");
        assert!(matches!(effect.components().len(), 0 | 2), "{name}");
        assert!((1e-6..=0.1).contains(&effect.plausible()), "{name}");
        // What is usual is far from the limit.
        assert!(effect.usual() > 0.0 && effect.usual() < 0.03 * effect.plausible(), "{name}");
        let friction = effect.order() == Order::Friction;
        assert!(friction || effect.load() != NeedsLoad::WithFriction, "{name}");
        assert!(effect.suits(JointKind::Revolute), "{name}");
        // What counts cycles a turn, or tilts what it turns about, is nothing of a joint
        // that slides.
        let turns = effect.order().is_cycles() || effect.acts_on() == ActsOn::Axis;
        assert_eq!(effect.suits(JointKind::Prismatic), !turns, "{name}");
        let [turns, slides] = [JointKind::Revolute, JointKind::Prismatic];
        let own = effect.acts_on() == ActsOn::Joint;
        assert_eq!(effect.unit(turns, turns) != effect.unit(slides, slides), own, "{name}");
        assert_eq!(
            effect.unit(turns, turns) != effect.unit(turns, slides),
            effect.is_coupled(),
            "{name}"
        );
    }
    assert_eq!(Effect::from_name("ghost"), None);
}

/// What a term depends on is what its effect says it needs.
#[test]
fn a_basis_depends_on_what_its_effect_needs() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    for term in all_terms::<6>() {
        let (mut load, mut approach, mut warmth) = (false, false, false);
        for _ in 0..50 {
            let torque = [0; 6].map(|_| rng.random_range(-40.0..40.0));
            let inputs = TermInputs {
                q: [0; 6].map(|_| rng.random_range(-3.0..3.0)),
                load: Load { torque, moment: [7.0, -9.0], across: Some([[3.0, -2.0]; 6]) },
                approach: [Positive; 6],
                warmth: 5.0,
            };
            let basis = |inputs: TermInputs<f64, 6>| term.basis(&inputs);
            let here = basis(inputs);
            load |= here != basis(TermInputs { load: Load::none(), ..inputs });
            approach |= here != basis(TermInputs { approach: [Negative; 6], ..inputs });
            warmth |= here != basis(TermInputs { warmth: -2.0, ..inputs });
        }
        assert_eq!(load, term.needs_load(), "{term:?}");
        assert_eq!(approach, term.effect.needs_approach(), "{term:?}");
        assert_eq!(warmth, term.effect.needs_warmth(), "{term:?}");
    }
}

#[test]
fn every_term_comes_back_from_a_blob() {
    for some in all_terms::<6>() {
        let unused = some.component > 0 && some.effect.components().is_empty();
        let f = |x: f64| f64::from(x as f32);
        let written = Term {
            component: if unused { 0 } else { some.component },
            source: if some.effect.is_coupled() { some.source } else { 0 },
            joint: some.own_joint().unwrap_or(if some.of_all_links() { some.joint } else { 0 }),
            coefficient: f(f64::from(some.effect.plausible()) * 0.7),
            ..some
        };
        if some.effect.is_coupled() && some.source == some.joint {
            continue;
        }
        let mut bytes = [0; 1024];
        let sent = parameters(&[Term { source: some.source, ..written }]);
        encode(&sent, &mut bytes).unwrap();
        let blob = Blob::check(&bytes[..encoded_len(6, 1)]).unwrap();
        let read = blob.parameters::<f64, 6>().unwrap();
        assert_eq!(read.terms[..], [written]);
        // Beyond what is plausible it is refused.
        let wild = Term { coefficient: 1.001 * f64::from(some.effect.plausible()), ..written };
        assert!(encode(&parameters(&[wild]), &mut bytes).is_err(), "{wild:?}");
    }
}

#[test]
fn the_format_lists_every_effect() {
    let text = include_str!("../../src/blob/FORMAT.md");
    let head =
        "| effect | name | component | joint | order | coefficient (revolute joint), at most |";
    let table = text.split_once(head).expect("the table of effects").1;
    let rows: Vec<Vec<&str>> = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    assert_eq!(rows.len(), Effect::ALL.len());
    for (effect, row) in Effect::ALL.iter().zip(rows) {
        let [code, name, component, joint, order, most] = row[..] else { panic!("{row:?}") };
        assert_eq!((code, name), (&*effect.code().to_string(), effect.name()));
        let parts = match effect.components() {
            [first, second] if effect.acts_on() == ActsOn::Base => {
                format!("0: about {first}, 1: about {second}")
            }
            [first, second] => format!("0: {first}, 1: {second}"),
            _ => "0".to_owned(),
        };
        assert_eq!(component, parts, "{name}");
        let place = match effect.acts_on() {
            ActsOn::Base => "0",
            ActsOn::Lengths => "the link, or 0 and \"all links\"",
            ActsOn::Joint if effect.is_coupled() => "yes, and another as source",
            ActsOn::Joint | ActsOn::Axis => "yes",
        };
        assert_eq!(joint, place, "{name}");
        let orders = match effect.order() {
            Order::None => "0",
            Order::Harmonic => "1 or 2 cycles a turn",
            Order::Cycles => "cycles a turn, above 0",
            Order::Friction => "friction torque, N m; 0: direction only",
            Order::TimeConstant => "time constant; 0: none",
        };
        assert_eq!(order, orders, "{name}");
        let (size, unit) = most.split_once(' ').unwrap();
        assert_eq!(size.parse(), Ok(effect.plausible()), "{name}");
        let turns = JointKind::Revolute;
        let short = |unit: &str| unit.replace("(N m)", "Nm");
        assert_eq!(short(unit), short(effect.unit(turns, turns)), "{name}");
    }
}
