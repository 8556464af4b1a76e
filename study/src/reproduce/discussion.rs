//! What the figures mean, and where the paper's own do not fit together.

use std::collections::BTreeMap;

use super::example::Example;
use super::markdown::{number, table};
use super::paper;
use super::study::{Study, contests, score, spread};
use super::trial::{Diagnosis, SWEEP, Sweep, Trial};
use truearm_host::diagnose::Verdict;

/// MAE on noise-free poses of a method in a contest over all seeds.
fn exact(study: &Study, contest: usize, method: &str) -> [f64; 4] {
    let of = contests()[contest].1;
    let mae =
        |t: &Trial| score(of(t), method).and_then(|s| s.exact).map_or(f64::NAN, |s| s.mean_mm);
    spread(&study.trials.iter().map(mae).collect::<Vec<_>>())
}

fn mid(study: &Study, contest: usize, method: &str) -> String {
    number(exact(study, contest, method)[0])
}

/// The discussion.
pub fn text(study: &Study, example: &Example) -> String {
    [
        failing(study),
        regularising(study),
        ordering(study),
        lambda(example),
        spreads(study),
        inconsistencies(),
        diagnosis(study),
    ]
    .concat()
}

fn failing(study: &Study) -> String {
    let seeds = study.trials.len();
    let broke = |of: fn(&Sweep) -> Option<f64>| {
        let all = study.trials.iter().flat_map(|t| &t.sweep).filter(|s| s.method == "LSM-N");
        let values: Vec<f64> = all.map(|s| of(s).unwrap_or(f64::NAN)).collect();
        (values.iter().filter(|v| v.is_nan()).count(), spread(&values))
    };
    let (catalogue, _) = broke(|s| s.catalogue_mm[3]);
    let (_, before) = broke(|s| s.calibrated_before_mm[3]);
    let [_, _, _, newton] = exact(study, 1, "GN");
    let [_, _, _, damped] = exact(study, 1, "LM");
    format!(
        "## When does plain least squares really fail?\n\n\
         - **Not by redundancy as such.** The un-reduced set has a condition number beyond 1e15, yet the \
         pseudo-inverse in one step (LSM) leaves {} mm and iterated (GN) {} mm, as RPIM does ({} mm): \
         it takes the shortest of all equal answers.\n\
         - **By the normal equations.** (U'U)^-1 squares the condition number. From the catalogue's geometry \
         it is exactly singular in {catalogue} of {seeds} cells; from a robot file that an earlier calibration \
         has moved off the exact degeneracy it does return numbers, median {} mm and worst {} mm RMS with 52 \
         poses, where the pseudo-inverse leaves hundredths. Rounding alone decides these; the paper's 1.445 mm of LSM is of \
         their order.\n\
         - **By steps without control.** With base and tool held, full Gauss-Newton steps end {} mm off in the \
         worst cell, damped ones {} mm.\n\
         - **By poses that are alike.** See the last table above: least squares then fits noise in \
         directions which the tolerances of manufacturing would have held.\n\n",
        mid(study, 0, "LSM"),
        mid(study, 0, "GN"),
        mid(study, 0, "RPIM"),
        number(before[0]),
        number(before[3]),
        number(newton),
        number(damped),
    )
}

fn regularising(study: &Study) -> String {
    let narrow = |method: &str, count: usize| {
        let all = study.trials.iter().flat_map(|t| &t.sweep).filter(|s| s.method == method);
        let values: Vec<f64> = all.map(|s| s.narrow_mm[count].unwrap_or(f64::NAN)).collect();
        let [median, _, _, worst] = spread(&values);
        format!("{} / {}", number(median), number(worst))
    };
    format!(
        "## What does regularisation buy?\n\n\
         With redundancy left in, it does what the pseudo-inverse does too: it picks the small one \
         of many equal answers, and unlike the pseudo-inverse it needs no threshold at rounding level. \
         With redundancy removed beforehand (GN-R) the answer is unique and, on 52 good poses, as good: \
         {} mm against {} mm of RPIM. Its own gain appears where the data are weak, because it then \
         knows how large errors of manufacturing are. Poses alike, RMS in mm, median / worst seed:\n\n{}\
         Where base and tool are held, it cannot help: nominal registration is then wrong by what two of the \
         six directions of the base carry, which no link parameter can take up. Cell (a), whose errors the \
         model can represent exactly, is left with {} mm by RPIM as printed and with {} mm by plain GN; refining \
         base and tool with the rest leaves {} mm. A good part of the paper's 0.472 mm may be this.\n\n",
        mid(study, 0, "GN-R"),
        mid(study, 0, "RPIM"),
        table(
            &["poses", "LSM", "GN-R", "RPIM-P", "RPIM"],
            &[0, 3].map(|c| {
                let row = ["LSM", "GN-R", "RPIM-P", "RPIM"].map(|m| narrow(m, c));
                std::iter::once(SWEEP[c].to_string()).chain(row).collect()
            }),
        ),
        mid(study, 1, "RPIM-P"),
        mid(study, 1, "GN"),
        mid(study, 1, "RPIM"),
    )
}

