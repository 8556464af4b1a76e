//! Names must not hang on a sigma that nobody knows: the shipped sets with half
//! and with twice the stated noise.

use std::collections::BTreeSet;
use std::path::Path;

use truearm_host::blob::pack;
use truearm_host::diagnose::{DiagnoseOptions, Effect, Outcome, Verdict, diagnose};
use truearm_host::evaluate::{Reregister, evaluate};
use truearm_host::model::{Measurements, Model, Robot};

type Names = BTreeSet<(String, Vec<usize>)>;

/// Names, the noise over the stated sigma, and whether structure without a name
/// is left.
fn named(folder: &Path, factor: f64) -> (Names, f64, bool) {
    let mut robot = Robot::read(&folder.join("robot.toml")).unwrap();
    robot.sigma *= factor;
    let data = Measurements::read(&folder.join("measurements.csv"), &robot).unwrap();
    let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
    let report = found.outcome;
    assert!(report.effects.iter().all(|e| e.probability >= 0.9));
    let names = report.effects.iter().map(|e| (e.name.to_owned(), e.joints.clone())).collect();
    (names, report.noise_scale, !report.unnamed.is_empty())
}

/// A sigma may be any, but not by two orders of magnitude: then the drawing or the files are
/// wrong, and what is left is not called noise.
#[test]
fn a_rest_beyond_any_sigma_is_said() {
    let set =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases/case_014");
    for (factor, expected) in [(0.05, Verdict::Clean), (0.01, Verdict::Unexplained)] {
        let mut robot = Robot::read(&set.join("robot.toml")).unwrap();
        robot.sigma *= factor;
        let data = Measurements::read(&set.join("measurements.csv"), &robot).unwrap();
        let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
        assert_eq!(found.outcome.verdict, expected, "{factor}: {:?}", found.outcome.unnamed);
        let said = found.outcome.unnamed.iter().any(|w| w.contains("see truearm check"));
        assert_eq!(said, expected == Verdict::Unexplained, "{factor}");
    }
}

/// Effects of 20 floors beside a sigma stated at a third: geometry alone leaves 130 of those, and
/// bends links by more than any arm has to follow them. That is no reason to give up before any
/// effect was asked.
#[test]
fn large_effects_beside_a_small_sigma_are_named() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/palletiser");
    let robot = Robot::read(&folder.join("robot.toml")).unwrap();
    let data = Measurements::read(&folder.join("measurements.csv"), &robot).unwrap();
    let found = diagnose(&robot, &data, None, &DiagnoseOptions::default(), &|_| ()).unwrap();
    let outcome = found.outcome;
    let names: Names =
        outcome.effects.iter().map(|e| (e.name.to_owned(), e.joints.clone())).collect();
    let expected = [
        ("encoder-eccentricity", vec![1]),
        ("joint-coupling", vec![1, 2]),
        ("joint-compliance", vec![3]),
    ];
    assert_eq!(names, expected.map(|(name, joints)| (name.to_owned(), joints)).into());
    assert_eq!(outcome.verdict, Verdict::Explained);
    assert!((2.0..4.0).contains(&outcome.noise_scale), "{}", outcome.noise_scale);
}

#[test]
fn names_do_not_hang_on_the_stated_sigma() {
    let sets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases");
    for (case, expected, nameless) in [
        ("case_004", vec![], true),
        ("case_005", vec![("tool-remount", vec![])], false),
        ("case_009", vec![("thermal-expansion", vec![])], false),
        ("case_014", vec![], false),
        ("case_016", vec![("backlash", vec![4])], false),
    ] {
        let expected: Names = expected.into_iter().map(|(n, j)| (n.to_owned(), j)).collect();
        for factor in [0.5, 2.0] {
            let (names, scale, left) = named(&sets.join(case), factor);
            println!("{case} x {factor}: {names:?}, noise {scale:.3} times the stated one");
            assert_eq!((&names, left), (&expected, nameless), "{case} x {factor}");
            assert!((scale * factor - 1.0).abs() < 0.15, "{case} x {factor}: {scale}");
        }
    }
}

