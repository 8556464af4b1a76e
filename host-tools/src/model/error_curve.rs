//! Smooth errors of joint angles over a turn, as the controller has them: what the
//! host predicts with is the table that is flashed, bit for bit.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use truearm::Curves;
use truearm::blob::{curve_len, encode_curve_with, gaps_len};
use truearm::effects::{Curve, Gaps};

/// Name of the effect in reports.
pub const CURVE: &str = "joint-error-curve";
/// Steps of the largest node of a table whose step follows from it.
const MOST_STEPS: f64 = 32_767.0;
/// Places between two nodes at which a function is looked at.
const LOOKS: usize = 8;

/// `theta += f(q)` of one joint: nodes of a periodic cubic B-spline, see
/// [`truearm::effects::Curve`].
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorCurve {
    joint: u8,
    band: f64,
    step: f32,
    nodes: Vec<i16>,
    gaps: Option<Guessed>,
}

/// Stretches between nodes where a curve is guessed: [`truearm::effects::Gaps`].
#[derive(Debug, Clone, PartialEq)]
struct Guessed {
    band: f64,
    known: Vec<u8>,
}

/// How near a curve comes to the function it was made of, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveFit {
    /// RMS distance over a turn.
    pub rms: f64,
    /// Largest distance.
    pub worst: f64,
    /// What rounding the nodes to whole steps can do: half a step.
    pub rounding: f64,
}

impl ErrorCurve {
    /// Of a joint, counted from 0, with these nodes, rad, the first at angle 0, and this
    /// standard deviation, rad. Nodes are rounded to the step that the largest of them
    /// allows, so that nothing moves by more than [`ErrorCurve::rounding`].
    ///
    /// # Errors
    /// What no controller takes, in words: a number of nodes that is not a power of two
    /// from 32 to 512, an error or a band above 0.05 rad, a number that is none.
    pub fn new(joint: u8, nodes: &[f64], band: f64) -> Result<Self, String> {
        let most = nodes.iter().fold(0.0, |most: f64, node| most.max(node.abs()));
        let mut step = (most / MOST_STEPS) as f32;
        if f64::from(step) * MOST_STEPS < most {
            // Rounded down: the largest node would be half a step more than fits.
            step = step.next_up();
        }
        Self::with_step(joint, nodes, step, band)
    }

    /// The same in steps of this size, rad, as another table had them.
    ///
    /// # Errors
    /// As for [`ErrorCurve::new`], and a node of more than 32,767 steps.
    pub fn with_step(joint: u8, nodes: &[f64], step: f32, band: f64) -> Result<Self, String> {
        if let Some(k) = nodes.iter().position(|node| !node.is_finite()) {
            return Err(format!("node {} is not finite", k + 1));
        }
        let steps = nodes.iter().map(|node| match node / f64::from(step) {
            _ if *node == 0.0 => Some(0),
            // NaN and infinity of a step of 0 are in no range, either.
            steps if (-32_768.5..32_767.5).contains(&steps) => Some(steps.round() as i16),
            _ => None,
        });
        let nodes: Option<Vec<i16>> = steps.collect();
        let nodes = nodes.ok_or_else(|| format!("a node has more than 32767 steps of {step:e}"))?;
        let curve = Self { joint, band, step, nodes, gaps: None };
        let mut bytes = vec![0; curve.len()];
        match curve.encode(&mut bytes) {
            Ok(_) => Ok(curve),
            Err(_) if !matches!(curve.nodes.len(), 32 | 64 | 128 | 256 | 512) => {
                Err(format!("{} nodes where 32, 64, 128, 256 or 512 are read", curve.nodes.len()))
            }
            Err(_) if !(0.0..=0.05).contains(&band) => {
                Err(format!("a band of {band:e} rad where 0 to 0.05 are read"))
            }
            Err(_) => Err(format!("a step of {step:e} rad, so an error of more than 0.05 rad")),
        }
    }

