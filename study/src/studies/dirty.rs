//! Sessions as they happen: how far can a stated probability be trusted, from
//! which size on is an effect named, and how near is the model to what is
//! attainable?

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use truearm_host::diagnose::{Doubt, Verdict};

use super::Result;
use crate::dirty::reliability::{Bin, bins, expected_error};
use crate::dirty::score::{Claimed, Judged, Truth, Worth, claims, judged};
use crate::dirty::set::{DirtySet, Sort};
use crate::dirty::tables::tables;

#[derive(Args)]
pub struct Options {
    /// Sets with effects
    #[arg(long, default_value_t = 1000)]
    sets: u64,
    /// Sets without
    #[arg(long, default_value_t = 400)]
    clean: u64,
    /// Another seed, other sets; of several, all sets so far are judged after each
    #[arg(long, default_value = "1", value_delimiter = ',')]
    seed: Vec<u64>,
    /// Only this set
    #[arg(long)]
    only: Option<u64>,
    /// Folder for that set's files
    #[arg(long, requires = "only")]
    out: Option<PathBuf>,
    /// Folder for claims.csv, effects.csv and reliability.svg of all sets
    #[arg(long)]
    tables: Option<PathBuf>,
}

/// Seeds of one study.
const A_STUDY: u64 = 10_000_000;
/// Where those of clean sets begin.
const CLEAN: u64 = 5_000_000;
/// Borders of the bins of size, in noise floors.
const SIZES: [f64; 8] = [0.0, 0.1, 0.2, 0.4, 0.8, 1.5, 3.0, f64::INFINITY];

pub fn run(options: &Options) -> Result {
    if let Some(seed) = options.only {
        let set = DirtySet::draw(seed, sort(seed));
        if let Some(folder) = &options.out {
            set.write(folder)?;
        }
        println!("{:#?}", judged(&set)?);
        return Ok(());
    }
    let mut all = Vec::new();
    for seed in &options.seed {
        let first = seed * A_STUDY;
        let dirty = first..first + options.sets;
        let clean = first + CLEAN..first + CLEAN + options.clean;
        all.extend(answers(&dirty.chain(clean).collect::<Vec<_>>())?);
        println!("\n{} sets, {} refused", all.len(), all.iter().filter(|a| a.is_err()).count());
        all.iter().filter_map(|a| a.as_ref().err()).for_each(|e| println!("refused: {e}"));
        let (clean, dirty): (Vec<&Judged>, Vec<_>) =
            all.iter().flatten().partition(|judged| is_clean(judged.seed));
        if let Some(folder) = &options.tables {
            tables(folder, &dirty, &clean)?;
        }
        printed(&dirty, &clean);
    }
    Ok(())
}

fn sort(seed: u64) -> Sort {
    if is_clean(seed) { Sort::Clean } else { Sort::Session }
}

fn is_clean(seed: u64) -> bool {
    seed % A_STUDY >= CLEAN
}

type Answer = std::result::Result<Judged, String>;

fn answers(seeds: &[u64]) -> Result<Vec<Answer>> {
    let style = "{bar:40} {pos}/{len}  {elapsed_precise}, {eta} left";
    let bar = ProgressBar::new(seeds.len() as u64).with_style(ProgressStyle::with_template(style)?);
    let answer = |seed: &u64| {
        let answer = judged(&DirtySet::draw(*seed, sort(*seed)));
        bar.inc(1);
        answer
    };
    let answers = seeds.par_iter().map(answer).collect();
    bar.finish_and_clear();
    Ok(answers)
}

fn printed(dirty: &[&Judged], without_effects: &[&Judged]) {
    calibration(dirty);
    surest(dirty);
    doubted(dirty);
    found("hidden", dirty, |_| true);
    found("that can be told", dirty, Truth::can_be_told);
    springs(dirty);
    attained(dirty);
    clean(without_effects);
    verdicts(dirty);
    listed("false names", &false_names(dirty, false));
    listed("false names that nobody could tell from what is there", &false_names(dirty, true));
    listed("not named though above 1.5 floors", &missed(dirty, |t| t.floors >= 1.5));
    let lost = |t: &Truth| t.floors >= 1.5 && t.can_be_told();
    listed("of these, what could be told", &missed(dirty, lost));
}

