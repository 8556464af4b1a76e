use std::path::Path;

use truearm::blob::Key;

use crate::error::{Error, Place, Result};

/// Reads a key: 32 bytes, or 64 hexadecimal digits as text.
///
/// # Errors
/// A file of another size or with other characters; its content is not shown.
pub fn read_key(path: &Path) -> Result<Key> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    if let Ok(key) = Key::try_from(&bytes[..]) {
        return Ok(key);
    }
    let text = bytes.trim_ascii();
    let mut key = Key::default();
    let (pairs, odd) = text.as_chunks::<2>();
    let hex = pairs.len() == key.len() && odd.is_empty();
    let digits = key.iter_mut().zip(pairs).all(|(byte, pair)| {
        let pair = str::from_utf8(pair).ok().filter(|p| p.bytes().all(|b| b.is_ascii_hexdigit()));
        pair.and_then(|p| u8::from_str_radix(p, 16).ok()).map(|value| *byte = value).is_some()
    });
    if hex && digits {
        return Ok(key);
    }
    Err(Error::file(
        path,
        Place::default(),
        format!("{} bytes are no key", bytes.len()),
        "a key is 32 random bytes, or 64 hexadecimal digits: head -c 32 /dev/urandom > robot.key",
    ))
}
