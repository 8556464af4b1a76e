use std::path::Path;

use crate::error::{Error, ErrorKind, Place, Result};
use crate::files;

/// A memory region of a linker script.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryRegion {
    /// As written: `PARAM_A`.
    pub name: String,
    /// First address.
    pub origin: u32,
    /// Bytes.
    pub length: u32,
}

/// The regions of the `MEMORY` command of a linker script.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryRegions(Vec<MemoryRegion>);

const HELP: &str = "give the linker script of the firmware with --memory FILE; its MEMORY command must \
                    have PARAM_A and PARAM_B, as memory.x of truearm shows";

impl MemoryRegions {
    /// Reads the `MEMORY` command: `NAME (attributes) : ORIGIN = n, LENGTH = n`,
    /// numbers decimal, 0x, or with K or M.
    ///
    /// # Errors
    /// Names file, line and what cannot be read there.
    pub fn read(path: &Path) -> Result<Self> {
        if !path.exists() {
            let looked = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
            let message = format!(
                "the linker script that says where the slots are is not there: looked for {}",
                looked.display()
            );
            return Err(Error::data(ErrorKind::NoSlot, message, HELP));
        }
        Self::parse(path, &files::read(path)?)
    }

    /// Like [`MemoryRegions::read`] from a text.
    ///
    /// # Errors
    /// As for [`MemoryRegions::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let text = without_comments(text);
        let fail = |at: usize, message: String| {
            Error::file(
                path,
                Place::line(Place::offset(&text, at).line.unwrap_or(1)),
                message,
                HELP,
            )
        };
        let start = text.find("MEMORY").ok_or_else(|| fail(0, "no MEMORY command".to_owned()))?;
        let open = text[start..].find('{').map(|i| start + i + 1);
        let close = open.and_then(|open| text[open..].find('}').map(|i| open + i));
        let (Some(open), Some(close)) = (open, close) else {
            return Err(fail(start, "MEMORY without { and }".to_owned()));
        };
        let mut regions = Vec::new();
        let mut at = open;
        for line in text[open..close].split_inclusive('\n') {
            if !line.trim().is_empty() {
                let region = region(line).map_err(|message| fail(at, message))?;
                regions.push(region);
            }
            at += line.len();
        }
        Ok(Self(regions))
    }

    /// The region of a name.
    ///
    /// # Errors
    /// None of that name, naming those there are.
    pub fn find(&self, path: &Path, name: &str) -> Result<&MemoryRegion> {
        self.0.iter().find(|r| r.name == name).ok_or_else(|| {
            let names: Vec<&str> = self.0.iter().map(|r| &*r.name).collect();
            let has = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
            Error::file(path, Place::default(), format!("no region {name}, it has {has}"), HELP)
        })
    }
}

/// Comments become blanks, so that lines keep their numbers.
fn without_comments(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, comment)) = rest.split_once("/*") {
        out += before;
        let (comment, behind) = comment.split_once("*/").unwrap_or((comment, ""));
        out.extend(comment.chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
        rest = behind;
    }
    out + rest
}

fn region(line: &str) -> std::result::Result<MemoryRegion, String> {
    let wrong = || format!("`{}` is no region NAME : ORIGIN = address, LENGTH = size", line.trim());
    let (name, values) = line.split_once(':').ok_or_else(wrong)?;
    let name = name.split('(').next().unwrap_or("").trim();
    let (origin, length) = values.split_once(',').ok_or_else(wrong)?;
    let value = |text: &str, names: [&str; 3]| {
        let (key, value) = text.split_once('=').ok_or_else(wrong)?;
        if !names.contains(&key.trim()) {
            return Err(wrong());
        }
        number(value.trim())
            .ok_or_else(|| format!("{name}: `{}` is no number of 32 bits", value.trim()))
    };
    Ok(MemoryRegion {
        name: name.to_owned(),
        origin: value(origin, ["ORIGIN", "org", "o"])?,
        length: value(length, ["LENGTH", "len", "l"])?,
    })
}

fn number(text: &str) -> Option<u32> {
    let (digits, factor) = match text.strip_suffix(['K', 'k']) {
        Some(digits) => (digits, 1 << 10),
        None => text.strip_suffix(['M', 'm']).map_or((text, 1), |digits| (digits, 1 << 20)),
    };
    let value = match digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        Some(hex) => u32::from_str_radix(hex, 16).ok()?,
        None => digits.parse().ok()?,
    };
    value.checked_mul(factor)
}
