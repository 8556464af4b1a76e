//! README and the pages beside it say everything once, and name every room of the house.

use std::path::Path;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

#[test]
fn nothing_stands_there_twice() {
    let pages = ["files", "identification", "effects", "methods", "map", "first-arm"];
    let pages = pages.map(|page| format!("docs/{page}.md"));
    for name in
        ["README.md", "src/README.md", "CHANGELOG.md"].map(str::to_owned).iter().chain(&pages)
    {
        let text = std::fs::read_to_string(root().join(name)).unwrap();
        let mut seen = std::collections::HashSet::new();
        for line in text.lines().filter(|line| line.len() > 30) {
            assert!(seen.insert(line), "{name} says twice: {line}");
        }
    }
}

#[test]
fn the_statuses_are_those_of_the_program() {
    let page = std::fs::read_to_string(root().join("docs/files.md")).unwrap();
    let table = page.split("| status | meaning |").nth(1).unwrap();
    let rows: Vec<&str> = table.lines().skip(2).take_while(|l| l.starts_with('|')).collect();
    let numbers: Vec<&str> = rows.iter().map(|row| row.split('|').nth(1).unwrap().trim()).collect();
    assert_eq!(numbers, ["0", "1", "2", "3", "4"]);
    let mut help = assert_cmd::Command::cargo_bin("truearm").unwrap();
    let help = String::from_utf8(help.arg("--help").output().unwrap().stdout).unwrap();
    let said = help.split("Exit status:").nth(1).unwrap();
    let words: String = said.split_whitespace().collect::<Vec<_>>().join(" ");
    for row in rows {
        let meaning = row.split('|').nth(2).unwrap().replace('`', "");
        for part in meaning.split("; ").flat_map(|part| part.split(": ").next()) {
            assert!(words.contains(part.trim()), "\"{part}\" is not in --help: {words}");
        }
    }
}

#[test]
fn every_room_is_named() {
    let map = std::fs::read_to_string(root().join("docs/map.md")).unwrap();
    for room in std::fs::read_dir(root().join("host-tools/src")).unwrap() {
        let room = room.unwrap();
        let name = room.file_name().into_string().unwrap();
        if room.path().is_dir() {
            assert!(
                map.contains(&format!("`{name}`")) || map.contains(&format!("/{name}`")),
                "{name}"
            );
        }
    }
}
