use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{fields, root};

/// That a file is what it should be; writes it where that is asked for.
pub fn hold(path: &Path, expected: &str) {
    if std::env::var_os("UPDATE_PAGES").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, expected).unwrap();
    }
    let committed = fs::read_to_string(path).unwrap_or_default();
    assert!(
        committed.replace("\r\n", "\n") == expected,
        "{}: run UPDATE_PAGES=1 cargo test -p truearm-host --test book",
        path.display()
    );
}

fn names(folder: &Path) -> Vec<PathBuf> {
    let mut names: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into()).collect();
    names.sort();
    names
}

#[test]
fn a_page_for_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let mut man = Command::new(env!("CARGO_BIN_EXE_truearm"));
    let made = man.args(["man", "--markdown"]).arg(folder.path()).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let verbs = root().join("docs/verbs");
    let expected = names(folder.path());
    for name in &expected {
        hold(&verbs.join(name), &fs::read_to_string(folder.path().join(name)).unwrap());
    }
    assert_eq!(names(&verbs), expected, "a page of a verb that there is not");
}

#[test]
fn a_page_of_all_fields() {
    hold(&root().join("docs/schemas.md"), &fields::page());
}
