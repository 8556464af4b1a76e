//! What was found beyond geometry: in words, in numbers, and against what gave it
//! away.

use super::super::charts::part;
use super::super::document::{Figure, Section};
use super::super::numbers::{cycles, period, runs};
use super::super::picture::Part;
use super::{details, list, table};
use crate::diagnose::{Coefficient, Effect, late, said};
use crate::effects::OUTLIERS;
use crate::model::CURVE;
use crate::units::{MICRO, MILLI, duration};

/// Pictures of one page, at most.
const MOST: usize = 24;

/// An effect in a few words.
pub fn short(e: &Effect) -> String {
    let name = e.name.replace('-', " ");
    let joints = match e.joints.len() {
        0 => String::new(),
        1 => format!(" of joint {}", e.joints[0]),
        _ if coupled(e) => format!(" from joint {} to {}", e.joints[0], e.joints[1]),
        _ => format!(" of joints {}", runs(&e.joints)),
    };
    match e.order {
        Some(n) if n > 1.0 => format!("{name}{joints}, {} (every {})", cycles_of(e, n), period(n)),
        Some(n) => format!("{name}{joints}, {}", cycles_of(e, n)),
        None => match e.time_constant_s {
            Some(tau) => format!("{name}{joints}, {} late", duration(tau)),
            None => format!("{name}{joints}"),
        },
    }
}

/// How often it comes back, and how sure that is.
fn cycles_of(e: &Effect, order: f64) -> String {
    e.order_left_open().map_or_else(|| cycles(order), |words| format!("{words} cycles a turn"))
}

fn coupled(e: &Effect) -> bool {
    truearm::effects::Effect::from_name(e.name).is_some_and(truearm::effects::Effect::is_coupled)
}

/// A sentence about an effect: what it is, at which joints, how large.
fn sentence(e: &Effect) -> String {
    let size = |c: &Coefficient| amount(c.value, c.unit);
    let joints = if e.joints.len() == 1 { "Joint" } else { "Joints" };
    let who = format!("{joints} {}", runs(&e.joints));
    if e.name == CURVE {
        let sizes: Vec<String> = e.coefficients.iter().map(size).collect();
        return format!(
            "{who}: the angle errs by a smooth curve over the turn, {} RMS.",
            sizes.join(", ")
        );
    }
    if e.name == OUTLIERS {
        return "Some rows are gross errors of the measurement; they were left out.".to_owned();
    }
    if let Some(order) = e.order {
        let mut waves: Vec<String> = Vec::new();
        for joint in &e.joints {
            let own = e.coefficients.iter().filter(|c| c.joint == Some(*joint));
            let square: f64 = own.map(|c| c.value * c.value).sum();
            waves.push(amount(square.sqrt(), "rad"));
        }
        return format!(
            "{who}: {} that comes back {}, a period of {}, amplitude {}.",
            e.name.replace('-', " "),
            cycles_of(e, order),
            period(order),
            waves.join(", ")
        );
    }
    let sizes: Vec<String> = e
        .coefficients
        .iter()
        .map(|c| format!("{} {}", c.part, size(c)).trim().to_owned())
        .collect();
    let mut name = short(e);
    name[..1].make_ascii_uppercase();
    let late = late(e).map_or(String::new(), |late| format!(" It grows {late}."));
    format!("{name}: {}.{late}", sizes.join(", "))
}

/// The same, and what speaks against its name.
fn suspicion(e: &Effect) -> String {
    e.suspicion().map_or_else(|| sentence(e), |doubt| format!("{} But {doubt}.", sentence(e)))
}

/// A coefficient in a unit that leaves one to three digits before the point.
fn amount(value: f64, unit: &str) -> String {
    let small = value.abs() < 1e-4;
    match unit.strip_prefix("rad") {
        Some(rest) if small => format!("{:.3} urad{rest}", value * MICRO),
        Some(rest) if value.abs() < 0.1 => format!("{:.4} mrad{rest}", value * MILLI),
        _ => match unit.strip_prefix('m').filter(|rest| rest.is_empty() || rest.starts_with('/')) {
            Some(rest) if small => format!("{:.3} um{rest}", value * MICRO),
            Some(rest) => format!("{:.4} mm{rest}", value * MILLI),
            None => format!("{value:.3e} {unit}"),
        },
    }
}

