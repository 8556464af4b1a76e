//! Rules for lambda: regret against the best lambda.

use clap::Args;
use indicatif::ProgressBar;
use rayon::prelude::*;
use truearm_host::identify::LambdaRule;

use super::Result;
use crate::regret::{Class, Regrets, judge, spread};

#[derive(Args)]
pub struct Options {
    /// Problems, a quarter of them a class
    #[arg(long, default_value_t = 500)]
    problems: u64,
    /// Another seed, other problems
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

pub fn run(options: &Options) -> Result {
    let bar = ProgressBar::new(options.problems);
    let plan = |i: u64| (options.seed * 1_000_000 + i, Class::ALL[(i % 4) as usize]);
    let judged: Vec<Regrets> = (0..options.problems)
        .into_par_iter()
        .map(|i| {
            let (seed, class) = plan(i);
            let regrets = judge(seed, class);
            bar.inc(1);
            regrets
        })
        .collect();
    bar.finish_and_clear();
    println!("Regret: RMS on 250 noise-free poses over that of the best lambda, minus 1, percent:");
    println!("median / worst decile / worst.\n");
    let classes: Vec<&str> = Class::ALL.iter().map(|c| c.name()).collect();
    println!("| rule | all | {} |", classes.join(" | "));
    println!("|---|{}", "---|".repeat(classes.len() + 1));
    for (k, rule) in LambdaRule::ALL.iter().enumerate() {
        row(rule.name(), &judged, |r| r.regret[k]);
    }
    row("lambda = 0", &judged, |r| r.plain);
    let default = LambdaRule::ALL.iter().position(|r| *r == LambdaRule::default());
    let k = default.ok_or("the default is none of the rules")?;
    let [median, decile, _] = spread(judged.iter().map(|r| r.regret[k]).collect());
    let enough = median <= 0.05 && decile <= 0.25;
    println!(
        "\ndefault {}: median {:.1} % (needed 5), worst decile {:.1} % (needed 25)",
        LambdaRule::default().name(),
        100.0 * median,
        100.0 * decile
    );
    if enough { Ok(()) } else { Err("the default rule's regret is too large".into()) }
}

fn row(name: &str, judged: &[Regrets], of: impl Fn(&Regrets) -> f64) {
    let cell = |class: Option<Class>| {
        let within = judged.iter().filter(|r| class.is_none_or(|c| r.class == c));
        let values: Vec<f64> = within.map(&of).collect();
        if values.is_empty() {
            return "-".to_owned();
        }
        let percent = |x: &f64| format!("{:.1}", 100.0 * x);
        spread(values).iter().map(percent).collect::<Vec<_>>().join(" / ")
    };
    let classes: Vec<String> = Class::ALL.iter().map(|c| cell(Some(*c))).collect();
    println!("| {name} | {} | {} |", cell(None), classes.join(" | "));
}
