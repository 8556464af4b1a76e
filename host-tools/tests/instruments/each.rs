//! Every kind of measurement in `identify`, judged by what can be reached, and
//! what mixed kinds, wrong sigmas and labels do.

use std::fs;
use std::path::Path;

use crate::judged::{Judged, cell, efficiency, read, robot};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use truearm_host::evaluate::{Reregister, evaluate};
use truearm_host::identify::start::registration::register;
use truearm_host::identify::{Identification, Options, Problem, Scaling, State, identify};
use truearm_host::model::{Measurements, Model, Robot};

const SEEDS: u64 = 40;

fn reaches_its_bound(wanted: &[(&'static str, usize)]) {
    let [ratio, two_errors, bound] = efficiency(&robot(), wanted, SEEDS);
    println!("{wanted:?}: {ratio:.3} +- {two_errors:.3} of {:.4} mm", bound * 1e3);
    assert!(ratio <= 1.03 + two_errors, "{wanted:?}");
}

#[test]
fn points_and_poses_reach_their_bound() {
    reaches_its_bound(&[("point", 50)]);
    reaches_its_bound(&[("pose", 50)]);
}

#[test]
fn lengths_reach_their_bound() {
    reaches_its_bound(&[("distance", 200)]);
    reaches_its_bound(&[("pair", 200)]);
}

#[test]
fn touches_reach_their_bound() {
    reaches_its_bound(&[("touch", 150)]);
    reaches_its_bound(&[("touch", 60), ("sphere", 60)]);
    reaches_its_bound(&[("cylinder", 150)]);
}

#[test]
fn holes_and_closures_reach_their_bound() {
    reaches_its_bound(&[("plate", 100)]);
    reaches_its_bound(&[("closure", 90)]);
}

#[test]
fn ranges_reach_their_bound() {
    reaches_its_bound(&[("range", 150)]);
}

#[test]
fn inclinations_beside_lengths_reach_their_bound() {
    reaches_its_bound(&[("inclination", 100), ("distance", 60)]);
}

#[test]
fn images_reach_their_bound() {
    reaches_its_bound(&[("pixel", 60)]);
}

fn found(robot: &Robot, data: &Measurements) -> Identification {
    identify(robot, data, &Options::default(), &|_, _| ()).unwrap()
}

fn state(found: &Identification) -> State {
    State {
        bases: found.model.stations.iter().map(|s| s.1).collect(),
        markers: found.model.markers.iter().map(|m| m.1).collect(),
        instruments: found.model.instruments.clone(),
        links: found.model.links(),
        terms: Vec::new(),
    }
}

/// Fifteen points and a hundred touches beat either alone, and a sigma that is
/// three times too large or too small in one kind does not hurt: what is wrong
/// is found out.
#[test]
fn mixed_kinds_find_their_own_noise() {
    let robot = robot();
    let mut squares = [0.0; 4];
    for seed in 0..6 {
        let mut rng = ChaCha8Rng::seed_from_u64(100 + seed);
        let cell = cell(&robot, &mut rng);
        let judged = Judged::new(&cell, &mut rng);
        let points = cell.file(&[("point", 15)], &mut rng);
        let touches = cell.file(&[("touch", 100)], &mut rng);
        let behind = touches.split_once('\n').unwrap().1;
        let both = points.clone() + behind;
        let error = |text: &str, sigma: f64| {
            let mut data = read(&robot, &cell, text);
            let touches = data.rows.iter_mut().filter(|r| r.kind.0 != 0);
            touches.for_each(|r| r.sigma *= sigma);
            let options = Options { allow_few_poses: true, ..Options::default() };
            let found = identify(&robot, &data, &options, &|_, _| ()).unwrap();
            (judged.error(&state(&found)), found)
        };
        let wrong = error(&both, 3.0);
        let scale = |k: usize| wrong.1.figures.kinds[k].noise_scale;
        assert!((scale(1) * 3.0 - 1.0).abs() < 0.3, "seed {seed}: touch {}", scale(1));
        let errors = [error(&points, 1.0).0, error(&touches, 1.0).0, error(&both, 1.0).0, wrong.0];
        (0..4).for_each(|k| squares[k] += errors[k].powi(2));
    }
    let [points, touches, both, wrong] = squares.map(|s| (s / 6.0).sqrt() * 1e3);
    println!(
        "15 points {points:.4}, 100 touches {touches:.4}, both {both:.4}, sigma x 3 {wrong:.4} mm"
    );
    assert!(both < points && both < touches && wrong < 1.1 * both);
}

/// Poses say how the last frame is turned, in the frame of the tracker, images and inclinations
/// in that of the arm; points, lengths and touches do not, nor does a ray, which may turn about
/// itself, nor do inclinations of which there are too few.
#[test]
fn what_is_turned_identifies_the_orientation() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let cell = cell(&robot, &mut rng);
    let mut identified = |kinds: &[(&'static str, usize)]| {
        let found = found(&robot, &read(&robot, &cell, &cell.file(kinds, &mut rng)));
        (found.model.orientation_identified, found.figures.rank)
    };
    assert_eq!(identified(&[("point", 50)]), (false, 27));
    assert_eq!(identified(&[("pose", 50)]), (true, 30));
    let kinds: [(&[(&str, usize)], bool); 8] = [
        (&[("range", 120)], false),
        (&[("pixel", 16)], true),
        (&[("inclination", 60), ("distance", 90)], true),
        (&[("inclination", 60), ("point", 50)], true),
        (&[("inclination", 5), ("distance", 90)], false),
        (&[("distance", 150)], false),
        (&[("touch", 60), ("plate", 30)], false),
        (&[("closure", 60), ("pair", 60)], false),
    ];
    for (kinds, known) in kinds {
        assert_eq!(identified(kinds).0, known, "{kinds:?}");
    }
}

/// Planes of unknown place leave the scale open, and it is said; a plate closes
/// it.
#[test]
fn planes_leave_the_scale_open() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let cell = cell(&robot, &mut rng);
    let open = |text: &str| {
        let found = found(&robot, &read(&robot, &cell, text));
        let told = found.figures.unidentifiable.iter().any(|line| line.contains("scale"));
        (told, found.figures)
    };
    let (told, figures) = open(&cell.file(&[("touch", 150)], &mut rng));
    assert!(told, "{:?}", figures.unidentifiable);
    assert!(figures.left_open[0].contains("overall scale"));
    let (told, figures) = open(&cell.file(&[("touch", 150), ("plate", 20)], &mut rng));
    assert!(!told, "{:?}", figures.unidentifiable);
}

/// A ray begins where it is said to, as a first guess: the sensor may sit far from
/// the tool that robot.toml has.
#[test]
fn a_guessed_ray_begins_where_it_is_said_to() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let cell = cell(&robot, &mut rng);
    let text = cell.file(&[("range", 60)], &mut rng);
    for guess in [true, false] {
        let stated = format!(
            "[[rays]]\nmarker = \"\"\norigin_mm = [300, -40, 20]\ndirection = [0, 0, 1]\n\
             guess = {guess}\n"
        );
        let data = Measurements::parse_with(Path::new("m.csv"), &text, &robot, &stated).unwrap();
        let start = register(&data, &robot.nominal(), robot.tool).unwrap();
        assert!((start.markers[0] - Vector3::new(0.3, -0.04, 0.02)).norm() < 1e-12);
        let unknown = Problem::new(&data, &robot, Scaling::Prior).unknowns.marker(0);
        assert_eq!(unknown.is_some(), guess);
    }
}

