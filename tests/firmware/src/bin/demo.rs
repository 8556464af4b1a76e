//! A controller that notices when its arm has changed and mends itself. It
//! loads its parameters from the EEPROM of the image `store` and then answers
//! lines on the serial port, which the host sends for the cell it works in
//! (xtask/src/demo). Numbers are decimal, rad and m; joints are six of them,
//! points three in the commanded frame.
//!
//! | line | answer | |
//! |---|---|---|
//! | | `up SEQUENCE` | at power-up |
//! | `move JOINTS` | `at JOINTS` | command, and the joints that the compensated arm goes to |
//! | `check JOINTS POINT` | `quiet`, `alarm` | a check point, and the drift watch on it |
//! | `point JOINTS POINT` | `taken` | one of the ten points after an alarm |
//! | | `stored SEQUENCE SUSPECT GROUPS` | after the tenth: whom the watch suspects, what was identified anew; it is in the EEPROM |
//!
//! What goes wrong is answered by `FAILED` and the reason, and ends the image.

#![no_std]
#![no_main]

#[path = "../command.rs"]
#[allow(dead_code, reason = "the blob is in the EEPROM")]
mod command;
#[path = "../interrupts.rs"]
mod interrupts;
#[path = "../mend.rs"]
mod mend;
#[path = "../outcome.rs"]
mod outcome;
#[path = "../sbcon.rs"]
mod sbcon;
#[path = "../uart.rs"]
mod uart;

use core::fmt::{Display, Write};
use core::str::SplitWhitespace;

use cortex_m_rt::entry;
use eeprom24x::{Eeprom24x, SlaveAddr, Storage};
use truearm::blob::{Acceptance, encode};
use truearm::compensate::Status;
use truearm::drift::{DriftWatch, FalseAlarms, Group};
use truearm::store::{ByteSlots, Medium, Store};
use truearm::{Arm6, ArmParameters6, Compensator, Pose, Scalar, Settings, State, Task};

use mend::{GROUPS, JOINTS, POINTS, Point};
use sbcon::{Clocks, SbCon};
use uart::Uart;

/// Pages of an AT24C64.
const PAGE: usize = 32;
/// Half of it for each slot.
const SLOT: u32 = 4096;
/// Ticks until the arm stands: fading in and the largest correction take less.
const TICKS: u32 = 2000;

/// Why the image ends; the reason has been sent.
struct Failed;

#[entry]
fn main() -> ! {
    // SAFETY: the image is for mps2 boards, and these lines run once.
    let (mut port, bus) = unsafe { (Uart::new(), SbCon::new()) };
    outcome::end(run(&mut port, bus).is_ok())
}

fn run(port: &mut Uart, bus: SbCon) -> Result<(), Failed> {
    let mut room = [0; 80];
    let robot = command::line(&mut room).and_then(|line| line.split_whitespace().nth(1));
    let robot = robot.and_then(|word| u64::from_str_radix(word, 16).ok()).unwrap_or(0);
    let eeprom = Eeprom24x::new_24x64(bus, SlaveAddr::default());
    let slots = ByteSlots::<_, PAGE>::new(Storage::new(eeprom, Clocks), [0, SLOT], SLOT);
    let slots = slots.map_err(|error| failed(port, error))?;
    let mut buffer = [0; SLOT as usize];
    let mine = Acceptance::of(robot, JOINTS);
    let opened = Store::open(slots, &mut buffer, mine);
    let (store, opened) = opened.map_err(|error| failed(port, error))?;
    let blob = opened.blob.ok_or_else(|| failed(port, "no parameters"))?;
    let parameters = blob.parameters().map_err(|error| failed(port, error))?;
    say(port, format_args!("up {}", parameters.sequence));
    let mut controller = Controller::new(port, store, parameters)?;
    let mut room = [0; uart::LINE];
    loop {
        let line = port.line(&mut room).ok_or_else(|| failed(port, "no line"))?;
        controller.answer(port, line)?;
    }
}

fn say(port: &mut Uart, what: impl Display) {
    // A serial port takes everything.
    let _ = writeln!(port, "{what}");
}

fn failed(port: &mut Uart, why: impl Display) -> Failed {
    say(port, format_args!("FAILED {why}"));
    Failed
}

/// What runs between power-up and power-down.
struct Controller<'t, M> {
    store: Store<M>,
    parameters: ArmParameters6<'t, f32>,
    compensator: Compensator<'t, f32, JOINTS>,
    watch: DriftWatch<f32, JOINTS>,
    /// Of an innovation's coordinate, m.
    sigma: f32,
    /// Since the alarm.
    points: [Point; POINTS],
    taken: usize,
}

