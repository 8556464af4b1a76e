//! What a controller has to know of an arm, and its blob.

use nalgebra::Vector3;
use truearm::blob::{Blob, DecodeError, EncodeError, encode_with};
use truearm::effects::{MAX_TERMS, Masses, Term};
use truearm::{ArmParameters, Curves, JointKind, Link, MdhParameters};

use crate::{fixed, with_joints};

/// [`ArmParameters`] of any number of joints: the same fields, in the same units.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters<'t> {
    /// Hash of the robot's model name and serial.
    pub robot_id: u64,
    /// Grows with every parameter set of a robot.
    pub sequence: u32,
    /// When they were identified, Unix seconds; 0 if unknown.
    pub created: u32,
    /// Nominal links, one a joint: as many as each list below has.
    pub nominal: Vec<Link<f64>>,
    /// Identified corrections, added to the nominal parameters.
    pub corrections: Vec<MdhParameters<f64>>,
    /// From the identified to the commanded frame: translation, m.
    pub base_translation: Vector3<f64>,
    /// The same: rotation vector, rad.
    pub base_rotation: Vector3<f64>,
    /// Default tool point in the identified flange frame, m.
    pub tool: Vector3<f64>,
    /// What the arm does beyond rigid geometry.
    pub terms: heapless::Vec<Term<f64>, MAX_TERMS>,
    /// Smooth errors of joint angles over a turn.
    pub curves: Curves<'t>,
    /// Gravity and the masses it pulls at.
    pub masses: Option<LinkMasses>,
    /// Temperature the geometry refers to, degrees Celsius.
    pub reference_temperature: f64,
    /// Joint limits, rad or m.
    pub limits: Vec<Option<[f64; 2]>>,
    /// Smallest and largest joint values of the identification, rad or m.
    pub covered: Vec<Option<[f64; 2]>>,
    /// RMS position error before identification, m; 0 if unknown.
    pub rms_before: f64,
    /// Cross-validated RMS position error after it, m; 0 if unknown.
    pub rms_after: f64,
    /// Whether the data determined the orientation of the flange.
    pub orientation_identified: bool,
}

/// [`Masses`] of any number of links.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkMasses {
    /// Gravity in the nominal base frame, m/s^2.
    pub gravity: Vector3<f64>,
    /// Mass of each link, kg.
    pub mass: Vec<f64>,
    /// Its centre of mass in its own frame, m.
    pub com: Vec<Vector3<f64>>,
    /// Centre of mass of the payload in the last frame, m.
    pub payload_com: Vector3<f64>,
}

impl<'t> Parameters<'t> {
    /// What a blob holds.
    ///
    /// # Errors
    /// Why a controller would refuse it.
    pub fn read(blob: &Blob<'t>) -> Result<Self, DecodeError> {
        with_joints!(blob.joints(), N => blob.parameters::<f64, N>().map(Self::of))
    }

    /// Writes the blob, with the factor of a covariance, and says how long it is.
    ///
    /// # Errors
    /// As [`encode_with`].
    ///
    /// # Panics
    /// Lists of different lengths, or of more than [`truearm::MAX_JOINTS`].
    pub fn encode(&self, factor: Option<&[f32]>, out: &mut [u8]) -> Result<usize, EncodeError> {
        with_joints!(self.nominal.len(), N => encode_with(&self.sized::<N>(), factor, out))
    }

    /// What each joint does.
    #[must_use]
    pub fn kinds(&self) -> Vec<JointKind> {
        self.nominal.iter().map(|link| link.kind).collect()
    }

    fn of<const N: usize>(p: ArmParameters<'t, f64, N>) -> Self {
        Self {
            robot_id: p.robot_id,
            sequence: p.sequence,
            created: p.created,
            nominal: p.nominal.to_vec(),
            corrections: p.corrections.to_vec(),
            base_translation: p.base_translation,
            base_rotation: p.base_rotation,
            tool: p.tool,
            terms: p.terms,
            curves: p.curves,
            masses: p.masses.map(|m| LinkMasses {
                gravity: m.gravity,
                mass: m.mass.to_vec(),
                com: m.com.to_vec(),
                payload_com: m.payload_com,
            }),
            reference_temperature: p.reference_temperature,
            limits: p.limits.to_vec(),
            covered: p.covered.to_vec(),
            rms_before: p.rms_before,
            rms_after: p.rms_after,
            orientation_identified: p.orientation_identified,
        }
    }

    pub(crate) fn sized<const N: usize>(&self) -> ArmParameters<'t, f64, N> {
        ArmParameters {
            robot_id: self.robot_id,
            sequence: self.sequence,
            created: self.created,
            nominal: fixed(&self.nominal),
            corrections: fixed(&self.corrections),
            base_translation: self.base_translation,
            base_rotation: self.base_rotation,
            tool: self.tool,
            terms: self.terms.clone(),
            curves: self.curves,
            masses: self.masses.as_ref().map(|m| Masses {
                gravity: m.gravity,
                mass: fixed(&m.mass),
                com: fixed(&m.com),
                payload_com: m.payload_com,
            }),
            reference_temperature: self.reference_temperature,
            limits: fixed(&self.limits),
            covered: fixed(&self.covered),
            rms_before: self.rms_before,
            rms_after: self.rms_after,
            orientation_identified: self.orientation_identified,
        }
    }
}
