//! One arm's life: it works, it crashes, it mends itself, its base comes
//! loose, it mends itself again.

use nalgebra::Vector3;
use truearm::blob::Blob;
use truearm_host::blob::pack;

use super::cell::{Cell, Event, Joints};
use super::controller::{Controller, Stored};
use super::reference::Reference;
use crate::run::Result;

/// Fresh tasks at which a tool error is judged.
pub const TASKS: usize = 200;
/// Check points in an undisturbed run.
pub const CHECKS: usize = 20;
/// After so many check points an event counts as not noticed.
const UNNOTICED: u32 = 50;

/// Of the tool over [`TASKS`], m.
#[derive(Clone, Copy)]
pub struct Errors {
    pub rms: f64,
    pub largest: f64,
}

/// What followed from an event.
pub struct Repair {
    pub event: Event,
    /// Compensated by the parameters that were right before.
    pub before: Errors,
    /// Check points until the alarm.
    pub checks: u32,
    /// What the points after it said.
    pub stored: Stored,
    /// After power-up with the new parameters.
    pub after: Errors,
    /// The same tasks by the host's re-identification.
    pub host: Errors,
    /// False alarms in the undisturbed run that followed.
    pub false_alarms: u32,
}

impl Repair {
    /// The controller's error in errors of the host.
    pub fn ratio(&self) -> f64 {
        self.after.rms / self.host.rms
    }

    /// Whether exactly what moved was identified anew.
    pub fn is_named(&self) -> bool {
        self.stored.moved == self.event.groups()
    }
}

/// The whole life.
pub struct Life {
    pub nominal: Errors,
    pub compensated: Errors,
    /// In the undisturbed run before anything happened.
    pub false_alarms: u32,
    pub repairs: Vec<Repair>,
}

/// A cell with a controller in it.
struct Shop<'a> {
    cell: Cell,
    controller: Controller,
    /// Where points are taken after an alarm.
    poses: &'a [Joints],
    /// The number of the controller's parameters.
    sequence: u32,
}

/// Lives it; the seed decides everything.
pub fn live(seed: u64, poses: &[Joints]) -> Result<Life> {
    let cell = Cell::new(seed)?;
    let blob = pack(&cell.model, Some(1))?;
    let sequence = Blob::check(&blob)?.sequence();
    let controller = Controller::new(&format!("demo-{seed}"), &blob)?;
    let mut shop = Shop { cell, controller, poses, sequence };
    let tasks = shop.cell.tasks(TASKS);
    let nominal = shop.errors(&tasks, |_, command, _| Ok(command.map(f64::from)))?;
    let compensated = shop.compensated(&tasks)?;
    let false_alarms = shop.undisturbed()?;
    let mut repairs = Vec::new();
    for happen in [Cell::crash, Cell::loosen] {
        let event = happen(&mut shop.cell);
        repairs.push(shop.repaired(event)?);
    }
    Ok(Life { nominal, compensated, false_alarms, repairs })
}

impl Shop<'_> {
    /// Tool errors at tasks, with the joints that something makes of each.
    fn errors(
        &mut self,
        tasks: &[[f32; 6]],
        mut joints: impl FnMut(&mut Controller, &[f32; 6], &Vector3<f64>) -> Result<Joints>,
    ) -> Result<Errors> {
        let (mut sum, mut largest) = (0.0, 0.0_f64);
        for command in tasks {
            let target = self.cell.target(command);
            let joints = joints(&mut self.controller, command, &target)?;
            let error = (self.cell.tool(&joints) - target).norm();
            sum += error * error;
            largest = largest.max(error);
        }
        Ok(Errors { rms: (sum / tasks.len() as f64).sqrt(), largest })
    }

    fn compensated(&mut self, tasks: &[[f32; 6]]) -> Result<Errors> {
        self.errors(tasks, |controller, command, _| controller.go(command))
    }

    /// A check point at the next task.
    fn check(&mut self) -> Result<bool> {
        let command = self.cell.task();
        let joints = self.controller.go(&command)?;
        let point = self.cell.measured(&joints);
        self.controller.check(&joints, &point)
    }

    /// False alarms while nothing happens; after each the watch starts anew.
    fn undisturbed(&mut self) -> Result<u32> {
        let mut alarms = 0;
        for _ in 0..CHECKS {
            if self.check()? {
                alarms += 1;
                self.controller.restart(self.sequence)?;
            }
        }
        Ok(alarms)
    }

    /// From an event to parameters that hold again.
    fn repaired(&mut self, event: Event) -> Result<Repair> {
        let tasks = self.cell.tasks(TASKS);
        let before = self.compensated(&tasks)?;
        let blob = self.controller.stored()?;
        let prior = Reference::new(&Blob::check(&blob)?.parameters()?, &self.cell);
        let mut checks = 1;
        while !self.check()? {
            checks += 1;
            if checks == UNNOTICED {
                return Err(format!("{event} was not noticed").into());
            }
        }
        let mut points = Vec::new();
        let mut stored = None;
        for pose in self.poses {
            let joints = self.controller.go(&pose.map(|q| q as f32))?;
            let point = self.cell.measured(&joints);
            stored = self.controller.point(&joints, &point)?;
            points.push((joints, point));
        }
        let stored: Stored = stored.ok_or("it wants more points")?;
        self.sequence = stored.sequence;
        self.controller.restart(self.sequence)?;
        let after = self.compensated(&tasks)?;
        let reference = prior.reidentified(&event, &points);
        let host = self.errors(&tasks, |_, command, target| {
            Ok(reference.compensated(&command.map(f64::from), target))
        })?;
        let false_alarms = self.undisturbed()?;
        Ok(Repair { event, before, checks, stored, after, host, false_alarms })
    }
}