fn ordering(study: &Study) -> String {
    let count =
        |k: usize| study.trials.iter().filter(|t| contests()[k].1(t).paper_ordering).count();
    let seeds = study.trials.len();
    format!(
        "## The ordering NC > LSM > GD > GN > RPIM\n\n\
         It appears in {}, {} (cell (a), base and tool fitted, held), {} and {} (cell (b)) of {seeds} seeds. NC has the \
         largest median throughout. LSM by pseudo-inverse, GN, LM and RPIM minimise the same sum of squares and come to the \
         same place within noise where they come to rest: no factor of two or three can lie between \
         them. GD is worse where it is stopped early ({} mm against {} mm of GN in cell (a), after 500 steps), and in \
         cell (b), where structure and not noise is left, not even that. LSM worse than GD needs the normal \
         equations (above). That GN should end between GD and RPIM means that it was stopped \
         early, ill-conditioned, or judged in other frames; the paper does not say which.\n\n",
        count(0),
        count(1),
        count(2),
        count(3),
        mid(study, 0, "GD"),
        mid(study, 0, "GN"),
    )
}

fn lambda(example: &Example) -> String {
    let c = &example.curve;
    let at = |lambda: f64| {
        let near = |p: &&[f64; 3]| (p[0] / lambda).ln().abs();
        let found = c.errors.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
        found.map_or(f64::NAN, |p| p[1])
    };
    let [corner, last] = paper::LAMBDAS;
    let share = f64::EPSILON * c.largest;
    format!(
        "## Lambda\n\n\
         Largest singular value squared of cell (b): {:.1} m^2 (in mm {:.1e}). Corner of the L-curve (Fig. 7) {:.2e}, after \
         the two steps {:.2e} m^2. The paper's {corner:.3e} and {last:.3e} have no unit. Rounding of U'U alone is {share:.1e} m^2 \
         ({:.1e} mm^2): the printed lambda is {:.1} times that in metres, {:.0e} of it in millimetres. Between these two lambdas the mean \
         error of the fitted points moves by {:.1e} mm here; that ten lambdas within one decade of 3e-14 differ visibly, as in Fig. 9 \
         and 10, is rounding, or another problem than Eq. 11. The condition number of {:.3e} (Eq. 24) is beyond the 4.5e15 that \
         double precision can tell from infinity. Chosen by the residual of the fitted points, the two steps go \
         towards lambda = 0 as far as the linear residual goes; a minimum inside appears only because the mean \
         distance after the full kinematics is judged and not the sum of squares that was minimised (Fig. 9).\n\n",
        c.largest,
        c.largest * 1e6,
        c.corner[0],
        c.chosen[0],
        share * 1e6,
        last / share,
        last / (share * 1e6),
        (at(corner) - at(last)).abs(),
        paper::CONDITION,
    )
}

fn spreads(study: &Study) -> String {
    let rows: Vec<Vec<String>> = paper::TABLE
        .iter()
        .map(|p| {
            let ratio = |t: &Trial| {
                let of = score(&t.beyond[1], p.name).and_then(|s| s.table);
                of.map_or(f64::NAN, |s| s.sd_mm / s.mean_mm)
            };
            let ours = spread(&study.trials.iter().map(ratio).collect::<Vec<_>>())[0];
            vec![p.name.to_owned(), number(p.sd_mm / p.mean_mm), number(ours)]
        })
        .collect();
    let after = paper::AXES.map(|(_, before, gone)| before * (1.0 - gone / 100.0));
    let length = after.iter().map(|x| x * x).sum::<f64>().sqrt();
    format!(
        "## Spread over mean\n\n\
         Errors of equal size along all axes have SD / MAE = 0.42; structure that differs from pose to pose makes it \
         larger, a shift common to all smaller. \
         Printed, and median of cell (b), base and tool held:\n\n{}\
         A ratio of 0.06 or 0.03 is what one constant shift of all points leaves, with scatter of the \
         repeatability (0.03 mm) about it. The means by axis say the same: after RPIM {:.3}, {:.3}, {:.3} mm along x, y, z \
         (text to Fig. 12), {length:.3} mm together, z far below the repeatability, which means of absolute errors cannot \
         be. The printed MAE of RPIM would then be a frame that was not fitted with the rest, and \
         what is left of the arm 0.03 mm. No method is told apart by such a shift. Printed data do not decide it.\n\n",
        table(&["method", "paper", "here"], &rows),
        after[0],
        after[1],
        after[2],
    )
}

