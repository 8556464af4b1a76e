//! A model of one half of the poses on the other half: is it better there than geometry alone,
//! and as good as it says?

use clap::Args;
use truearm_host::diagnose::{DiagnoseOptions, GapRow, diagnose};
use truearm_host::evaluate::not_covered;
use truearm_host::model::Measurements;

use super::{Result, of_each};
use crate::dirty::set::{DirtySet, Sort};

#[derive(Args)]
pub struct Options {
    /// Sessions
    #[arg(long, default_value_t = 100)]
    sets: u64,
    /// The first one; others are other sessions
    #[arg(long, default_value_t = 260_000_000)]
    seed: u64,
}

/// How the poses are parted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Parted {
    /// First half and second in time, which is the order of the rows.
    Time,
    /// By the values of the joint that moves farthest: the lower 85 % and the upper, so that
    /// their ranges have 70 % in common.
    Joint,
}

/// On the other half.
struct Answer {
    seed: u64,
    rows: usize,
    /// RMS of the model over that of geometry alone.
    over_geometry: f64,
    /// RMS of the model over what it has cross-validated on its own half.
    over_stated: f64,
    /// Whether the model says that the other half has angles that its own has not.
    beyond: bool,
    /// Whether the halves are of one session without an effect that has no name.
    listed: bool,
}

/// Fewest rows of a half: fewer do not tell an arm.
const FEWEST: usize = 40;

pub fn run(options: &Options) -> Result {
    for parted in [Parted::Time, Parted::Joint] {
        let seeds = options.seed..options.seed + options.sets;
        let all: Vec<_> =
            of_each(seeds, |seed| answer(seed, parted))?.into_iter().flatten().collect();
        println!("\n{parted:?}: {} sets", all.len());
        told("over geometry alone", &all, |a| a.over_geometry, 1.02);
        let listed: Vec<&Answer> = all.iter().filter(|a| a.listed).collect();
        println!("without an effect that has no name:");
        told("over its own cross-validated", &listed, |a| a.over_stated, 1.3);
        let beyond = listed.iter().filter(|a| a.beyond);
        let far = |a: &&&Answer| a.over_stated > 1.3;
        println!(
            "{} of {} have angles that the model's half has not, {} of those above 1.3",
            beyond.clone().count(),
            listed.len(),
            beyond.filter(far).count()
        );
    }
    Ok(())
}

fn told<A: std::borrow::Borrow<Answer>>(
    what: &str,
    all: &[A],
    of: impl Fn(&Answer) -> f64,
    most: f64,
) {
    let mut ratios: Vec<(f64, &Answer)> =
        all.iter().map(|a| a.borrow()).map(|a| (of(a), a)).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(last) = ratios.len().checked_sub(1) else { return };
    let at = |share: f64| ratios[(last as f64 * share) as usize].0;
    let above: Vec<_> =
        ratios.iter().filter(|r| r.0 > most).map(|(r, a)| (a.seed, a.rows, *r)).collect();
    println!(
        "error {what}: a tenth below {:.3}, median {:.3}, nine tenths below {:.3}, worst {:.3}; \
         {} of {} above {most}: {above:.2?}",
        at(0.1),
        at(0.5),
        at(0.9),
        ratios[last].0,
        above.len(),
        ratios.len()
    );
}

fn answer(seed: u64, parted: Parted) -> Option<Answer> {
    let set = DirtySet::draw(seed, Sort::Session);
    let (robot, [data, _]) = set.read();
    let own = halves(&data, parted)?;
    let part = |which: bool| {
        let rows = own.iter().zip(&data.rows).filter(|(own, _)| **own == which);
        Measurements { rows: rows.map(|(_, row)| row.clone()).collect(), ..data.clone() }
    };
    let (fitted, other) = (part(true), part(false));
    if fitted.rows.len() < FEWEST || other.rows.is_empty() {
        return None;
    }
    let fitted = counted(fitted);
    let other = counted(other);
    let options = DiagnoseOptions::default();
    let diagnosed = diagnose(&robot, &fitted, Some(&other), &options, &|_| ()).ok()?;
    let found = diagnosed.outcome;
    let error = |row: &GapRow| row.holdout_rms_mm;
    let geometry = found.gap.iter().find(|row| row.model == "geometry").and_then(error)?;
    let last = found.gap.last()?;
    Some(Answer {
        seed,
        rows: fitted.rows.len(),
        over_geometry: error(last)? / geometry,
        over_stated: error(last)? / last.cross_validated_rms_mm?,
        beyond: !not_covered(&diagnosed.model, &other).is_empty(),
        listed: set.open().hidden.unlisted.is_none(),
    })
}

/// Its poses numbered from 0.
fn counted(mut data: Measurements) -> Measurements {
    let mut known: Vec<usize> = data.rows.iter().map(|row| row.pose).collect();
    known.sort_unstable();
    known.dedup();
    for row in &mut data.rows {
        row.pose = known.binary_search(&row.pose).unwrap_or_default();
    }
    data.poses = known.len();
    data
}

/// Which rows are of the half that is fitted: all readings of a pose or none.
fn halves(data: &Measurements, parted: Parted) -> Option<Vec<bool>> {
    let rows = &data.rows;
    match parted {
        Parted::Time => {
            let middle = rows.get(rows.len() / 2)?.pose;
            Some(rows.iter().map(|row| row.pose < middle).collect())
        }
        Parted::Joint => {
            let range = |joint: usize| {
                let mut values: Vec<f64> = rows.iter().map(|row| row.q[joint]).collect();
                values.sort_by(f64::total_cmp);
                Some([*values.first()?, *values.last()?])
            };
            let ranges: Vec<[f64; 2]> = (0..rows.first()?.q.len()).filter_map(range).collect();
            let width = |j: &usize| ranges[*j][1] - ranges[*j][0];
            let joint = (0..ranges.len()).max_by(|a, b| width(a).total_cmp(&width(b)))?;
            let at = |share: f64| ranges[joint][0] + share * width(&joint);
            // Between the borders poses go to either half in turn.
            let own = |row: &truearm_host::model::Row| {
                let q = row.q[joint];
                q < at(0.15) || (q < at(0.85) && row.pose.is_multiple_of(2))
            };
            Some(rows.iter().map(own).collect())
        }
    }
}
