//! A blob in words, for `truearm inspect`.

use nalgebra::Vector3;
use truearm::blob::{self, Blob};
use truearm::effects::{Curve, Term, time_constant};
use truearm::{Curves, JointKind, MdhParameters};
use truearm_sized::Parameters;

use crate::model::{ErrorCurve, friction, friction_unit, part};

/// A blob in words, every field with its unit. `given` is how many bytes it was
/// found in; that its tag has to be checked is said where it is not (`asked`).
#[must_use]
pub fn describe(blob: &Blob, given: usize, asked: bool) -> String {
    let mut text = format!(
        "truearm parameter blob, layout {} (format 1.6), {} bytes, checksum good\n",
        blob::LAYOUT,
        blob.size()
    );
    if given > blob.size() {
        text += &format!("{} bytes behind the blob are ignored\n", given - blob.size());
    }
    text += match (blob.is_tagged(), asked) {
        (true, true) => "authentication        HMAC-SHA-256 tag\n",
        (true, false) => "authentication        HMAC-SHA-256 tag, not checked without a key\n",
        (false, _) => "authentication        none\n",
    };
    text + &fields(blob, &parameters(blob))
}

/// What a blob that was checked holds.
pub(super) fn parameters<'t>(blob: &Blob<'t>) -> Parameters<'t> {
    Parameters::read(blob).unwrap_or_else(|e| unreachable!("of its own number of joints: {e}"))
}

fn fields(blob: &Blob, p: &Parameters) -> String {
    let kinds = p.kinds();
    let mut text = head(p);
    text += "joint     alpha deg       a mm  theta deg       d mm   beta deg   limits          covered\n";
    (0..kinds.len()).for_each(|i| text += &joint(p, i));
    text +=
        "\nRows marked + are the identified corrections, added to the nominal values above them.\n";
    text + &links(p) + &terms(&p.terms, &kinds) + &curves(p.curves) + &uncertainty(blob, p)
}

/// A point or a rotation vector in the unit of a factor.
fn vector(v: &Vector3<f64>, factor: f64) -> String {
    let [x, y, z] = [v.x, v.y, v.z].map(|x| shown(x * factor));
    format!("{x:.4} {y:.4} {z:.4}")
}

/// What is said of the arm as a whole.
fn head(p: &Parameters) -> String {
    let created = match p.created {
        0 => "unknown".to_owned(),
        seconds => {
            let since = std::time::Duration::from_secs(u64::from(seconds));
            let when = humantime::format_rfc3339_seconds(std::time::UNIX_EPOCH + since);
            format!("{when} ({seconds} Unix s)")
        }
    };
    let orientation =
        if p.orientation_identified { "identified" } else { "not identified (nominal)" };
    format!(
        "robot id              {:#018x}\n\
         sequence              {}\n\
         created               {created}\n\
         base translation mm   {}\n\
         base rotation deg     {}\n\
         tool mm               {}\n\
         flange orientation    {orientation}\n\
         RMS error mm          {} before, {} after (cross-validated)\n\
         reference temp. C     {:.2}\n\
         {}\n",
        p.robot_id,
        p.sequence,
        vector(&p.base_translation, 1e3),
        vector(&p.base_rotation, 1_f64.to_degrees()),
        vector(&p.tool, 1e3),
        rms(p.rms_before),
        rms(p.rms_after),
        p.reference_temperature,
        match &p.masses {
            None if p.terms.iter().any(Term::needs_torque) => {
                "masses                not given: joint torques are read\n".to_owned()
            }
            None => "masses                not given\n".to_owned(),
            Some(m) => format!(
                "gravity m/s^2         {}\npayload point mm      {}\n",
                vector(&m.gravity, 1.0),
                vector(&m.payload_com, 1e3)
            ),
        }
    )
}

/// The nominal parameters of a joint and, below them, the corrections.
fn joint(p: &Parameters, i: usize) -> String {
    let revolute = p.nominal[i].kind == JointKind::Revolute;
    let factor = if revolute { 1_f64.to_degrees() } else { 1e3 };
    let range = |r: &Option<[f64; 2]>| match r {
        Some([low, high]) => format!("{:.1}..{:.1}", low * factor, high * factor),
        None => "-".to_owned(),
    };
    let row = |name: &str, q: &MdhParameters<f64>| {
        format!(
            "{name:7} {:>10.4} {:>10.4} {:>10.4} {:>10.4} {:>10.4}",
            shown(q.alpha.to_degrees()),
            shown(q.a * 1e3),
            shown(q.theta.to_degrees()),
            shown(q.d * 1e3),
            shown(q.beta.to_degrees()),
        )
    };
    let name = format!("{} {}", i + 1, if revolute { "rot" } else { "lin" });
    format!(
        "{}   {:15} {}\n{}\n",
        row(&name, &p.nominal[i].parameters),
        range(&p.limits[i]),
        range(&p.covered[i]),
        row("      +", &p.corrections[i])
    )
}

/// Masses of the links, where there are any.
fn links(p: &Parameters) -> String {
    let Some(m) = &p.masses else { return String::new() };
    let mut text = "\nlink     mass kg   centre of mass mm\n".to_owned();
    for (i, (mass, com)) in m.mass.iter().zip(&m.com).enumerate() {
        text += &format!("{:<4} {:>11.4}   {}\n", i + 1, shown(*mass), vector(com, 1e3));
    }
    text
}

