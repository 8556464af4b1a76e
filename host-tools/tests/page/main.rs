//! report.html.

#[path = "../markup/mod.rs"]
mod markup;
mod page;