    /// The table of so many nodes that comes nearest to a function of the joint's
    /// angle, rad, of a period of a turn: least squares over eight places a node.
    ///
    /// # Errors
    /// As for [`ErrorCurve::new`].
    pub fn of_function(
        joint: u8,
        nodes: usize,
        band: f64,
        function: impl Fn(f64) -> f64,
    ) -> Result<(Self, CurveFit), String> {
        let places = LOOKS * nodes;
        let looks: Vec<(f64, f64)> = (0..places)
            .map(|i| (i as f64 + 0.5) * TAU / places as f64)
            .map(|q| (q, function(q)))
            .collect();
        let mut normal = DMatrix::zeros(nodes, nodes);
        let mut rhs = DVector::zeros(nodes);
        for (q, value) in &looks {
            let weights = Curve::weights(nodes, *q);
            for (i, a) in weights {
                rhs[i] += a * value;
                weights.iter().for_each(|(j, b)| normal[(i, *j)] += a * b);
            }
        }
        let solved = normal.cholesky().map(|factor| factor.solve(&rhs));
        let solved = solved.ok_or_else(|| format!("{nodes} nodes are no table"))?;
        let curve = Self::new(joint, solved.as_slice(), band)?;
        let tables = JointTables::new(std::slice::from_ref(&curve));
        let off = |(q, value): &(f64, f64)| tables.value(joint, *q) - value;
        let square: f64 = looks.iter().map(|look| off(look).powi(2)).sum();
        let fit = CurveFit {
            rms: (square / places as f64).sqrt(),
            worst: looks.iter().fold(0.0, |worst, look| off(look).abs().max(worst)),
            rounding: curve.rounding(),
        };
        Ok((curve, fit))
    }

    /// As a blob has it.
    #[must_use]
    pub fn of_blob(curve: &Curve<'_>) -> Self {
        let gaps = curve
            .gaps()
            .map(|gaps| Guessed { band: f64::from(gaps.band()), known: gaps.known().to_vec() });
        Self {
            joint: curve.joint(),
            band: f64::from(curve.band()),
            step: curve.step(),
            nodes: curve.nodes().collect(),
            gaps,
        }
    }

    /// The same, not known in these stretches between nodes, the first behind node 0; one
    /// standard deviation there is `band`, rad. Stretches beyond the nodes are left out.
    ///
    /// # Errors
    /// A band that no controller takes, in words.
    pub fn with_gaps(self, band: f64, stretches: &[usize]) -> Result<Self, String> {
        let mut known = vec![0xff; self.nodes.len() / 8];
        for stretch in stretches.iter().filter(|stretch| **stretch < self.nodes.len()) {
            known[stretch / 8] &= !(1 << (stretch % 8));
        }
        if known.iter().all(|bits| *bits == 0xff) {
            return Ok(self);
        }
        let curve = Self { gaps: Some(Guessed { band, known }), ..self };
        let encoded = curve.encode(&mut vec![0; curve.len()]);
        encoded.map_err(|_| format!("a band of {band:e} rad in gaps where 0 to 0.05 are read"))?;
        Ok(curve)
    }

    /// One standard deviation where it is not known, rad; none where it is known all over.
    #[must_use]
    pub fn gap_band(&self) -> Option<f64> {
        self.gaps.as_ref().map(|gaps| gaps.band)
    }

    /// Stretches between nodes where it is not known, the first behind node 0.
    #[must_use]
    pub fn gaps(&self) -> Vec<usize> {
        let Some(gaps) = &self.gaps else { return Vec::new() };
        (0..self.nodes.len()).filter(|k| gaps.known[k / 8] >> (k % 8) & 1 == 0).collect()
    }

    /// The same as turns from one angle to another, rad, the lower first.
    #[must_use]
    pub fn gap_ranges(&self) -> Vec<[f64; 2]> {
        let stretch = TAU / self.nodes.len() as f64;
        let gaps = self.gaps();
        let runs = gaps.chunk_by(|a, b| a + 1 == *b);
        runs.map(|run| [run[0] as f64 * stretch, (run[0] + run.len()) as f64 * stretch]).collect()
    }

    /// Whether it is known at encoder reading `q`, rad.
    #[must_use]
    pub fn knows(&self, q: f64) -> bool {
        let Some(gaps) = &self.gaps else { return true };
        let turns = (q / TAU).rem_euclid(1.0);
        let stretch = (turns * self.nodes.len() as f64) as usize % self.nodes.len();
        gaps.known[stretch / 8] >> (stretch % 8) & 1 != 0
    }

