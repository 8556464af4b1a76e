//! The controller under QEMU, and what it answers on its serial port; see
//! tests/firmware/src/bin/demo.rs.

use std::fmt::Display;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;

use nalgebra::Vector3;
use truearm::blob::Blob;

use super::cell::Joints;
use crate::board::{Board, Running};
use crate::run::Result;

/// A controller, switched on.
pub struct Controller {
    board: Board,
    running: Running,
    port: BufReader<TcpStream>,
}

/// What it made of the points after an alarm.
pub struct Stored {
    /// The number of the new parameters, which are in the EEPROM.
    pub sequence: u32,
    /// Whom its watch suspects.
    pub suspect: String,
    /// What was identified anew.
    pub moved: String,
}

impl Controller {
    /// With this blob in its EEPROM, its files in a directory of this name.
    pub fn new(name: &str, blob: &[u8]) -> Result<Self> {
        let board = Board::new(name, blob, Blob::check(blob)?.robot_id())?;
        let (running, port) = board.start_talking("demo")?;
        let mut this = Self { board, running, port: BufReader::new(port) };
        this.is_up(Blob::check(blob)?.sequence())?;
        Ok(this)
    }

    /// Ends its power, whatever it does, and switches it on again: it must come
    /// up with the parameters of this number.
    pub fn restart(&mut self, sequence: u32) -> Result {
        let (running, port) = {
            self.running.kill()?;
            self.board.start_talking("demo")?
        };
        (self.running, self.port) = (running, BufReader::new(port));
        self.is_up(sequence)
    }

    fn is_up(&mut self, sequence: u32) -> Result {
        let line = self.line()?;
        if line == format!("up {sequence}") {
            Ok(())
        } else {
            Err(format!("came up with `{line}`, not parameters {sequence}").into())
        }
    }

    /// The blob in its EEPROM.
    pub fn stored(&self) -> Result<Vec<u8>> {
        Ok(self.board.found()?.ok_or("no parameters in the EEPROM")?)
    }

    /// The joints it goes to at a command, rad.
    pub fn go(&mut self, command: &[f32; 6]) -> Result<Joints> {
        let answer = self.ask("move", command)?;
        let numbers = answer
            .strip_prefix("at ")
            .map(|rest| rest.split(' ').map(|word| Ok(f64::from(word.parse::<f32>()?))).collect());
        let numbers: Result<Vec<f64>> = numbers.ok_or_else(|| format!("it says `{answer}`"))?;
        Ok(numbers?.as_slice().try_into()?)
    }

    /// Takes a check point; whether the watch alarms.
    pub fn check(&mut self, joints: &Joints, point: &Vector3<f64>) -> Result<bool> {
        match self.ask("check", joints.iter().chain(point))?.as_str() {
            "alarm" => Ok(true),
            "quiet" => Ok(false),
            answer => Err(format!("it says `{answer}`").into()),
        }
    }

    /// Takes a point of those after an alarm; something after the last one.
    pub fn point(&mut self, joints: &Joints, point: &Vector3<f64>) -> Result<Option<Stored>> {
        let answer = self.ask("point", joints.iter().chain(point))?;
        if answer == "taken" {
            return Ok(None);
        }
        let stored = answer.strip_prefix("stored ").and_then(|rest| {
            let (sequence, rest) = rest.split_once(' ')?;
            let (suspect, moved) = rest.split_once(' ')?;
            let (suspect, moved) = (suspect.to_owned(), moved.to_owned());
            Some(Stored { sequence: sequence.parse().ok()?, suspect, moved })
        });
        stored.map(Some).ok_or_else(|| format!("it says `{answer}`").into())
    }

    fn ask<T: Display>(
        &mut self,
        verb: &str,
        numbers: impl IntoIterator<Item = T>,
    ) -> Result<String> {
        let mut line = verb.to_owned();
        for number in numbers {
            line += &format!(" {number}");
        }
        writeln!(self.port.get_mut(), "{line}")?;
        self.line()
    }

    fn line(&mut self) -> Result<String> {
        let mut line = String::new();
        self.port.read_line(&mut line)?;
        match line.trim_end().strip_prefix("FAILED ") {
            Some(why) => Err(format!("the controller: {why}").into()),
            None if line.ends_with('\n') => Ok(line.trim_end().to_owned()),
            None => Err("the controller's power is gone".into()),
        }
    }
}