fn calibration(sets: &[&Judged]) {
    println!(
        "\n| stated probability | claims | mean stated | true | named | of them true | false and alike |"
    );
    println!("|---|---|---|---|---|---|---|");
    let bins = bins(&claims(sets));
    for bin in &bins {
        let Bin { range: [low, high], claims, stated, named: [named, right, alike], .. } = bin;
        println!(
            "| {low:.2} to {high:.2} | {claims} | {stated:.3} | {:.3} | {named} | {right} | {alike} |",
            bin.share()
        );
    }
    let curves = sets.iter().flat_map(|j| &j.claims).filter(|c| c.worth == Worth::OfACurve);
    let error = expected_error(&bins);
    println!("expected calibration error {error:.4}; {} claims on curves left out", curves.count());
}

/// Names of 0.99 and more where everything hidden has a name, and where not.
fn surest(sets: &[&Judged]) {
    for (what, unlisted) in [("without", false), ("with", true)] {
        let own: Vec<_> =
            sets.iter().filter(|j| j.unlisted.is_some() == unlisted).copied().collect();
        let claims = claims(&own);
        let named: Vec<_> = claims.iter().filter(|c| c.named && c.probability >= 0.99).collect();
        let right = named.iter().filter(|c| c.worth == Worth::True).count();
        println!(
            "names above 0.99 in sets {what} an unlisted effect: {right} of {} true",
            named.len()
        );
    }
}

/// What claims of 0.5 and more are worth against which something speaks.
fn doubted(sets: &[&Judged]) {
    let claims = claims(sets);
    println!();
    for doubt in [
        Doubt::Halves,
        Doubt::Memory,
        Doubt::Levels,
        Doubt::Unweighed,
        Doubt::Knee,
        Doubt::HeldOut,
        Doubt::Waves,
    ] {
        let own = claims.iter().filter(|c| c.doubt == Some(doubt) && c.probability >= 0.5);
        let own: Vec<_> = own.collect();
        let right = own.iter().filter(|c| c.worth == Worth::True).count();
        println!("doubted ({}): {} claims, {right} true", doubt.words(), own.len());
    }
}

fn found(which: &str, sets: &[&Judged], counts: impl Fn(&Truth) -> bool) {
    println!("\n| size in noise floors | effects {which} | named | named or told |");
    println!("|---|---|---|---|");
    let truths: Vec<_> = sets.iter().flat_map(|j| &j.truths).filter(|t| counts(t)).collect();
    let row = |low: f64, high: f64| {
        let own: Vec<_> = truths.iter().filter(|t| (low..high).contains(&t.floors)).collect();
        let share = |good: usize| {
            format!("{good} ({:.1} %)", 100.0 * good as f64 / own.len().max(1) as f64)
        };
        let named = share(own.iter().filter(|t| t.named).count());
        let told = share(own.iter().filter(|t| t.named || t.told).count());
        println!("| {low} to {high} | {} | {named} | {told} |", own.len());
    };
    SIZES.windows(2).for_each(|bin| row(bin[0], bin[1]));
    [0.8, 1.5].into_iter().for_each(|from| row(from, f64::INFINITY));
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

/// Names with the seeds of their sets.
fn false_names<'j>(sets: &[&'j Judged], alike: bool) -> Vec<(&'j str, u64)> {
    let wrong = |c: &&Claimed| c.named && c.worth == Worth::False && c.alike == alike;
    let of = |j: &&'j Judged| j.claims.iter().filter(wrong).map(|c| (c.place.0.as_str(), j.seed));
    sets.iter().flat_map(of).collect()
}

fn missed<'j>(sets: &[&'j Judged], counts: impl Fn(&Truth) -> bool) -> Vec<(&'j str, u64)> {
    let lost = sets.iter().flat_map(|j| j.truths.iter().map(move |t| (j.seed, t)));
    let lost = lost.filter(|(_, t)| !t.named && counts(t));
    lost.map(|(seed, t)| (t.place.0.as_str(), seed)).collect()
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
