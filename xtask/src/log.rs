//! The log of a controller: the image `log` under QEMU, its frames decoded
//! here by the format strings of its ELF file. They must say what `Debug` says
//! of the same values on the host.

#[path = "../../tests/firmware/src/log.rs"]
mod image;

use std::fs;

use defmt_decoder::{DecodeError, Table};
use truearm::blob::Blob;
use truearm::compensate::{Refusal, Status};

use crate::image::{build_dir, build_of, directory, qemu_command};
use crate::qemu;
use crate::run::{Result, call, target_dir};
use crate::vectors::{self, Files};

pub fn check() -> Result {
    call(&mut build_of(&build_dir(), "--bin log --features log"))?;
    let files = vectors::shipped();
    let elf = crate::image::image("log");
    let lines = decode(&fs::read(&elf)?, &frames(&qemu_command(&elf, &files)?)?)?;
    for line in &lines {
        println!("{line}");
    }
    let expected = expected(&files)?;
    let same = lines.iter().map(|line| plain(line)).eq(expected.iter().map(|line| plain(line)));
    if !same {
        return Err(format!("expected was\n{}", expected.join("\n")).into());
    }
    Ok(())
}

/// What the image sends.
fn frames(command: &[String]) -> Result<Vec<u8>> {
    let path = target_dir().join("firmware/log.frames");
    let success = qemu::run_to(&path, command, &directory())?;
    let frames = fs::read(path)?;
    if success {
        Ok(frames)
    } else {
        Err(format!("the image failed: {}", String::from_utf8_lossy(&frames)).into())
    }
}

fn decode(elf: &[u8], frames: &[u8]) -> Result<Vec<String>> {
    let table = Table::parse(elf)?.ok_or("the image has no section .defmt")?;
    let mut stream = table.new_stream_decoder();
    stream.received(frames);
    let mut lines = Vec::new();
    loop {
        match stream.decode() {
            Ok(frame) => {
                let level = frame.level().map_or("", |level| level.as_str());
                lines.push(format!("{level} {}", frame.display_message()));
            }
            Err(DecodeError::UnexpectedEof) => return Ok(lines),
            Err(error) => return Err(format!("after {} frames: {error}", lines.len()).into()),
        }
    }
}

/// The line with its real numbers in one notation: the decoder and `Debug` do not
/// take to powers of ten at the same size.
fn plain(line: &str) -> String {
    let words = line.split_inclusive([' ', ',', '[', ']']).map(|word| {
        let number = word.trim_end_matches([' ', ',', '[', ']']);
        match number.parse::<f32>() {
            Ok(value) if number.contains(['.', 'e']) => word.replace(number, &format!("{value:e}")),
            _ => word.to_owned(),
        }
    });
    words.collect()
}

fn expected(files: &Files) -> Result<Vec<String>> {
    // The rest of a slot is erased flash.
    let mut slot = [0xff; 1024];
    let bytes = fs::read(&files.blob)?;
    slot.get_mut(..bytes.len()).ok_or("a blob of more than 1 KiB")?.copy_from_slice(&bytes);
    let blob = Blob::check(&slot)?;
    let image::Events { damaged, cut, position, off, ramping, on, singular, refused } =
        image::events(&slot).ok_or("an event did not come about")?;
    // Otherwise the log says less than it is to show.
    let joint = image::REFUSED;
    let statuses = [off.status, ramping.status, on.status, refused.status];
    let refusal = Status::Refused(Refusal::CommandNotFinite { joint });
    if statuses != [Status::Off, Status::Ramping, Status::On, refusal]
        || singular.damping.is_none_or(|mu| mu <= 0.0)
    {
        return Err(format!("{statuses:?}, singular: {singular:?}").into());
    }
    let (robot, sequence) = (blob.robot_id(), blob.sequence());
    let (joints, terms) = (blob.joints(), blob.terms());
    Ok(vec![
        format!(
            "info Blob {{ robot_id: {robot:016x}, sequence: {sequence}, joints: {joints}, \
             terms: {terms} }}"
        ),
        format!("error {damaged:?}"),
        format!("error {cut:?}"),
        format!("info {position:?}"),
        format!("info {off:?}"),
        format!("info {:?}", ramping.status),
        format!("info {on:?}"),
        format!("warn {singular:?}"),
        format!("error {refused:?}"),
    ])
}
