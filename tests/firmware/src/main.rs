//! The image that QEMU runs: finds its parameters as a controller would,
//! computes the shipped poses, compares their bits with those of the host and
//! counts instructions. Exits by semihosting with 0 or 1.

#![no_std]
#![no_main]

mod interrupts;
mod measure;
mod memory;
mod outcome;
mod vectors;

use core::cell::RefCell;
use core::fmt;
use core::hint::black_box;

use cortex_m_rt::entry;
use cortex_m_semihosting::hprintln;
use truearm::blob::{Blob, DecodeError};
use truearm::kinematics::Jacobian;
use truearm::{Arm, ArmParameters, Compensator, Pose, Scalar, Settings, State, Task, Tick};

use measure::Counter;
use vectors::{JOINTS, PARTS, Vectors};

/// What the image computes in.
#[cfg(not(feature = "f64"))]
type Real = f32;
#[cfg(feature = "f64")]
type Real = f64;

type Joints = vectors::Joints<Real>;

/// Poses that work is measured over.
const MEASURED: usize = 512;

/// Why the image exits with 1; the reason has been printed.
struct Refused;

#[entry]
fn main() -> ! {
    outcome::end(run().is_ok())
}

fn run() -> Result<(), Refused> {
    let (bytes, parameters) = find_parameters()?;
    let arm = Arm::new(&parameters);
    let vectors = Vectors::parse(memory::vector_region()).map_err(|error| {
        hprintln!("vectors at {:#010x}: {}", memory::VECTORS, error);
        Refused
    })?;
    let (name, expected) = match size_of::<Real>() {
        4 => ("f32", vectors.single),
        _ => ("f64", vectors.double),
    };
    let hashes = vectors::hashes(&arm, vectors.poses());
    hprintln!("{}, poses: {}", name, vectors.poses::<Real>().len());
    for (part, hash) in PARTS.iter().zip(&hashes) {
        hprintln!("hash {}: {:016x}", part, hash);
    }
    measure(bytes, &parameters, &arm, vectors.poses());
    let mut result = Ok(());
    for (part, (hash, expected)) in PARTS.iter().zip(hashes.iter().zip(&expected)) {
        if hash != expected {
            hprintln!("FAILED: the host computed {:016x} for {}", expected, part);
            result = Err(Refused);
        }
    }
    if result.is_ok() {
        hprintln!("ok: bit for bit what the host computed");
    }
    result
}

/// The first slot that holds a valid blob for this arm.
fn find_parameters() -> Result<(&'static [u8], ArmParameters<'static, Real, JOINTS>), Refused> {
    for (slot, bytes) in memory::parameter_slots() {
        match decode(bytes) {
            Ok(parameters) => {
                hprintln!("slot {} at {:p}: a valid blob", slot, bytes.as_ptr());
                hprintln!("robot id: {:016x}", parameters.robot_id);
                return Ok((bytes, parameters));
            }
            Err(error) => hprintln!("slot {} at {:p}: {}", slot, bytes.as_ptr(), error),
        }
    }
    hprintln!("FAILED: no valid parameter blob in either slot");
    Err(Refused)
}

/// What bends an arm, in the names of what is measured: `+TERMS`, with curves
/// `+TERMS+CURVES`.
struct Bends(usize, usize);

impl Bends {
    fn of(arm: &Arm<Real, JOINTS>) -> Self {
        Self(arm.terms().len(), arm.curves().iter().count())
    }
}

impl fmt::Display for Bends {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self(terms, 0) => write!(f, "+{terms}"),
            Self(terms, curves) => write!(f, "+{terms}+{curves}"),
        }
    }
}

