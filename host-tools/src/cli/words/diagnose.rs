use truearm_host::diagnose::{
    Alternative, Effect, GapUnit, Outcome, Verdict, late, otherwise, place, said,
};
use truearm_host::effects::OUTLIERS;
use truearm_host::identify::KindFigures;
use truearm_host::identify::certainty::scale::SCALE_OPEN;
use truearm_host::table::Table;
use truearm_host::units::MILLI;

use super::list;

/// Effects of one name up to which each has a line of its own.
const EACH: usize = 3;
/// Sentences about where the residuals are.
const PLACES: usize = 6;
/// RMS over the scale from which on tails are worth a word: normal noise has 1.
const TAILS: f64 = 1.1;

/// The summary of `diagnose`.
pub fn diagnosis(r: &Outcome) -> String {
    let b = &r.figures;
    let mut out = format!("{}\n{}: {} rows of {} poses\n", b.robot, b.data, b.rows, b.poses);
    out += verdict(r);
    out += &effects(&r.effects, false);
    if !r.suspected.is_empty() {
        out += "suspected, in the model all the same:\n";
        out += &effects(&r.suspected, true);
    }
    r.unnamed.iter().for_each(|line| out += &format!("without a name: {line}\n"));
    out += &format!("\n{}held out: {}\n", gap(r), b.cross_validation);
    if let Some(nested) = r.nested_rms_mm.filter(|_| r.gap_unit() == GapUnit::Millimetres) {
        out += &format!(
            "held out with the choice of effects made anew in each fold: {nested:.4} mm\n"
        );
    }
    out += &format!("noise is {} the stated standard deviation{}\n", noise(r), tails(r));
    if !b.outliers.is_empty() {
        let what = match r.effects.iter().any(|e| e.name == OUTLIERS) {
            true => "flagged as gross errors and left out",
            false => "that do not fit, left out",
        };
        out += &format!("rows {what}: {}\n", list(&b.outlier_rows));
    }
    if !r.whereabouts.is_empty() {
        out += "where geometry alone disagrees:\n";
        r.whereabouts.iter().take(PLACES).for_each(|line| out += &format!("  {line}\n"));
    }
    if b.unidentifiable.iter().any(|line| line == SCALE_OPEN) {
        out += &format!("left open: {SCALE_OPEN}\n");
    }
    r.alternatives.iter().for_each(|a| out += &alternative(a, r));
    r.not_testable.iter().for_each(|line| out += &format!("not testable: {line}\n"));
    out
}

/// By how much it is larger, of each kind where there are several.
fn noise(r: &Outcome) -> String {
    match &r.figures.kinds[..] {
        kinds @ [_, _, ..] => {
            let twice = |k: &KindFigures| kinds.iter().filter(|o| o.kind == k.kind).count() > 1;
            let of = |k: &KindFigures| match twice(k) {
                true => format!("of {} ({}) {:.2} times", k.kind, k.unit, k.noise_scale),
                false => format!("of {} {:.2} times", k.kind, k.noise_scale),
            };
            kinds.iter().map(of).collect::<Vec<_>>().join(", ")
        }
        _ => format!("{:.2} times", r.noise_scale),
    }
}

/// Where noise has tails its scale says less than what is left of rows.
fn tails(r: &Outcome) -> String {
    let left = r.gap.last().map_or(1.0, |last| last.train_rms_sigmas);
    match r.gap_unit() == GapUnit::Millimetres && left > TAILS {
        true => format!(" in its middle, {:.2} times with its tails (RMS)", left * r.noise_scale),
        false => String::new(),
    }
}

fn verdict(r: &Outcome) -> &'static str {
    match r.verdict {
        // What returns with the pose, or is far beyond what was stated, need be no noise.
        Verdict::Clean if !r.leaves_noise() => {
            "verdict: clean, what geometry alone leaves has no name\n"
        }
        Verdict::Explained if !r.leaves_noise() => {
            "verdict: explained, what the model leaves has no name\n"
        }
        Verdict::Clean => "verdict: clean, geometry alone leaves nothing but noise\n",
        Verdict::Explained => "verdict: explained, the model leaves nothing but noise\n",
        Verdict::Unexplained if r.effects.is_empty() => {
            "verdict: unexplained, structure is left that no listed effect explains\n"
        }
        Verdict::Unexplained => {
            "verdict: unexplained, structure is left beside the effects below\n"
        }
    }
}

