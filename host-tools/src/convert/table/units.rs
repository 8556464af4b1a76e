use crate::model::Placement;

/// Units of columns whose names do not tell: how many metres or radians one is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Units {
    /// Of lengths.
    pub length: Option<f64>,
    /// Of angles.
    pub angle: Option<f64>,
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Alpha,
    A,
    Theta,
    D,
    Beta,
    Kind,
    Lower,
    Upper,
    /// The number of the row.
    Number,
}

impl Quantity {
    /// By a name without its unit.
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "alpha" => Self::Alpha,
            "a" | "r" => Self::A,
            "theta" | "theta_offset" | "offset" => Self::Theta,
            "d" | "d_offset" => Self::D,
            "beta" => Self::Beta,
            "kind" | "type" => Self::Kind,
            "lower" | "min" => Self::Lower,
            "upper" | "max" => Self::Upper,
            "joint" | "link" | "i" | "axis" | "name" => Self::Number,
            _ => return None,
        })
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Alpha => "alpha",
            Self::A => "a",
            Self::Theta => "theta_offset",
            Self::D => "d",
            Self::Beta => "beta",
            Self::Kind => "kind",
            Self::Lower => "lower",
            Self::Upper => "upper",
            Self::Number => "joint",
        }
    }

    pub fn is_length(self) -> bool {
        matches!(self, Self::A | Self::D)
    }

    pub fn is_text(self) -> bool {
        matches!(self, Self::Kind | Self::Number)
    }
}

/// A column by its title: `a_mm`, `alpha [rad]`, `θ (deg)`, `d`; what it holds
/// and, where the title says it, how many metres or radians one of it is.
pub(super) fn column(title: &str) -> Option<(Quantity, Option<f64>)> {
    let plain: String = title
        .to_lowercase()
        .replace('α', "alpha")
        .replace('θ', "theta")
        .replace('β', "beta")
        .replace(['[', '(', ' '], "_")
        .replace([']', ')', '"'], "");
    let words: Vec<&str> = plain.split('_').filter(|w| !w.is_empty()).collect();
    let unit = |word: &str| match word {
        "mm" => Some((true, 1e-3)),
        "m" => Some((true, 1.0)),
        "deg" | "degrees" | "°" => Some((false, 1_f64.to_radians())),
        "rad" | "radians" => Some((false, 1.0)),
        _ => None,
    };
    if let [front @ .., last] = words.as_slice()
        && let Some((length, factor)) = unit(last)
        && let Some(quantity) = Quantity::of(&front.join("_"))
    {
        // A limit has the unit of its joint.
        let fits =
            quantity.is_length() == length || matches!(quantity, Quantity::Lower | Quantity::Upper);
        return (fits && !quantity.is_text()).then_some((quantity, Some(factor)));
    }
    Quantity::of(&words.join("_")).map(|quantity| (quantity, None))
}

/// With the minus and the pi of typesetters as a keyboard has them.
fn plain(cell: &str) -> String {
    cell.trim().to_lowercase().replace('−', "-").replace('π', "pi")
}

/// Whether a cell has its number in parts of pi.
pub(super) fn in_turns(cell: &str) -> bool {
    plain(cell).contains("pi")
}

/// A cell: a number, or pi, pi/2, -pi/2 and the like as data sheets have them.
pub(super) fn value(cell: &str) -> Option<f64> {
    let cell = plain(cell);
    if let Ok(value) = cell.parse::<f64>() {
        return Some(value).filter(|v| v.is_finite());
    }
    let (sign, rest) = match cell.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, cell.as_str()),
    };
    let (factor, divisor) = rest.split_once("pi")?;
    let factor: f64 = match factor.trim_end_matches('*') {
        "" => 1.0,
        factor => factor.parse().ok()?,
    };
    let divisor: f64 = match divisor {
        "" => 1.0,
        divisor => divisor.strip_prefix('/')?.parse().ok()?,
    };
    Some(sign * factor * std::f64::consts::PI / divisor).filter(|v| v.is_finite())
}

/// A placement in a remark of a table.
pub(super) fn in_words(name: &str, placement: &Placement) -> String {
    let number = crate::files::number;
    let xyz = crate::units::point_to_mm(&placement.xyz).map(number).join(" ");
    let rpy: [f64; 3] = placement.rpy.into();
    let rpy = rpy.map(|x| number(x.to_degrees())).join(" ");
    format!("# {name} xyz_mm {xyz} rpy_deg {rpy}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles() {
        let degree = Some(1_f64.to_radians());
        for (title, found) in [
            ("a_mm", Some((Quantity::A, Some(1e-3)))),
            ("a [m]", Some((Quantity::A, Some(1.0)))),
            ("α (rad)", Some((Quantity::Alpha, Some(1.0)))),
            ("alpha_deg", Some((Quantity::Alpha, degree))),
            ("theta_offset_deg", Some((Quantity::Theta, degree))),
            ("Theta", Some((Quantity::Theta, None))),
            ("d", Some((Quantity::D, None))),
            ("lower_mm", Some((Quantity::Lower, Some(1e-3)))),
            ("Joint", Some((Quantity::Number, None))),
            ("d_deg", None),
            ("alpha_mm", None),
            ("mass", None),
            ("", None),
        ] {
            assert_eq!(column(title), found, "{title}");
        }
    }

    #[test]
    fn cells() {
        use std::f64::consts::PI;
        for (cell, found) in [
            ("-0.5", Some(-0.5)),
            ("pi", Some(PI)),
            ("-π/2", Some(-PI / 2.0)),
            ("−pi/4", Some(-PI / 4.0)),
            ("3*pi/2", Some(1.5 * PI)),
            ("2pi", Some(2.0 * PI)),
            ("q1", None),
            ("pi/0", None),
            ("nan", None),
            ("", None),
        ] {
            assert_eq!(value(cell), found, "{cell}");
        }
    }
}
