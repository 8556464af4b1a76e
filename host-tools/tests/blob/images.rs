//! The files that `pack` writes, read as the tools of their users do: by
//! parsers that share no code with the writers.

use std::path::{Path, PathBuf};
use std::process::Command as Process;

use assert_cmd::Command;
use tempfile::TempDir;
use truearm::blob::{Acceptance, AcceptanceError, Blob};
use truearm_host::blob::image::MemoryRegions;
use truearm_host::files::read_key;
use truearm_host::identify::{Options, identify};
use truearm_host::model::{Measurements, Model, ModelTerm, Robot};

const SCRIPT: &str = "MEMORY {\n  PARAM_A (r) : ORIGIN = 0x0801FEF8, LENGTH = 8K /* : ORIGIN = 5 */\n\
                      PARAM_B : org = 0x0803_X, len = 4K\n}\n";

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data").join(name)
}

/// A folder with model.toml (with terms and masses), memory.x and a key.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut robot = Robot::read(&data("seed-table-8/robot.toml")).unwrap();
    (robot.name, robot.serial) = ("arm".to_owned(), "0042".to_owned());
    let rows = Measurements::read(&data("seed-table-8/measurements.csv"), &robot).unwrap();
    let model = identify(&robot, &rows, &Options::default(), &|_, _| ()).unwrap().model;
    std::fs::write(folder.path().join("model.toml"), model.to_toml()).unwrap();
    let script = SCRIPT.replace("0x0803_X", "134414336");
    std::fs::write(folder.path().join("memory.x"), script).unwrap();
    std::fs::write(folder.path().join("robot.key"), "0f".repeat(32) + "\n").unwrap();
    folder
}

fn truearm(folder: &TempDir, line: &str) -> std::process::Output {
    let mut command = Command::cargo_bin("truearm").unwrap();
    command.current_dir(folder).env("COLUMNS", "1000");
    command.args(line.split_whitespace()).output().unwrap()
}

