//! Bytes of a text file as text, whatever program wrote them.

use std::path::Path;

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

use crate::error::{Error, Place, Result};

/// A text, and how it was encoded.
pub(super) struct Decoded {
    pub text: String,
    /// As WHATWG names it, in lower case.
    pub encoding: String,
    /// What says so.
    pub because: &'static str,
}

/// Formats that are known by their first bytes, and what to do about each.
const FOREIGN: [(&[u8], &str, &str); 6] = [
    (b"MATLAB 5.0", "a MATLAB file", MATLAB),
    (b"\x89HDF", "an HDF5 file (MATLAB 7.3 writes such)", MATLAB),
    (
        b"\x93NUMPY",
        "a NumPy array",
        "save it as CSV: python3 -c \"import numpy as n; n.savetxt('FILE.csv', n.load('INPUT'), \
         delimiter=',', fmt='%.17g')\"",
    ),
    (
        b"PAR1",
        "a Parquet file",
        "save it as CSV: python3 -c \"import pandas as p; \
         p.read_parquet('INPUT').to_csv('FILE.csv', index=False)\"",
    ),
    (b"%PDF", "a PDF", "export the table from the program that made it, as CSV or .xlsx"),
    (b"\x1f\x8b", "compressed with gzip", "unpack it first: gunzip INPUT"),
];
/// MATLAB's containers are private to it; one line of either program opens them.
const MATLAB: &str = "save the variable as CSV, in MATLAB: writematrix(NAME, 'FILE.csv') after load; \
    in Python: python3 -c \"import scipy.io as s, numpy as n; n.savetxt('FILE.csv', \
    s.loadmat('INPUT')['NAME'], delimiter=',', fmt='%.17g')\" (s.whosmat('INPUT') lists the \
    names; h5py opens files of version 7.3)";

/// Refuses what is no table, by what it is.
pub(super) fn refuse_foreign(path: &Path, bytes: &[u8]) -> Result<()> {
    let mat = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mat"));
    let known = FOREIGN.iter().find(|(magic, _, _)| bytes.starts_with(magic));
    let (what, help) = match known {
        Some((_, what, help)) => (*what, *help),
        None if mat => ("a MATLAB file", MATLAB),
        None => return Ok(()),
    };
    let stem = path.file_stem().map_or("FILE".into(), |s| s.to_string_lossy().into_owned());
    let help = help.replace("FILE", &stem).replace("INPUT", &path.display().to_string());
    Err(Error::file(path, Place::default(), format!("{what}, not a table"), help))
}

/// Decodes text: by `asked` if given, else by the byte-order mark, by zeros in
/// every second byte, as UTF-8 if it is that, and as Windows-1252 otherwise.
///
/// # Errors
/// An unknown encoding, bytes that are none of it, and files that are no text.
pub(super) fn decode(path: &Path, bytes: &[u8], asked: Option<&str>) -> Result<Decoded> {
    refuse_foreign(path, bytes)?;
    let (encoding, because) = match asked {
        Some(label) => (labelled(label)?, "it was asked for"),
        None => detect(path, bytes)?,
    };
    let (text, used, wrong) = encoding.decode(bytes);
    if wrong {
        let at = text.find('\u{fffd}').unwrap_or(0);
        return Err(Error::file(
            path,
            Place::line(text[..at].matches('\n').count() + 1),
            format!("bytes that are no {}", used.name()),
            "say what it is: --encoding utf-8, windows-1252, utf-16le, ...",
        ));
    }
    // Lines end in as many ways as there were systems.
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    Ok(Decoded { text, encoding: used.name().to_lowercase(), because })
}

fn labelled(label: &str) -> Result<&'static Encoding> {
    Encoding::for_label(label.as_bytes()).ok_or_else(|| {
        Error::usage(
            format!("encoding \"{label}\""),
            "give one of utf-8, utf-16le, utf-16be, windows-1252 (latin1), shift_jis, gb18030, ...",
        )
    })
}

fn detect(path: &Path, bytes: &[u8]) -> Result<(&'static Encoding, &'static str)> {
    if let Some((encoding, _)) = Encoding::for_bom(bytes) {
        return Ok((encoding, "its byte-order mark says so"));
    }
    let zeros = |from: usize| bytes.iter().skip(from).step_by(2).filter(|b| **b == 0).count();
    // Digits and separators have a zero in every second byte.
    let most = bytes.len() * 3 / 10;
    if zeros(1) > most && zeros(0) == 0 {
        return Ok((UTF_16LE, "every second byte is zero"));
    }
    if zeros(0) > most && zeros(1) == 0 {
        return Ok((UTF_16BE, "every second byte is zero"));
    }
    if bytes.contains(&0) {
        let help = "give text (CSV, TSV, columns), .xlsx, .xls or .ods";
        return Err(Error::file(path, Place::default(), "no text and no spreadsheet", help));
    }
    match str::from_utf8(bytes) {
        Ok(_) => Ok((UTF_8, "all bytes are UTF-8")),
        Err(_) => Ok((WINDOWS_1252, "some bytes are no UTF-8")),
    }
}
