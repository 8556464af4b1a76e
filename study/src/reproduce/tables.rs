//! The report's tables over all seeds: 9 and 10, contests, the sweep.

use super::example::Example;
use super::markdown::{middle, number, table};
use super::paper;
use super::study::{SHOWN, Study, score, spread};
use super::trial::{Contest, SWEEP, Score, Sweep, Trial};
use truearm_host::statistics::Stats;

/// How near cell (a) comes to the bound.
pub fn summary(study: &Study) -> String {
    let [ratio, low, high, worst] =
        spread(&study.trials.iter().map(|t| t.rms_mm / t.cramer_rao_mm).collect::<Vec<_>>());
    format!(
        "Cell (a), RPIM: RMS on 250 noise-free poses over that seed's Cramer-Rao bound: mean {:.3}, \
         median {ratio:.3}, 10 to 90 % {low:.3} to {high:.3}, worst {worst:.3}.\n\n",
        study.mean_rms_over_cramer_rao
    )
}

/// Tables 9 and 10 beside the printed ones: medians over seeds.
pub fn nine_and_ten(study: &Study, example: &Example) -> String {
    let mut out = format!(
        "## Tables 9 and 10\n\nOver the 52 + 18 points, mm: what the paper prints, and the \
         median over the seeds of cell (b), base and tool held as in the paper and fitted with the rest \
         (seed {SHOWN} of the figures in brackets). RPIM fits them in either.\n\n"
    );
    let stat = |which: usize, name: &str, f: fn(&Stats) -> f64| {
        let of = |c: &Contest| score(c, name).and_then(|s| s.table).map_or(f64::NAN, |t| f(&t));
        let all: Vec<f64> = study.trials.iter().map(|t| of(&t.beyond[which])).collect();
        format!("{} [{}]", number(spread(&all)[0]), number(of(&example.contests[which])))
    };
    let gone = |which: usize, name: &str, f: fn(&Stats) -> f64| {
        let of = |t: &Trial| {
            let c = &t.beyond[which];
            let value = |n| score(c, n).and_then(|s: &Score| s.table).map_or(f64::NAN, |t| f(&t));
            100.0 * (1.0 - value(name) / value("NC"))
        };
        format!("{:.1}", spread(&study.trials.iter().map(of).collect::<Vec<_>>())[0])
    };
    type Figure = (&'static str, fn(&paper::Printed) -> f64, fn(&Stats) -> f64);
    let figures: [Figure; 3] = [
        ("Max", |p| p.max_mm, |s| s.max_mm),
        ("MAE", |p| p.mean_mm, |s| s.mean_mm),
        ("SD", |p| p.sd_mm, |s| s.sd_mm),
    ];
    let mut rows = Vec::new();
    for (what, printed, ours) in figures {
        for p in &paper::TABLE {
            let mut row = vec![what.to_owned(), p.name.to_owned(), number(printed(p))];
            row.extend([1, 0].map(|which| stat(which, p.name, ours)));
            rows.push(row);
            if p.name == "RPIM" {
                let mut row = vec![what.to_owned(), "RPIM-P".to_owned(), String::new()];
                row.extend([1, 0].map(|which| stat(which, "RPIM-P", ours)));
                rows.push(row);
            }
        }
    }
    out += &table(&["figure", "method", "paper", "held", "fitted"], &rows);
    let mut rows = Vec::new();
    for p in paper::TABLE.iter().skip(1) {
        type Reduction = (&'static str, Option<f64>, fn(&Stats) -> f64);
        let both: [Reduction; 2] =
            [("MAE", p.mae_reduction, |s| s.mean_mm), ("SD", p.sd_reduction, |s| s.sd_mm)];
        for (what, printed, f) in both {
            let mut row = vec![what.to_owned(), p.name.to_owned()];
            row.push(printed.map_or(String::new(), |x| format!("{x:.3}")));
            row.extend([1, 0].map(|which| gone(which, p.name, f)));
            rows.push(row);
        }
    }
    out += "Reduction against NC, percent:\n\n";
    out + &table(&["of", "method", "paper", "held", "fitted"], &rows)
}

/// All methods of a contest.
pub fn contest(title: &str, contests: &[&Contest]) -> String {
    let mut rows = Vec::new();
    for (k, first) in contests[0].scores.iter().enumerate() {
        let all: Vec<&Score> = contests.iter().map(|c| &c.scores[k]).collect();
        let stat = |of: fn(&Score) -> Option<Stats>, f: fn(&Stats) -> f64| {
            all.iter().map(|s| of(s).map_or(f64::NAN, |t| f(&t))).collect::<Vec<f64>>()
        };
        let failed = all.iter().filter(|s| s.failure.is_some()).count();
        let exact = stat(|s| s.exact, |s| s.mean_mm);
        let norm: Vec<f64> = all.iter().map(|s| s.correction_norm.unwrap_or(f64::NAN)).collect();
        let ms: Vec<f64> = all.iter().map(|s| s.seconds * 1e3).collect();
        let steps: Vec<f64> = all.iter().map(|s| s.iterations as f64).collect();
        rows.push(vec![
            first.method.to_owned(),
            number(spread(&stat(|s| s.table, |s| s.max_mm))[0]),
            middle(&stat(|s| s.table, |s| s.mean_mm)),
            number(spread(&stat(|s| s.table, |s| s.sd_mm))[0]),
            middle(&exact),
            number(spread(&exact)[3]),
            number(spread(&norm)[0]),
            format!("{:.0}", spread(&steps)[0]),
            format!("{:.2}", spread(&ms)[0]),
            failed.to_string(),
        ]);
    }
    let ordered = contests.iter().filter(|c| c.paper_ordering).count();
    format!(
        "## {title}\n\nMedians over {} seeds, tenth to ninetieth percentile in brackets, mm. The \
         paper's ordering of MAE, NC > LSM > GD > GN > RPIM, appears in {ordered} of them.\n\n{}",
        contests.len(),
        table(
            &[
                "method",
                "Max",
                "MAE, 52 + 18 points",
                "SD",
                "MAE, 250 noise-free",
                "worst seed",
                "norm, tolerances",
                "iterations",
                "ms",
                "broke down",
            ],
            &rows,
        )
    )
}

/// RMS against the number of poses.
pub fn sweep(study: &Study) -> String {
    let part = |of: fn(&Sweep) -> &[Option<f64>]| {
        let mut rows = Vec::new();
        for (m, first) in study.trials[0].sweep.iter().enumerate() {
            let mut row = vec![first.method.to_owned()];
            for c in 0..SWEEP.len() {
                let all = study.trials.iter().map(|t| of(&t.sweep[m])[c].unwrap_or(f64::NAN));
                let all: Vec<f64> = all.collect();
                let [median, _, _, worst] = spread(&all);
                let broken = all.iter().filter(|x| x.is_nan()).count();
                let note =
                    if broken > 0 { format!(", {broken} broke down") } else { String::new() };
                row.push(format!("{} / {}{note}", number(median), number(worst)));
            }
            rows.push(row);
        }
        let head: Vec<String> = SWEEP.iter().map(|n| format!("{n} poses")).collect();
        let head = std::iter::once("method").chain(head.iter().map(String::as_str));
        table(&head.collect::<Vec<_>>(), &rows)
    };
    format!(
        "## Fewer poses, and a robot file that is not the catalogue's\n\nCell (a), base and tool \
         fitted: RMS on 250 noise-free poses, mm, median / worst seed. From the catalogue's geometry, \
         where redundant parameters are exactly so:\n\n{}From a file whose parameters are off by \
         1 mm and 1 mrad (one standard deviation) each, as after an earlier calibration:\n\n{}From the catalogue, \
         but every joint within 20 degrees of one pose, as the rows of the paper's Table 8 nearly are; \
         judged on others of that region:\n\n{}",
        part(|s| &s.catalogue_mm),
        part(|s| &s.calibrated_before_mm),
        part(|s| &s.narrow_mm)
    )
}
