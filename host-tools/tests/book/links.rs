use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::{pages, root};

/// Where the links of a page lead, out of code.
fn links(text: &str) -> Vec<String> {
    let fenced = text.split("```").step_by(2);
    let prose: String = fenced.flat_map(|part| part.split('`').step_by(2)).collect();
    let ends = prose.split("](").skip(1);
    ends.map(|rest| rest.split(')').next().unwrap().to_owned()).collect()
}

/// What a heading is called in an address.
fn slug(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.collect::<String>().replace(' ', "-")
}

fn headings(text: &str) -> HashSet<String> {
    let prose = text.split("\n```").step_by(2).flat_map(str::lines);
    prose.filter(|l| l.starts_with('#')).map(|l| slug(l.trim_start_matches('#'))).collect()
}

/// Nothing where it leads to a file and a heading that are there.
fn broken(page: &Path, text: &str, link: &str) -> Option<String> {
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let target = if file.is_empty() { page.to_owned() } else { page.with_file_name(file) };
    let shown = page.strip_prefix(root()).unwrap().display();
    if !target.exists() {
        return Some(format!("{shown}: {link} is not there"));
    }
    let there = if file.is_empty() { text.to_owned() } else { super::with_included(&target) };
    let known = anchor.is_empty() || headings(&there).contains(anchor);
    (!known).then(|| format!("{shown}: {link}: no such heading"))
}

#[test]
fn every_link_leads_somewhere() {
    let readme = root().join("README.md");
    let text = fs::read_to_string(&readme).unwrap();
    let mut wrong = Vec::new();
    let mut seen = 0;
    for (page, text) in pages().into_iter().chain([(readme, text)]) {
        for link in links(&text).iter().filter(|link| !link.contains("://")) {
            wrong.extend(broken(&page, &text, link));
            seen += 1;
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(seen > 80, "{seen} links seen");
}

/// In the book there is nothing beside its own folder.
#[test]
fn no_page_links_out_of_the_book() {
    let docs = root().join("docs");
    for (page, text) in pages() {
        for link in links(&text).iter().filter(|link| !link.contains("://")) {
            let target = page.with_file_name(link.split('#').next().unwrap());
            let target = target.canonicalize().unwrap_or(target);
            assert!(
                target.starts_with(&docs),
                "{}: {link}: name the file as code instead",
                page.display()
            );
        }
    }
}

#[test]
fn every_page_is_listed() {
    let summary = root().join("docs/SUMMARY.md");
    let listed = links(&fs::read_to_string(&summary).unwrap());
    let listed: HashSet<PathBuf> = listed.iter().map(|link| summary.with_file_name(link)).collect();
    for (page, _) in pages().iter().filter(|(page, _)| *page != summary) {
        assert!(listed.contains(page), "{} is not in SUMMARY.md", page.display());
    }
    assert_eq!(listed.len() + 1, pages().len(), "a page is listed twice");
}