/// A row that was written twice was measured once: same names, probabilities and
/// error bars.
#[test]
fn rows_written_again_change_nothing() {
    let sets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases");
    for case in ["case_005", "case_014", "case_015"] {
        let robot = Robot::read(&sets.join(case).join("robot.toml")).unwrap();
        let text = std::fs::read_to_string(sets.join(case).join("measurements.csv")).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        let report = |times: usize| {
            let text = format!("{header}\n{}", rows.repeat(times));
            let data = Measurements::parse(Path::new("m.csv"), &text, &robot).unwrap();
            let options = DiagnoseOptions::default();
            diagnose(&robot, &data, None, &options, &|_| ()).unwrap().outcome
        };
        let once = report(1);
        for times in [2, 3] {
            let again = report(times);
            assert_eq!((again.verdict, again.effects.len()), (once.verdict, once.effects.len()));
            for (a, b) in again.effects.iter().zip(&once.effects) {
                assert_eq!((a.name, &a.joints), (b.name, &b.joints), "{case} x {times}");
                assert!((a.probability - b.probability).abs() < 0.05, "{case} x {times}");
                for (a, b) in a.coefficients.iter().zip(&b.coefficients) {
                    assert!((a.sigma / b.sigma - 1.0).abs() < 0.05, "{case} x {times}");
                }
            }
            assert!(again.figures.warnings.iter().any(|w| w.contains("count once")));
        }
    }
}

/// A model for less room has no more terms than there is room for, and is still
/// better than geometry alone.
#[test]
fn a_model_has_no_more_terms_than_asked_for() {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases/case_015");
    let robot = Robot::read(&folder.join("robot.toml")).unwrap();
    let data = Measurements::read(&folder.join("measurements.csv"), &robot).unwrap();
    let report = |most_terms| {
        let options = DiagnoseOptions { most_terms, ..DiagnoseOptions::default() };
        let found = diagnose(&robot, &data, None, &options, &|_| ()).unwrap();
        let gap = found.outcome.gap.iter().filter_map(|row| row.cross_validated_rms_mm);
        (found.model.terms.len(), gap.collect::<Vec<f64>>(), found.outcome.verdict)
    };
    let (all, ..) = report(128);
    assert!(all > 2, "{all}");
    for most in [1, 2] {
        let (terms, gap, verdict) = report(most);
        assert_ne!(verdict, Verdict::Clean, "{most}");
        assert!(terms <= most, "{terms} terms where {most} were asked for");
        assert!(gap[gap.len() - 1] < gap[0], "{gap:?}");
    }
}

/// Where nobody weighed the arm, the moments of its links are fitted beside the
/// springs: no second name for what assumed masses get wrong, no spring that is not
/// at least suspected, and points as good as with masses.
#[test]
fn springs_are_named_without_masses() {
    let sets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/hidden-effects/cases");
    let spring = |joint| ("joint-compliance", vec![joint]);
    for (case, expected) in [
        ("case_012", vec![spring(3)]),
        ("case_014", vec![]),
        ("case_015", vec![("encoder-eccentricity", vec![5]), spring(2), spring(3)]),
        ("case_018", vec![("base-compliance", vec![])]),
    ] {
        let report = |weighed: bool| {
            let mut robot = Robot::read(&sets.join(case).join("robot.toml")).unwrap();
            if !weighed {
                robot.links.clear();
            }
            let read =
                |file: &str| Measurements::read(&sets.join(case).join(file), &robot).unwrap();
            let (data, holdout) = (read("measurements.csv"), read("holdout.csv"));
            let options = DiagnoseOptions::default();
            let found = diagnose(&robot, &data, Some(&holdout), &options, &|_| ()).unwrap();
            // The file has loads that another program reads, and the same points.
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join("model.toml");
            std::fs::write(&file, found.model.to_toml()).unwrap();
            let model = Model::read(&file).unwrap();
            let again = evaluate(&model, &holdout, Reregister::Nothing).unwrap();
            let (again, told) = (again.stats.unwrap().rms_mm, &found.outcome);
            let first = told.gap.last().unwrap().holdout_rms_mm.unwrap();
            assert!((again - first).abs() < 1e-3 * first, "{case}: {again} {first}");
            assert!(pack(&model, None).is_ok(), "{case}");
            found.outcome
        };
        let (with, without) = (report(true), report(false));
        let each = |effects: &[Effect]| -> Vec<(&'static str, Vec<usize>)> {
            let single = |e: &Effect| match e.joints.is_empty() {
                true => vec![(e.name, Vec::new())],
                false => e.joints.iter().map(|joint| (e.name, vec![*joint])).collect(),
            };
            effects.iter().flat_map(single).collect()
        };
        let (named, suspected) = (each(&without.effects), each(&without.suspected));
        assert!(named.iter().all(|name| expected.contains(name)), "{case}: {named:?}");
        let told = |e: &(&'static str, Vec<usize>)| named.contains(e) || suspected.contains(e);
        assert!(expected.iter().all(told), "{case}: {named:?}, suspected {suspected:?}");
        assert!(named.is_empty() == expected.is_empty(), "{case}: {named:?}");
        let left = |o: &Outcome| o.gap.last().unwrap().holdout_rms_mm.unwrap();
        assert!(left(&without) < 1.1 * left(&with), "{case}: {} {}", left(&without), left(&with));
    }
}