/// A wrong length is named with its component.
#[test]
fn a_wrong_length_is_flagged() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let cell = cell(&robot, &mut rng);
    let text = cell.file(&[("point", 20), ("distance", 240)], &mut rng);
    let mut data = read(&robot, &cell, &text);
    data.rows[100].measured[0] += 5e-3;
    let found = found(&robot, &data);
    assert_eq!(found.figures.outlier_rows, [101]);
    assert_eq!(found.figures.outliers[0].coordinates, ["distance"]);
    assert!((found.figures.outliers[0].residual_mm[0] - 5.0).abs() < 0.3);
    assert_eq!(found.rows[100].held_out.unwrap().len(), 1);
}

/// What a model says of its instruments is read again, and scores other rows.
#[test]
fn a_model_knows_its_instruments() {
    let robot = robot();
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let cell = cell(&robot, &mut rng);
    let kinds = [("pose", 40), ("distance", 60), ("touch", 60)];
    let found = found(&robot, &read(&robot, &cell, &cell.file(&kinds, &mut rng)));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    fs::write(&path, found.model.to_toml()).unwrap();
    let model = Model::read(&path).unwrap();
    assert_eq!(model.instruments.len(), found.model.instruments.len());
    let others = read(&robot, &cell, &cell.file(&kinds, &mut rng));
    let scored = evaluate(&model, &others, Reregister::Nothing).unwrap();
    for kind in &scored.kinds {
        let [before, after] = [kind.nominal_rms.unwrap(), kind.rms.unwrap()];
        println!("{} {}: {before:.4} nominal, {after:.4}", kind.kind, kind.unit);
        assert!(after < 0.2 * before, "{}", kind.kind);
    }
}

/// Wrong cells say where they are and what to do.
#[test]
fn labels_that_say_nothing_are_refused() {
    let robot = robot();
    let row = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,kind,plate,hole,camera,u_px,v_px,distance_mm\n\
               0,10,20,30,40,50,";
    for (cells, word) in [
        ("plate,p,h,,,,", "hole \"h\" of plate \"p\" is not known"),
        ("pixel,p,h,cam,1,2,", "camera \"cam\" is not known"),
        ("distance,,,,,,", "empty cell"),
        ("distance,,,,,,-5", "-0.005 m away"),
        ("length,,,,,,5", "kind \"length\""),
        ("pose,,,,,,", "a row of kind \"pose\" needs x_mm"),
    ] {
        let text = format!("{row}{cells}\n");
        let error = Measurements::parse(Path::new("m.csv"), &text, &robot).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
        assert!(!error.help().is_empty());
    }
}
