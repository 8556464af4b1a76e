//! Arms that warm up late, at once, or not at all: is it said which, and how late?

use clap::Args;
use rayon::prelude::*;
use truearm_host::diagnose::Verdict;

use super::Result;
use crate::warming::{Hidden, Told, WarmSet};

#[derive(Args)]
pub struct Options {
    /// Sets of each kind
    #[arg(long, default_value_t = 60)]
    sets: u64,
    /// Another seed, other sets
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only this set of links that are late, with all that is said of it
    #[arg(long)]
    only: Option<u64>,
}

const KINDS: [(Hidden, &str); 4] = [
    (Hidden::Late, "links follow late"),
    (Hidden::AtOnce, "links follow at once"),
    (Hidden::Settling, "the tracker settles"),
    (Hidden::Nothing, "nothing"),
];

pub fn run(options: &Options) -> Result {
    if let Some(seed) = options.only {
        let told = WarmSet::draw(seed, Hidden::Late).diagnosed()?;
        println!("{:#?}\n{:#?}", told.set.climate, told.outcome);
        return Ok(());
    }
    println!(
        "| hidden | sets | named late | at once | suspected | only an alternative | other names | verdict right |\n\
         |---|---|---|---|---|---|---|---|"
    );
    let mut late = Vec::new();
    for (kind, (hidden, words)) in KINDS.into_iter().enumerate() {
        let seed = |i: u64| options.seed * 1_000_000 + kind as u64 * 100_000 + i;
        let seeds: Vec<u64> = (0..options.sets).map(seed).collect();
        let told: Vec<_> =
            seeds.par_iter().map(|s| WarmSet::draw(*s, hidden).diagnosed()).collect();
        let told = told.into_iter().collect::<std::result::Result<Vec<_>, String>>()?;
        println!("| {words} | {} | {}", told.len(), row(&told));
        for one in &told {
            missed(one);
        }
        if hidden == Hidden::Late {
            late = told;
        }
    }
    time_constants(&late);
    Ok(())
}

fn row(told: &[Told]) -> String {
    let count = |is: &dyn Fn(&Told) -> bool| told.iter().filter(|t| is(t)).count();
    let late = |t: &Told| t.thermal().is_some_and(|e| e.time_constant_s.is_some());
    let counts = [
        count(&|t| t.is_named() && late(t)),
        count(&|t| t.is_named() && !late(t)),
        count(&|t| !t.is_named() && t.thermal().is_some()),
        count(&|t| t.thermal().is_none() && t.is_alternative()),
        told.iter().map(|t| t.false_names().len()).sum(),
        count(&|t| {
            let clean = t.set.hidden == Hidden::Nothing;
            t.outcome.verdict == if clean { Verdict::Clean } else { Verdict::Explained }
        }),
    ];
    counts.map(|count| format!("{count} | ")).concat()
}

/// What is not as it is, a line each.
fn missed(t: &Told) {
    let wanted = match t.set.hidden {
        Hidden::Late => t.is_named() && t.time_constant_off().is_some(),
        Hidden::AtOnce => t.is_named() && t.time_constant_off().is_none(),
        Hidden::Settling | Hidden::Nothing => t.thermal().is_none(),
    };
    let off = t.time_constant_off().is_some_and(|[z, _]| z.abs() > 2.5);
    if wanted && !off && t.false_names().is_empty() {
        return;
    }
    let said = |e: &truearm_host::diagnose::Effect| {
        format!(
            "{} {:?} tau {:?} +- {:?} p {:.2}",
            e.name, e.joints, e.time_constant_s, e.time_constant_sigma_s, e.probability
        )
    };
    let (effects, suspected) = (&t.outcome.effects, &t.outcome.suspected);
    eprintln!(
        "  {}: {} rows in {:.1} h, noise {} times, {:.1e} 1/K, tau {:.0} s, ahead {:.1} K: {:?} {:?}, \
         suspected {:?}, unnamed {:?}",
        t.set.seed,
        t.set.data.rows.len(),
        t.set.climate.length / 3600.0,
        t.set.noise,
        t.set.growth,
        t.set.climate.time_constant,
        t.set.climate.ahead,
        t.outcome.verdict,
        effects.iter().map(said).collect::<Vec<_>>(),
        suspected.iter().map(said).collect::<Vec<_>>(),
        t.outcome.unnamed
    );
}

/// How far time constants are off, of links that were in balance at the first row and of others.
fn time_constants(late: &[Told]) {
    println!(
        "\n| links at the first row | time constants | median error | largest | median stated | \
         within one sigma | within two |\n|---|---|---|---|---|---|---|"
    );
    for (words, balanced) in [("as warm as is read", true), ("1.5 K off (1 sigma)", false)] {
        let own = late.iter().filter(|t| (t.set.climate.ahead == 0.0) == balanced);
        let off: Vec<([f64; 2], f64)> = own
            .filter_map(|t| {
                let e = t.thermal()?;
                Some((t.time_constant_off()?, e.time_constant_sigma_s? / e.time_constant_s?))
            })
            .collect();
        let middle = |mut all: Vec<f64>| {
            all.sort_by(f64::total_cmp);
            all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let errors: Vec<f64> = off.iter().map(|(o, _)| o[1].abs().exp_m1()).collect();
        let largest = errors.iter().copied().fold(0.0, f64::max);
        let within = |z: f64| off.iter().filter(|(o, _)| o[0].abs() < z).count();
        println!(
            "| {words} | {} | {:.1} % | {:.1} % | {:.1} % | {} | {} |",
            off.len(),
            100.0 * middle(errors),
            100.0 * largest,
            100.0 * middle(off.iter().map(|(_, stated)| *stated).collect()),
            within(1.0),
            within(2.0)
        );
    }
}
