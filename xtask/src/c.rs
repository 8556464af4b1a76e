//! `cargo xtask c`: the C library. Its header is generated and compared, its own
//! tests are run, a C program is linked with it and run on the host and on the
//! board, and with a panic built in that program must not link.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use cbindgen::{Builder, Config};

use crate::budgets;
use crate::image::{PANIC_SYMBOL, directory as firmware, qemu_command};
use crate::qemu;
use crate::run::{Result, call, cargo, root, step, target_dir};
use crate::tools::{self, TARGET};
use crate::vectors::{Files, shipped, shipped_terms};

/// Of every compiler.
const FLAGS: &str = "-std=c11 -O2 -Wall -Wextra -Wpedantic -Werror -Wl,--gc-sections";
/// What the program says of itself when it has found nothing.
const GOOD: &str = "ok: C gives the bits of Rust";

/// Pointers as long as the controller's, and no assembly in libm, which Miri
/// cannot run.
const MIRI_TARGET: &str = "arm-unknown-linux-gnueabi";

/// Where a C program runs.
struct Platform {
    gcc: &'static str,
    flags: &'static str,
    /// The source beside `check.c`.
    start: &'static str,
    /// What rustc calls it, if it is not the host.
    target: Option<&'static str>,
}

const HOST: Platform = Platform {
    gcc: "gcc",
    flags: "-fsanitize=address,undefined -fno-sanitize-recover=all",
    start: "host.c",
    target: None,
};
const BOARD: Platform = Platform {
    gcc: "arm-none-eabi-gcc",
    flags: "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -ffunction-sections \
            -ffreestanding -nostdlib",
    start: "board.c",
    target: Some(TARGET),
};

/// The library's workspace.
pub fn directory() -> PathBuf {
    root().join("capi")
}

pub fn run() -> Result {
    tools::ensure()?;
    ensure_compilers()?;
    step("C header in step with the crate", || check_header(false))?;
    step("C library from Rust", || call(cargo_in("test --locked").arg("--quiet")))?;
    for (platform, name) in [(&HOST, "on the host"), (&BOARD, "on the controller")] {
        step(&format!("C program {name}"), || platform.check())?;
        step(&format!("C program {name} with a panic built in"), || platform.must_not_link())?;
    }
    step("C of the book", of_the_book)?;
    step("C that looks at no error", ignored)
}

/// A program that looks at no error is warned of every one: by the attribute of C23 and C++17
/// as by that of the compiler.
fn ignored() -> Result {
    let source = directory().join("c/ignored.c");
    let calls = fs::read_to_string(&source)?.matches("\n    truearm_").count();
    for (gcc, language) in
        [(HOST.gcc, "c11"), (HOST.gcc, "c2x"), (HOST.gcc, "c++17"), (BOARD.gcc, "c11")]
    {
        let mut compile = Command::new(gcc);
        let name = if language.starts_with("c++") { "c++" } else { "c" };
        compile.args(["-x", name, &format!("-std={language}"), "-Wall", "-Wextra", "-Wpedantic"]);
        compile.arg("-I").arg(directory().join("include")).arg("-c").arg(&source);
        compile.env("LC_ALL", "C");
        let output = compile.arg("-o").arg(build_dir().join("ignored.o")).output()?;
        let said = String::from_utf8_lossy(&output.stderr);
        let (all, unused) =
            (said.matches(" warning: ").count(), said.matches("[-Wunused-result]").count());
        if !output.status.success() || all != calls || unused != calls {
            return Err(format!("{gcc} -std={language}: {unused} of {calls}:\n{said}").into());
        }
    }
    Ok(())
}

/// The page that shows how a C program uses the library compiles.
fn of_the_book() -> Result {
    let page = fs::read_to_string(root().join("docs/firmware.md"))?;
    let (_, rest) = page.split_once("\n```c\n").ok_or("docs/firmware.md has no C")?;
    let (shown, _) = rest.split_once("```").ok_or("docs/firmware.md: C without an end")?;
    let source = build_dir().join("book.c");
    fs::write(&source, shown)?;
    for Platform { gcc, flags, .. } in [&HOST, &BOARD] {
        let mut compile = Command::new(gcc);
        compile.args(FLAGS.split_whitespace()).args(flags.split_whitespace()).arg("-I");
        compile.arg(directory().join("include")).arg("-c").arg(&source).arg("-o");
        call(compile.arg(source.with_extension("o")))?;
    }
    Ok(())
}

