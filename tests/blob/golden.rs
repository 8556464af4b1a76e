//! Golden blobs: what was once written must be read for ever, with the same
//! meaning. How to add one is in tests/data/golden/README.md.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use truearm::blob::{Blob, LAYOUT, encode_with, encoded_len, factor_len, robot_id};
use truearm::effects::{Effect, MAX_TERMS, Masses, Term};
use truearm::{ArmParameters, Curves, Link, MdhParameters};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/golden").join(name)
}

/// What stands in a golden blob.
struct Golden<const N: usize> {
    name: &'static str,
    layout: u16,
    parameters: ArmParameters<'static, f32, N>,
    factor: Option<Vec<f32>>,
}

impl<const N: usize> Golden<N> {
    fn bytes(&self) -> Vec<u8> {
        let factor = self.factor.as_deref();
        let numbers = factor.map_or(0, <[f32]>::len);
        let size = encoded_len(N, self.parameters.terms.len()) + 4 * numbers;
        let mut bytes = vec![0; size + self.parameters.curves.as_bytes().len()];
        encode_with(&self.parameters, factor, &mut bytes).unwrap();
        bytes
    }

    /// The file gives these values, and, while its layout is the one that is
    /// written, these values give the file.
    fn holds(&self) {
        let file = std::fs::read(path(self.name)).unwrap();
        assert_eq!(file[4..6], self.layout.to_le_bytes(), "{}", self.name);
        let blob = Blob::check(&file).unwrap();
        assert_eq!(blob.parameters(), Ok(self.parameters.clone()), "{}", self.name);
        let factor: Option<Vec<f32>> = blob.covariance().map(|c| c.factor().collect());
        assert_eq!(factor, self.factor, "{}", self.name);
        if self.layout == LAYOUT {
            assert!(self.bytes() == file, "{}: written otherwise than before", self.name);
        }
    }

    /// Never overwrites: a golden blob that changes is none.
    fn write_if_missing(&self) {
        if self.layout == LAYOUT && !path(self.name).exists() {
            std::fs::write(path(self.name), self.bytes()).unwrap();
            println!("wrote {}", self.name);
        }
    }
}

#[test]
fn golden_blobs_mean_what_they_meant() {
    layout_3_least().holds();
    layout_3_full().holds();
    layout_3_covariance().holds();
    layout_3_stiffening().holds();
    layout_3_lateral().holds();
    layout_3_lag().holds();
    layout_3_torques().holds();
    layout_3_friction().holds();
    #[cfg(feature = "curves")]
    layout_3_curves().holds();
    #[cfg(feature = "curves")]
    layout_3_gaps().holds();
}

#[test]
#[ignore = "writes files, see tests/data/golden/README.md"]
fn write_missing_golden_blobs() {
    layout_3_least().write_if_missing();
    layout_3_full().write_if_missing();
    layout_3_covariance().write_if_missing();
    layout_3_stiffening().write_if_missing();
    layout_3_lateral().write_if_missing();
    layout_3_lag().write_if_missing();
    layout_3_torques().write_if_missing();
    layout_3_friction().write_if_missing();
    #[cfg(feature = "curves")]
    layout_3_curves().write_if_missing();
    #[cfg(feature = "curves")]
    layout_3_gaps().write_if_missing();
}

/// The example of FORMAT.md.
fn layout_3_least() -> Golden<1> {
    Golden { name: "layout-3-least.blob", layout: 3, parameters: least(), factor: None }
}

/// Three joints, one of them prismatic, terms of every effect.
fn layout_3_full() -> Golden<3> {
    Golden { name: "layout-3-full.blob", layout: 3, parameters: parameters(), factor: None }
}

/// One joint with a covariance.
fn layout_3_covariance() -> Golden<1> {
    let factor = Some((1..=factor_len(1, 0)).map(|k| k as f32 / 1024.0).collect());
    Golden { name: "layout-3-covariance.blob", layout: 3, parameters: least(), factor }
}

/// One joint with the effect that format 1.1 added.
fn layout_3_stiffening() -> Golden<1> {
    loaded("layout-3-stiffening.blob", Effect::JointStiffening, -2.5e-6)
}

/// One joint with the effect that format 1.3 added.
fn layout_3_lateral() -> Golden<1> {
    loaded("layout-3-lateral.blob", Effect::LateralCompliance, 1.5e-5)
}

