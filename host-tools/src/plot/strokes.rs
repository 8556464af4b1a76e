//! What frames and series are both drawn with: texts, dashes, shapes, coordinates.

use crate::markup::{Element, element};

/// Colours for the shapes of which there are fewer.
const SHAPES: usize = 5;

/// A text of a drawing.
pub(super) fn text(x: f64, y: f64, text: &str) -> Element {
    element("text").with("x", number(x)).with("y", number(y)).text(text)
}

/// Dashes of lines of an ink.
pub(super) fn dashes(ink: usize) -> &'static str {
    ["none", "7 3", "2 3", "9 3 2 3", "none", "4 2", "none", "7 3", "none", "2 3"][ink % 10]
}

/// The shape of an ink about a point.
pub(super) fn shape(ink: usize, x: f64, y: f64) -> String {
    let at = |dx: f64, dy: f64| format!("{} {}", number(x + dx), number(y + dy));
    match ink % SHAPES {
        0 => format!("M{}a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z", at(-3.0, 0.0)),
        1 => format!("M{}h5.4v5.4h-5.4z", at(-2.7, -2.7)),
        2 => format!("M{}l3.6 6.4h-7.2z", at(0.0, -3.8)),
        3 => format!("M{}l3.8 3.8l-3.8 3.8l-3.8 -3.8z", at(0.0, -3.8)),
        _ => format!("M{}l3.6 -6.4h-7.2z", at(0.0, 3.8)),
    }
}

/// A coordinate of a drawing.
pub(super) fn number(value: f64) -> String {
    let tenths = (value * 10.0).round() / 10.0 + 0.0;
    format!("{tenths}")
}