/// The library's tests under Miri, which finds undefined behaviour; not where
/// Miri cannot be had.
pub fn miri() -> Result {
    step("C library under Miri", || {
        // Does nothing where they are.
        let mut install = Command::new("rustup");
        install.args(["component", "add", "miri", "rust-src", "--toolchain", "nightly"]);
        if let Err(why) = call(&mut install) {
            eprintln!("SKIPPED, nothing is known of undefined behaviour: {why}");
            return Ok(());
        }
        let mut test = Command::new("rustup");
        test.args(["run", "nightly", "cargo", "miri", "test", "--locked", "--quiet"]);
        test.args(["--target", MIRI_TARGET]);
        test.current_dir(directory()).arg("--target-dir").arg(build_dir());
        call(&mut test)
    })
}

fn ensure_compilers() -> Result {
    tools::ensure_program(
        HOST.gcc,
        "gcc libc6-dev",
        "  Debian, Ubuntu  sudo apt-get install gcc libc6-dev\n  \
           Fedora          sudo dnf install gcc libasan libubsan\n  \
           macOS           xcode-select --install",
    )?;
    tools::ensure_program(
        BOARD.gcc,
        "gcc-arm-none-eabi",
        "  Debian, Ubuntu  sudo apt-get install gcc-arm-none-eabi\n  \
           Fedora          sudo dnf install arm-none-eabi-gcc-cs\n  \
           macOS           brew install arm-none-eabi-gcc",
    )
}

/// Compares the committed header with a generated one, or rewrites it.
pub fn check_header(rewrite: bool) -> Result {
    let dir = directory();
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

fn build_dir() -> PathBuf {
    target_dir().join("capi")
}

fn cargo_in(arguments: &str) -> Command {
    let mut command = cargo(&directory(), arguments);
    command.arg("--target-dir").arg(build_dir());
    command
}

impl Platform {
    /// The program on the shipped arm, without terms and with them.
    fn check(&self) -> Result {
        let (program, output) = self.link(&[])?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into());
        }
        for files in [shipped(), shipped_terms()] {
            self.run(&program, &files)?;
        }
        if self.target.is_some() {
            let (text, ram) = budgets::sizes(&program, "reset")?;
            println!("C program: {text} bytes of text, {ram} of static RAM");
        }
        Ok(())
    }

    fn must_not_link(&self) -> Result {
        let (_, output) = self.link(&["--features", "negative_control"])?;
        let message = String::from_utf8_lossy(&output.stderr);
        if output.status.success() || !message.contains(PANIC_SYMBOL) {
            return Err(format!("it must not link for want of {PANIC_SYMBOL}:\n{message}").into());
        }
        eprintln!("it does not link ({PANIC_SYMBOL})");
        Ok(())
    }

    /// Builds the library with these arguments and links the program with it.
    fn link(&self, arguments: &[&str]) -> Result<(PathBuf, Output)> {
        let mut library = cargo_in("build --release --locked");
        library.args(arguments);
        let mut built = build_dir();
        if let Some(target) = self.target {
            library.args(["--target", target]);
            built.push(target);
        }
        call(&mut library)?;
        let program = built.join("c.elf");
        let source = directory();
        let mut gcc = Command::new(self.gcc);
        gcc.args(FLAGS.split_whitespace()).args(self.flags.split_whitespace());
        gcc.arg("-I").arg(source.join("include"));
        gcc.args(["check.c", self.start].map(|file| source.join("c").join(file)));
        gcc.arg(built.join("release/libtruearm_capi.a"));
        if self.target.is_some() {
            gcc.arg("-L").arg(root()).arg("-T").arg(source.join("c/board.ld")).arg("-lgcc");
        }
        let output = gcc.arg("-o").arg(&program).output();
        Ok((program, output.map_err(|error| format!("{}: {error}", self.gcc))?))
    }

    fn run(&self, program: &Path, files: &Files) -> Result {
        let command = if self.target.is_some() {
            qemu_command(program, files)?
        } else {
            [program, &files.blob, &files.vectors].map(|path| path.display().to_string()).into()
        };
        let ended = qemu::run(&command, &firmware())?;
        if ended.success && ended.output.contains(GOOD) {
            Ok(())
        } else {
            Err("the C program found a fault".into())
        }
    }
}
