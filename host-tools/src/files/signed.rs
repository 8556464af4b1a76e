//! Files that a user may go on to edit: they carry a digest, so that writing
//! one again does not take the user's work away.

use std::path::Path;

use super::digest::of_text;
use crate::error::{Error, Place, Result};

const MARK: &str = "truearm digest ";

/// How a kind of file writes a remark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comment {
    /// TOML, YAML and CSV: `# ...`
    Hash,
    /// XML, behind the line that says so: `<!-- ... -->`
    Xml,
}

/// The text under its digest. An XML text is given without its first line,
/// `<?xml version="1.0"?>`.
#[must_use]
pub fn signed(comment: Comment, body: &str) -> String {
    let mark = format!("{MARK}{} of all below", of_text(body));
    match comment {
        Comment::Hash => format!("# {mark}\n{body}"),
        Comment::Xml => format!("<?xml version=\"1.0\"?>\n<!-- {mark} -->\n{body}"),
    }
}

/// Whether a file may be written here: it is not there yet, or it stands there
/// as truearm wrote it, or `force` is given.
///
/// # Errors
/// It would be lost what somebody else wrote.
pub fn overwritable(path: &Path, force: bool) -> Result<()> {
    let file = std::fs::metadata(path).is_ok_and(|m| m.is_file());
    if force || !file {
        return Ok(());
    }
    let text = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    match std::str::from_utf8(&text) {
        Ok(text) if is_own(text) => Ok(()),
        _ => Err(foreign(path)),
    }
}

/// The same of a table or a program, which other programs read and which
/// therefore carries no digest: what stands there begins with the line that the
/// verb is about to write (of a table: its columns) or is that very text.
///
/// # Errors
/// As for [`overwritable`].
pub fn overwritable_like(path: &Path, text: &str, force: bool) -> Result<()> {
    let file = std::fs::metadata(path).is_ok_and(|m| m.is_file());
    if force || !file {
        return Ok(());
    }
    let stands = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let first = text.lines().next().unwrap_or("");
    let alike = !first.trim().is_empty()
        && std::str::from_utf8(&stands).is_ok_and(|old| old.lines().next() == Some(first));
    if alike || stands == text.as_bytes() { Ok(()) } else { Err(foreign(path)) }
}

/// The refusal: what stands there is not of truearm's making.
#[must_use]
pub fn foreign(path: &Path) -> Error {
    Error::file(
        path,
        Place::default(),
        "the file is there, and it is not as truearm wrote it",
        "give another name, or --force to overwrite it",
    )
}

/// Whether the text is as it was written.
fn is_own(text: &str) -> bool {
    if let Ok(serde_json::Value::Object(json)) = serde_json::from_str(text) {
        return json
            .get("schema")
            .and_then(|s| s.as_str())
            .is_some_and(|s| s.starts_with("truearm-"));
    }
    let mut rest = text;
    for _ in 0..2 {
        let Some((line, below)) = rest.split_once('\n') else { return false };
        if let Some((_, digest)) = line.split_once(MARK) {
            return digest.split(' ').next() == Some(of_text(below).as_str());
        }
        rest = below;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_edited_is_kept() {
        for comment in [Comment::Hash, Comment::Xml] {
            let text = signed(comment, "a = 1\nb = 2\n");
            assert!(is_own(&text));
            assert!(!is_own(&text.replace("b = 2", "b = 3")), "{text}");
            assert!(!is_own(&(text + "c = 3\n")));
        }
        assert!(is_own("{\"schema\": \"truearm-export-1\"}"));
        for other in ["", "a = 1\n", "{}", "{\"schema\": \"urdf\"}", "# truearm digest \n"] {
            assert!(!is_own(other), "{other}");
        }
    }

    #[test]
    fn a_file_of_others_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("robot.toml");
        overwritable(&path, false).unwrap();
        std::fs::write(&path, signed(Comment::Hash, "a = 1\n")).unwrap();
        overwritable(&path, false).unwrap();
        std::fs::write(&path, "a = 1\n").unwrap();
        let error = overwritable(&path, false).unwrap_err();
        assert!(error.help().contains("--force"), "{error}");
        overwritable(&path, true).unwrap();
    }

    #[test]
    fn tables_are_known_by_their_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("told.csv");
        let like = |stands: &str, text: &str| {
            std::fs::write(&path, stands).unwrap();
            overwritable_like(&path, text, false).is_ok()
        };
        assert!(like("a,b\n1,2\n", "a,b\n3,4\n"));
        assert!(like("", "") && like("\nx", "\nx"));
        assert!(!like("a,b,c\n1,2,3\n", "a,b\n3,4\n"));
        assert!(!like("\nx", "\ny") && !like("notes", "a,b\n3,4\n"));
    }
}
