//! Sessions as they happen: how far can a stated probability be trusted, from
//! which size on is an effect named, and how near is the model to what is
//! attainable?

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use truearm_host::diagnose::{Doubt, Verdict};

use super::Result;
use crate::dirty::score::{Claimed, Judged, Place, Truth, Worth, judged};
use crate::dirty::set::DirtySet;

#[derive(Args)]
pub struct Options {
    /// Sets with effects
    #[arg(long, default_value_t = 1000)]
    sets: u64,
    /// Sets without
    #[arg(long, default_value_t = 400)]
    clean: u64,
    /// Another seed, other sets
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only this set
    #[arg(long)]
    only: Option<u64>,
    /// Folder for that set's files
    #[arg(long, requires = "only")]
    out: Option<PathBuf>,
    /// Folder for claims.csv and effects.csv of all sets
    #[arg(long)]
    tables: Option<PathBuf>,
}

/// Seeds of one study.
const A_STUDY: u64 = 10_000_000;
/// Where those of clean sets begin.
const CLEAN: u64 = 5_000_000;
/// Borders of the bins of stated probability.
const BINS: [f64; 8] = [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.000_001];
/// Borders of the bins of size, in noise floors.
const SIZES: [f64; 8] = [0.0, 0.1, 0.2, 0.4, 0.8, 1.5, 3.0, f64::INFINITY];

pub fn run(options: &Options) -> Result {
    let first = options.seed * A_STUDY;
    let mut seeds: Vec<(u64, bool)> = (0..options.sets).map(|i| (first + i, false)).collect();
    seeds.extend((0..options.clean).map(|i| (first + CLEAN + i, true)));
    if let Some(seed) = options.only {
        let clean = seed % A_STUDY >= CLEAN;
        seeds = vec![(seed, clean)];
        if let Some(folder) = &options.out {
            DirtySet::draw(seed, clean).write(folder)?;
        }
    }
    let style = "{bar:40} {pos}/{len}  {elapsed_precise}, {eta} left";
    let bar = ProgressBar::new(seeds.len() as u64).with_style(ProgressStyle::with_template(style)?);
    let answers: Vec<_> = seeds
        .par_iter()
        .map(|(seed, clean)| {
            let answer = judged(&DirtySet::draw(*seed, *clean));
            bar.inc(1);
            answer.map(|judged| (judged, *clean))
        })
        .collect();
    bar.finish_and_clear();
    let refused: Vec<_> = answers.iter().filter_map(|a| a.as_ref().err()).collect();
    refused.iter().for_each(|error| println!("refused: {error}"));
    let judged = |which: bool| -> Vec<&Judged> {
        answers.iter().flatten().filter(|(_, clean)| *clean == which).map(|(j, _)| j).collect()
    };
    if options.only.is_some() {
        answers.iter().flatten().for_each(|(judged, _)| println!("{judged:#?}"));
        return Ok(());
    }
    if let Some(folder) = &options.tables {
        let all: Vec<&Judged> = answers.iter().flatten().map(|(j, _)| j).collect();
        tables(folder, &all)?;
    }
    println!("{} sets, {} refused", seeds.len(), refused.len());
    calibration(&judged(false));
    doubted(&judged(false));
    found(&judged(false));
    springs(&judged(false));
    attained(&judged(false));
    clean(&judged(true));
    verdicts(&judged(false));
    listed("false names", &false_names(&judged(false)));
    listed("not named though above 1.5 floors", &missed(&judged(false)));
    Ok(())
}

fn claims<'j>(sets: &[&'j Judged]) -> Vec<&'j Claimed> {
    sets.iter().flat_map(|j| &j.claims).filter(|c| c.worth != Worth::OfACurve).collect()
}

