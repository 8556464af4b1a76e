//! What stands in comments of files that are written.

/// On one line, without control characters: what others named may hold either, and TOML
/// takes neither in a comment.
pub fn on_one_line(text: &str) -> String {
    let between = |c: char| c.is_whitespace() || c.is_control();
    text.split(between).filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
}