fn effects(effects: &[Effect], suspected: bool) -> String {
    let mut out = String::new();
    let mut told: Vec<&str> = Vec::new();
    for e in effects {
        let same: Vec<&Effect> = effects.iter().filter(|o| o.name == e.name).collect();
        if same.len() <= EACH {
            out += &format!("  {}\n", effect(e, suspected));
        } else if !told.contains(&e.name) {
            told.push(e.name);
            out += &spectrum(&same);
        }
    }
    out
}

fn gap(r: &Outcome) -> Table {
    let unit = r.gap_unit();
    let mut table = Table::new([unit.words(), "fitted", "cross-val", "hold-out"]);
    let cell = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.4}"));
    for row in &r.gap {
        let cells = unit.figures(row).map(cell);
        table.row(std::iter::once(row.model.clone()).chain(cells));
    }
    match unit {
        GapUnit::Millimetres => table.numbers("noise as stated", [r.noise_floor_mm]),
        GapUnit::Deviations => table.numbers("noise alone", [1.0]),
    };
    table
}

/// An alternative by what it has that the model has not, and the reverse.
fn alternative(a: &Alternative, r: &Outcome) -> String {
    let own = [r.effects.clone(), r.suspected.clone()].concat();
    let how = match a.is_told_by_poses() {
        true => {
            "measure these poses to tell them apart (degrees or mm; floor and cell not looked at):"
        }
        false => "measure on while the arm warms up and while it cools down to tell them apart",
    };
    let mut out = format!(
        "alternative within reach (worse by {:.1} in chi-square): {}\n  {how}\n",
        a.worse_by,
        otherwise(a, &own)
    );
    for pose in &a.separating_poses {
        let joints: Vec<String> = pose.joints.iter().map(|q| format!("{q:.2}")).collect();
        out += &format!("    {}  ({:.3} mm apart)\n", joints.join(", "), pose.difference_mm);
    }
    out
}

fn effect(e: &Effect, suspected: bool) -> String {
    let mut out = place(e.name, &e.joints);
    if let Some(order) = e.order_left_open().or(e.order.map(|n| n.to_string())) {
        out += &format!(", {order} cycles a turn");
    }
    if let Some(late) = late(e) {
        out += &format!(", {late}");
    }
    let values: Vec<String> = e
        .coefficients
        .iter()
        .map(|c| {
            let part = if c.part.is_empty() { String::new() } else { format!("{} ", c.part) };
            format!("{part}{:.3e} +- {:.0e} {}", c.value, c.sigma, c.unit)
        })
        .collect();
    if !values.is_empty() {
        out += &format!(": {}", values.join(", "));
    }
    out += &format!("; probability {}", said(e.probability));
    if let Some(doubt) = e.suspicion().filter(|_| suspected) {
        out += &format!(", but {doubt}");
    }
    if e.holdout_gain != 0.0 {
        out += &format!("; {}", gained(e.holdout_gain));
    }
    out
}

/// What an effect is worth on poses held out.
fn gained(gain: f64) -> String {
    let percent = (gain * 100.0).round();
    let way = if percent < 0.0 { "rises" } else { "falls" };
    format!("held-out error {way} by {} %", percent.abs())
}

/// Many orders of one periodic effect: a line a joint, amplitudes in mrad.
fn spectrum(effects: &[&Effect]) -> String {
    let mut joints: Vec<usize> = effects.iter().flat_map(|e| e.joints.clone()).collect();
    joints.sort_unstable();
    joints.dedup();
    let gain = effects.first().map_or(0.0, |e| e.holdout_gain);
    let name = effects.first().map_or("", |e| e.name);
    let least = effects.iter().map(|e| e.probability).fold(1.0, f64::min);
    let mut out = format!("  {name}; probability {}; {}\n", said(least), gained(gain));
    for joint in joints {
        let mut lines: Vec<(f64, String)> = Vec::new();
        for e in effects {
            let mine = e.coefficients.iter().filter(|c| c.joint == Some(joint));
            let square: f64 = mine.map(|c| c.value * c.value).sum();
            if square > 0.0 {
                let order = e.order.map_or(String::new(), |n| format!("{n:.1}"));
                lines.push((square.sqrt() * MILLI, e.order_left_open().unwrap_or(order)));
            }
        }
        lines.sort_by(|a, b| b.0.total_cmp(&a.0));
        let list: Vec<String> =
            lines.iter().map(|(mrad, order)| format!("{order} ({mrad:.2})")).collect();
        out += &format!("    joint {joint}, cycles a turn (mrad): {}\n", list.join(", "));
    }
    out
}
