//! The report in Markdown: tables first, then what they mean.

use std::fmt::Write;

use super::example::Example;
use super::section_v::NinePoses;
use super::trial::{Contest, SWEEP, Score, Sweep};
use super::{CAUTION, SHOWN, Study, Trial, discussion, paper, points, spread};
use truearm_host::report::Stats;

/// A Markdown table.
pub fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut out = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len()));
    for row in rows {
        let _ = writeln!(out, "| {} |", row.join(" | "));
    }
    out.push('\n');
    out
}

/// Three decimals, powers of ten where they do not serve.
pub fn number(x: f64) -> String {
    match x.abs() {
        _ if !x.is_finite() => "-".to_owned(),
        a if a == 0.0 || (1e-3..1e4).contains(&a) => format!("{x:.3}"),
        _ => format!("{x:.1e}"),
    }
}

/// Median, and tenth to ninetieth percentile.
fn middle(values: &[f64]) -> String {
    let [median, low, high, _] = spread(values);
    if median.is_nan() {
        return "-".to_owned();
    }
    format!("{} ({} - {})", number(median), number(low), number(high))
}

/// The whole text.
pub fn report(study: &Study, example: &Example, nine: &NinePoses) -> String {
    let mut out = format!(
        "{CAUTION}\n\n# The paper's experiment on simulated cells\n\n\
         X. Li et al., IEEE Access 10 (2022), doi 10.1109/ACCESS.2022.3201818, on {} simulated cells (seeds 1 to {}): a 6R arm \
         of reach 1,024 mm, target at the offset of Eq. 23, 0.0304 mm of noise a coordinate \
         (repeatability 0.03 mm, tracker 5 um), 52 poses in an 800 mm cube to identify, 18 to \
         validate, and 250 noise-free ones, which no measurement has, to judge by. Geometric errors \
         are drawn at random and scaled so that no calibration leaves the paper's MAE of 2.533 mm. \
         Cell (a) has nothing else. Cell (b) has springs in joints 2 and 3 and gear transmission \
         errors in joints 1 and 2, scaled so that the best geometric fit leaves the paper's 0.472 mm.\n\n\
         Methods: {}\n\n",
        study.trials.len(),
        study.trials.len(),
        example
            .held
            .methods
            .iter()
            .map(|o| format!("**{}** {}", o.name, o.about))
            .collect::<Vec<_>>()
            .join("; "),
    );
    out += "Errors are 3-D distances: largest (Max), mean (MAE), standard deviation (SD).\n\n";
    out += &summary(study);
    out += &nine_and_ten(study, example);
    for (title, of) in contests() {
        out += &contest(title, &study.trials.iter().map(of).collect::<Vec<_>>());
    }
    out += &sweep(study);
    out += &discussion::text(study, example);
    out += &points::section_v(nine);
    out += &points::parameters(example);
    out += &points::validation(example);
    out += &figures();
    out
}

type Of = fn(&Trial) -> &Contest;

/// The four contests.
pub fn contests() -> [(&'static str, Of); 4] {
    [
        ("(a) geometric errors only, base and tool fitted", |t| &t.geometric[0]),
        ("(a) geometric errors only, base and tool held", |t| &t.geometric[1]),
        ("(b) springs and gears, base and tool fitted", |t| &t.beyond[0]),
        ("(b) springs and gears, base and tool held", |t| &t.beyond[1]),
    ]
}

fn summary(study: &Study) -> String {
    let [ratio, low, high, worst] =
        spread(&study.trials.iter().map(|t| t.rms_mm / t.cramer_rao_mm).collect::<Vec<_>>());
    format!(
        "Cell (a), RPIM: RMS on 250 noise-free poses over that seed's Cramer-Rao bound: mean {:.3}, \
         median {ratio:.3}, 10 to 90 % {low:.3} to {high:.3}, worst {worst:.3}.\n\n",
        study.mean_rms_over_cramer_rao
    )
}

/// Tables 9 and 10 beside the printed ones: medians over seeds.
fn nine_and_ten(study: &Study, example: &Example) -> String {
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

/// A method's score.
pub fn score<'a>(contest: &'a Contest, name: &str) -> Option<&'a Score> {
    contest.scores.iter().find(|s| s.method == name)
}

fn contest(title: &str, contests: &[&Contest]) -> String {
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

fn sweep(study: &Study) -> String {
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

fn figures() -> String {
    format!(
        "## Figures and files\n\n`figure-04` to `figure-14` are the counterparts of the paper's \
         figures of these numbers, of cell (b), seed {SHOWN}, base and tool held; `table-5.svg` is of section \
         V; `figure-15` shows every seed, `figure-16` the number of poses, `figure-17` the Cramer-Rao \
         ratios. `cell/` holds the robot and the measurements (Table 6 is `cell/identification.csv`): \
         `truearm compare cell/robot.toml cell/identification.csv --validate cell/validation.csv --hold-frames` \
         computes the comparison of that seed again. `report.json` has every seed.\n"
    )
}
