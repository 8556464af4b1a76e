//! One spring under loads that nobody states: is it named, and nothing beside it?

use clap::Args;

use super::{One, Result, of_each};
use crate::apart::TOLD;
use crate::dirty::set::Sort;
use crate::dirty::springs::{Answer, answer};

#[derive(Args)]
pub struct Options {
    /// Sets
    #[arg(long, default_value_t = 300)]
    sets: u64,
    /// The first one; others are other sets
    #[arg(long, default_value_t = 41_000)]
    seed: u64,
    #[command(flatten)]
    one: One,
}

pub fn run(options: &Options) -> Result {
    if let Some(seed) = options.one.drawn(Sort::Spring)? {
        println!("{:#?}", answer(seed)?);
        return Ok(());
    }
    let all = of_each(options.seed..options.seed + options.sets, answer)?;
    all.iter().filter_map(|a| a.as_ref().err()).for_each(|e| println!("refused: {e}"));
    let all: Vec<&Answer> = all.iter().flatten().collect();
    println!("| sets | how many | right joint | nothing else named | both |");
    println!("|---|---|---|---|---|");
    let row = |what: &str, of: &dyn Fn(&Answer) -> bool| {
        let own: Vec<_> = all.iter().filter(|a| of(a)).collect();
        let count = |of: &dyn Fn(&Answer) -> bool| own.iter().filter(|a| of(a)).count();
        println!(
            "| {what} | {} | {} | {} | {} |",
            own.len(),
            count(&|a| a.right),
            count(&|a| a.second.is_empty()),
            count(&|a| a.right && a.second.is_empty()),
        );
    };
    row("that can be told", &|a| a.sure >= TOLD);
    row("of them above 0.8 floors", &|a| a.sure >= TOLD && a.floors >= 0.8);
    row("of them above 1.5 floors", &|a| a.sure >= TOLD && a.floors >= 1.5);
    row("that cannot be told", &|a| a.sure < TOLD);
    row("all", &|_| true);
    for a in all.iter().filter(|a| !a.second.is_empty() || (a.sure >= TOLD && !a.right)) {
        println!(
            "{} joint {} ({} rows, {:.1} and {:.1} sd, {:.2} floors): {}; beside it {:?}",
            a.seed,
            a.joint,
            a.rows,
            a.from_nothing,
            a.sure,
            a.floors,
            if a.right { "named" } else { "not named" },
            a.second
        );
    }
    Ok(())
}
