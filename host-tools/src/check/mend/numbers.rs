//! Numbers of a TOML file, set so that all around them stays.

use toml_edit::{Item, TableLike, Value};

use crate::check::words::tidy;

/// Whether a length is nearer to the usual one once it is scaled; always, where there is none.
pub fn nearer(length: f64, (scale, usual): (f64, f64)) -> bool {
    let farther = |length: f64| (length / usual).ln().abs();
    length > 0.0 && (usual.is_infinite() || farther(length * scale) < farther(length))
}

/// Scales the numbers of a key where they are then nearer to the usual one.
pub fn rescale(table: &mut dyn TableLike, key: &str, by: (f64, f64)) {
    let Some(all) = numbers(table, key) else { return };
    let far = all.iter().fold(0.0_f64, |far, x| far.max(x.abs()));
    if nearer(far, by) {
        let scaled = all.iter().map(|x| scaled_number(*x, by.0));
        let single = table.get(key).is_some_and(|item| item.as_array().is_none());
        let value = if single { scaled.clone().next() } else { None };
        set(table, key, value.unwrap_or_else(|| scaled.collect()));
    }
}

/// The numbers of a key: one, or a list.
pub fn numbers(table: &dyn TableLike, key: &str) -> Option<Vec<f64>> {
    let item = table.get(key)?;
    match item.as_array() {
        Some(all) => all.iter().map(|v| number(&Item::Value(v.clone()))).collect(),
        None => number(item).map(|one| vec![one]),
    }
}

/// A number of a file, whole or not.
fn number(item: &Item) -> Option<f64> {
    item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64))
}

/// Nine decimals: a picometre.
fn scaled_number(value: f64, scale: f64) -> Value {
    ((value * scale * 1e9).round() / 1e9).into()
}

/// A file's angles are within a turn.
pub fn within_a_turn(key: &str, value: f64) -> f64 {
    let angle = key.ends_with("_deg") && value.abs() > 180.0;
    let value = if angle { value - 360.0 * (value / 360.0).round() } else { value };
    tidy(value).parse().unwrap_or(value)
}

/// Another value of a key; blanks and comments around it stay.
pub fn set(table: &mut dyn TableLike, key: &str, mut value: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(stood) => {
            *value.decor_mut() = stood.decor().clone();
            *stood = value;
        }
        None => {
            table.insert(key, Item::Value(value));
        }
    }
}

#[cfg(test)]
mod tests {
    use toml_edit::DocumentMut;

    use super::*;
    use crate::files::tables;

    #[test]
    fn a_number_keeps_what_stands_around_it() {
        let text = "# arm\njoints = [\n  { alpha_deg = 0, a_mm = 12.5 }, # first\n]\n";
        let mut document: DocumentMut = text.parse().unwrap();
        set(tables(&mut document, "joints")[0], "a_mm", (-12.5).into());
        assert_eq!(document.to_string(), text.replace("12.5", "-12.5"));
        let text = "[[joints]]\na_mm   =  12.5  # by hand\n\n[[joints]]\na_mm = 1\n";
        let mut document: DocumentMut = text.parse().unwrap();
        set(tables(&mut document, "joints")[0], "a_mm", 25.0.into());
        assert_eq!(document.to_string(), text.replace("12.5", "25.0"));
    }
}
