//! Arms with so few lengths that a unit can hardly be told.

use crate::mistakes::read;
use crate::simulated::Truth;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::check::{Said, Verdict, check};
use truearm_host::model::Robot;

/// An arm whose only length is that of its tool, measured better than a mistake is judged: the
/// points were said to be in centimetres.
#[test]
fn a_rotary_table_raises_no_alarm() {
    let robot = "name = \"table\"\nmeasurement_sigma_mm = 0.02\n[[joints]]\nalpha_deg = 0.0\n\
                 a_mm = 0.0\nd_mm = 300.0\ntheta_offset_deg = 0.0\n[tool]\nxyz_mm = [150, 0, 20]\n";
    for seed in 0..4 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut text = "q1_deg,x_mm,y_mm,z_mm\n".to_owned();
        for _ in 0..40 {
            let q: f64 = rng.random_range(-170.0..170.0);
            let (sin, cos) = q.to_radians().sin_cos();
            let mut noise = || rng.random_range(-0.03..0.03);
            let (x, y, z) =
                (1000.0 + 150.0 * cos + noise(), 150.0 * sin + noise(), 320.0 + noise());
            text += &format!("{q:.4},{x:.4},{y:.4},{z:.4}\n");
        }
        let (robot, data) = read(robot, &text);
        let finding = check(&robot, &data);
        assert_eq!(finding.verdict, Verdict::Sound, "seed {seed}: {:?}", finding.said);
    }
}

/// The points of two joints in another unit are found, however well a bent arm fits them as they
/// stand; those of a rotary table are of a larger tool, which is said.
#[test]
fn units_of_arms_with_few_lengths() {
    let joint = |alpha: f64, a: f64, d: f64| {
        format!("[[joints]]\nalpha_deg = {alpha}\na_mm = {a}\nd_mm = {d}\ntheta_offset_deg = 0.0\n")
    };
    let text = |joints: &[String]| {
        let joints = joints.concat();
        format!(
            "name = \"x\"\nmeasurement_sigma_mm = 0.02\n{joints}[tool]\nxyz_mm = [300, 20, 60]\n"
        )
    };
    let (first, second) = (joint(0.0, 0.0, 200.0), joint(90.0, 50.0, 0.0));
    let arms = [text(&[first.clone(), second]), text(&[first])];
    for (arm, told) in arms.iter().zip([true, false]) {
        for (unit, millimetres) in [("mm", 1.0), ("cm", 10.0), ("inch", 25.4), ("m", 1000.0)] {
            let robot = Robot::parse("robot.toml".as_ref(), arm).unwrap();
            let mut rng = ChaCha8Rng::seed_from_u64(9);
            let joints = robot.joints.len();
            let truth = Truth::draw(&robot, 1, 1, &mut rng);
            let mut data: String = (1..=joints).map(|k| format!("q{k}_deg,")).collect();
            data += "x_mm,y_mm,z_mm\n";
            for _ in 0..50 {
                let q: Vec<f64> = (0..joints).map(|_| rng.random_range(-1.7..1.7)).collect();
                let mut point = truth.point(&q, 0, 0);
                point.iter_mut().for_each(|x| *x += rng.random_range(-3e-5..3e-5));
                let angles: String = q.iter().map(|q| format!("{:.6},", q.to_degrees())).collect();
                let [x, y, z] = [0, 1, 2].map(|k| 1e3 * point[k] / millimetres);
                data += &format!("{angles}{x:.9},{y:.9},{z:.9}\n");
            }
            let (robot, data) = read(arm, &data);
            let finding = check(&robot, &data);
            let said = format!("{joints} joints in {unit}: {:?}", finding.said);
            let unseen = finding.absorbed.iter().any(|what| what == "unit of the points");
            match (told, unit) {
                (true, "mm") => assert_eq!(finding.verdict, Verdict::Sound, "{said}"),
                (true, _) => {
                    let is = |said: &Said| said.what == "point-unit" && said.from == unit;
                    assert!(matches!(&finding.said[..], [one] if is(one)), "{said}");
                }
                (false, "mm") => {
                    assert!(finding.verdict == Verdict::Sound && unseen, "{said}");
                }
                (false, _) => {}
            }
        }
    }
}

/// One point again and again agrees with any arm whose tool is on the axis, however the joint turns.
#[test]
fn points_in_one_place_are_no_sound_file() {
    let robot = "name = \"x\"\nmeasurement_sigma_mm = 0.02\n[[joints]]\nalpha_deg = 0.0\na_mm = 0.0\n\
                 d_mm = 300.0\ntheta_offset_deg = 0.0\n[tool]\nxyz_mm = [150, 0, 20]\n";
    for (turned, noise, why) in
        [(0.0, 0.0, "1 pose "), (1.0, 0.0, "in one place"), (1.0, 0.02, "in one place")]
    {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut text = "q1_deg,x_mm,y_mm,z_mm\n".to_owned();
        for k in 0..30 {
            let mut noise = || noise * rng.random_range(-1.7..1.7);
            let (x, y, z) = (1000.0 + noise(), 200.0 + noise(), 300.0 + noise());
            text += &format!("{},{x},{y},{z}\n", turned * f64::from(k));
        }
        let (robot, data) = read(robot, &text);
        let finding = check(&robot, &data);
        assert_eq!(finding.verdict, Verdict::NotUnderstood, "{:?}", finding.said);
        let told = finding.too_few.unwrap_or_default();
        assert!(told.contains(why), "{told}");
    }
}