/// Standard deviations from the covariance, as the corrections are printed.
fn uncertainty(blob: &Blob, p: &Parameters) -> String {
    let Some(covariance) = blob.covariance() else {
        return "\ncovariance            none\n".to_owned();
    };
    let (size, kinds) = (covariance.parameters(), p.kinds());
    let mut variance = vec![0.0; size];
    let mut numbers = covariance.factor();
    for column in 0..size {
        for (variance, x) in variance[column..].iter_mut().zip(&mut numbers) {
            *variance += f64::from(x).powi(2);
        }
    }
    let sigma: Vec<f64> = variance.into_iter().map(f64::sqrt).collect();
    let (mm, degrees) = (1e3, 1_f64.to_degrees());
    let three = |at: usize, factor: f64| {
        let [x, y, z] = [0, 1, 2].map(|k| sigma[at + k] * factor);
        format!("{x:.4} {y:.4} {z:.4}")
    };
    let mut text = format!(
        "\ncovariance            of {size} parameters; one standard deviation of each:\n\
         base translation mm   {}\nbase rotation deg     {}\ntool mm               {}\n\
         joint     alpha deg       a mm  theta deg       d mm   beta deg\n",
        three(0, mm),
        three(3, degrees),
        three(6, mm)
    );
    for i in 0..kinds.len() {
        let factors = [degrees, mm, degrees, mm, degrees];
        let cells =
            factors.iter().enumerate().map(|(k, f)| format!(" {:>10.4}", sigma[9 + 5 * i + k] * f));
        text += &format!("{:7}{}\n", i + 1, cells.collect::<String>());
    }
    for (i, term) in p.terms.iter().enumerate() {
        let unit = term.unit(&kinds);
        text += &format!("term {:<3} {:.3e} {unit}\n", i + 1, sigma[9 + 5 * kinds.len() + i]);
    }
    text
}

/// The terms, a line each.
fn terms(terms: &[Term<f64>], kinds: &[JointKind]) -> String {
    let mut text = match terms {
        [] => String::new(),
        _ => "\nterm  effect                   joint  component     order     coefficient\n"
            .to_owned(),
    };
    for (i, t) in terms.iter().enumerate() {
        let (joint, component, order) = term_columns(t, kinds);
        let (name, coefficient) = (t.effect.name(), t.coefficient);
        let line = format!(
            "{:<5} {name:24} {joint:6} {component:10} {order:>8} {coefficient:>16.6e} {}",
            i + 1,
            t.unit(kinds)
        );
        text += &line;
        text.push('\n');
    }
    text
}

/// The curves, a line each.
fn curves(curves: Curves<'_>) -> String {
    let mut text = String::new();
    for (i, curve) in curves.iter().enumerate() {
        if i == 0 {
            text += "\ncurve  effect             joint  nodes  largest mrad  RMS mrad  band mrad  step nrad\n";
        }
        let of_model = ErrorCurve::of_blob(&curve);
        let [largest, rms] = of_model.size().map(|rad| rad * 1e3);
        text += &format!(
            "{:<6} {:18} {:5}  {:5}  {largest:12.4}  {rms:8.4}  {:9.4}  {:9.4}\n",
            i + 1,
            Curve::NAME,
            curve.joint() + 1,
            curve.nodes().len(),
            of_model.band() * 1e3,
            f64::from(curve.step()) * 1e9
        );
        if let Some(gaps) = gaps_in_words(&of_model) {
            text += &format!("       {gaps}\n");
        }
    }
    text
}

/// Where a curve is not known, if there is such a place.
pub(super) fn gaps_in_words(curve: &ErrorCurve) -> Option<String> {
    let band = curve.gap_band()? * 1e3;
    let range =
        |[low, high]: &[f64; 2]| format!("{:.1}..{:.1}", low.to_degrees(), high.to_degrees());
    let ranges: Vec<String> = curve.gap_ranges().iter().map(range).collect();
    Some(format!("not known at {} deg: band {band:.4} mrad there", ranges.join(", ")))
}

/// Joint, component and order of a term as a reader of reports knows them.
pub(crate) fn term_columns(
    term: &Term<f64>,
    kinds: &[JointKind],
) -> (String, &'static str, String) {
    let number = |joint: u8| (u16::from(joint) + 1).to_string();
    let joint = match term.own_joint() {
        Some(joint) if term.effect.is_coupled() => {
            format!("{}>{}", number(term.source), number(joint))
        }
        Some(joint) => number(joint),
        None if term.of_all_links() => "all".to_owned(),
        None => "base".to_owned(),
    };
    let order = match friction(term) {
        Some(friction) => format!("{friction} {}", friction_unit(kinds, term.joint)),
        None if term.effect.order().is_cycles() => term.order.to_string(),
        None if time_constant(std::slice::from_ref(term)) > 0.0 => format!("{} s", term.order),
        None => String::new(),
    };
    (joint, part(term), order)
}

/// Four decimals without a minus zero.
fn shown(x: f64) -> f64 {
    (x * 1e4).round() / 1e4 + 0.0
}

/// An RMS error in mm; a blob has 0 where it is not known.
pub(crate) fn rms(metres: f64) -> String {
    if metres == 0.0 { "not known".to_owned() } else { format!("{:.4}", metres * 1e3) }
}