fn run(folder: &TempDir, line: &str) -> String {
    let out = truearm(folder, line);
    assert!(out.status.success(), "{line}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

fn fail(folder: &TempDir, line: &str) -> String {
    let out = truearm(folder, line);
    assert_eq!(out.status.code(), Some(1), "{line}");
    let text = String::from_utf8(out.stderr).unwrap().replace('│', " ");
    assert!(!text.contains("panicked"), "{text}");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn packed(folder: &TempDir, more: &str) -> Vec<u8> {
    run(folder, &format!("pack model.toml --out packed {more}"));
    std::fs::read(folder.path().join("packed")).unwrap()
}

const SLOT_A: u32 = 0x0801_fef8;

#[test]
fn intel_hex_gives_the_bytes_at_the_slot() {
    let folder = folder();
    let blob = packed(&folder, "");
    let text = String::from_utf8(packed(&folder, "--format ihex --slot a")).unwrap();
    // The blob runs across 0x08020000, where the upper address changes.
    let (mut upper, mut bytes, mut next) = (0, Vec::<u8>::new(), SLOT_A);
    let mut ended = false;
    for line in text.lines() {
        assert!(!ended);
        let digits = line.strip_prefix(':').unwrap();
        let record: Vec<u8> = (0..digits.len() / 2)
            .map(|k| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).unwrap())
            .collect();
        assert_eq!(record.iter().fold(0, |sum: u8, b| sum.wrapping_add(*b)), 0, "{line}");
        let (count, kind) = (usize::from(record[0]), record[3]);
        let content = &record[4..record.len() - 1];
        assert_eq!(content.len(), count);
        match kind {
            0 => {
                let low = u32::from(record[1]) << 8 | u32::from(record[2]);
                assert_eq!(upper << 16 | low, next);
                assert!(low as usize + count <= 0x1_0000);
                bytes.extend(content);
                next += count as u32;
            }
            1 => ended = true,
            4 => upper = u32::from(content[0]) << 8 | u32::from(content[1]),
            _ => panic!("{line}"),
        }
    }
    assert!(ended && upper == 0x0802);
    assert_eq!(bytes, blob);
}

#[test]
fn uf2_gives_the_bytes_at_the_slot() {
    let folder = folder();
    let blob = packed(&folder, "--covariance");
    let file = packed(&folder, "--covariance --format uf2 --slot b --uf2-family 0xe48bff56");
    let (blocks, rest) = file.as_chunks::<512>();
    assert!(rest.is_empty());
    let mut bytes: Vec<u8> = Vec::new();
    for (k, block) in blocks.iter().enumerate() {
        let word = |at: usize| u32::from_le_bytes(block[at..at + 4].try_into().unwrap());
        assert_eq!((word(0), word(4), word(508)), (0x0a32_4655, 0x9e5d_5157, 0x0ab1_6f30));
        assert_eq!((word(8), word(28)), (0x2000, 0xe48b_ff56));
        assert_eq!(word(12), 134_414_336 + 256 * k as u32);
        assert_eq!((word(16), word(20), word(24)), (256, k as u32, blocks.len() as u32));
        bytes.extend(&block[32..32 + 256]);
    }
    assert_eq!(bytes[..blob.len()], blob);
    assert!(bytes[blob.len()..].iter().all(|b| *b == 0xff));
}

#[test]
fn elf_has_one_segment_at_the_slot() {
    let folder = folder();
    let blob = packed(&folder, "");
    let elf = packed(&folder, "--format elf --slot a");
    let word = |at: usize| u32::from_le_bytes(elf[at..at + 4].try_into().unwrap());
    let half = |at: usize| u16::from_le_bytes(elf[at..at + 2].try_into().unwrap());
    // Class 32, little-endian; executable, Arm, EABI 5; one program header.
    assert_eq!(elf[..7], *b"\x7fELF\x01\x01\x01");
    assert_eq!((half(16), half(18), word(36), half(44)), (2, 40, 0x0500_0000, 1));
    let header = word(28) as usize;
    let [kind, offset, vaddr, paddr, filesz, memsz] =
        [0, 4, 8, 12, 16, 20].map(|k| word(header + k));
    assert_eq!((kind, vaddr, paddr), (1, SLOT_A, SLOT_A));
    assert_eq!((filesz, memsz), (blob.len() as u32, blob.len() as u32));
    assert_eq!(elf[offset as usize..][..blob.len()], blob);
    // Binutils and LLVM find the section, where they are installed.
    let path = folder.path().join("packed");
    let out = folder.path().join("back.bin");
    let tools = [("objcopy", "-O binary"), ("llvm-objcopy", "-O binary")];
    for (tool, arguments) in tools {
        let mut command = Process::new(tool);
        match command.args(arguments.split(' ')).arg(&path).arg(&out).output() {
            Ok(done) if done.status.success() => {
                assert_eq!(std::fs::read(&out).unwrap(), blob, "{tool}");
            }
            Ok(done) => println!("{tool}: {}", String::from_utf8_lossy(&done.stderr)),
            Err(_) => println!("{tool} is not installed"),
        }
    }
}

/// Compiled and run where there is a compiler; `rustc` there always is.
#[test]
fn sources_compile_and_hold_the_bytes() {
    let folder = folder();
    let blob = packed(&folder, "");
    let path = |name: &str| folder.path().join(name);
    let compile_and_run = |compiler: &str, arguments: &[&str]| {
        let mut command = Process::new(compiler);
        let built = match command.current_dir(&folder).args(arguments).output() {
            Ok(built) => built,
            Err(_) => return println!("{compiler} is not installed"),
        };
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let said = Process::new(path("program")).output().unwrap();
        assert!(said.stdout == blob, "{compiler}");
    };

    std::fs::write(path("parameters.rs"), packed(&folder, "--format rust")).unwrap();
    let main = "mod parameters;\nuse std::io::Write;\n\
                fn main() { std::io::stdout().write_all(&parameters::PARAMETERS).unwrap(); }";
    std::fs::write(path("main.rs"), main).unwrap();
    compile_and_run("rustc", &["-D", "warnings", "--edition", "2024", "-o", "program", "main.rs"]);

    let c = packed(&folder, "--format c");
    for name in ["parameters.c", "parameters.cpp"] {
        std::fs::write(path(name), &c).unwrap();
    }
    let main = "#include <stdint.h>\n#include <stdio.h>\n\
                #ifdef __cplusplus\nextern \"C\" {\n#endif\n\
                extern const uint8_t truearm_parameters[]; extern const uint32_t truearm_parameters_size;\n\
                #ifdef __cplusplus\n}\n#endif\n\
                int main(void) { if ((uintptr_t)truearm_parameters % 4) return 1;\n\
                return fwrite(truearm_parameters, truearm_parameters_size, 1, stdout) != 1; }\n";
    for name in ["main.c", "main.cpp"] {
        std::fs::write(path(name), main).unwrap();
    }
    let strict = ["-Wall", "-Wextra", "-Werror", "-o", "program"];
    let c = [&["-std=c11"][..], &strict, &["main.c", "parameters.c"]].concat();
    compile_and_run("cc", &c);
    let cpp = [&["-std=c++11"][..], &strict, &["main.cpp", "parameters.cpp"]].concat();
    compile_and_run("c++", &cpp);
}

#[test]
fn unpack_then_pack_gives_the_same_bytes() {
    let folder = folder();
    let with = |more: &str| packed(&folder, more);
    let mut blobs = vec![
        (with(""), ""),
        (with("--sequence 7"), ""),
        (with("--covariance"), "--covariance"),
        (with("--covariance --key robot.key"), "--covariance --key robot.key"),
    ];
    // Other arms: prismatic joints, absent ranges, every effect, masses, another layout of joints.
    for name in
        ["golden/layout-3-full.blob", "golden/layout-3-least.blob", "firmware/ur10-terms.blob"]
    {
        blobs.push((std::fs::read(data(name)).unwrap(), ""));
    }
    blobs.push((std::fs::read(data("golden/layout-3-covariance.blob")).unwrap(), "--covariance"));
    for (k, (blob, more)) in blobs.iter().enumerate() {
        std::fs::write(folder.path().join("a.bin"), blob).unwrap();
        let said = run(&folder, "unpack a.bin --out back.toml --force");
        assert!(said.contains("name and serial of the robot"), "{said}");
        assert!(said.contains("tracker stations"), "{said}");
        assert_eq!(said.contains("the key of the authentication tag"), more.contains("--key"));
        run(&folder, &format!("pack back.toml --out b.bin --force {more}"));
        let again = std::fs::read(folder.path().join("b.bin")).unwrap();
        assert!(again == *blob, "blob {k}");
    }
    // With its name the model needs no id, and is that of identify again.
    std::fs::write(folder.path().join("a.bin"), &blobs[0].0).unwrap();
    let said = run(&folder, "unpack a.bin --out back.toml --name arm --serial 0042 --force");
    assert!(!said.contains("name and serial of the robot"), "{said}");
    assert!(Model::read(&folder.path().join("back.toml")).unwrap().robot_id.is_none());
    run(&folder, "pack back.toml --out b.bin --force");
    assert_eq!(std::fs::read(folder.path().join("b.bin")).unwrap(), blobs[0].0);
    let message = fail(&folder, "unpack a.bin --out back.toml --name somebody");
    assert!(message.contains("is not that of \"somebody\" \"\""), "{message}");
}

#[test]
fn a_key_signs_and_is_asked_for() {
    let folder = folder();
    let blob = packed(&folder, "--key robot.key");
    let key = read_key(&folder.path().join("robot.key")).unwrap();
    assert_eq!(key, [0x0f; 32]);
    let robot = Blob::check(&blob).unwrap().robot_id();
    assert!(Acceptance::of(robot, 6).with_key(key).check(&blob).is_ok());
    let refusal = Acceptance::of(robot, 6).with_key([0; 32]).check(&blob).unwrap_err();
    assert_eq!(refusal, AcceptanceError::WrongKey);
    let said = run(&folder, "inspect packed --key robot.key --not-before 1");
    assert!(said.contains("accepted by a controller with: key robot.key, sequence 1"), "{said}");
    // 32 raw bytes are a key as well.
    std::fs::write(folder.path().join("other.key"), [7; 32]).unwrap();
    let message = fail(&folder, "inspect packed --key other.key");
    assert!(message.contains("tag does not fit the key"), "{message}");
    packed(&folder, "");
    let message = fail(&folder, "inspect packed --key robot.key");
    assert!(message.contains("carries no authentication tag"), "{message}");
    for (text, says) in [("", "0 bytes are no key"), (&"0g".repeat(32), "64 bytes are no key")] {
        std::fs::write(folder.path().join("bad.key"), text).unwrap();
        let message = fail(&folder, "pack model.toml --out packed --key bad.key");
        assert!(message.contains(says) && message.contains("64 hexadecimal digits"), "{message}");
    }
}

#[test]
fn bad_input_is_named() {
    let folder = folder();
    let pack = |more: &str| fail(&folder, &format!("pack model.toml --out x {more}"));
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    for format in ["ihex", "uf2", "elf"] {
        let message = pack(&format!("--format {format}"));
        assert!(message.contains("carry an address") && message.contains("--slot a"), "{message}");
    }
    let message = pack("--slot a --memory none.x");
    assert!(message.contains("none.x") && message.contains("--memory FILE"), "{message}");
    for (text, says) in [
        ("SECTIONS { }", "bad.x:1: no MEMORY command"),
        ("\nMEMORY", "bad.x:2: MEMORY without { and }"),
        ("MEMORY {\n RAM : ORIGIN = 0, LENGTH = 4K\n}", "no region PARAM_A, it has RAM"),
        ("MEMORY {\n}", "no region PARAM_A, it has nothing"),
        ("MEMORY {\n\n PARAM_A : ORIGIN = 0\n}", "bad.x:3: `PARAM_A : ORIGIN = 0` is no region"),
        (
            "MEMORY {\n PARAM_A : ORIGIN = 1K + 1, LENGTH = 4K\n}",
            "bad.x:2: PARAM_A: `1K + 1` is no number of 32 bits",
        ),
        (
            "MEMORY {\n PARAM_A : ORIGIN = 8M, LENGTH = 5000M\n}",
            "bad.x:2: PARAM_A: `5000M` is no number",
        ),
        (
            "MEMORY {\n PARAM_A : ORIGIN = 8M, LENGTH = 0x100\n}",
            "564 bytes of parameters, PARAM_A has 256",
        ),
    ] {
        write("bad.x", text);
        let message = pack("--slot a --memory bad.x");
        assert!(message.contains(says), "{message}\nshould say\n{says}");
    }
    assert!(!folder.path().join("x").exists());

    let model = std::fs::read_to_string(folder.path().join("model.toml")).unwrap();
    let (without, covariance) = model.split_once("[covariance]").unwrap();
    write("none.toml", without);
    let message = fail(&folder, "pack none.toml --out x --covariance");
    assert!(message.contains("no [covariance]"), "{message}");
    write("short.toml", &format!("{without}[covariance]{}", covariance.replacen("  [", "# [", 1)));
    let message = fail(&folder, "pack short.toml --out x --covariance");
    assert!(message.contains("741 numbers where joints and terms need 780"), "{message}");
    write(
        "torn.toml",
        &format!("{without}[covariance]{}", covariance.replacen("\n  [", "\n  [0.5, ", 1)),
    );
    let message = fail(&folder, "pack torn.toml --out x");
    assert!(message.contains("[covariance] column 1 has"), "{message}");
    write("id.toml", &model.replacen("name =", "robot_id = \"12\"\nname =", 1));
    let message = fail(&folder, "pack id.toml --out x");
    assert!(message.contains("robot_id \"12\" is not 0x and 16 hex digits"), "{message}");
}

/// Every refusal comes with what it means and what to do.
#[test]
fn inspect_explains_refusals() {
    let folder = folder();
    let good = packed(&folder, "");
    let inspect = |bytes: &[u8]| {
        std::fs::write(folder.path().join("x.bin"), bytes).unwrap();
        fail(&folder, "inspect x.bin")
    };
    let changed = |at: usize, value: &[u8], mend: bool| {
        let mut bytes = good.clone();
        bytes[at..at + value.len()].copy_from_slice(value);
        if mend {
            let body = bytes.len() - 4;
            let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&bytes[..body]);
            bytes[body..].copy_from_slice(&sum.to_le_bytes());
        }
        bytes
    };
    let nan = f32::NAN.to_le_bytes();
    for (bytes, error, meaning) in [
        (vec![0xff; 600], "does not begin with TARM", "erased flash"),
        (
            packed(&folder, "--format ihex --slot a"),
            "does not begin with TARM",
            "looks like Intel HEX",
        ),
        (packed(&folder, "--format uf2 --slot a"), "does not begin with TARM", "looks like UF2"),
        (packed(&folder, "--format elf --slot a"), "does not begin with TARM", "looks like ELF"),
        (good[..99].to_vec(), "99 bytes where 104 are needed", "the end is missing"),
        (b"TARX".to_vec(), "4 bytes where 104 are needed", "give a file written by"),
        (Vec::new(), "0 bytes where 104 are needed", "the file is empty"),
        (changed(4, &[2], true), "layout 2 was a draft", "pack the model again"),
        (changed(4, &[9], true), "layout 9 is newer", "update this program"),
        (changed(6, &[99], true), "99 joints", "contradicts itself"),
        // A wrong length has no checksum that fits: damage comes first.
        (changed(8, &[1], true), "checksum 0x", "bytes changed after it was packed"),
        (changed(60, &[1], false), "checksum 0x", "bytes changed after it was packed"),
        (changed(56, &nan, true), "tool x is not a finite number", "the checksum is right"),
        (changed(112, &11_f32.to_le_bytes(), true), "joint 1 nominal a is outside", "FORMAT.md"),
        (changed(28, &[0xf0], true), "flags has a value without a meaning", "a newer truearm"),
    ] {
        let message = inspect(&bytes);
        assert!(message.contains(error) && message.contains(meaning), "{message}");
    }
    std::fs::write(folder.path().join("x.bin"), &good).unwrap();
    let robot = data("ur10-ipa/robot.toml");
    let message = fail(&folder, &format!("inspect x.bin --robot {}", robot.display()));
    assert!(
        message.contains("where this robot is") && message.contains("another robot's"),
        "{message}"
    );
    let message = fail(&folder, "inspect x.bin --not-before 4000000000");
    assert!(message.contains("is older than 4000000000"), "{message}");
}

#[test]
fn diff_says_what_moved_and_how_far() {
    let folder = folder();
    let path = folder.path().join("model.toml");
    run(&folder, "pack model.toml --out a.bin --sequence 1");
    let mut model = Model::read(&path).unwrap();
    run(&folder, "pack model.toml --out same.bin --sequence 2");
    let said = run(&folder, "diff a.bin same.bin");
    assert_eq!(said, "sequence 1 -> 2\nthe parameters are the same\n");

    // One metre from the first axis a milliradian is a millimetre.
    model.corrections[0].theta += 1e-3;
    model.corrections[3].a += 0.25e-3;
    let gain = truearm::effects::Term {
        effect: truearm::effects::Effect::JointGain,
        joint: 1,
        source: 0,
        component: 0,
        order: 0.0,
        coefficient: 1e-4,
    };
    model.terms.push(ModelTerm::Arm(gain));
    std::fs::write(&path, model.to_toml()).unwrap();
    run(&folder, "pack model.toml --out b.bin --sequence 2");
    let said = run(&folder, "diff a.bin b.bin");
    for words in [
        "joint 1 correction theta_offset",
        "+0.057296 deg",
        "joint 4 correction a",
        "+0.250000 mm",
        "term joint-gain 2: new, 1.000000e-4 rad/rad",
        "within the joint limits, 10000 poses",
        "within what both identifications covered, 10000 poses",
    ] {
        assert!(said.contains(words), "{words} in {said}");
    }
    assert!(!said.contains("joint 2 correction"), "{said}");
    // The figure is the motion at the pose it names.
    let line = said.lines().find(|l| l.starts_with("within what both")).unwrap();
    let most: f64 =
        line.split("moves by ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let pose = said.split("within what both").nth(1).unwrap().split("worst pose ").nth(1).unwrap();
    let q: Vec<f64> = pose
        .split(": by")
        .next()
        .unwrap()
        .split(", ")
        .map(|cell| cell.trim_end_matches(" deg").parse::<f64>().unwrap().to_radians())
        .collect();
    let q: [f64; 6] = q.try_into().unwrap();
    let point = |name: &str| {
        let bytes = std::fs::read(folder.path().join(name)).unwrap();
        let parameters = Blob::check(&bytes).unwrap().parameters::<f64, 6>().unwrap();
        truearm::Arm::new(&parameters).real_pose(&q).translation
    };
    assert!(((point("a.bin") - point("b.bin")).norm() * 1e3 - most).abs() < 1e-3, "{said}");
    assert!(most > 0.25 && most < 3.0, "{said}");

    std::fs::copy(data("golden/layout-3-full.blob"), folder.path().join("other.bin")).unwrap();
    let message = fail(&folder, "diff a.bin other.bin");
    assert!(message.contains("6 joints before, 3 after"), "{message}");
    std::fs::write(folder.path().join("bad.bin"), "junk").unwrap();
    assert!(fail(&folder, "diff a.bin bad.bin").contains("bad.bin: 4 bytes where 104"));
}

#[test]
fn the_repository_has_slots_that_hold_everything() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../memory.x");
    let regions = MemoryRegions::read(&path).unwrap();
    let [a, b] = ["PARAM_A", "PARAM_B"].map(|name| regions.find(&path, name).unwrap());
    let most = truearm::blob::encoded_len(6, 24) + 32 + 4 * truearm::blob::factor_len(6, 24);
    assert!(a.length == b.length && a.length as usize >= most + 64);
    assert!(a.origin + a.length <= b.origin);
}
