//! Honest ties: sets whose poses cannot tell two effects apart. Are both named,
//! and do the poses that the report proposes separate them?

use clap::Args;
use rayon::prelude::*;
use truearm_host::diagnose::{DiagnoseOptions, diagnose};
use truearm_host::model::Robot;

use super::Result;
use crate::blind::score::{Places, places, told};
use crate::blind::sets::BlindSet;
use crate::simulated::parse;

#[derive(Args)]
pub struct Options {
    /// Sets to draw
    #[arg(long, default_value_t = 60)]
    sets: u64,
    /// Another seed, other sets
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

struct Outcome {
    seed: u64,
    truth: Places,
    first: Places,
    alternatives: Vec<Places>,
    after: Option<Places>,
}

pub fn run(options: &Options) -> Result {
    let seeds: Vec<u64> = (0..options.sets).map(|i| options.seed * 1_000_000 + i).collect();
    let outcomes: Vec<_> = seeds.par_iter().map(|s| judged(*s)).collect();
    let outcomes = outcomes.into_iter().collect::<std::result::Result<Vec<_>, _>>()?;
    // A tie is where the report itself says that two explanations are within
    // reach of each other.
    let ties: Vec<&Outcome> = outcomes.iter().filter(|o| o.after.is_some()).collect();
    let told = |o: &&&Outcome| o.first == o.truth || o.alternatives.contains(&o.truth);
    let separated = ties.iter().filter(|o| o.after.as_ref() == Some(&o.truth)).count();
    let confident = outcomes.iter().filter(|o| o.after.is_none());
    let wrong = confident.clone().filter(|o| o.first != o.truth).count();
    println!(
        "{} sets, one joint hardly moved, a gain or an eccentricity hidden in it",
        outcomes.len()
    );
    println!(
        "{} ties reported; the truth is among the named in {}",
        ties.len(),
        ties.iter().filter(told).count()
    );
    println!("the proposed poses separate {separated} of {}", ties.len());
    println!("{} sets named without an alternative, {wrong} of them wrongly", confident.count());
    for o in outcomes.iter().filter(|o| o.after.as_ref().unwrap_or(&o.first) != &o.truth) {
        println!(
            "  {}: hidden {:?}; named {:?}, alternatives {:?}, after {:?}",
            o.seed, o.truth, o.first, o.alternatives, o.after
        );
    }
    if separated * 10 < ties.len() * 9 || ties.is_empty() {
        return Err(format!("{separated} of {} separated, needed 90 %", ties.len()).into());
    }
    Ok(())
}

fn judged(seed: u64) -> std::result::Result<Outcome, String> {
    let set = BlindSet::tie(seed);
    let (robot, data, _) = set.read();
    let answer =
        |robot: &Robot, data: &_| -> std::result::Result<truearm_host::diagnose::Outcome, String> {
            let found = diagnose(robot, data, None, &DiagnoseOptions::default(), &|_| ());
            found.map(|f| f.outcome).map_err(|e| format!("seed {seed}: {e}"))
        };
    let report = answer(&robot, &data)?;
    let named = |list: &[(&str, Vec<usize>)]| {
        list.iter().map(|(name, joints)| ((*name).to_owned(), joints.clone())).collect::<Places>()
    };
    let poses: Vec<Vec<f64>> = report
        .alternatives
        .iter()
        .flat_map(|a| a.separating_poses.iter().map(|p| p.joints.clone()))
        .collect();
    let after = if poses.is_empty() {
        None
    } else {
        let more = parse(&robot, &set.measured_further(&poses));
        Some(places(&answer(&robot, &more)?))
    };
    let truth = &set.open().arm.defects;
    Ok(Outcome {
        seed,
        truth: truth.iter().map(|d| (d.kind.name().to_owned(), d.kind.joints())).collect(),
        first: told(&report),
        alternatives: report.alternatives.iter().map(|a| named(&a.effects)).collect(),
        after,
    })
}