fn calibration(sets: &[&Judged]) {
    let claims = claims(sets);
    println!("\n| stated probability | claims | mean stated | true | named | of them true |");
    println!("|---|---|---|---|---|---|");
    let mut error = 0.0;
    for bin in BINS.windows(2) {
        let own: Vec<_> =
            claims.iter().filter(|c| (bin[0]..bin[1]).contains(&c.probability)).collect();
        if own.is_empty() {
            continue;
        }
        let n = own.len() as f64;
        let stated = own.iter().map(|c| c.probability).sum::<f64>() / n;
        let right = own.iter().filter(|c| c.worth == Worth::True).count() as f64 / n;
        error += n * (stated - right).abs() / claims.len() as f64;
        let named: Vec<_> = own.iter().filter(|c| c.named).collect();
        let named_right = named.iter().filter(|c| c.worth == Worth::True).count();
        println!(
            "| {:.2} to {:.2} | {} | {stated:.3} | {right:.3} | {} | {named_right} |",
            bin[0],
            bin[1].min(1.0),
            own.len(),
            named.len()
        );
    }
    let curves = sets.iter().flat_map(|j| &j.claims).filter(|c| c.worth == Worth::OfACurve);
    println!("expected calibration error {error:.4}; {} claims on curves left out", curves.count());
}

/// What claims of 0.5 and more are worth against which something speaks.
fn doubted(sets: &[&Judged]) {
    let claims = claims(sets);
    println!();
    for doubt in [Doubt::Halves, Doubt::Memory, Doubt::Levels] {
        let own = claims.iter().filter(|c| c.doubt == Some(doubt) && c.probability >= 0.5);
        let own: Vec<_> = own.collect();
        let right = own.iter().filter(|c| c.worth == Worth::True).count();
        println!("doubted ({}): {} claims, {right} true", doubt.words(), own.len());
    }
}

fn found(sets: &[&Judged]) {
    println!("\n| size in noise floors | effects | named | named or told |");
    println!("|---|---|---|---|");
    let truths: Vec<_> = sets.iter().flat_map(|j| &j.truths).collect();
    for bin in SIZES.windows(2) {
        let own: Vec<_> = truths.iter().filter(|t| (bin[0]..bin[1]).contains(&t.floors)).collect();
        if own.is_empty() {
            continue;
        }
        let share =
            |good: usize| format!("{good} ({:.1} %)", 100.0 * good as f64 / own.len() as f64);
        println!(
            "| {} to {} | {} | {} | {} |",
            bin[0],
            bin[1],
            own.len(),
            share(own.iter().filter(|t| t.named).count()),
            share(own.iter().filter(|t| t.named || t.told).count())
        );
    }
}

/// Whether the standard deviations of springs that are named are what they say.
fn springs(sets: &[&Judged]) {
    println!();
    for (what, unlisted) in [("without", false), ("with", true)] {
        let own = sets.iter().filter(|j| j.unlisted.is_some() == unlisted);
        let off: Vec<f64> = own.flat_map(|j| &j.truths).filter_map(|t| t.off).collect();
        let within = |most: f64| off.iter().filter(|z| z.abs() < most).count();
        println!(
            "{} springs named in sets {what} an unlisted effect: {} within 1.96 stated standard \
             deviations, {} within 4",
            off.len(),
            within(1.96),
            within(4.0)
        );
    }
}