/// Prints one line `instructions NAME COUNT` for each piece of work; xtask
/// holds these against budgets.toml.
fn measure(
    bytes: &[u8],
    parameters: &ArmParameters<Real, JOINTS>,
    arm: &Arm<Real, JOINTS>,
    poses: impl Iterator<Item = Joints> + Clone,
) {
    let Some(systick) = cortex_m::Peripherals::take().map(|p| p.SYST) else { return };
    let mut counter = Counter::new(systick);
    let print = |name: fmt::Arguments, tenths: u64| {
        hprintln!("instructions {} {}.{}", name, tenths / 10, tenths % 10);
    };
    let bends = Bends::of(arm);
    let mut inputs = [[0.0; JOINTS]; MEASURED];
    let mut states = [([0.0; JOINTS], vectors::state(0)); MEASURED];
    let cases = inputs.iter_mut().zip(&mut states).zip(poses.clone());
    for (index, ((input, state), q)) in cases.enumerate() {
        *input = q;
        *state = (q, vectors::state(index));
    }
    let count = counter.tenths_per_call(8, &inputs, |q| {
        black_box(&forward(black_box(arm), q));
    });
    print(format_args!("forward"), count);
    let count = counter.tenths_per_call(8, &states, |(q, state)| {
        black_box(&forward_in(black_box(arm), q, state));
    });
    print(format_args!("real_pose_in{bends}"), count);
    let count = counter.tenths_per_call(8, &inputs, |q| {
        black_box(&jacobian(black_box(arm), q));
    });
    print(format_args!("jacobian"), count);
    for (name, task) in [("tick", Task::Pose), ("tick_position", Task::Position)] {
        let settings = Settings { ramp_ticks: 1, ..Settings::new(task) };
        let settings = settings.trusting_nominal_orientation();
        let Ok(compensator) = Compensator::new(arm.clone(), settings, &[0.0; JOINTS]) else {
            return;
        };
        let compensator = RefCell::new(compensator);
        compensator.borrow_mut().set_active(true);
        let count = counter.tenths_per_call(8, &motion(&states), |(q, state)| {
            black_box(&tick(&mut black_box(&compensator).borrow_mut(), q, state));
        });
        print(format_args!("{name}{bends}"), count);
        // Over poses far apart, many of them near singular or out of bounds.
        let cases = poses.clone().enumerate().map(|(index, q)| (q, vectors::state(index)));
        let longest = counter.longest(cases, |(q, state)| {
            black_box(&tick(&mut black_box(&compensator).borrow_mut(), q, state));
        });
        print(format_args!("{name}_longest{bends}"), longest * 10);
    }
    let count = counter.tenths_per_call(1000, &[bytes], |bytes| {
        let _ = black_box(&decode(bytes));
    });
    print(format_args!("check+parameters{bends}"), count);
    let count = counter.tenths_per_call(1000, &[parameters], |parameters| {
        black_box(&load(parameters));
    });
    print(format_args!("load"), count);
}

/// Joint values and what the arm is in.
type Case = (Joints, State<Real, JOINTS>);

/// A motion at a few rad/s, a millisecond a step, in front of the robot, where
/// no pose is singular.
fn motion(poses: &[Case; MEASURED]) -> [Case; MEASURED] {
    const MIDDLE: Joints = [0.0, -1.2, 1.6, -1.2, -1.57, 0.0];
    let mut path = *poses;
    for (tick, (q, state)) in path.iter_mut().enumerate() {
        let share = Real::from_f32((tick % 256) as f32 / 256.0);
        let (from, to) = (poses[tick / 256].0, poses[tick / 256 + 1].0);
        for ((q, middle), (from, to)) in q.iter_mut().zip(MIDDLE).zip(from.iter().zip(to)) {
            *q = middle + (from + (to - from) * share) / 16.0;
        }
        *state = poses[0].1;
    }
    path
}

// What is measured, as calls of their own.

#[inline(never)]
fn decode(bytes: &[u8]) -> Result<ArmParameters<'_, Real, JOINTS>, DecodeError> {
    Blob::check(bytes)?.parameters()
}

#[inline(never)]
fn load<'t>(parameters: &ArmParameters<'t, Real, JOINTS>) -> Arm<'t, Real, JOINTS> {
    Arm::new(parameters)
}

#[inline(never)]
fn forward(arm: &Arm<Real, JOINTS>, q: &Joints) -> Pose<Real> {
    arm.real().forward(q)
}

#[inline(never)]
fn forward_in(arm: &Arm<Real, JOINTS>, q: &Joints, state: &State<Real, JOINTS>) -> Pose<Real> {
    arm.real_pose_in(q, state)
}

#[inline(never)]
fn tick(
    compensator: &mut Compensator<Real, JOINTS>,
    q: &Joints,
    state: &State<Real, JOINTS>,
) -> Tick<Real, JOINTS> {
    compensator.tick(q, state)
}

#[inline(never)]
fn jacobian(arm: &Arm<Real, JOINTS>, q: &Joints) -> Jacobian<Real, JOINTS> {
    arm.real().jacobian(q)
}