/// One joint with the time constant that format 1.4 added: 25 minutes.
fn layout_3_lag() -> Golden<1> {
    let all = Term::<f32>::ALL;
    let terms = [(all, 1.2e-5), (0, 4e-6)]
        .map(|(joint, size)| term(Effect::ThermalExpansion, joint, 1500.0, size));
    let parameters = ArmParameters { terms: heapless::Vec::from_iter(terms), ..least() };
    Golden { name: "layout-3-lag.blob", layout: 3, parameters, factor: None }
}

/// One joint with a spring that follows torques that are read, which format 1.5 added.
fn layout_3_torques() -> Golden<1> {
    let terms = heapless::Vec::from_iter([term(Effect::JointCompliance, 0, 0.0, 9e-6)]);
    let parameters = ArmParameters { terms, ..least() };
    Golden { name: "layout-3-torques.blob", layout: 3, parameters, factor: None }
}

/// One joint with play whose friction, 0.1 N m, is in the steps that format 1.6 added, and
/// a spring softer than those before it.
fn layout_3_friction() -> Golden<1> {
    let soft = loaded("layout-3-friction.blob", Effect::JointCompliance, 0.03);
    let mut parameters = soft.parameters;
    parameters.terms.push(term(Effect::Backlash, 0, 410.0 / 4096.0, 5e-4)).unwrap();
    Golden { parameters, ..soft }
}

/// One joint with a curve that is not known everywhere, which format 1.5 added.
#[cfg(feature = "curves")]
fn layout_3_gaps() -> Golden<1> {
    use truearm::blob::{curve_len, encode_curve_with, gaps_len};
    use truearm::effects::Gaps;
    let nodes: Vec<i16> = (0..32).map(|k: i16| k * k * 31 - 15_000).collect();
    let mut bytes = vec![0; curve_len(32) + gaps_len(32)];
    let gaps = Gaps::new(2.5e-4, &[0xff, 0x1f, 0x00, 0xf8]);
    encode_curve_with(0, 1.5e-8, 2e-5, &nodes, Some(gaps), &mut bytes).unwrap();
    let parameters = ArmParameters { curves: Curves::of(bytes.leak()).unwrap(), ..least() };
    Golden { name: "layout-3-gaps.blob", layout: 3, parameters, factor: None }
}

/// One joint with masses and what they bend.
fn loaded(name: &'static str, effect: Effect, coefficient: f32) -> Golden<1> {
    let masses = Masses {
        gravity: Vector3::new(0.0, -9.8, 0.0),
        mass: [4.5],
        com: [Vector3::new(0.1, 0.0, 0.0)],
        payload_com: Vector3::new(0.1, 0.0, 0.0),
    };
    let terms = heapless::Vec::from_iter([term(effect, 0, 0.0, coefficient)]);
    let parameters = ArmParameters { terms, masses: Some(masses), ..least() };
    Golden { name, layout: 3, parameters, factor: None }
}

/// Three joints with everything that format 1.2 has: two curves and a covariance.
#[cfg(feature = "curves")]
fn layout_3_curves() -> Golden<3> {
    use truearm::blob::{curve_len, encode_curve};
    let node = |k: i32| (k * k * 37 % 65_536 - 32_768) as i16;
    let tables: [Vec<i16>; 2] = [(0..32).map(node).collect(), (32..288).map(node).collect()];
    let mut bytes = vec![0; curve_len(32) + curve_len(256)];
    let (first, second) = bytes.split_at_mut(curve_len(32));
    encode_curve(0, 1.5e-8, 2e-5, &tables[0], first).unwrap();
    encode_curve(2, 2.5e-8, 3e-5, &tables[1], second).unwrap();
    let curves = Curves::of(bytes.leak()).unwrap();
    let factor = Some((1..=factor_len(3, MAX_TERMS)).map(|k| k as f32 / 8192.0).collect());
    let parameters = ArmParameters { curves, ..parameters() };
    Golden { name: "layout-3-curves.blob", layout: 3, parameters, factor }
}

/// Never the rest without them.
#[cfg(not(feature = "curves"))]
#[test]
fn a_reader_without_curves_refuses_them() {
    let file = std::fs::read(path("layout-3-curves.blob")).unwrap();
    let refused = Blob::check(&file).unwrap_err().to_string();
    assert_eq!(refused, "flags has a value without a meaning in this layout");
    assert!(Curves::of(&[0; 76]).is_err());
}