fn attained(sets: &[&Judged]) {
    let mut ratios: Vec<f64> = sets.iter().filter_map(|j| j.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    if let Some(last) = ratios.last() {
        let at = |share: f64| ratios[((ratios.len() - 1) as f64 * share) as usize];
        println!(
            "\nhold-out RMS over attainable, {} sets: median {:.3}, nine tenths below {:.3}, worst {last:.3}",
            ratios.len(),
            at(0.5),
            at(0.9)
        );
        let far = sets.iter().filter(|j| j.ratio.is_some_and(|ratio| ratio > 1.15));
        let far: Vec<_> = far.map(|j| (j.seed, j.ratio.unwrap_or_default())).collect();
        println!("above 1.15: {far:.2?}");
    }
    let mut scales: Vec<f64> = sets.iter().map(|j| j.scale).collect();
    scales.sort_by(f64::total_cmp);
    if !scales.is_empty() {
        let at = |share: f64| scales[((scales.len() - 1) as f64 * share) as usize];
        println!(
            "noise scale over the true one: a tenth below {:.3}, median {:.3}, nine tenths below {:.3}",
            at(0.1),
            at(0.5),
            at(0.9)
        );
    }
}

fn clean(sets: &[&Judged]) {
    let named = sets.iter().filter(|j| j.claims.iter().any(|c| c.named)).count();
    let verdict = sets.iter().filter(|j| j.verdict == Verdict::Clean).count();
    println!("\n{} clean arms: {named} with a name, {verdict} called clean", sets.len());
    for j in sets.iter().filter(|j| j.claims.iter().any(|c| c.named)) {
        println!("  {} ({} rows): {:?}", j.seed, j.rows, j.claims);
    }
}

fn verdicts(sets: &[&Judged]) {
    for (what, unlisted) in [("without", false), ("with", true)] {
        let own: Vec<_> = sets.iter().filter(|j| j.unlisted.is_some() == unlisted).collect();
        let count = |v: Verdict| own.iter().filter(|j| j.verdict == v).count();
        println!(
            "{} sets {what} an unlisted effect: clean {}, explained {}, unexplained {}",
            own.len(),
            count(Verdict::Clean),
            count(Verdict::Explained),
            count(Verdict::Unexplained)
        );
    }
}

/// Every claim and every hidden effect, one a line.
fn tables(folder: &Path, sets: &[&Judged]) -> io::Result<()> {
    let place = |(name, joints): &Place| {
        let joints: Vec<String> = joints.iter().map(usize::to_string).collect();
        format!("{name},{}", joints.join(" "))
    };
    let mut claims = "seed,rows,unlisted,name,joints,probability,named,doubt,worth\n".to_owned();
    let mut effects = "seed,rows,unlisted,name,joints,floors,named,told\n".to_owned();
    for j in sets {
        let set = format!("{},{},{}", j.seed, j.rows, j.unlisted.unwrap_or_default());
        for Claimed { place: at, probability, named, doubt, worth } in &j.claims {
            let doubt = doubt.map_or("", Doubt::words);
            claims += &format!("{set},{},{probability:.6},{named},{doubt},{worth:?}\n", place(at));
        }
        for Truth { place: at, floors, named, told, .. } in &j.truths {
            effects += &format!("{set},{},{floors:.4},{named},{told}\n", place(at));
        }
    }
    fs::create_dir_all(folder)?;
    fs::write(folder.join("claims.csv"), claims)?;
    fs::write(folder.join("effects.csv"), effects)
}

/// Names with the seeds of their sets.
fn false_names<'j>(sets: &[&'j Judged]) -> Vec<(&'j str, u64)> {
    let wrong = |c: &&Claimed| c.named && c.worth == Worth::False;
    let of = |j: &&'j Judged| j.claims.iter().filter(wrong).map(|c| (c.place.0.as_str(), j.seed));
    sets.iter().flat_map(of).collect()
}

fn missed<'j>(sets: &[&'j Judged]) -> Vec<(&'j str, u64)> {
    let lost = |t: &&Truth| !t.named && t.floors >= 1.5;
    let of = |j: &&'j Judged| j.truths.iter().filter(lost).map(|t| (t.place.0.as_str(), j.seed));
    sets.iter().flat_map(of).collect()
}

/// Most frequent first.
fn listed(what: &str, found: &[(&str, u64)]) {
    let mut names: BTreeMap<&str, Vec<u64>> = BTreeMap::new();
    for (name, seed) in found {
        names.entry(name).or_default().push(*seed);
    }
    let mut names: Vec<_> = names.into_iter().collect();
    names.sort_by_key(|(_, seeds)| std::cmp::Reverse(seeds.len()));
    println!("\n{what} (cargo xtask study dirty --only SEED):");
    for (name, seeds) in names {
        println!("  {name}: {}, in {:?}", seeds.len(), &seeds[..seeds.len().min(6)]);
    }
}
