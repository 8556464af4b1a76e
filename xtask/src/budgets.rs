//! `cargo xtask budgets`: what the images cost, held against
//! `tests/firmware/budgets.toml`. Other costs are held against files of the same form.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::{fs, iter};

use object::{Object, ObjectSection, ObjectSymbol, SectionKind};

use crate::image::{
    CURVES, build_for, build_in, command_of, dir_of, directory, image, image_in, read_toml,
};
use crate::qemu;
use crate::run::{Result, call, root};
use crate::tools::TARGET;
use crate::vectors::{shipped, shipped_terms};

/// A file of budgets.
pub struct Budgets {
    /// Where it is in the repository.
    pub file: &'static str,
    /// What is budgeted, and its unit.
    pub tables: &'static [(&'static str, &'static str)],
}

/// Of the controller's images.
pub const IMAGES: Budgets = Budgets {
    file: "tests/firmware/budgets.toml",
    tables: &[
        ("instructions", "instructions"),
        ("text", "bytes"),
        ("stack", "bytes"),
        ("ram", "bytes"),
    ],
};

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

impl Budgets {
    /// Holds what was printed, as lines `TABLE NAME VALUE`, against the budgets.
    pub fn check(&self, output: &str) -> Result {
        let file = root().join(self.file);
        let budgets = read_toml(&file)?;
        // Where the file is: the firmware could ask for a compiler of its own.
        let directory = file.parent().ok_or("no directory")?;
        let compiler = Command::new("rustc").arg("--version").current_dir(directory).output()?;
        self.judge(output, &budgets, String::from_utf8_lossy(&compiler.stdout).trim())
    }

    fn judge(&self, output: &str, budgets: &toml::Table, compiler: &str) -> Result {
        let judged = budgets.get("rustc").and_then(toml::Value::as_str) == Some(compiler);
        let mut over = Vec::new();
        for (table, unit) in self.tables {
            let limits = budgets.get(*table).and_then(toml::Value::as_table);
            let limits = limits.ok_or_else(|| format!("no [{table}] in {}", self.file))?;
            for (name, limit) in limits {
                let limit = limit.as_integer().ok_or_else(|| format!("{name}: not an integer"))?;
                let value = value(output, table, name);
                let value = value.ok_or_else(|| format!("nothing printed `{table} {name}`"))?;
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
}

/// From a line `TABLE NAME VALUE`.
fn value(output: &str, table: &str, name: &str) -> Option<f64> {
    output.lines().find_map(|line| {
        let mut words = line.split(' ');
        let found = iter::zip([table, name], words.by_ref()).all(|(a, b)| a == b);
        found.then(|| words.next()?.parse().ok()).flatten()
    })
}

#[cfg(test)]
mod tests {
    use super::Budgets;

    /// What is said of `output` where `forward` may take ten instructions.
    fn said(output: &str, compiler: &str) -> String {
        let budgets = Budgets { file: "the file", tables: &[("instructions", "a pose")] };
        let file = "rustc = \"this one\"\n[instructions]\nforward = 10".parse().expect("TOML");
        let judged = budgets.judge(output, &file, compiler);
        judged.map_or_else(|error| error.to_string(), |()| "within".to_owned())
    }

    #[test]
    fn a_count_over_budget_fails_with_the_compiler_that_the_budget_is_for() {
        assert_eq!(said("instructions forward 10.0", "this one"), "within");
        let over = "instructions forward 10.1";
        assert_eq!(said(over, "this one"), "over budget: instructions forward");
        assert_eq!(said(over, "another"), "within");
    }

    #[test]
    fn a_budget_of_what_was_not_counted_fails() {
        let nothing = "nothing printed `instructions forward`";
        assert_eq!(said("instructions backward 1", "this one"), nothing);
        assert_eq!(said("", "another"), nothing);
    }
}
