use truearm_host::error::count;
use truearm_host::plan::{PosePlan, plural};
use truearm_host::report::SeparatedAlternative;
use truearm_host::table::Table;
use truearm_host::units::MICRO;

/// Poses of `plan` and what they will tell.
pub fn planned(found: &PosePlan) -> String {
    let head = format!("predicted 3-D standard deviation of {}, geometry alone", found.what);
    let mut table = Table::new([head.as_str(), "um"]);
    let determined = found.determined;
    for (name, metres) in [
        ("  worst over the region", Some(found.worst)),
        ("  root mean square over the region", Some(found.rms)),
        ("  no set has a smaller worst than", found.bound),
        ("  worst of as many random poses", Some(found.random_worst)),
        ("  worst but for what stays open", determined.map(|d| d.worst)),
        ("  the same of as many random poses", determined.map(|d| d.random_worst)),
    ] {
        if let Some(metres) = metres {
            table.row([name.to_owned(), format!("{:.1}", metres * MICRO)]);
        }
    }
    let o = &found.observability;
    let open = found.undetermined.iter().map(|line| format!("left open: {line}\n"));
    format!(
        "{} for {} parameters that {} can determine\n{table}{}\
         observability: O1 {:.4}, O2 {:.2e}, O3 {:.4}, O4 {:.2e}, O5 {:.4}\n",
        counted(found),
        found.parameters,
        plural(found.kind),
        open.collect::<String>(),
        o.o1,
        o.o2,
        o.o3,
        o.o4,
        o.o5
    )
}

/// How many poses, and how many measurements where that is another number.
fn counted(found: &PosePlan) -> String {
    let (poses, measurements) = (found.poses.len(), found.measurements.len());
    match poses == measurements {
        true => count(poses, "pose"),
        false => format!("{measurements} {} at {}", plural(found.kind), count(poses, "pose")),
    }
}

/// What so many planned poses tell of alternatives.
pub fn separated(alternatives: &[SeparatedAlternative], poses: usize) -> String {
    let line = |a: &SeparatedAlternative| {
        format!(
            "alternative {}: worse by {:.1} in chi-square now, by {:.0} more expected with these \
             {poses} poses\n",
            a.instead, a.worse_by_now, a.worse_by_planned
        )
    };
    alternatives.iter().map(line).collect()
}