/// FORMAT.md shows these bytes.
#[test]
fn the_example_of_the_format_is_a_golden_blob() {
    let text = include_str!("../../src/blob/FORMAT.md");
    let dump = text.split("```text\n").nth(1).and_then(|t| t.split("```").next()).unwrap();
    let bytes = dump.lines().flat_map(|line| {
        let (_, bytes) = line.split_once("  ").unwrap();
        bytes.split_whitespace().map(|b| u8::from_str_radix(b, 16).unwrap())
    });
    let bytes: Vec<u8> = bytes.collect();
    assert_eq!(bytes, std::fs::read(path("layout-3-least.blob")).unwrap());
}

fn least() -> ArmParameters<'static, f32, 1> {
    ArmParameters {
        robot_id: robot_id("arm", "0042"),
        sequence: 7,
        created: 1_700_000_000,
        nominal: [Link::revolute(0.0, 0.0, 0.0, 0.5, 0.0)],
        corrections: [MdhParameters::from_array([0.0, 0.0, 0.0, 2e-3, 0.0])],
        base_translation: Vector3::zeros(),
        base_rotation: Vector3::zeros(),
        tool: Vector3::new(0.1, 0.0, 0.0),
        terms: heapless::Vec::new(),
        curves: Curves::NONE,
        masses: None,
        reference_temperature: 20.0,
        limits: [Some([-3.0, 3.0])],
        covered: [Some([-1.5, 1.5])],
        rms_before: 2e-3,
        rms_after: 1e-4,
        orientation_identified: false,
    }
}

fn term(effect: Effect, joint: u8, order: f32, coefficient: f32) -> Term<f32> {
    Term { effect, joint, source: 0, component: 0, order, coefficient }
}

/// As many as there is room for, every effect among them.
fn every_effect() -> heapless::Vec<Term<f32>, MAX_TERMS> {
    let all = Term::<f32>::ALL;
    let mut terms = heapless::Vec::from_iter([
        term(Effect::JointCompliance, 1, 0.0, 1e-5),
        Term { component: 1, ..term(Effect::BaseCompliance, 0, 0.0, -2e-6) },
        term(Effect::EncoderEccentricity, 0, 2.0, 1e-4),
        Term { component: 1, ..term(Effect::GearTransmissionError, 2, 201.25, 5e-5) },
        term(Effect::JointPeriodicError, 2, 65535.0 / 64.0, -3e-5),
        term(Effect::JointGain, 0, 0.0, 2e-4),
        Term { source: 1, ..term(Effect::JointCoupling, 2, 0.0, 1e-3) },
        term(Effect::Backlash, 0, 0.0, 2e-4),
        term(Effect::Backlash, 1, 3.5, 2e-4),
        term(Effect::ThermalExpansion, all, 0.0, 1.2e-5),
        term(Effect::ThermalExpansion, 2, 0.0, 1e-5),
    ]);
    while terms.push(term(Effect::JointPeriodicError, 1, terms.len() as f32, 1e-5)).is_ok() {}
    terms
}

/// Three joints, one of them prismatic, with everything.
fn parameters() -> ArmParameters<'static, f32, 3> {
    let correction = |k: f32| MdhParameters::from_array([1e-3 * k, 2e-4, -3e-3, 4e-4 * k, 5e-4]);
    ArmParameters {
        robot_id: robot_id("arm", "0042"),
        sequence: 7,
        created: 1_700_000_000,
        nominal: [
            Link::revolute(0.0, 0.0, 0.0, 0.1273, 0.0),
            Link::prismatic(1.5, -0.612, 0.1, 0.02, 0.0),
            Link::revolute(-1.5, 0.3, 0.0, 0.0, 0.01),
        ],
        corrections: [correction(1.0), correction(2.0), correction(3.0)],
        base_translation: Vector3::new(1e-3, -2e-3, 3e-4),
        base_rotation: Vector3::new(1e-4, 2e-4, -3e-4),
        tool: Vector3::new(0.0, 0.01, 0.109),
        limits: [Some([-6.2, 6.2]), Some([0.0, 0.5]), None],
        covered: [Some([-1.0, 1.0]), None, Some([-2.0, 2.0])],
        rms_before: 1.1e-3,
        rms_after: 4.4e-4,
        terms: every_effect(),
        curves: Curves::NONE,
        masses: Some(Masses {
            gravity: Vector3::new(0.5, -0.1, -9.8),
            mass: [7.0, 12.5, 0.25],
            com: [Vector3::new(0.0, 0.1, -0.2), Vector3::zeros(), Vector3::new(0.3, 0.0, 0.0)],
            payload_com: Vector3::new(0.0, 0.02, 0.15),
        }),
        reference_temperature: 21.5,
        orientation_identified: false,
    }
}
