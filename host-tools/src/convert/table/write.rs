use truearm::{JointKind, Link, LinkParameter};

use super::units::in_words;
use crate::convert::Identified;
use crate::convert::axes::{Convention, Described};
use crate::convert::reach::farthest;
use crate::files::{csv_text, number};
use crate::model::{Model, Placement};
use crate::units::{link_unit, to_mm};

const KIND: [&str; 2] = ["revolute", "prismatic"];

/// The identified links as `Rx(alpha) Tx(a) Rz(theta_offset + q) Tz(d) Ry(beta)`,
/// with base and target in remarks above.
#[must_use]
pub fn mdh_csv(arm: &Identified) -> String {
    let titles = ["kind", "alpha_deg", "a_mm", "theta_offset_deg", "d_mm", "beta_deg"];
    let row = |link: &Link<f64>| {
        let values = LinkParameter::ALL.into_iter().zip(link.parameters.to_array());
        let cells = values.map(|(p, value)| number(value * link_unit(p).1));
        std::iter::once(kind(link)).chain(cells).collect()
    };
    "# Rx(alpha) Tx(a) Rz(theta_offset + q) Tz(d) Ry(beta), modified Denavit-Hartenberg and beta\n"
        .to_owned()
        + &in_words("base", &Placement::of(&arm.base))
        + &in_words("tool", &Placement::of(&arm.tool))
        + &csv_text(titles, arm.links.iter().map(row))
}

/// An identified arm in the standard convention.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardDh {
    /// The links, still as modified ones without beta.
    pub described: Described,
    /// How far the tool point is off where axes had to be made parallel: the
    /// largest distance over seeded poses, m; 0 where nothing was changed.
    pub deviation: f64,
}

/// The same axes in space without beta. Exact, unless axes are so nearly
/// parallel that their common normal is out of reach: these are made parallel.
#[must_use]
pub fn standard_dh(model: &Model, arm: &Identified) -> StandardDh {
    let described = arm.axes().describe(Convention::Dh);
    let changed = Identified {
        base: described.base,
        links: described.links.clone(),
        tool: described.tool,
        marker: arm.marker.clone(),
    };
    let deviation =
        if described.straightened.is_empty() { 0.0 } else { farthest(model, arm, &changed) };
    StandardDh { described, deviation }
}

/// As `Rz(theta_offset + q) Tz(d) Tx(a) Rx(alpha)`, with base and target in
/// remarks above.
#[must_use]
pub fn standard_dh_csv(dh: &StandardDh) -> String {
    let Described { base, links, tool, .. } = &dh.described;
    let titles = ["kind", "theta_offset_deg", "d_mm", "a_mm", "alpha_deg"];
    let row = |(i, link): (usize, &Link<f64>)| {
        let p = &link.parameters;
        let next = links.get(i + 1).map_or((0.0, 0.0), |l| (l.parameters.a, l.parameters.alpha));
        let values = [p.theta.to_degrees(), to_mm(p.d), to_mm(next.0), next.1.to_degrees()];
        std::iter::once(kind(link)).chain(values.map(number)).collect()
    };
    "# Rz(theta_offset + q) Tz(d) Tx(a) Rx(alpha), standard Denavit-Hartenberg\n".to_owned()
        + &in_words("base", &Placement::of(base))
        + &in_words("tool", &Placement::of(tool))
        + &csv_text(titles, links.iter().enumerate().map(row))
}

fn kind(link: &Link<f64>) -> String {
    KIND[usize::from(link.kind == JointKind::Prismatic)].to_owned()
}
