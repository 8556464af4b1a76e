use std::fs;
use std::path::Path;
use std::process::Command;

use rust_xlsxwriter::Workbook;
use tempfile::TempDir;

use super::generated::hold;
use super::{blocks, pages, root};

/// What cargo would build and run is built already.
const CARGO: &str = "cargo() { [ \"$1 $2 $3 $4 $5\" = 'run --release -p truearm-host --' ] \
                     || { echo \"not a command of this test: cargo $*\"; return 1; }; \
                     shift 5; truearm \"$@\"; }\n";

/// Runs the commands of a page, each block in the folder that the one before left, and holds
/// what stands below against what they print: the folder, and all that was printed.
fn run(name: &str, text: &str) -> (TempDir, String) {
    let folder = stage();
    let all = blocks(text);
    let mut printed = String::new();
    for (k, (info, script)) in all.iter().enumerate() {
        match *info {
            "sh" => {}
            "sh ignore" => {
                let ours = script.lines().find(|line| line.starts_with("truearm "));
                assert!(ours.is_none(), "{name}: {ours:?} would not be run");
                continue;
            }
            _ => continue,
        }
        let said = shell(&folder, &format!("{CARGO}set -e\n{script}"))
            .unwrap_or_else(|said| panic!("{name}:\n{script}\n{said}"));
        if let Some(("text", below)) = all.get(k + 1) {
            prints(name, &said, below);
        }
        printed += &said;
    }
    assert!(!printed.is_empty(), "{name}: no block that runs");
    (folder, printed)
}

/// That what stands below a command was printed; `...` is what was left out.
fn prints(name: &str, said: &str, below: &str) {
    let flat = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = flat(said);
    let mut rest = said.as_str();
    for part in below.split("...").map(flat) {
        let Some((_, after)) = rest.split_once(part.as_str()) else {
            panic!("{name} shows:\n{part}\nsaid was:\n{said}");
        };
        rest = after;
    }
}

/// Standard output, or all that was said where a line failed.
fn shell(folder: &TempDir, script: &str) -> Result<String, String> {
    let program = Path::new(env!("CARGO_BIN_EXE_truearm")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("sh");
    let ran = command.current_dir(folder).args(["-c", script]).env("PATH", path).output().unwrap();
    let [out, err] = [ran.stdout, ran.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    if ran.status.success() { Ok(out) } else { Err(format!("{}\n{out}{err}", ran.status)) }
}

/// A folder with what the repository has and a user would: an arm as URDF and table, joints
/// and points apart, other measurements, what was flashed before, a path.
fn stage() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("host-tools")).unwrap();
    for name in ["tests", "memory.x", "host-tools/examples"] {
        std::os::unix::fs::symlink(root().join(name), folder.path().join(name)).unwrap();
    }
    shell(&folder, USERS).unwrap_or_else(|said| panic!("{said}"));
    tracker(&folder.path().join("tracker.csv"), &folder.path().join("tracker.xlsx"));
    folder
}

const USERS: &str = r#"set -e
rows=tests/data/seed-table-8/measurements.csv
truearm identify tests/data/seed-table-8/robot.toml $rows --out was
truearm pack was/model.toml --out old.bin
truearm export was/model.toml --urdf made.urdf --dh table.csv
sed 's/"target"/"tool0"/' made.urdf > arm.urdf
cut -d, -f1-6 $rows > joints.csv
cut -d, -f7-9 $rows > tracker.csv
head -n 6 joints.csv > path.csv
# A hundredth of a micrometre off: measured again, and not the rows that are fitted.
sed '2,$s/$/00001/' $rows > check.csv
cp check.csv other.csv
printf 'x_mm,y_mm,z_mm\n-400,-200,300\n' > poses.csv
rm -r was made.urdf
"#;

/// A table as a tracker's program saves it.
fn tracker(table: &Path, path: &Path) {
    let mut book = Workbook::new();
    let sheet = book.add_worksheet();
    for (row, line) in fs::read_to_string(table).unwrap().lines().enumerate() {
        for (column, cell) in line.split(',').enumerate() {
            let (row, column) = (row as u32, column as u16);
            match cell.parse::<f64>() {
                Ok(number) => sheet.write_number(row, column, number).unwrap(),
                Err(_) => sheet.write_string(row, column, cell).unwrap(),
            };
        }
    }
    book.save(path).unwrap();
}

#[test]
fn commands_run_and_print_what_stands_below_them() {
    let all = pages();
    let with = all.iter().filter(|(_, text)| blocks(text).iter().any(|(info, _)| *info == "sh"));
    std::thread::scope(|scope| {
        let started: Vec<_> = with
            .map(|(page, text)| scope.spawn(|| run(&page.display().to_string(), text)))
            .collect();
        assert!(started.len() >= 4, "{} pages have commands", started.len());
    });
}

/// One for every kind, which runs the kind's example.
#[test]
fn every_kind_of_measurement_has_a_page() {
    for kind in truearm_host::observations::KINDS {
        let page = root().join(format!("docs/instruments/{}.md", kind.name()));
        let text = fs::read_to_string(&page).unwrap_or_default();
        assert!(text.starts_with("# ") && text.contains(&format!("(`{}`)", kind.name())));
        assert!(blocks(&text).iter().any(|(info, _)| *info == "sh"), "{}", page.display());
    }
}

/// So do those of the README, whose picture is one that they make, and whose report the
/// book explains.
#[test]
fn the_readme_shows_what_its_commands_make() {
    let (folder, printed) =
        run("README.md", &fs::read_to_string(root().join("README.md")).unwrap());
    let picture = fs::read_to_string(folder.path().join("out/ur10/staircase.svg")).unwrap();
    hold(&root().join("docs/staircase.svg"), &picture);
    let page = root().join("docs/reading.md");
    for (_, shown) in blocks(&fs::read_to_string(&page).unwrap()) {
        prints("docs/reading.md", &printed, shown);
    }
}
