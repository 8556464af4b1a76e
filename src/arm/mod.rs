//! Where the tool really is: nominal geometry, identified corrections, the
//! terms beyond geometry and the robot frame they refer to.

mod bent;
mod parameters;

use heapless::Vec;

pub(crate) use bent::Bent;
pub use parameters::{ArmParameters, MAX_JOINTS};

use crate::effects::{
    Approach, Curves, FoldedTerms, GravityModel, Load, MAX_TERMS, Term, TermInputs,
};
use crate::kinematics::{Chain, Deflection, Link, Pose, Turns};
use crate::scalar::Scalar;

/// What an arm's terms depend on besides the joint values.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct State<T, const N: usize> {
    /// How each joint came to rest.
    pub approach: [Approach; N],
    /// Mass at the payload point, kg.
    pub payload: T,
    /// Temperature of the arm, degrees Celsius: what is read; of an arm that follows it
    /// late, what [`Arm::thermal_lag`] makes of the readings.
    pub temperature: T,
    /// What loads each joint, as sensors or motor currents tell, N m or N, positive where it
    /// pulls towards +q as gravity's torque does: the opposite of what the joint holds. It
    /// counts in place of the torques that masses give; `None` where nothing is read. To be
    /// filtered: what trembles makes the correction tremble, by springs in proportion and, about
    /// the friction of a gap, from one side of it to the other. Currents of a joint that moves
    /// hold friction and acceleration as well.
    pub torque: Option<[T; N]>,
}

impl<T: Scalar, const N: usize> State<T, N> {
    /// Whether every number of it is one, and torques are there if they are `needed`.
    // In every tick: a number times zero is zero; an infinity or a NaN is NaN.
    #[inline]
    pub(crate) fn is_finite(&self, needed: bool) -> bool {
        let zero = self.payload * T::ZERO + self.temperature * T::ZERO;
        match &self.torque {
            Some(torque) => torque.iter().fold(zero, |zero, t| zero + *t * T::ZERO) == T::ZERO,
            None => !needed && zero == T::ZERO,
        }
    }

    /// Becomes the state `now`, but for numbers that are none: these stay.
    pub(crate) fn learn(&mut self, now: &Self) {
        self.approach = now.approach;
        learn(&mut self.payload, now.payload);
        learn(&mut self.temperature, now.temperature);
        if let Some(read) = &now.torque {
            match &mut self.torque {
                Some(known) => known.iter_mut().zip(read).for_each(|(a, b)| learn(a, *b)),
                None if read.iter().all(|torque| torque.is_finite()) => self.torque = now.torque,
                // Those that masses give count where none were ever read.
                None => (),
            }
        }
    }

    /// Every number of it.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = &T> {
        [&self.payload, &self.temperature].into_iter().chain(self.torque.iter().flatten())
    }

    /// At a temperature in degrees Celsius, without payload, approach unknown, no torques
    /// read.
    #[must_use]
    pub const fn at(temperature: T) -> Self {
        let approach = [Approach::Unknown; N];
        Self { approach, payload: T::ZERO, temperature, torque: None }
    }
}

// Not inlined: rare, and there are as many as joints.
#[cold]
#[inline(never)]
fn learn<T: Scalar>(known: &mut T, now: T) {
    if now.is_finite() {
        *known = now;
    }
}

/// An identified arm, folded for the control loop.
///
/// ```
/// use truearm::{Arm6, Pose, State, blob::Blob};
///
/// # fn main() -> Result<(), Box<dyn core::error::Error>> {
/// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
/// let arm = Arm6::<f32>::new(&Blob::check(slot)?.parameters()?);
/// let arm = arm.with_tool(Pose::translation(0.0, 0.0, 0.15));
/// let q = [0.1, -1.2, 1.6, -1.2, -1.57, 0.8];
/// let loaded = State { payload: 3.0, temperature: 24.0, ..arm.state() };
/// let real = arm.real_pose_in(&q, &loaded);
/// let off = real.translation - arm.nominal().forward(&q).translation;
/// assert!(off.norm() > 1e-4, "an arm is not where its drawing says");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Arm<'t, T, const N: usize> {
    robot_id: u64,
    sequence: u32,
    nominal: Chain<T, N>,
    real: Chain<T, N>,
    covered: [Option<[T; 2]>; N],
    limits: [Option<[T; 2]>; N],
    terms: Vec<Term<T>, MAX_TERMS>,
    curves: Curves<'t>,
    /// Whether some curve has gaps, which [`Self::covers`] need not ask in every tick.
    gaps: bool,
    folded: FoldedTerms<T, N>,
    /// Only where a term depends on gravity: whether to compute loads is
    /// decided here and not in every tick.
    gravity: Option<GravityModel<T, N>>,
    reference_temperature: T,
    orientation_identified: bool,
    /// Whether [`Self::with_tool`] gave the tool.
    production_tool: bool,
}

