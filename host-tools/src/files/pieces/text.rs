//! Tables in texts, cut between rows.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::super::instruments::Gathered;
use super::super::reading::{Reading, headings};
use super::super::source::Source;
use crate::error::{Error, Place, Result};
use crate::model::{Measurements, Robot};

/// Bytes of a piece, about: some thousands of rows.
const PIECE: u64 = 1 << 19;

/// Where a piece is in its file.
struct Cut {
    from: u64,
    to: u64,
    /// Lines before it.
    lines: usize,
}

/// A text in pieces.
pub struct Text {
    names: Vec<String>,
    cuts: Vec<Cut>,
    lines: usize,
}

impl Text {
    /// Cuts a file where a row ends and none is quoted.
    pub fn open(path: &Path) -> Result<Self> {
        let mut cuts: Vec<Cut> = Vec::new();
        let mut first = Cut { from: 0, to: 0, lines: 0 };
        let end = walk(path, &mut |at, lines| {
            if at - first.from >= PIECE {
                cuts.push(Cut { to: at, ..first });
                first = Cut { from: at, to: at, lines };
            }
        })?;
        let (at, lines) = end;
        if at > first.from || cuts.is_empty() {
            cuts.push(Cut { to: at, ..first });
        }
        let head = text(path, &cuts[0])?;
        let source = Source { path, text: &head };
        source.refuse_toml()?;
        Ok(Self { names: headings(&source)?, cuts, lines })
    }

    pub fn pieces(&self) -> usize {
        self.cuts.len()
    }

    pub fn rows(&self) -> usize {
        self.lines.saturating_sub(1)
    }

    /// Reads a piece.
    pub fn read(
        &self,
        (path, piece): (&Path, usize),
        robot: &Robot,
        book: &Gathered,
        with: &mut dyn FnMut(Measurements) -> Result<()>,
    ) -> Result<()> {
        let cut = &self.cuts[piece];
        let text = text(path, cut)?;
        let source = Source { path, text: &text };
        let asked = (Some("q"), true);
        let reading = Reading::begin(source, &self.names, robot, asked, book.clone())?;
        let mut reading = reading.each_by_itself();
        let mut reader = super::super::csv_reader(&text, piece == 0);
        // A line of a piece is another one of the text that an error would show.
        let shown = |error: Error| if piece == 0 { error } else { error.without_excerpt() };
        reading.lines(&mut reader, cut.lines).map_err(shown)?;
        match reading.rows() {
            0 => Ok(()),
            _ => with(reading.end().map_err(shown)?),
        }
    }
}

/// The text of a piece, without the mark that some programs begin a file with.
fn text(path: &Path, cut: &Cut) -> Result<String> {
    let error = |e| Error::io(path, e);
    let mut file = File::open(path).map_err(error)?;
    file.seek(SeekFrom::Start(cut.from)).map_err(error)?;
    let mut bytes = Vec::with_capacity((cut.to - cut.from) as usize);
    file.take(cut.to - cut.from).read_to_end(&mut bytes).map_err(error)?;
    if bytes.starts_with("\u{feff}".as_bytes()) && cut.from == 0 {
        bytes.drain(..3);
    }
    String::from_utf8(bytes).map_err(|e| {
        let before = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = cut.lines + before.iter().filter(|byte| **byte == b'\n').count() + 1;
        let help = "save the file as UTF-8; `truearm import` reads tables of any encoding";
        Error::file(path, Place::line(line), "not UTF-8 text", help)
    })
}

/// Lines of a file that are no remarks.
pub fn lines(path: &Path) -> Result<usize> {
    walk(path, &mut |_, _| ()).map(|(_, lines)| lines)
}

/// Calls with where each row ends, in bytes and lines; where the file ends.
fn walk(path: &Path, ended: &mut dyn FnMut(u64, usize)) -> Result<(u64, usize)> {
    let error = |e| Error::io(path, e);
    let mut file = BufReader::with_capacity(1 << 20, File::open(path).map_err(error)?);
    let (mut at, mut lines, mut quoted, mut remark, mut begins) = (0, 0, false, false, true);
    loop {
        let block = file.fill_buf().map_err(error)?;
        if block.is_empty() {
            return Ok((at, lines + usize::from(!begins)));
        }
        let length = block.len();
        for (k, byte) in block.iter().enumerate() {
            match byte {
                b'\n' => {
                    (lines, remark) = (lines + 1, false);
                    begins = true;
                    if !quoted {
                        ended(at + k as u64 + 1, lines);
                    }
                    continue;
                }
                b'#' if begins && !quoted => remark = true,
                b'"' if !remark => quoted = !quoted,
                _ => {}
            }
            begins = false;
        }
        at += length as u64;
        file.consume(length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever stands in it, pieces are the file, and no row is cut.
    #[test]
    fn no_row_is_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.csv");
        let mut all = "q1_deg,station\n".to_owned();
        for k in 0..60_000 {
            all += match k % 7 {
                0 => "# a remark with one \" in it\n",
                1 => "1.5,\"of two\nlines, and a \"\"word\"\"\"\n",
                2 => "\n",
                _ => "12.25,plain\n",
            };
        }
        std::fs::write(&path, &all).unwrap();
        let cut = Text::open(&path).unwrap();
        assert!(cut.pieces() > 1);
        let texts: Vec<String> = cut.cuts.iter().map(|cut| text(&path, cut).unwrap()).collect();
        assert_eq!(texts.concat(), all);
        for (text, cut) in texts.iter().zip(&cut.cuts) {
            let begins = ["q1", "# a", "1.5", "\n", "12.25"];
            assert!(begins.iter().any(|begin| text.starts_with(begin)), "{:?}", &text[..20]);
            assert_eq!(all[..cut.from as usize].matches('\n').count(), cut.lines);
        }
    }
}