impl<'t, M: Medium> Controller<'t, M> {
    fn new(
        port: &mut Uart,
        store: Store<M>,
        parameters: ArmParameters6<'t, f32>,
    ) -> Result<Self, Failed> {
        // Of measurement and model together: cross-validated.
        let sigma = parameters.rms_after / Scalar::sqrt(3.0);
        let watch = DriftWatch::new(sigma, FalseAlarms::OneIn1000);
        let settings = Settings::new(Task::Position);
        let compensator = Compensator::new(Arm6::new(&parameters), settings, &[0.0; JOINTS]);
        let mut compensator = compensator.map_err(|error| failed(port, error))?;
        compensator.set_active(true);
        let none = Pose::translation(0.0, 0.0, 0.0).translation;
        Ok(Self {
            store,
            compensator,
            watch: watch.map_err(|error| failed(port, error))?,
            sigma,
            points: [Point::plain([0.0; JOINTS], none, parameters.reference_temperature); POINTS],
            taken: 0,
            parameters,
        })
    }

    fn answer(&mut self, port: &mut Uart, line: &str) -> Result<(), Failed> {
        let mut words = line.split_whitespace();
        let verb = words.next().unwrap_or_default();
        let understood = match verb {
            "move" => numbers(&mut words).map(|command| self.go(port, &command)),
            "check" => self.point(&mut words).map(|point| self.check(port, &point)),
            "point" => self.point(&mut words).map(|point| self.take(port, &point)),
            _ => None,
        };
        understood.unwrap_or_else(|| Err(failed(port, line)))
    }

    fn point(&self, words: &mut SplitWhitespace) -> Option<Point> {
        let joints = numbers(words)?;
        let [x, y, z] = numbers(words)?;
        let point = Pose::translation(x, y, z).translation;
        Some(Point::plain(joints, point, self.parameters.reference_temperature))
    }

    /// Ticks at a standing command until the joints stand, too.
    fn go(&mut self, port: &mut Uart, command: &[f32; JOINTS]) -> Result<(), Failed> {
        let state = State::at(self.parameters.reference_temperature);
        let mut last = [0.0; JOINTS];
        for _ in 0..TICKS {
            let tick = self.compensator.tick(command, &state);
            if tick.status == Status::On && tick.joints == last {
                let [a, b, c, d, e, f] = last;
                say(port, format_args!("at {a} {b} {c} {d} {e} {f}"));
                return Ok(());
            }
            last = tick.joints;
        }
        Err(failed(port, "the arm does not come to rest"))
    }

    fn check(&mut self, port: &mut Uart, point: &Point) -> Result<(), Failed> {
        let alarm = self.watched(port, point)?;
        say(port, if alarm { "alarm" } else { "quiet" });
        Ok(())
    }

    fn watched(&mut self, port: &mut Uart, point: &Point) -> Result<bool, Failed> {
        let baseline = Pose::translation(0.0, 0.0, 0.0).translation;
        let verdict = self.watch.push(self.compensator.arm(), point, &baseline);
        Ok(verdict.map_err(|error| failed(port, error))?.recalibrate)
    }

    /// After the tenth point: new parameters into the EEPROM.
    fn take(&mut self, port: &mut Uart, point: &Point) -> Result<(), Failed> {
        let Some(place) = self.points.get_mut(self.taken) else {
            return Err(failed(port, "too many points"));
        };
        *place = *point;
        self.taken += 1;
        self.watched(port, point)?;
        if self.taken < POINTS {
            say(port, "taken");
            return Ok(());
        }
        let suspect = self.watch.suspect().map(|suspect| suspect.group);
        let mended = mend::mend(&self.parameters, suspect, &self.points, self.sigma);
        let mended = mended.map_err(|error| failed(port, error))?;
        let mut bytes = [0; SLOT as usize];
        let size = encode(&mended.parameters, &mut bytes).map_err(|error| failed(port, error))?;
        let blob = bytes.get(..size).unwrap_or_default();
        // Written or there already: it is what the next power-up finds.
        let _ = self.store.store(blob).map_err(|error| failed(port, error))?;
        let _ = write!(port, "stored {} {}", mended.parameters.sequence, Name(suspect));
        for (group, _) in GROUPS.iter().zip(mended.moved).filter(|(_, moved)| *moved) {
            let _ = write!(port, " {}", Name(Some(*group)));
        }
        say(port, if mended.moved.contains(&true) { "" } else { " nothing" });
        Ok(())
    }
}

/// The next numbers of a line.
fn numbers<const K: usize>(words: &mut SplitWhitespace) -> Option<[f32; K]> {
    let mut numbers = [0.0; K];
    for number in &mut numbers {
        *number = words.next()?.parse().ok()?;
    }
    Some(numbers)
}

/// Joints counted from 1, as everywhere where people read.
struct Name(Option<Group>);

impl Display for Name {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.0 {
            Some(Group::JointOffset(joint)) => write!(f, "joint-{}", joint + 1),
            Some(Group::Tool) => f.write_str("tool"),
            Some(Group::Base) => f.write_str("base"),
            None => f.write_str("nothing"),
        }
    }
}
