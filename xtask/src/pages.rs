//! Every `report.html` opened in Chromium at the width of a telephone, of a desk
//! and of a wall: all marks of the data are in the document, nothing is wider than the
//! window, and the console has no other word.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::run::{Result, call, exists, program, root, step, target_dir};
use crate::tools;

const PROGRAMS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
const WIDTHS: [usize; 3] = [390, 1280, 2560];
/// Of Chromium's windows, in pixels.
const NARROWEST: usize = 500;
/// What counts, at the end of a copy of each page, and what it says of a sound one.
const COUNT: &str = include_str!("pages.js");
const SOUND: &str = "as in the data: ";

/// Verbs on the paper's points, with the page that each writes; and a diagnosis of a real
/// arm, which has curves and waves to show.
const LINES: [(&str, &str); 6] = [
    ("identify robot.toml measurements.csv --out identify", "identify/report.html"),
    ("diagnose robot.toml measurements.csv --out diagnose", "diagnose/report.html"),
    ("diagnose ur10/robot.toml ur10/measurements.csv --out ur10/out", "ur10/out/report.html"),
    ("compare robot.toml measurements.csv --out compare", "compare/report.html"),
    ("verify identify/model.toml commanded.csv --out verify", "verify/report.html"),
    (
        "plan robot.toml --poses 20 --limits -120:120,-120:120,-120:120,-120:120,-120:120,-120:120 \
         --out plan/poses.csv --html plan/report.html",
        "plan/report.html",
    ),
];

/// Of these pages, or of every verb's where none are given.
pub fn run(pages: &[PathBuf]) -> Result {
    let Some(browser) = found().or_else(installed) else {
        println!("no Chromium found ({}): pages were not opened", PROGRAMS.join(", "));
        return Ok(());
    };
    if !starts(browser)? {
        println!("{browser} does not start here: pages were not opened");
        return Ok(());
    }
    let made = if pages.is_empty() { step("pages of every verb", made)? } else { pages.to_vec() };
    made.iter().try_for_each(|page| {
        step(&page.display().to_string(), || {
            WIDTHS.iter().try_for_each(|width| open(browser, page, *width))
        })
    })
}

fn found() -> Option<&'static str> {
    PROGRAMS.into_iter().find(|program| exists(program))
}

fn installed() -> Option<&'static str> {
    let why = tools::ensure_program(PROGRAMS[0], PROGRAMS[0], "  a package of the system").err();
    why.iter().for_each(|why| println!("{why}"));
    found()
}

fn headless(browser: &str) -> Command {
    let mut command = Command::new(browser);
    command.args(["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]);
    // A container may have little shared memory.
    command.args(["--disable-dev-shm-usage", "--enable-logging=stderr"]);
    command
}

/// Whether a page's word reaches its console at all: not so in every container. A page of a
/// file, as those that are looked at: one of an address alone is not opened everywhere.
fn starts(browser: &str) -> Result<bool> {
    let page = target_dir().join("pages/word.html");
    std::fs::create_dir_all(target_dir().join("pages"))?;
    std::fs::write(&page, "<!doctype html><script>console.log('a word')</script>")?;
    let page = format!("file://{}", page.display());
    let output = headless(browser).args(["--dump-dom", &page]).output()?;
    Ok(String::from_utf8_lossy(&output.stderr).contains("a word"))
}

fn made() -> Result<Vec<PathBuf>> {
    let folder = target_dir().join("pages");
    let data = root().join("tests/data");
    for name in ["plan", "ur10"] {
        std::fs::create_dir_all(folder.join(name))?;
    }
    for (from, to) in [
        ("seed-table-8/robot.toml", "robot.toml"),
        ("seed-table-8/measurements.csv", "measurements.csv"),
        ("ur10-ipa/robot.toml", "ur10/robot.toml"),
        ("ur10-ipa/series-c/measurements.csv", "ur10/measurements.csv"),
    ] {
        std::fs::copy(data.join(from), folder.join(to))?;
    }
    // The same joints as commanded ones.
    let rows = std::fs::read_to_string(folder.join("measurements.csv"))?;
    let commanded = (1..=6).fold(rows, |t, j| t.replace(&format!("q{j}_"), &format!("cmd{j}_")));
    std::fs::write(folder.join("commanded.csv"), commanded)?;
    for (line, _) in LINES {
        call(program()?.current_dir(&folder).args(line.split_whitespace()))?;
    }
    Ok(LINES.iter().map(|(_, page)| folder.join(page)).collect())
}

/// What the page says on the console, and a picture of it beside it.
fn open(browser: &str, page: &Path, width: usize) -> Result {
    let page = std::fs::canonicalize(page)?;
    let picture = page.with_extension(format!("{width}.png"));
    let copy = page.with_extension("counted.html");
    let text = std::fs::read_to_string(&page)?;
    let script = format!("<script>\n{COUNT}</script></body>");
    std::fs::write(&copy, text.replacen("</body>", &script, 1))?;
    // No window of Chromium's is narrower than 500 px: as wide as asked for is a frame in it.
    let frame = page.with_extension("frame.html");
    let name = copy.file_name().unwrap_or_default().to_string_lossy();
    let style = format!("border: 0; width: {width}px; height: 5990px");
    let framed = format!("<iframe src=\"{name}\" style=\"{style}\"></iframe>");
    std::fs::write(&frame, format!("<!DOCTYPE html><style>body {{ margin: 0 }}</style>{framed}"))?;
    let window = width.max(NARROWEST);
    let output = headless(browser)
        .arg(format!("--window-size={window},6000"))
        .arg(format!("--screenshot={}", picture.display()))
        .arg(format!("file://{}", frame.display()))
        .output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = said.lines().filter(|line| line.contains("CONSOLE")).collect();
    let [line] = lines[..] else {
        return Err(format!("{} at {width}: {}", page.display(), lines.join("\n")).into());
    };
    let Some((_, counted)) = line.split_once(SOUND) else {
        return Err(format!("{} at {width}: {line}", page.display()).into());
    };
    if !picture.is_file() {
        return Err(format!("no picture of {}", page.display()).into());
    }
    let counted = counted.split('"').next().unwrap_or(counted);
    println!("{width} px: {counted}: {}", picture.display());
    Ok(())
}
