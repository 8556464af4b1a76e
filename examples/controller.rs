//! A 1 kHz control loop as firmware has it: parameters from a slot or a reason
//! why not, compensation switched on while the arm moves, approach, payload and
//! temperature known to the controller, something to do for every [`Status`]. It
//! runs on the host with a simulated clock; `load`, `Observer` and `Supervisor` need
//! `core` only and go into firmware as they are.
//!
//! `cargo run --example controller`

use truearm::blob::{Acceptance, AcceptanceError};
use truearm::compensate::{SettingError, Status, TaskError};
use truearm::{Arm6, Compensator, Pose, Settings, State, Task, Tick};

/// On a controller: the parameter slot of memory.x.
static SLOT: &[u8] = include_bytes!("../tests/data/firmware/ur10-terms.blob");
/// Of this robot, as `truearm inspect` prints it for its own blob.
const ROBOT_ID: u64 = 0x544a_b5f3_0b94_225d;
/// Seconds of a tick.
const PERIOD: f32 = 1e-3;
/// What the work can bear along each axis, m.
const TOLERANCE: f32 = 1e-3;
/// Slower than this a joint's approach is that of its last motion, rad/s.
const STANDSTILL: f32 = 1e-3;

type Joints = [f32; 6];

/// Why the loop runs without compensation.
#[derive(Debug)]
enum Uncompensated {
    Blob(AcceptanceError),
    /// An encoder that gives no number, for instance.
    Settings(SettingError),
}

/// Without valid parameters the loop runs on nominal kinematics, as before the
/// calibration, and says why.
fn load<'t>(slot: &'t [u8], start: &Joints) -> Result<Compensator<'t, f32, 6>, Uncompensated> {
    let blob = Acceptance::of(ROBOT_ID, 6).check(slot).map_err(Uncompensated::Blob)?;
    let parameters = blob.parameters().map_err(|error| Uncompensated::Blob(error.into()))?;
    let mut arm = Arm6::new(&parameters);
    // In place: `with_tool` makes a second arm, 3 KB of stack.
    arm.set_tool(&Pose::translation(0.0, 0.0, 0.15));
    // Orientation that the data did not determine is not corrected.
    let task = if arm.orientation_identified() { Task::Pose } else { Task::Position };
    let settings = Settings { ramp_ticks: 500, ..Settings::new(task) };
    Compensator::new(arm, settings, start).map_err(Uncompensated::Settings)
}

impl core::fmt::Display for Uncompensated {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Blob(error) => error.fmt(f),
            Self::Settings(error) => error.fmt(f),
        }
    }
}

/// The controller's knowledge of the arm, updated from its own motion.
struct Observer {
    last: Joints,
    state: State<f32, 6>,
}

impl Observer {
    fn new(start: Joints, temperature: f32) -> Self {
        Self { last: start, state: State::at(temperature) }
    }

    fn moved(&mut self, command: &Joints) {
        let joints = command.iter().zip(&mut self.last).zip(&mut self.state.approach);
        for ((q, last), approach) in joints {
            *approach = approach.after((q - *last) / PERIOD, STANDSTILL);
            *last = *q;
        }
    }
}

/// What the supervisor of the motion does about a tick.
#[derive(Debug, Default)]
struct Supervisor {
    off: u32,
    ramping: u32,
    on: u32,
    refused: u32,
    held: u32,
    damped: u32,
    far: u32,
}

impl Supervisor {
    /// False: stop the motion.
    fn judge(&mut self, tick: &Tick<f32, 6>) -> bool {
        match tick.status {
            Status::Off => self.off += 1,
            Status::Ramping => self.ramping += 1,
            Status::On => self.on += 1,
            // A sensor or a command is wrong: stop. Until the arm stands the joints are to be sent:
            // finite, and without a step where a reading is missing. A command that is finite is
            // not judged; limits of joints and speeds are the controller's.
            Status::Refused(_) => self.refused += 1,
            _ => return false,
        }
        // Nearer to its target than without, by what `left` says not quite there:
        // go on, unless the work asks for more than that.
        self.held += u32::from(!tick.clamped.is_empty());
        self.damped += u32::from(tick.damping.is_some_and(|damping| damping > 0.0));
        let far = |left: TaskError<f32>| left.position.iter().any(|e| e.abs() > TOLERANCE);
        if tick.status == Status::On && tick.left.is_some_and(far) {
            self.far += 1;
            #[cfg(feature = "defmt")]
            defmt::warn!("{}", tick);
        }
        !matches!(tick.status, Status::Refused(_))
    }
}

/// A motion in front of the robot, rad.
fn command(time: f32) -> Joints {
    let wave =
        |amplitude: f32, period: f32| amplitude * (core::f32::consts::TAU * time / period).sin();
    [
        wave(0.6, 4.0),
        -1.2 + wave(0.3, 3.0),
        1.6 + wave(0.3, 2.5),
        -1.2 + wave(0.4, 2.0),
        -1.57 + wave(0.3, 3.5),
        wave(0.8, 5.0),
    ]
}

fn main() {
    if let Err(refusal) = load(&[0xff; 4096], &command(0.0)) {
        println!("slot A: {refusal}");
    }
    let mut compensator = match load(SLOT, &command(0.0)) {
        Ok(compensator) => compensator,
        Err(refusal) => return println!("slot B: {refusal}; nominal kinematics"),
    };
    println!("slot B: {} terms", compensator.arm().terms().len());
    println!("time, s  status    tool error, mm: command  compensated   largest change, mrad/tick");

    let mut observer = Observer::new(command(0.0), 24.0);
    let mut supervisor = Supervisor::default();
    let (mut applied, mut largest) = ([0.0; 6], 0.0_f32);
    for step in 0..4000_u32 {
        let q = command(step as f32 * PERIOD);
        match step {
            1000 => compensator.set_active(true), // while it moves
            2000 => observer.state.payload = 3.0, // gripped
            3400 => compensator.set_active(false),
            _ => (),
        }
        observer.moved(&q);
        let tick = compensator.tick(&q, &observer.state);
        if !supervisor.judge(&tick) {
            return println!("stopped at {:.3} s: {:?}", step as f32 * PERIOD, tick.status);
        }
        for ((joint, q), applied) in tick.joints.iter().zip(&q).zip(&mut applied) {
            largest = largest.max((joint - q - *applied).abs());
            *applied = joint - q;
        }
        if step % 250 == 249 {
            let arm = compensator.arm();
            let target = arm.nominal().forward(&q).translation;
            let error = |joints: &Joints| {
                let real = arm.real_pose_in(joints, &observer.state).translation;
                (real - target).norm() * 1e3
            };
            let (before, after) = (error(&q), error(&tick.joints));
            let time = (step + 1) as f32 * PERIOD;
            let status = format!("{:?}", tick.status);
            println!("{time:<8.2} {status:9} {before:23.4} {after:12.4} {:27.4}", largest * 1e3);
            largest = 0.0;
        }
    }
    println!("ticks: {supervisor:?}");
    println!(
        "The error is that of the parameters' own arm: what compensation adds to it, not what"
    );
    println!("identification left.");
}