impl<'t, T: Scalar, const N: usize> Arm<'t, T, N> {
    /// Adds the corrections to the nominal links and folds both chains. Call
    /// it once, at load time. Only for 1 to [`MAX_JOINTS`] joints; another
    /// number does not compile.
    ///
    /// Of parameters from a checked blob, or such as [`crate::blob::encode`] takes: nothing is
    /// looked at here, so that of others a term may be of no joint, which bends nothing, or of
    /// masses that are not there.
    #[must_use]
    pub fn new(parameters: &ArmParameters<'t, T, N>) -> Self {
        const { assert!(N >= 1 && N <= MAX_JOINTS, "an arm has 1 to 16 joints") };
        let p = parameters;
        let tool = Pose { translation: p.tool, ..Pose::identity() };
        let base = Pose::from_rotation_vector(p.base_translation, p.base_rotation);
        let mut links = p.nominal;
        Link::correct(&mut links, &p.corrections);
        let nominal = Chain::new(&p.nominal, Pose::identity(), tool);
        let folded = FoldedTerms::new(&p.terms);
        let real = Chain::new(&links, base, tool);
        let masses = p.masses.filter(|_| folded.needs_load());
        let gravity = masses.map(|masses| masses.on(&real));
        Self {
            robot_id: p.robot_id,
            sequence: p.sequence,
            nominal,
            real,
            covered: p.covered,
            limits: p.limits,
            terms: p.terms.clone(),
            curves: p.curves,
            gaps: p.curves.have_gaps(),
            folded,
            gravity,
            reference_temperature: p.reference_temperature,
            orientation_identified: p.orientation_identified,
            production_tool: false,
        }
    }

    /// The same arm with the production tool, a pose in the flange frame. Not looked at: where
    /// it comes from outside as a matrix, [`Pose::from_rows`] refuses one that is scaled or
    /// left-handed, of which the third axis would be made anew here from the first two. The other
    /// arm takes 3 KB of stack; [`Self::set_tool`] needs none.
    #[must_use]
    pub fn with_tool(&self, tool: Pose<T>) -> Self {
        let mut other = self.clone();
        other.set_tool(&tool);
        other
    }

    /// The production tool, a pose in the flange frame, in place; not looked at, as for
    /// [`Self::with_tool`].
    pub fn set_tool(&mut self, tool: &Pose<T>) {
        self.nominal.set_tool(tool);
        self.real.set_tool(tool);
        self.production_tool = true;
    }

