//! What a heading's words mean.

use super::heading::Heading;
use super::unit::Quantity;

/// What a column is by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// A joint; the number as it stands there, from 0 or from 1.
    Joint(usize),
    /// A coordinate of the point: x, y, z are 0, 1, 2.
    Axis(usize),
    /// A component of a quaternion: x, y, z, w are 0 to 3.
    Quaternion(usize),
    /// Roll, pitch, yaw.
    Rpy(usize),
    /// Rx, Ry, Rz: roll, pitch, yaw to some, a rotation vector to others.
    Turn(usize),
    /// An entry of a rotation matrix: row and column from 0.
    Matrix(usize, usize),
    /// The side a joint came to rest from, from 1.
    Direction(usize),
    /// Tracker station.
    Station,
    /// Target on the arm.
    Marker,
    /// Series.
    Series,
    /// Order of measurement.
    Order,
    /// Time.
    Time,
    /// Date of a time of day.
    Date,
    /// Temperature.
    Temperature,
    /// Payload.
    Payload,
    /// Standard deviation of a coordinate.
    Sigma,
}

/// A role, whose columns belong together, and how likely it is what was
/// measured rather than what was commanded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// What it is.
    pub role: Role,
    /// The words that the columns of a group share.
    pub family: String,
    /// Larger is likelier; below 0 it is something else than a measurement.
    pub preference: i32,
}

const JOINT: [&str; 23] = [
    "q",
    "j",
    "joint",
    "joints",
    "theta",
    "th",
    "θ",
    "axis",
    "a",
    "ax",
    "jt",
    "enc",
    "encoder",
    "achse",
    "gelenk",
    "angle",
    "phi",
    "jointangle",
    "jointpos",
    "qpos",
    "position",
    "pos",
    "winkel",
];
const UR: [&str; 6] = ["shoulder pan", "shoulder lift", "elbow", "wrist 1", "wrist 2", "wrist 3"];
const MOTOMAN: [&str; 6] = ["s", "l", "u", "r", "b", "t"];
const MEASURED: [&str; 12] = [
    "act", "actual", "meas", "measured", "ist", "tracker", "leica", "lt", "laser", "smr", "faro",
    "gemessen",
];
const OTHER: [&str; 31] = [
    "cmd",
    "goal",
    "planned",
    "command",
    "commanded",
    "nominal",
    "nom",
    "soll",
    "desired",
    "des",
    "ref",
    "reference",
    "fk",
    "error",
    "err",
    "delta",
    "dev",
    "deviation",
    "diff",
    "std",
    "sigma",
    "uncertainty",
    "residual",
    "vel",
    "velocity",
    "acc",
    "torque",
    "current",
    "effort",
    "setpoint",
    "d",
];
/// The controller's own idea of where the tool is; better than nothing.
const CONTROLLER: [&str; 3] = ["tcp", "target", "controller"];

impl Named {
    /// By the words of a heading; `None` if they say nothing.
    #[must_use]
    pub fn of(heading: &Heading) -> Option<Self> {
        let words: Vec<&str> = heading.words.iter().map(String::as_str).collect();
        let clock = heading.unit.is_some_and(|unit| unit.quantity() == Quantity::Time);
        let (role, family) = (words == ["t"] && clock)
            .then(|| (Role::Time, String::new()))
            .or_else(|| single(&words))
            .or_else(|| orientation(&words))
            .or_else(|| listed(&words))
            .or_else(|| axis(&words))
            .or_else(|| numbered(&words))?;
        let any = |of: &[&str]| i32::from(words.iter().any(|w| of.contains(w)));
        let preference = 2 * any(&MEASURED) - 8 * any(&OTHER) - any(&CONTROLLER);
        Some(Self { role, family, preference })
    }
}

/// Names that stand alone.
fn single(words: &[&str]) -> Option<(Role, String)> {
    let role = match words {
        ["station" | "tracker" | "instrument"] | ["tracker", "station"] => Role::Station,
        ["marker" | "smr" | "reflector" | "prism"] => Role::Marker,
        ["series" | "serie" | "session" | "batch" | "run"] => Role::Series,
        ["order" | "index" | "nr" | "no" | "idx" | "row"] => Role::Order,
        ["time" | "timestamp" | "zeit" | "datetime" | "uhrzeit"] | ["time", "stamp"] => Role::Time,
        ["date" | "datum"] => Role::Date,
        ["temperature" | "temp" | "temperatur"] | ["air" | "ambient", "temperature" | "temp"] => {
            Role::Temperature
        }
        ["payload"] | ["payload", "mass"] => Role::Payload,
        ["sigma"] => Role::Sigma,
        ["dir", number] => Role::Direction(number.parse().ok()?),
        _ => return None,
    };
    Some((role, String::new()))
}