/// Effects of a model and the rows that show them.
pub fn effects(named: &[Effect], suspected: &[Effect], parts: &[Part], clean: bool) -> Section {
    let mut section = Section::new("effects", "What the geometry lacks");
    if named.is_empty() && suspected.is_empty() {
        return section.say(match clean {
            true => "Nothing: no effect of the repertoire is needed beside the geometry.",
            false => "No effect of the repertoire is told from what geometry alone leaves.",
        });
    }
    section = section.node(list(named.iter().map(sentence)));
    if !suspected.is_empty() {
        section = section
            .say(
                "Suspected: in the model all the same, but less sure, or something speaks against \
                 the name.",
            )
            .node(list(suspected.iter().map(suspicion)));
    }
    let all = table(
        &[
            "effect",
            "joint",
            "part",
            "value",
            "+- 1 sigma",
            "unit",
            "probability",
            "held-out error falls",
        ],
        table_rows(named.iter().chain(suspected)),
    );
    section = section.node(details("the numbers: coefficients, probabilities, gains", all));
    let mut names: Vec<String> = Vec::new();
    for p in parts.iter().take(MOST) {
        let joint = p.joint.map_or(String::new(), |joint| format!("-{joint}"));
        let name = format!("{}{joint}", p.effect);
        names.push(name.clone());
        let again = names.iter().filter(|n| **n == name).count();
        let name = if again > 1 { format!("{name}-{again}") } else { name };
        section = section.figure(Figure::new(name, caption(p), vec![part(p)]));
    }
    if parts.len() > MOST {
        section = section.say(format!("{} more are in report.json.", parts.len() - MOST));
    }
    section
}

fn caption(p: &Part) -> String {
    let silent = match p.silent {
        0 => String::new(),
        1 => " One more row hardly moves with it and is not drawn.".to_owned(),
        n => format!(" {n} more rows hardly move with it and are not drawn."),
    };
    // Against values that have names there is no line.
    let model = if p.names.is_empty() { "Line and band" } else { "Marks with bars" };
    format!(
        "{} rows: what the residual of each says of this effect alone, everything else of the model \
         taken off. {model}: the model with its own 95 % interval, which rows with their noise \
         need not stand in.{silent}",
        p.points.len()
    )
}

/// Lines of the table. The fall of the error is of all effects of a name together, and stands
/// once.
fn table_rows<'e>(effects: impl Iterator<Item = &'e Effect>) -> Vec<Vec<String>> {
    let (mut out, mut before): (Vec<Vec<String>>, Option<&Effect>) = (Vec::new(), None);
    for e in effects {
        let first = before.is_none_or(|b| (b.name, b.holdout_gain) != (e.name, e.holdout_gain));
        let lines = rows(e, first);
        out.extend(lines);
        before = Some(e);
    }
    out
}

fn rows(e: &Effect, first: bool) -> Vec<Vec<String>> {
    let p = said(e.probability);
    let gain = format!("{:.0} %", 100.0 * e.holdout_gain);
    let mut gains = first.then_some(gain).into_iter();
    let name = match e.order {
        Some(n) => format!("{}, {}", e.name, cycles_of(e, n)),
        None => e.name.to_owned(),
    };
    let line = |c: &Coefficient| {
        let joint = c.joint.map_or(String::new(), |joint| joint.to_string());
        let (value, sigma) = (format!("{:.3e}", c.value), format!("{:.0e}", c.sigma));
        let first = [name.clone(), joint, c.part.to_owned(), value, sigma, c.unit.to_owned()];
        first.into_iter().chain([p.clone(), gains.next().unwrap_or_default()]).collect()
    };
    if e.coefficients.is_empty() {
        let blank = vec![String::new(); 5];
        return vec![[vec![name], blank, vec![p, gains.next().unwrap_or_default()]].concat()];
    }
    e.coefficients.iter().map(line).collect()
}
