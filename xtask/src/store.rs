//! The store on the controller: size of its code, and parameters in a real
//! EEPROM under QEMU that survive whatever is done to the board.

use std::fs;

use object::{Object, ObjectSymbol};
use truearm::blob::{Blob, robot_id};
use truearm::{Arm6, ArmParameters, State};

use crate::board::{Board, EEPROM, SLOT};
use crate::image::{CURVES, build, image};
use crate::run::{Result, call, program, step, target_dir};
use crate::study::restarts;
use crate::vectors;

/// Most bytes of text for the store, of a flash with words of 8 bytes.
const TEXT: u64 = 6 * 1024;

/// Restarts of a test run; `cargo xtask study restarts` has more.
const RESTARTS: u32 = 20;

pub fn run() -> Result {
    step("size of the store", check_text)?;
    step("build of the store image", || call(build("store").args(CURVES)))?;
    step("parameters in an EEPROM", survive)?;
    step("a blob of truearm pack in the EEPROM", packed)?;
    step("restarts at random moments", || restarts::run(RESTARTS, 1))
}

/// Sums up the functions of the store, for one memory, in the image that proves
/// them panic-free.
fn check_text() -> Result {
    call(build("no_panic").args(["--features", "flash_only"]))?;
    let bytes = fs::read(image("no_panic"))?;
    let file = object::File::parse(&*bytes)?;
    let parts = ["truearm5store", "power_up11store_", "power_up10store_"];
    let ours = file.symbols().filter_map(|symbol| {
        let name = symbol.name().ok()?;
        parts.iter().any(|part| name.contains(part)).then(|| (symbol.size(), name.to_owned()))
    });
    let ours: Vec<_> = ours.collect();
    for expected in ["store_slots", "store_open", "store_store"] {
        if !ours.iter().any(|(_, name)| name.contains(expected)) {
            return Err(format!("no function {expected} in the image: names changed?").into());
        }
    }
    let text: u64 = ours.iter().map(|(size, _)| size).sum();
    eprintln!("store: {text} of {TEXT} bytes in {} functions", ours.len());
    if text > TEXT { Err("the store is too large".into()) } else { Ok(()) }
}

/// An empty board, stores and restarts, and everything that is refused.
fn survive() -> Result {
    let files = [vectors::shipped(), vectors::shipped_terms()];
    let [first, second] = files.map(|files| files.blob);
    let robot = Blob::check(&fs::read(&first)?)?.robot_id();
    let board = Board::new("survive", &[], robot)?;
    expect(&board, "boot", 20_000, None, true, &["nominal; [Blank, Blank]"])?;
    expect(&board, "store", 20_000, Some(&first), true, &["stored: Written(A)"])?;
    expect(&board, "boot", 20_000, None, true, &["slot A, the newest", "settled: Already"])?;
    expect(&board, "store", 20_000, Some(&first), true, &["stored: Unchanged"])?;
    expect(&board, "store", 20_000, Some(&second), false, &["is not above the stored"])?;

    let newer = target_dir().join("board/newer.blob");
    fs::write(&newer, renumbered(&fs::read(&second)?, 7)?)?;
    expect(&board, "store", 20_000, Some(&newer), true, &["stored: Written(B)"])?;
    let output = expect(&board, "boot", 31_500, None, true, &["slot B, the newest"])?;
    check_tool(&output, &fs::read(&newer)?, 31.5)?;
    let output = expect(&board, "boot", -12_000, None, true, &["sequence: 7"])?;
    check_tool(&output, &fs::read(&newer)?, -12.0)?;

    // Two blobs with five tables of 256 nodes each, one beside the other.
    let curved = fs::read(vectors::shipped_curves().blob)?;
    for (sequence, slot) in [(8, "A"), (9, "B")] {
        fs::write(&newer, renumbered(&curved, sequence)?)?;
        let stored = format!("stored: Written({slot})");
        expect(&board, "store", 20_000, Some(&newer), true, &[&stored])?;
    }
    let output = expect(&board, "boot", 31_500, None, true, &["slot B, the newest"])?;
    check_tool(&output, &fs::read(&newer)?, 31.5)?;

    let mut bytes = board.read()?;
    bytes[SLOT as usize + 200] ^= 0x10;
    board.write(&bytes)?;
    let wanted = ["slot A, the last good; slot B: checksum"];
    expect(&board, "boot", 20_000, None, true, &wanted)?;
    let other = Board::new("other-robot", &bytes, robot ^ 1)?;
    expect(&other, "boot", 20_000, None, true, &["nominal", "WrongRobot"])?;
    expect(&other, "store", 20_000, Some(&first), false, &["where this robot is"])?;
    Ok(())
}

/// What the host packs and a programmer writes is what the controller reads.
fn packed() -> Result {
    let out = target_dir().join("board/packed.bin");
    let model = target_dir().join("line/model.toml");
    call(program()?.arg("pack").arg(&model).arg("--out").arg(&out))?;
    let blob = fs::read(&out)?;
    let identified: toml::Table = fs::read_to_string(&model)?.parse()?;
    let text = |key| identified.get(key).and_then(toml::Value::as_str).unwrap_or_default();
    let robot = robot_id(text("name"), text("serial"));
    for (start, slot) in [(0, "slot A"), (SLOT as usize, "slot B")] {
        let mut bytes = vec![0; EEPROM];
        bytes[start..start + blob.len()].copy_from_slice(&blob);
        let board = Board::new("packed", &bytes, robot)?;
        let output = expect(&board, "boot", 25_000, None, true, &[slot, "settled: Already"])?;
        check_tool(&output, &blob, 25.0)?;
        if board.read()? != bytes {
            return Err("the image wrote over what a programmer wrote".into());
        }
    }
    Ok(())
}

/// The blob with another sequence number and another stated error: one that
/// differs in its number alone is not stored again.
fn renumbered(blob: &[u8], sequence: u32) -> Result<Vec<u8>> {
    let mut parameters: ArmParameters<f32, 6> = Blob::check(blob)?.parameters()?;
    parameters.sequence = sequence;
    parameters.rms_after = 1e-5 * sequence as f32;
    let mut bytes = vec![0; EEPROM];
    let size = truearm::blob::encode(&parameters, &mut bytes)?;
    bytes.truncate(size);
    Ok(bytes)
}

/// A run of the board that must end so and print all of these.
fn expect(
    board: &Board,
    verb: &str,
    temperature: i32,
    blob: Option<&std::path::Path>,
    success: bool,
    wanted: &[&str],
) -> Result<String> {
    let (ended, output) = board.run(verb, temperature, blob)?;
    eprint!("{output}");
    let missing = wanted.iter().find(|text| !output.contains(**text));
    match missing {
        _ if ended != success => {
            Err(format!("{verb}: ended with success: {ended}, wanted {success}").into())
        }
        Some(text) => Err(format!("{verb}: did not print `{text}`").into()),
        None => Ok(output),
    }
}

/// The image's tool point is the host's, bit for bit, at the temperature that
/// the sensor was given.
fn check_tool(output: &str, blob: &[u8], temperature: f32) -> Result {
    let parameters: ArmParameters<f32, 6> = Blob::check(blob)?.parameters()?;
    let state = State::at(temperature);
    let pose = Arm6::new(&parameters).real_pose_in(&[0.0; 6], &state);
    let [x, y, z] = [0, 1, 2].map(|axis| pose.translation[axis].to_bits());
    let wanted = format!("temperature: {temperature} C\ntool: {x:08x} {y:08x} {z:08x}\n");
    if output.contains(&wanted) { Ok(()) } else { Err(format!("wanted {wanted}").into()) }
}
