//! Effects outside the repertoire: is it said what errs, and with what?

use clap::Args;
use truearm_host::diagnose::Verdict;

use super::{One, Result, of_each};
use crate::apart::TOLD;
use crate::dirty::outside::{Answer, answer};
use crate::dirty::set::Sort;

#[derive(Args)]
pub struct Options {
    /// Sets, of six kinds in turn
    #[arg(long, default_value_t = 120)]
    sets: u64,
    /// The first one; others are other sets
    #[arg(long, default_value_t = 9_000)]
    seed: u64,
    #[command(flatten)]
    one: One,
}

/// Size from which on it must be described, noise floors.
const LARGE: f64 = 0.8;

pub fn run(options: &Options) -> Result {
    if let Some(seed) = options.one.drawn(Sort::Outside)? {
        println!("{:#?}", answer(seed)?);
        return Ok(());
    }
    let all = of_each(options.seed..options.seed + options.sets, answer)?;
    all.iter().filter_map(|a| a.as_ref().err()).for_each(|e| println!("refused: {e}"));
    let all: Vec<&Answer> = all.iter().flatten().collect();
    let mut kinds: Vec<&str> = all.iter().map(|a| a.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    println!(
        "| kind | sets | that can be told | of them described | above {LARGE} floors | of them described | sets with a wrong name |"
    );
    println!("|---|---|---|---|---|---|---|");
    let row = |kind: &str, own: &[&&Answer]| {
        let count = |of: &dyn Fn(&Answer) -> bool| own.iter().filter(|a| of(a)).count();
        println!(
            "| {kind} | {} | {} | {} | {} | {} | {} |",
            own.len(),
            count(&told),
            count(&|a| told(a) && a.right),
            count(&large),
            count(&|a| large(a) && a.right),
            count(&|a| !a.wrong.is_empty()),
        );
    };
    for kind in kinds {
        row(kind, &all.iter().filter(|a| a.kind == kind).collect::<Vec<_>>());
    }
    row("all", &all.iter().collect::<Vec<_>>());
    let listed: usize = all.iter().map(|a| a.named[0]).sum();
    let named: usize = all.iter().map(|a| a.named[1]).sum();
    println!("\n{named} of {listed} effects that have a name are named");
    let explained = all.iter().filter(|a| told(a) && a.verdict != Verdict::Unexplained);
    println!("{} sets that can be told are not called unexplained", explained.count());
    for a in &all {
        if !a.wrong.is_empty() || (told(a) && !a.right) {
            println!(
                "{} {} ({} rows, {:.1} and {:.1} sd, {:.2} floors): {:?}; wrong {:?}; {:?}",
                a.seed,
                a.kind,
                a.rows,
                a.from_nothing,
                a.sure,
                a.floors,
                a.described,
                a.wrong,
                a.verdict
            );
        }
    }
    Ok(())
}

fn told(a: &Answer) -> bool {
    a.sure >= TOLD
}

fn large(a: &Answer) -> bool {
    told(a) && a.floors >= LARGE
}
