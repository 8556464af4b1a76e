//! Numbers of a model.toml that are none.

use toml::{Table, Value};

/// The first number of a file that is infinite or none, with the key that leads
/// to it, such as `corrections[2].a_mm`.
pub(super) fn unlike_a_number(table: &Table) -> Option<(String, f64)> {
    table.iter().find_map(|(key, value)| of_value(key.clone(), value))
}

fn of_value(key: String, value: &Value) -> Option<(String, f64)> {
    match value {
        Value::Float(x) if !x.is_finite() => Some((key, *x)),
        Value::Array(values) => {
            let mut entries = values.iter().enumerate();
            entries.find_map(|(i, value)| of_value(format!("{key}[{}]", i + 1), value))
        }
        Value::Table(table) => {
            table.iter().find_map(|(inner, value)| of_value(format!("{key}.{inner}"), value))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_is_named() {
        for (text, key) in [
            ("a = 1.0\nb = [1.0, nan]", Some("b[2]")),
            ("[frame]\nxyz_mm = [0.0, inf, 1.0]", Some("frame.xyz_mm[2]")),
            ("[[joints]]\na_mm = 1.0\n[[joints]]\na_mm = -inf", Some("joints[2].a_mm")),
            ("a = 1.0\nname = \"nan\"", None),
        ] {
            let found = unlike_a_number(&text.parse().unwrap());
            assert_eq!(found.map(|(key, _)| key), key.map(str::to_owned), "{text}");
        }
    }
}
