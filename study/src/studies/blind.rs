//! Hidden effects in simulated arms: singles, pairs, triples, clean arms, and
//! effects that no report can name.

use std::collections::BTreeMap;

use clap::Args;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm_host::diagnose::Verdict;

use super::Result;
use super::judged;
use crate::blind::score::{Places, Score};
use crate::blind::sets::{LISTED, UNLISTED, Wanted};

#[derive(Args)]
pub struct Options {
    /// Sets with one effect
    #[arg(long, default_value_t = 500)]
    singles: u64,
    /// With two
    #[arg(long, default_value_t = 150)]
    pairs: u64,
    /// With three
    #[arg(long, default_value_t = 50)]
    triples: u64,
    /// With none
    #[arg(long, default_value_t = 200)]
    clean: u64,
    /// With one that the repertoire does not have
    #[arg(long, default_value_t = 60)]
    unlisted: u64,
    /// Another seed, other sets
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only this set, by the seed that a list of misses gives
    #[arg(long)]
    only: Option<u64>,
}

/// Classes of sets; a set's seed tells its class.
const CLASSES: [&str; 5] = ["singles", "pairs", "triples", "clean", "unlisted"];
const A_CLASS: u64 = 1_000_000;
const A_STUDY: u64 = 10 * A_CLASS;

/// What is to be hidden in the set of a seed: single effects in turn, so that
/// each has as many sets; others at random.
fn wanted(seed: u64) -> (usize, Vec<Wanted>) {
    let class = ((seed % A_STUDY) / A_CLASS) as usize;
    let index = (seed % A_CLASS) as usize;
    let mut rng = ChaCha8Rng::seed_from_u64(!seed);
    let several = |count: usize, rng: &mut ChaCha8Rng| {
        let mut names: Vec<Wanted> = Vec::new();
        while names.len() < count {
            let name = LISTED[rng.random_range(0..LISTED.len())];
            if names.iter().all(|n| n.0 != name) {
                names.push((name, [2.0, 6.0]));
            }
        }
        names
    };
    let wanted = match class {
        0 => vec![(LISTED[index % LISTED.len()], [2.0, 10.0])],
        1 => several(2, &mut rng),
        2 => several(3, &mut rng),
        4 => vec![(UNLISTED[index % UNLISTED.len()], [2.0, 10.0])],
        _ => Vec::new(),
    };
    (class, wanted)
}

pub fn run(options: &Options) -> Result {
    let o = options;
    let counts = [o.singles, o.pairs, o.triples, o.clean, o.unlisted];
    let seeds: Vec<u64> = match o.only {
        Some(seed) => vec![seed],
        None => {
            let of = |(class, count): (u64, u64)| {
                (0..count).map(move |i| o.seed * A_STUDY + class * A_CLASS + i)
            };
            (0..5).zip(counts).flat_map(of).collect()
        }
    };
    let plans: Vec<_> = seeds.iter().map(|seed| (*seed, wanted(*seed).1)).collect();
    let scores = judged(&plans)?;
    let class = |k: usize| scores.iter().filter(|s| wanted(s.seed).0 == k).collect::<Vec<_>>();

    let mut by_name: BTreeMap<String, Vec<&Score>> = BTreeMap::new();
    for score in class(0) {
        let name = score.truth.iter().next().map_or(String::new(), |p| p.0.clone());
        by_name.entry(name).or_default().push(score);
    }
    println!(
        "| hidden | sets | names | joints | verdict | extra names | RMS / attainable: median, worst |"
    );
    println!("|---|---|---|---|---|---|---|");
    by_name.iter().for_each(|(name, scores)| row(name, scores));
    (0..5).for_each(|k| row(&format!("**{}**", CLASSES[k]), &class(k)));

    println!("\nmisses (cargo xtask study blind --only SEED):");
    scores.iter().filter(|s| missed(s)).for_each(show);
    if o.only.is_some() {
        scores.iter().filter(|s| !missed(s)).for_each(show);
        return Ok(());
    }
    required(&[class(0), class(1), class(2), class(3), class(4)])
}

/// Unlisted sets are missed when a name was forced on them.
fn missed(score: &Score) -> bool {
    if score.unlisted() {
        return score.forced();
    }
    !score.names_right() || !score.joints_right() || !score.verdict_right()
}

fn row(name: &str, scores: &[&Score]) {
    if scores.is_empty() {
        return;
    }
    let share = |good: fn(&Score) -> bool| {
        let count = scores.iter().filter(|s| good(s)).count();
        format!("{count} ({:.1} %)", 100.0 * count as f64 / scores.len() as f64)
    };
    let extra: usize = scores.iter().map(|s| s.extra()).sum();
    let mut ratios: Vec<f64> = scores.iter().filter_map(|s| s.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let ratios = match ratios.last() {
        Some(worst) => format!("{:.3}, {worst:.3}", ratios[ratios.len() / 2]),
        None => "-".to_owned(),
    };
    println!(
        "| {name} | {} | {} | {} | {} | {extra} | {ratios} |",
        scores.len(),
        share(Score::names_right),
        share(Score::joints_right),
        share(Score::verdict_right),
    );
}

fn show(score: &Score) {
    let list = |places: &Places| {
        let all: Vec<String> = places.iter().map(|(name, at)| format!("{name}{at:?}")).collect();
        if all.is_empty() { "nothing".to_owned() } else { all.join(" + ") }
    };
    let verdict = match score.verdict {
        Verdict::Clean => "clean",
        Verdict::Explained => "explained",
        Verdict::Unexplained => "unexplained",
    };
    println!(
        "  {}: hidden {}; named {}; {verdict}; reduced chi-square {:.3}, with the truth {:.3}; \
         RMS / attainable {:.3}; rows flagged {:?}, wrong {:?}, on the other side of a gap {:?}",
        score.seed,
        list(&score.truth),
        list(&score.answer),
        score.reduced[0],
        score.reduced[1],
        score.ratio.unwrap_or(f64::NAN),
        score.rows[0],
        score.rows[1],
        score.rows[2],
    );
}

/// What the diagnosis must reach.
fn required(classes: &[Vec<&Score>; 5]) -> Result {
    // No sets, no figure: not a failure either.
    let good = |k: usize, test: fn(&Score) -> bool| {
        let of: &[&Score] = &classes[k];
        let count = of.iter().filter(|s| test(s)).count();
        (!of.is_empty()).then(|| count as f64 / of.len() as f64)
    };
    let mut failed = Vec::new();
    for (what, reached, needed) in [
        ("singles, names", good(0, Score::names_right), 0.99),
        ("singles, joints", good(0, Score::joints_right), 0.98),
        ("pairs, names", good(1, Score::names_right), 0.95),
        ("triples, names", good(2, Score::names_right), 0.85),
        ("clean without a name", good(3, |s| s.answer.is_empty()), 0.99),
        ("unlisted without a forced name", good(4, |s| !s.forced()), 0.98),
    ] {
        let Some(reached) = reached else { continue };
        let verdict = if reached >= needed { "ok" } else { "TOO FEW" };
        println!("{what}: {:.1} %, needed {:.0} %: {verdict}", 100.0 * reached, 100.0 * needed);
        if reached < needed {
            failed.push(what);
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("; ").into()) }
}