/// Names of orientations: `qw`, `quat_x`, `orientation.w`, `roll`, `Rx`, `r11`.
fn orientation(words: &[&str]) -> Option<(Role, String)> {
    let (last, before) = words.split_last()?;
    let family = before.join(" ");
    let component = |c: &str| ["x", "y", "z", "w"].iter().position(|known| *known == c);
    let one = |c: Option<&str>| c.and_then(component);
    let quaternion = one(last.strip_prefix("q")).or_else(|| {
        let of = ["q", "quat", "quaternion", "orientation", "ori"];
        before.last().filter(|w| of.contains(w)).and_then(|_| component(last))
    });
    if let Some(c) = quaternion {
        return Some((Role::Quaternion(c), family));
    }
    if let Some(c) = ["roll", "pitch", "yaw"].iter().position(|name| name == last) {
        return Some((Role::Rpy(c), family));
    }
    let turn = one(last.strip_prefix("r")).or_else(|| {
        before.last().filter(|w| ["r", "rot", "rotvec"].contains(w)).and_then(|_| component(last))
    });
    if let Some(c) = turn.filter(|c| *c < 3) {
        return Some((Role::Turn(c), family));
    }
    let entry = |digits: &str| match digits.as_bytes() {
        [row @ b'1'..=b'3', column @ b'1'..=b'3'] => {
            Some(Role::Matrix(usize::from(row - b'1'), usize::from(column - b'1')))
        }
        _ => None,
    };
    match before.last() {
        Some(&("r" | "rot" | "m")) => Some((entry(last)?, family)),
        _ => {
            let column = ["n", "o", "a"].iter().position(|c| last.starts_with(c))?;
            let row = component(last.get(1..)?)?;
            (row < 3).then(|| (Role::Matrix(row, column), format!("{family} noa")))
        }
    }
}

/// Joints that have names: those of the UR in ROS, Yaskawa's letters.
fn listed(words: &[&str]) -> Option<(Role, String)> {
    let rest: Vec<&str> = words.iter().copied().filter(|w| *w != "joint").collect();
    let text = rest.join(" ");
    for (place, name) in UR.iter().enumerate() {
        if let Some(at) = text.find(name) {
            let family = [&text[..at], "ur", &text[at + name.len()..]].concat();
            return Some((Role::Joint(place + 1), family));
        }
    }
    let letter = MOTOMAN.iter().position(|l| words == [*l] || words == ["axis", l])?;
    Some((Role::Joint(letter + 1), "slurbt".to_owned()))
}

/// `x`, `px`, `pos_x`, `measured Y`.
fn axis(words: &[&str]) -> Option<(Role, String)> {
    let letters = ["x", "y", "z"];
    let place = |word: &str| {
        let bare = ["pos", "p", "t", "meas", "m"].iter().find_map(|p| word.strip_prefix(p));
        letters.iter().position(|l| *l == word || bare == Some(*l))
    };
    let at = words.iter().rposition(|w| place(w).is_some())?;
    let family: Vec<&str> = [&words[..at], &words[at + 1..]].concat();
    Some((Role::Axis(place(words[at])?), family.join(" ")))
}

/// A joint's word and a number.
fn numbered(words: &[&str]) -> Option<(Role, String)> {
    let at = words.iter().rposition(|w| w.parse::<usize>().is_ok_and(|n| n <= 64))?;
    let rest = [&words[..at], &words[at + 1..]].concat();
    let known = |w: &&str| JOINT.contains(w) || w.ends_with("joint");
    rest.iter()
        .any(known)
        .then(|| (words[at].parse().unwrap_or(0), rest.join(" ")))
        .map(|(number, family)| (Role::Joint(number), family))
}

/// The column of a measurements.csv that a heading may stand for, the joint
/// counted as it is there; `None` if the words say nothing.
#[must_use]
pub fn suggestion(text: &str) -> Option<String> {
    let named = Named::of(&Heading::new(text)).filter(|named| named.preference >= 0)?;
    Some(match named.role {
        Role::Joint(number) => format!("q{number}"),
        Role::Axis(axis) => ["x", "y", "z"][axis.min(2)].to_owned(),
        Role::Quaternion(c) => ["qx", "qy", "qz", "qw"][c.min(3)].to_owned(),
        Role::Rpy(_) | Role::Turn(_) | Role::Matrix(..) | Role::Date => return None,
        Role::Direction(joint) => format!("dir{joint}"),
        Role::Station => "station".to_owned(),
        Role::Marker => "marker".to_owned(),
        Role::Series => "series".to_owned(),
        Role::Order => "order".to_owned(),
        Role::Time => "time_s".to_owned(),
        Role::Temperature => "temperature_c".to_owned(),
        Role::Payload => "payload_kg".to_owned(),
        Role::Sigma => "sigma_mm".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_roles() {
        let role = |text: &str| Named::of(&Heading::new(text)).map(|named| named.role);
        for (text, expected) in [
            ("q1_deg", Role::Joint(1)),
            ("Achse 3 [°]", Role::Joint(3)),
            ("panda_joint7", Role::Joint(7)),
            ("actual_q_0", Role::Joint(0)),
            ("wrist_2_joint", Role::Joint(5)),
            ("U", Role::Joint(3)),
            ("X", Role::Axis(0)),
            ("Measured Z [mm]", Role::Axis(2)),
            ("py", Role::Axis(1)),
            ("qw", Role::Quaternion(3)),
            ("pose.orientation.x", Role::Quaternion(0)),
            ("yaw", Role::Rpy(2)),
            ("Rx", Role::Turn(0)),
            ("r23", Role::Matrix(1, 2)),
            ("oz", Role::Matrix(2, 1)),
            ("dir4", Role::Direction(4)),
            ("Temperatur [°C]", Role::Temperature),
            ("Uhrzeit", Role::Time),
            ("Zeit [min]", Role::Time),
            ("Datum", Role::Date),
        ] {
            assert_eq!(role(text), Some(expected), "{text}");
        }
        for text in ["comment", "operator", "gain 3"] {
            assert_eq!(role(text), None, "{text}");
        }
        let preference = |text: &str| Named::of(&Heading::new(text)).map(|n| n.preference);
        assert!(preference("X nominal") < preference("X"));
        assert!(preference("goal_x_mm") < preference("x_mm"));
        assert!(preference("X") < preference("X actual"));
    }
}