    /// The arm of other parameters, as a re-identification gives them, with this one's
    /// production tool; where none was given, with the tool of the parameters. A changed
    /// [`Parameter::Tool`](crate::parameters::Parameter::Tool) is the measured point's: whether
    /// the production tool moved with it the caller knows.
    ///
    /// ```
    /// use truearm::{Arm6, Pose, blob::Blob, parameters::Parameter};
    ///
    /// # fn main() -> Result<(), Box<dyn core::error::Error>> {
    /// # let slot = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/firmware/ur10.blob"));
    /// let stored = Blob::check(slot)?.parameters::<f32, 6>()?;
    /// let arm = Arm6::new(&stored).with_tool(Pose::translation(0.0, 0.0, 0.15));
    /// let mut found = stored.clone();
    /// Parameter::JointOffset(2).apply(&mut found, 1e-3);
    /// let next = arm.with_parameters(&found);
    /// assert_eq!(next.real().tool(), arm.real().tool());
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_parameters<'p>(&self, parameters: &ArmParameters<'p, T, N>) -> Arm<'p, T, N> {
        let mut arm = Arm::new(parameters);
        if self.production_tool {
            arm.set_tool(self.real.tool());
        }
        arm
    }

    /// Id of the robot, see [`crate::blob::robot_id`].
    #[must_use]
    pub fn robot_id(&self) -> u64 {
        self.robot_id
    }

    /// Sequence number of its parameters.
    #[must_use]
    pub fn sequence(&self) -> u32 {
        self.sequence
    }

    /// The chain the controller believes in.
    #[must_use]
    pub fn nominal(&self) -> &Chain<T, N> {
        &self.nominal
    }

    /// The identified chain.
    #[must_use]
    pub fn real(&self) -> &Chain<T, N> {
        &self.real
    }

    /// The terms beyond geometry.
    #[must_use]
    pub fn terms(&self) -> &[Term<T>] {
        &self.terms
    }

    /// The smooth errors of its joint angles.
    #[must_use]
    pub fn curves(&self) -> Curves<'t> {
        self.curves
    }

    /// Whether it is anything but rigid.
    #[inline]
    pub(crate) fn bends(&self) -> bool {
        !(self.terms.is_empty() && self.curves.is_empty())
    }

    /// Whether a term follows torques that only [`State::torque`] can give, as there are no
    /// masses. In a state without them the arm has no finite pose.
    #[must_use]
    pub fn reads_torques(&self) -> bool {
        self.gravity.is_none() && self.folded.needs_torque()
    }

    /// Whether all that a term depends on is there in this state, and a number.
    #[cold]
    #[inline(never)]
    pub(crate) fn can_be_in(&self, state: &State<T, N>) -> bool {
        let payload = self.gravity.is_none() || state.payload.is_finite();
        let torque = match &state.torque {
            Some(torque) => torque.iter().all(|torque| torque.is_finite()),
            None => !self.reads_torques(),
        };
        let loads = payload && (torque || !self.folded.needs_torque());
        loads && (!self.folded.needs_warmth() || state.temperature.is_finite())
    }

    /// The arm at its reference temperature, without payload, approach unknown:
    /// where to begin when a controller knows less than all of its state.
    #[must_use]
    pub fn state(&self) -> State<T, N> {
        State::at(self.reference_temperature)
    }

    /// Temperature the geometry refers to, degrees Celsius.
    #[must_use]
    pub fn reference_temperature(&self) -> T {
        self.reference_temperature
    }

    /// Where the tool really is at encoder readings `q` (rad or m), in the
    /// commanded frame, the nominal base: without payload, at the reference
    /// temperature, approach unknown. Terms that need only `q` and gravity apply; an arm that
    /// [reads torques](Self::reads_torques) has no pose without them: NaN.
    #[must_use]
    #[inline]
    pub fn real_pose(&self, q: &[T; N]) -> Pose<T> {
        self.real_pose_in(q, &self.state())
    }

    /// Where the tool really is at encoder readings `q` (rad or m) in a state
    /// of the arm, in the commanded frame. In `f32` a periodic term of order n
    /// gives NaN from |n q| = 8192 rad on, see [`Scalar::sin_cos`]; so does an arm that
    /// [reads torques](Self::reads_torques) in a state without.
    #[must_use]
    pub fn real_pose_in(&self, q: &[T; N], state: &State<T, N>) -> Pose<T> {
        // One walk for both: a second one would be 600 bytes of text.
        let deflection = if self.bends() { self.deflection(q, state) } else { Deflection::none() };
        self.real.forward_deflected(q, &deflection)
    }

    /// How far all terms and curves together deflect the arm. Gravity loads are those of the
    /// identified chain before it bends, where no torques are read: a zero that is degrees off
    /// changes a torque by more than springs can hide.
    #[must_use]
    pub fn deflection(&self, q: &[T; N], state: &State<T, N>) -> Deflection<T, N> {
        self.deflection_at(&self.inputs(q, state))
    }

    /// The same, where the inputs are known.
    #[inline]
    pub(crate) fn deflection_at(&self, inputs: &TermInputs<T, N>) -> Deflection<T, N> {
        let mut out = self.folded.deflection(inputs);
        if !self.curves.is_empty() {
            self.curves.add(&inputs.q, &mut out.joints, &mut [T::ZERO; N]);
        }
        out
    }

    /// What the terms depend on at joint values `q` in a state of the arm.
    #[inline]
    pub(crate) fn inputs(&self, q: &[T; N], state: &State<T, N>) -> TermInputs<T, N> {
        self.inputs_at(&self.real.turns(q), state)
    }

    /// The same with the sines of the identified chain taken already.
    #[inline]
    fn inputs_at(&self, turns: &Turns<T, N>, state: &State<T, N>) -> TermInputs<T, N> {
        let mut inputs = self.inputs_within_joints(turns, state);
        if let (true, Some(gravity)) = (self.folded.tilts_axes(), &self.gravity) {
            inputs.load.across = Some(
                gravity.across(&self.real, turns, state.payload, |joint| self.folded.tilts(joint)),
            );
        }
        inputs
    }

    /// All of them but the moments across the axes.
    #[inline(never)]
    fn inputs_within_joints(&self, turns: &Turns<T, N>, state: &State<T, N>) -> TermInputs<T, N> {
        let mut load = self
            .gravity
            .as_ref()
            .map_or(Load::none(), |gravity| gravity.load(&self.real, turns, state.payload));
        if self.folded.needs_torque() {
            match &state.torque {
                Some(torque) => load.torque = *torque,
                // Not zero: an arm that nobody asked would stand unloaded.
                None if self.gravity.is_none() => load.torque = [T::from_f32(f32::NAN); N],
                None => (),
            }
        }
        TermInputs {
            q: *turns.joints(),
            load,
            approach: state.approach,
            warmth: state.temperature - self.reference_temperature,
        }
    }

    /// Joint limits, rad or m.
    #[must_use]
    pub fn limits(&self) -> &[Option<[T; 2]>; N] {
        &self.limits
    }

    /// Whether the data determined the orientation of the flange; if not, only
    /// the tool point is better than nominal.
    #[must_use]
    pub fn orientation_identified(&self) -> bool {
        self.orientation_identified
    }

    /// Whether every joint lies within the range that the identification
    /// covered, and where its curve, if it has one, [is known](crate::effects::Curve::knows).
    /// Elsewhere the corrections are extrapolated.
    #[must_use]
    pub fn covers(&self, q: &[T; N]) -> bool {
        let within = self.covered.iter().zip(q).all(|(range, q)| match range {
            Some([low, high]) => *low <= *q && *q <= *high,
            None => false,
        });
        within && (!self.gaps || self.curves.know(q))
    }
}
