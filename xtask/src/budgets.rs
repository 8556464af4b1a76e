//! `cargo xtask budgets`: what the images cost, held against
//! `tests/firmware/budgets.toml`.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::{fs, iter};

use object::{Object, ObjectSection, ObjectSymbol, SectionKind};

use crate::image::{
    CURVES, build_for, build_in, command_of, dir_of, directory, image, image_in, read_toml,
};
use crate::qemu;
use crate::run::{Result, call};
use crate::tools::TARGET;
use crate::vectors::{shipped, shipped_terms};

/// What is budgeted, and its unit.
const TABLES: [(&str, &str); 4] =
    [("instructions", "instructions"), ("text", "bytes"), ("stack", "bytes"), ("ram", "bytes")];

/// Parts of names by which a heap is known.
const HEAP: [&str; 6] = ["__rust_alloc", "__rg_alloc", "__rdl_alloc", "malloc", "_sbrk", "realloc"];

/// Runs the lean controller with and without terms: its stack and its sizes,
/// as lines `TABLE NAME VALUE`. Fails where a heap is linked.
pub fn controller() -> Result<String> {
    let mut output = String::new();
    for files in [shipped(), shipped_terms()] {
        let ended = qemu::run(&command_of("controller", &files)?, &directory())?;
        if !ended.success {
            return Err("the controller did not run".into());
        }
        output += &ended.output;
    }
    let (_, ram) = sizes(&image("controller"), "Reset")?;
    writeln!(output, "ram controller {ram}")?;
    output += &texts()?;
    Ok(output)
}

/// What images take in flash, for speed and for size: the controller, and the least
/// that asks where the tool is. Each links without a panic.
fn texts() -> Result<String> {
    let mut output = String::new();
    for (level, name) in [("3", "fast"), ("s", "small")] {
        for binary in ["controller", "load"] {
            call(&mut build_for(TARGET, level, binary))?;
            let (text, _) = sizes(&image_in(&dir_of(level), binary), "Reset")?;
            writeln!(output, "text {binary}-{name} {text}")?;
        }
        // Elsewhere, so that no other step finds it in place of the plain one.
        let dir = dir_of("curves");
        let mut with_curves = build_in(&dir, "controller");
        with_curves.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", level).args(CURVES);
        call(with_curves.args(["--target", TARGET]))?;
        let (text, _) = sizes(&image_in(&dir, "controller"), "Reset")?;
        writeln!(output, "text controller-curves-{name} {text}")?;
    }
    Ok(output)
}

/// Bytes of an image in flash (code, constants, vectors, start values) and of
/// its static variables. `entry` is the symbol it must have: without symbols no
/// heap would be found.
pub fn sizes(path: &Path, entry: &str) -> Result<(u64, u64)> {
    let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let file = object::File::parse(&*bytes)?;
    let names: Vec<&str> = file.symbols().filter_map(|symbol| symbol.name().ok()).collect();
    if !names.contains(&entry) {
        return Err(format!("{}: no symbols to look for a heap in", path.display()).into());
    }
    if let Some(name) = names.iter().find(|name| HEAP.iter().any(|part| name.contains(part))) {
        return Err(format!("{}: a heap is linked: {name}", path.display()).into());
    }
    let (mut text, mut ram) = (0, 0);
    for section in file.sections() {
        use SectionKind::{Data, ReadOnlyData, ReadOnlyString, Text, UninitializedData};
        let kind = section.kind();
        if matches!(kind, Text | ReadOnlyData | ReadOnlyString | Data) {
            text += section.size();
        }
        if matches!(kind, Data | UninitializedData) {
            ram += section.size();
        }
    }
    Ok((text, ram))
}

/// Holds what was printed, as lines `TABLE NAME VALUE`, against the budgets.
pub fn check(output: &str) -> Result {
    let budgets = read_toml(&directory().join("budgets.toml"))?;
    let compiler = Command::new("rustc").arg("--version").current_dir(directory()).output()?;
    let compiler = String::from_utf8_lossy(&compiler.stdout).trim().to_owned();
    let judged = budgets.get("rustc").and_then(toml::Value::as_str) == Some(&compiler);
    let mut over = Vec::new();
    for (table, unit) in TABLES {
        let limits = budgets.get(table).and_then(toml::Value::as_table);
        let limits = limits.ok_or_else(|| format!("no [{table}] in budgets.toml"))?;
        for (name, limit) in limits {
            let limit = limit.as_integer().ok_or_else(|| format!("{name}: not an integer"))?;
            let value = value(output, table, name);
            let value = value.ok_or_else(|| format!("no image printed `{table} {name}`"))?;
            println!("{table:12} {name:22} {value:8} of {limit:6} {unit}");
            if value > limit as f64 {
                over.push(format!("{table} {name}"));
            }
        }
    }
    if !judged {
        eprintln!("not judged: the budgets are not for {compiler}");
    } else if !over.is_empty() {
        return Err(format!("over budget: {}", over.join(", ")).into());
    }
    Ok(())
}

/// From a line `TABLE NAME VALUE`.
fn value(output: &str, table: &str, name: &str) -> Option<f64> {
    output.lines().find_map(|line| {
        let mut words = line.split(' ');
        let found = iter::zip([table, name], words.by_ref()).all(|(a, b)| a == b);
        found.then(|| words.next()?.parse().ok()).flatten()
    })
}
