//! Every `report.html` opened in Chromium at the width of a telephone, of a desk
//! and of a wall: no word on the console.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::run::{Result, call, exists, program, root, step, target_dir};

const PROGRAMS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
const WIDTHS: [usize; 3] = [390, 1280, 2560];

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
    let Some(browser) = PROGRAMS.into_iter().find(|program| exists(program)) else {
        println!("no Chromium found ({}): pages were not opened", PROGRAMS.join(", "));
        return Ok(());
    };
    let made = if pages.is_empty() { step("pages of every verb", made)? } else { pages.to_vec() };
    made.iter().try_for_each(|page| {
        step(&page.display().to_string(), || {
            WIDTHS.iter().try_for_each(|width| open(browser, page, *width))
        })
    })
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
    let output = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
        .arg("--enable-logging=stderr")
        .arg(format!("--window-size={width},6000"))
        .arg(format!("--screenshot={}", picture.display()))
        .arg(format!("file://{}", page.display()))
        .output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    match said.lines().find(|line| line.contains("CONSOLE")) {
        Some(line) => Err(format!("{} at {width}: {line}", page.display()).into()),
        None if !picture.is_file() => Err(format!("no picture of {}", page.display()).into()),
        None => {
            println!("{width} px: {}", picture.display());
            Ok(())
        }
    }
}
