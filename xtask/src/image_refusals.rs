//! What the image must do when a slot or the vector file is not as it should be.

use std::fs;

use crate::image::{directory, loading};
use crate::run::{Result, root, target_dir};
use crate::{qemu, vectors};

/// Varies the command of a run that went well.
pub fn check(command: &[String]) -> Result {
    let [a, b] = [origin("PARAM_A")?, origin("PARAM_B")?];
    let blob = loader(command, &a)?;
    let file = command.iter().position(|word| word.contains(".vectors,addr="));
    let file = file.ok_or("the runner loads no vectors")?;

    let mut only_b = command.to_vec();
    only_b[blob] = only_b[blob].replace(&a, &b);
    expect(&only_b, true, &["slot A", "does not begin with TARM", "slot B", "a valid blob"])?;

    expect(&without(command, blob), false, &["no valid parameter blob in either slot"])?;
    expect(&without(command, file), false, &["no vector file"])?;

    // A comparison that cannot fail would prove nothing: one bit of the hash.
    let mut bytes = fs::read(vectors::shipped().vectors)?;
    *bytes.get_mut(16).ok_or("the shipped vector file is empty")? ^= 1;
    let path = target_dir().join("firmware/wrong.vectors");
    fs::write(&path, bytes)?;
    let mut wrong = command.to_vec();
    wrong[file] = loading(&wrong[file], &path);
    expect(&wrong, false, &["FAILED: the host computed"])
}

/// Where a region of memory.x begins, as written there.
fn origin(region: &str) -> Result<String> {
    let text = fs::read_to_string(root().join("memory.x"))?;
    let line = text.lines().find(|line| line.trim_start().starts_with(region));
    let origin = line.and_then(|line| line.split("ORIGIN =").nth(1)?.split(',').next());
    Ok(origin.ok_or_else(|| format!("memory.x has no {region}"))?.trim().to_owned())
}

/// Index of the word that loads something to this address.
fn loader(command: &[String], address: &str) -> Result<usize> {
    let found = command.iter().position(|word| word.contains(&format!("addr={address}")));
    found.ok_or_else(|| format!("the runner loads nothing to {address}, see memory.x").into())
}

/// The command without this word and the `-device` before it.
fn without(command: &[String], word: usize) -> Vec<String> {
    let rest = command.iter().enumerate().filter(|(i, _)| *i != word && i + 1 != word);
    rest.map(|(_, word)| word.clone()).collect()
}

fn expect(command: &[String], success: bool, words: &[&str]) -> Result {
    let ended = qemu::run(command, &directory())?;
    if ended.success != success {
        let should = if success { "run" } else { "refused" };
        return Err(format!("the image should have {should}").into());
    }
    match words.iter().find(|word| !ended.output.contains(**word)) {
        Some(word) => Err(format!("the image did not print `{word}`").into()),
        None => Ok(()),
    }
}