fn inconsistencies() -> String {
    let gone =
        |p: &paper::Printed, f: fn(&paper::Printed) -> f64| 100.0 * (1.0 - f(p) / f(&paper::NC));
    let mut rows = Vec::new();
    for p in paper::TABLE.iter().skip(1) {
        let pair = |printed: Option<f64>, own: f64| {
            [printed.map_or(String::new(), |x| format!("{x:.3}")), format!("{own:.3}")]
        };
        let mae = pair(p.mae_reduction, gone(p, |p| p.mean_mm));
        let sd = pair(p.sd_reduction, gone(p, |p| p.sd_mm));
        rows.push([vec![p.name.to_owned()], mae.to_vec(), sd.to_vec()].concat());
    }
    let mut means = Vec::new();
    for (name, many, few) in paper::MEANS {
        let table = paper::TABLE.iter().find(|p| p.name == name).map_or(f64::NAN, |p| p.mean_mm);
        let all = many.map(|m| (52.0 * m + 18.0 * few) / 70.0);
        means.push(vec![
            name.to_owned(),
            many.map_or("-".to_owned(), |m| format!("{m:.3}")),
            format!("{few:.3}"),
            all.map_or("-".to_owned(), |a| format!("{a:.3}")),
            format!("{table:.3}"),
        ]);
    }
    format!(
        "## Where the paper's formulas and numbers do not agree\n\n\
         - Eq. 14 has lost the unknown and squares lambda: 2 (lambda I)' lambda I must be 2 lambda x; Eq. 13 adds a matrix to a \
         scalar. Eq. 6 adds where it must multiply, Eq. 2 has two wrong entries, Eq. 23 and its text give \
         two x of the tool (-3.04154 and -3.402).\n\
         - Table 10 against Table 9, reduction in percent: printed, and from the printed Max, MAE and SD. The SD of RPIM does not \
         follow (it would be 0.033 mm), and the text has 63.261 for GN where the table has 62.261.\n\n{}\
         - Means of Fig. 11 (52 points) and Fig. 14 (18 points) in the text, their mean over 70 points, and \
         Table 9, mm. For GD and GN the 18 points have the very figures that Table 9 gives for all 70.\n\n{}",
        table(
            &["method", "MAE printed", "MAE from Table 9", "SD printed", "SD from Table 9"],
            &rows
        ),
        table(&["method", "52 points", "18 points", "70 points", "Table 9"], &means),
    )
}

fn diagnosis(study: &Study) -> String {
    let of = |f: fn(&Diagnosis) -> f64| {
        spread(&study.trials.iter().map(|t| f(&t.diagnosis)).collect::<Vec<_>>())
    };
    let seeds = study.trials.len();
    let right = study.trials.iter().filter(|t| t.diagnosis.right).count();
    let explained =
        study.trials.iter().filter(|t| t.diagnosis.verdict == Verdict::Explained).count();
    let (before, after) = (of(|d| d.geometry_rms_mm), of(|d| d.final_rms_mm));
    let mut others: BTreeMap<String, usize> = BTreeMap::new();
    for trial in study.trials.iter().filter(|t| !t.diagnosis.right) {
        *others.entry(trial.diagnosis.effects.join(", ")).or_default() += 1;
    }
    let others: Vec<String> =
        others.iter().map(|(named, count)| format!("{named} in {count}")).collect();
    let other = match others.as_slice() {
        [] => String::new(),
        others => format!(" Named otherwise: {}.", others.join("; ")),
    };
    format!(
        "## Beyond geometry: `diagnose` on cell (b)\n\n\
         From the 52 poses alone the springs of joints 2 and 3 and the gear errors of joints 1 and 2 are named, and \
         nothing else, in {right} of {seeds} cells; the verdict is `explained` in {explained}. RMS on 250 noise-free poses: geometry \
         {} mm, with the effects {} mm (median), {} mm (worst). No choice of lambda does that.{other}\n\n",
        number(before[0]),
        number(after[0]),
        number(after[3]),
    )
}
