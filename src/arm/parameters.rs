//! Everything a controller has to know of an identified arm.

use heapless::Vec;
use nalgebra::Vector3;

use crate::effects::{Curves, MAX_TERMS, Masses, Term};
use crate::kinematics::{Link, MdhParameters};
use crate::scalar::Scalar;

/// Most joints of an arm: what a blob has numbers for.
pub const MAX_JOINTS: usize = 16;

/// Everything a controller has to know of an identified arm of N joints, SI
/// units; what a parameter blob carries. Its curves stay where the blob is, for
/// `'t`: `'static` where that is memory-mapped flash.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ArmParameters<'t, T, const N: usize> {
    /// Hash of the robot's model name and serial, see [`crate::blob::robot_id`].
    pub robot_id: u64,
    /// Grows with every parameter set of a robot.
    pub sequence: u32,
    /// When they were identified, Unix seconds; 0 if unknown.
    pub created: u32,
    /// Nominal links, as the controller's own kinematics has them.
    pub nominal: [Link<T>; N],
    /// Identified corrections, added to the nominal parameters.
    pub corrections: [MdhParameters<T>; N],
    /// Small rigid transform from the identified to the commanded (nominal
    /// base) frame: translation, m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub base_translation: Vector3<T>,
    /// The same: rotation vector, rad.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub base_rotation: Vector3<T>,
    /// Default tool point in the identified flange frame, m.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub tool: Vector3<T>,
    /// What the arm does beyond rigid geometry.
    pub terms: Vec<Term<T>, MAX_TERMS>,
    /// Smooth errors of joint angles over a turn.
    pub curves: Curves<'t>,
    /// Gravity in the frame of the chain's own base, before `base_rotation`, and the masses it
    /// pulls at. Without them a term that depends on a joint's torque follows those that are read,
    /// [`State::torque`](super::State::torque).
    pub masses: Option<Masses<T, N>>,
    /// Temperature the geometry refers to, degrees Celsius.
    pub reference_temperature: T,
    /// Joint limits, rad or m.
    pub limits: [Option<[T; 2]>; N],
    /// Smallest and largest joint values of the identification, rad or m.
    /// Poses outside are extrapolation.
    pub covered: [Option<[T; 2]>; N],
    /// RMS position error before identification, m; 0 if unknown.
    pub rms_before: T,
    /// Cross-validated RMS position error after identification, m; 0 if unknown.
    pub rms_after: T,
    /// Whether the data determined the orientation of the flange, or only
    /// points were measured and unseen directions are nominal.
    pub orientation_identified: bool,
}

impl<T: Scalar, const N: usize> ArmParameters<'_, T, N> {
    /// The same, of which nothing is borrowed from a blob any more: for an arm that outlives the
    /// buffer its blob was received in. `None` where there are curves, which stay where the blob
    /// is; without them it would be another arm.
    ///
    /// ```
    /// use truearm::{Arm6, blob::Blob};
    ///
    /// fn received(buffer: &[u8]) -> Option<Arm6<'static, f32>> {
    ///     let parameters = Blob::check(buffer).ok()?.parameters().ok()?;
    ///     Some(Arm6::new(&parameters.detached()?))
    /// }
    ///
    /// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
    /// let mut buffer = [0xff; 1024];
    /// buffer[..slot.len()].copy_from_slice(slot);
    /// let arm = received(&buffer).ok_or("no parameters")?;
    /// buffer.fill(0xff);
    /// assert!(arm.real_pose(&[0.1, -1.2, 1.6, -1.2, -1.57, 0.8]).translation.norm() > 0.1);
    /// # Ok::<(), &str>(())
    /// ```
    #[must_use]
    pub fn detached(&self) -> Option<ArmParameters<'static, T, N>> {
        self.curves.is_empty().then(|| ArmParameters { curves: Curves::NONE, ..self.clone() })
    }

    /// Becomes a set after this one, identified on the controller: of the next sequence
    /// number, and nobody knows when, nor how well it would stand a cross-validation.
    /// `None` after the last number that can be followed.
    pub(crate) fn follow(&mut self) -> Option<()> {
        self.sequence = self.sequence.checked_add(1).filter(|next| *next < u32::MAX)?;
        self.created = 0;
        self.rms_before = T::ZERO;
        self.rms_after = T::ZERO;
        Some(())
    }
}
