//! `cargo xtask c`: the C interface. Its header is generated and compared, a C
//! program is linked with it and run on the board, and with a panic built in
//! that program must not link.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use cbindgen::{Builder, Config};

use crate::firmware::{PANIC_SYMBOL, build_dir, build_of, directory, qemu_command};
use crate::qemu::{self, TARGET};
use crate::run::{Result, call, root, step};
use crate::vectors::{shipped, shipped_terms};
use crate::{budgets, vectors::Files};

const GCC: &str = "arm-none-eabi-gcc";
const FLAGS: &str = "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -std=c11 -O2 \
    -Wall -Wextra -Wpedantic -Werror -ffunction-sections -ffreestanding -nostdlib -Wl,--gc-sections";

pub fn run() -> Result {
    qemu::ensure_tools()?;
    qemu::ensure(
        GCC,
        "gcc-arm-none-eabi",
        "  Debian, Ubuntu  sudo apt-get install gcc-arm-none-eabi\n  \
           Fedora          sudo dnf install arm-none-eabi-gcc-cs\n  \
           macOS           brew install arm-none-eabi-gcc",
    )?;
    step("C header in step with the crate", || check_header(false))?;
    step("C program on the controller", || {
        let program = link(&[])?;
        if !program.1.status.success() {
            return Err(String::from_utf8_lossy(&program.1.stderr).into());
        }
        run_on(&program.0, &shipped())?;
        run_on(&program.0, &shipped_terms())?;
        let (text, ram) = budgets::sizes(&program.0, "reset")?;
        println!("C program: {text} bytes of text, {ram} of static RAM");
        Ok(())
    })?;
    step("C program with a panic built in", || {
        let (_, output) = link(&["--features", "negative_control"])?;
        let message = String::from_utf8_lossy(&output.stderr);
        if output.status.success() || !message.contains(PANIC_SYMBOL) {
            return Err(format!("it must not link for want of {PANIC_SYMBOL}:\n{message}").into());
        }
        eprintln!("it does not link ({PANIC_SYMBOL})");
        Ok(())
    })
}

/// Compares the committed header with a generated one, or rewrites it.
pub fn check_header(rewrite: bool) -> Result {
    let dir = directory().join("capi");
    let config = Config::from_file(dir.join("cbindgen.toml"))?;
    let mut builder = Builder::new().with_config(config);
    for file in ["types.rs", "lib.rs"] {
        builder = builder.with_src(dir.join("src").join(file));
    }
    let mut header = Vec::new();
    builder.generate()?.write(&mut header);
    let path = dir.join("include/truearm.h");
    if rewrite {
        return Ok(fs::write(path, header)?);
    }
    if fs::read(&path)? == header {
        Ok(())
    } else {
        Err("include/truearm.h differs from the crate: cargo xtask c --header".into())
    }
}

/// Builds the library with these arguments and links the program with it.
fn link(arguments: &[&str]) -> Result<(PathBuf, Output)> {
    let dir = build_dir();
    call(build_of(&dir, "--package truearm-capi").args(arguments))?;
    let program = dir.join("c.elf");
    let source = directory().join("capi");
    let mut gcc = Command::new(GCC);
    gcc.args(FLAGS.split_whitespace()).arg("-I").arg(source.join("include"));
    gcc.arg("-L").arg(root()).arg("-T").arg(source.join("c/board.ld"));
    gcc.args(["main.c", "board.c"].map(|file| source.join("c").join(file)));
    gcc.arg(dir.join(TARGET).join("release/libtruearm_capi.a"));
    gcc.args(["-lgcc", "-o"]).arg(&program);
    let output = gcc.output().map_err(|error| format!("{GCC}: {error}"))?;
    Ok((program, output))
}

fn run_on(program: &Path, files: &Files) -> Result {
    let ended = qemu::run(&qemu_command(program, files)?, &directory())?;
    if ended.success && ended.output.contains("ok: C gives the bits of Rust") {
        Ok(())
    } else {
        Err("the C program found a fault".into())
    }
}
