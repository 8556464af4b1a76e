//! The book: its pages are listed, their links lead somewhere, what is generated
//! is current, and their commands run and print what stands below them.
//!
//! To write the generated pages anew: `UPDATE_PAGES=1 cargo test -p truearm-host --test book`

#![cfg(unix)]

mod commands;
mod fields;
mod generated;
mod links;
mod readme;

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// Path and text of every page, with the pages that it includes.
fn pages() -> Vec<(PathBuf, String)> {
    let docs = root().join("docs");
    let folders = [docs.clone(), docs.join("instruments"), docs.join("verbs")];
    let entries = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "md"));
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), with_included(&path))).collect()
}

fn with_included(page: &Path) -> String {
    let text = fs::read_to_string(page).unwrap();
    let line = |line: &str| match line.strip_prefix("{{#include ") {
        Some(rest) => {
            let path = page.with_file_name(rest.trim_end_matches("}}"));
            fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
        }
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// What is fenced, with the words behind the fence.
fn blocks(text: &str) -> Vec<(&str, &str)> {
    let mut rest = text;
    let mut found = Vec::new();
    while let Some((_, after)) = rest.split_once("\n```") {
        let (info, after) = after.split_once('\n').unwrap();
        let (body, after) = after.split_once("```").unwrap();
        found.push((info, body));
        rest = after;
    }
    found
}