    /// One standard deviation at encoder reading `q`, rad.
    #[must_use]
    pub fn band_at(&self, q: f64) -> f64 {
        match &self.gaps {
            Some(gaps) if !self.knows(q) => gaps.band,
            _ => self.band,
        }
    }

    /// Bytes in a blob.
    fn len(&self) -> usize {
        let gaps = if self.gaps.is_some() { gaps_len(self.nodes.len()) } else { 0 };
        curve_len(self.nodes.len()) + gaps
    }

    /// The joint, counted from 0.
    #[must_use]
    pub fn joint(&self) -> u8 {
        self.joint
    }

    /// One standard deviation, rad.
    #[must_use]
    pub fn band(&self) -> f64 {
        self.band
    }

    /// What one unit of the table is, rad.
    #[must_use]
    pub fn step(&self) -> f32 {
        self.step
    }

    /// The nodes, rad: coefficients of the spline, the first at angle 0.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = f64> {
        self.nodes.iter().map(|node| f64::from(*node) * f64::from(self.step))
    }

    /// How far rounding may have moved the curve, rad: half a step.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        0.5 * f64::from(self.step)
    }

    /// Largest and RMS error over a turn, rad.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        let tables = JointTables::new(std::slice::from_ref(self));
        let places = LOOKS * self.nodes.len();
        let value = |i: usize| tables.value(self.joint, i as f64 * TAU / places as f64);
        let square: f64 = (0..places).map(|i| value(i).powi(2)).sum();
        let most = (0..places).fold(0.0, |most: f64, i| most.max(value(i).abs()));
        [most, (square / places as f64).sqrt()]
    }

    fn encode(&self, out: &mut [u8]) -> Result<usize, truearm::blob::EncodeError> {
        let gaps = self.gaps.as_ref().map(|gaps| Gaps::new(gaps.band as f32, &gaps.known));
        encode_curve_with(self.joint, self.step, self.band as f32, &self.nodes, gaps, out)
    }
}

/// Curves as a controller reads them, to be asked for values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointTables(Vec<u8>);

impl JointTables {
    /// Of curves in any order, one a joint; a later one of the same joint is left out.
    #[must_use]
    pub fn new(curves: &[ErrorCurve]) -> Self {
        let mut sorted: Vec<&ErrorCurve> = curves.iter().collect();
        sorted.sort_by_key(|curve| curve.joint);
        sorted.dedup_by_key(|curve| curve.joint);
        let mut bytes = Vec::new();
        for curve in sorted {
            let at = bytes.len();
            bytes.resize(at + curve.len(), 0);
            curve.encode(&mut bytes[at..]).unwrap_or_else(|e| unreachable!("made whole: {e}"));
        }
        Self(bytes)
    }

    /// The bytes, borrowed as from a slot.
    #[must_use]
    pub fn curves(&self) -> Curves<'_> {
        Curves::of(&self.0).unwrap_or_else(|e| unreachable!("encoded so: {e}"))
    }

    /// What is added to a joint, counted from 0, at encoder reading `q`, rad; 0 without a
    /// curve.
    #[must_use]
    pub fn value(&self, joint: u8, q: f64) -> f64 {
        self.curves().of_joint(joint).map_or(0.0, |curve| curve.at(q))
    }

    /// The same of all joints.
    #[must_use]
    pub fn bend(&self, q: &[f64]) -> Vec<f64> {
        let mut bend = vec![0.0; q.len()];
        for curve in self.curves().iter() {
            let joint = usize::from(curve.joint());
            if let (Some(bend), Some(q)) = (bend.get_mut(joint), q.get(joint)) {
                *bend = curve.at(*q);
            }
        }
        bend
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smooth(q: f64) -> f64 {
        3e-4 * (q + 0.3).sin() - 1e-4 * (7.0 * q).cos() + 5e-5 * (31.0 * q + 1.0).sin()
    }

    #[test]
    fn a_function_becomes_a_table_as_near_as_it_says() {
        for (nodes, near) in [(64, 3e-5), (128, 5e-7), (256, 4e-8), (512, 1e-8)] {
            let (curve, fit) = ErrorCurve::of_function(2, nodes, 1e-5, smooth).unwrap();
            assert!(fit.rms < near && fit.worst < 4.0 * near, "{nodes}: {fit:?}");
            assert!(fit.rounding == curve.rounding() && fit.rounding < 8e-9);
            let tables = JointTables::new(&[curve]);
            for k in 0..2000 {
                let q = f64::from(k) * 0.0173 - 17.0;
                assert!((tables.value(2, q) - smooth(q)).abs() < fit.worst * 1.2 + 1e-12);
            }
        }
    }

    /// Whatever order they come in.
    #[test]
    fn tables_are_sorted_by_joint() {
        let curve = |joint| ErrorCurve::of_function(joint, 32, 1e-5, f64::sin).unwrap_err();
        assert!(curve(0).contains("more than 0.05 rad"));
        let curve = |joint: u8| {
            let small = |q: f64| 1e-4 * (q + f64::from(joint)).sin();
            ErrorCurve::of_function(joint, 32, 1e-5, small).unwrap().0
        };
        let one = JointTables::new(&[curve(1), curve(4), curve(3)]);
        let other = JointTables::new(&[curve(3), curve(1), curve(4)]);
        assert_eq!(one, other);
        let q = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        let bend = one.bend(&q);
        for joint in 0..6 {
            assert_eq!(bend[usize::from(joint)], one.value(joint, q[usize::from(joint)]));
        }
        assert_eq!(JointTables::new(&[]).bend(&q), [0.0; 6]);
    }

    /// As the controller reads them, at any number of turns.
    #[test]
    fn gaps_are_those_of_the_table() {
        let (curve, _) = ErrorCurve::of_function(1, 32, 1e-5, |q| 1e-4 * q.sin()).unwrap();
        assert_eq!(curve.clone().with_gaps(3e-4, &[]), Ok(curve.clone()));
        assert_eq!(curve.clone().with_gaps(3e-4, &[32, 99]), Ok(curve.clone()));
        assert!(curve.clone().with_gaps(0.06, &[1]).unwrap_err().contains("in gaps"));
        let gapped = curve.with_gaps(3e-4, &[0, 1, 7, 30, 31]).unwrap();
        assert_eq!(gapped.gaps(), [0, 1, 7, 30, 31]);
        let degrees: Vec<_> =
            gapped.gap_ranges().iter().map(|r| r.map(|q| q.to_degrees().round())).collect();
        assert_eq!(degrees, [[0.0, 23.0], [79.0, 90.0], [338.0, 360.0]]);
        let tables = JointTables::new(std::slice::from_ref(&gapped));
        let read = tables.curves().of_joint(1).unwrap();
        assert_eq!(ErrorCurve::of_blob(&read).gaps(), gapped.gaps());
        for k in -900..900 {
            let q = f64::from(k) * 0.02 + 0.003;
            assert_eq!(read.knows(q), gapped.knows(q), "{q}");
            assert!((f64::from(read.band_at(q)) - gapped.band_at(q)).abs() < 1e-10);
        }
    }

    #[test]
    fn what_a_table_cannot_hold_is_named() {
        let refused = |nodes: &[f64], band| ErrorCurve::new(0, nodes, band).unwrap_err();
        assert!(refused(&[1e-4; 100], 0.0).contains("100 nodes"));
        assert!(refused(&[1e-4; 256], -1.0).contains("band"));
        assert!(refused(&[0.1; 256], 0.0).contains("more than 0.05 rad"));
        let mut nodes = [1e-4; 64];
        nodes[7] = f64::NAN;
        assert_eq!(refused(&nodes, 0.0), "node 8 is not finite");
        assert!(ErrorCurve::with_step(0, &[1e-3; 32], 1e-8, 0.0).unwrap_err().contains("32767"));
        assert!(ErrorCurve::with_step(0, &[1e-3; 32], 0.0, 0.0).unwrap_err().contains("32767"));
        let zero = ErrorCurve::new(0, &[0.0; 32], 1e-5).unwrap();
        assert_eq!((zero.step(), zero.size()), (0.0, [0.0; 2]));
    }
}
