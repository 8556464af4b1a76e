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
    rows: usize,
}

impl Text {
    /// Cuts a file where a row ends and none is quoted.
    pub fn open(path: &Path) -> Result<Self> {
        let mut cuts: Vec<Cut> = Vec::new();
        let mut first = Cut { from: 0, to: 0, lines: 0 };
        let end = walk(path, &mut |at| {
            // The headings and a row behind them are in the first piece, whatever is before them.
            if at.bytes - first.from >= PIECE && at.rows > 1 {
                cuts.push(Cut { to: at.bytes, ..first });
                first = Cut { from: at.bytes, to: at.bytes, lines: at.lines };
            }
        })?;
        if end.bytes > first.from || cuts.is_empty() {
            cuts.push(Cut { to: end.bytes, ..first });
        }
        let head = text(path, &cuts[0])?;
        let source = Source { path, text: &head };
        source.refuse_toml()?;
        Ok(Self { names: headings(&source)?, cuts, rows: end.rows.saturating_sub(1) })
    }

    pub fn pieces(&self) -> usize {
        self.cuts.len()
    }

    pub fn rows(&self) -> usize {
        self.rows
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
            _ => {
                let mut data = reading.end().map_err(shown)?;
                data.remark_unused();
                with(data)
            }
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

/// Rows of a file, its headings among them.
pub fn rows(path: &Path) -> Result<usize> {
    walk(path, &mut |_| ()).map(|end| end.rows)
}

/// Where a walk through a file is.
#[derive(Debug, Clone, Copy, Default)]
struct Walked {
    bytes: u64,
    lines: usize,
    /// Rows that ended before: no remarks, and no empty lines.
    rows: usize,
}

/// Where in a row a byte stands, as the reader of tables has it.
#[derive(Clone, Copy, PartialEq)]
enum In {
    /// Before the first byte of a row.
    Line,
    /// Before the first of a cell.
    Cell,
    Plain,
    Quoted,
    /// Behind a quote that ends what is quoted, or is the first of two.
    Quote,
    Remark,
}

impl In {
    fn next(self, byte: u8) -> Self {
        match (self, byte) {
            (Self::Quoted, b'"') => Self::Quote,
            (Self::Quoted, _) => Self::Quoted,
            (Self::Quote | Self::Line | Self::Cell, b'"') => Self::Quoted,
            (Self::Remark, b'\n') => Self::Line,
            (Self::Remark, _) | (Self::Line, b'#') => Self::Remark,
            (_, b'\n' | b'\r') => Self::Line,
            (_, b',') => Self::Cell,
            _ => Self::Plain,
        }
    }
}

/// Calls with where each line ends that is not within quotes; where the file ends.
fn walk(path: &Path, ended: &mut dyn FnMut(Walked)) -> Result<Walked> {
    let error = |e| Error::io(path, e);
    let mut file = BufReader::with_capacity(1 << 20, File::open(path).map_err(error)?);
    let (mut at, mut state) = (Walked::default(), In::Line);
    loop {
        let block = file.fill_buf().map_err(error)?;
        if block.is_empty() {
            at.rows += usize::from(!matches!(state, In::Line | In::Remark));
            return Ok(at);
        }
        for byte in block {
            let before = state;
            state = state.next(*byte);
            at.bytes += 1;
            at.lines += usize::from(*byte == b'\n');
            if state == In::Line {
                at.rows += usize::from(!matches!(before, In::Line | In::Remark));
                ended(at);
            }
        }
        let length = block.len();
        file.consume(length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pieces of a text.
    fn cut(all: &str) -> (Text, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.csv");
        std::fs::write(&path, all).unwrap();
        let cut = Text::open(&path).unwrap();
        let texts = cut.cuts.iter().map(|cut| text(&path, cut).unwrap()).collect();
        (cut, texts)
    }

    /// Rows as the reader of tables has them.
    fn rows_of(text: &str, headings: bool) -> Vec<csv::StringRecord> {
        super::super::super::csv_reader(text, headings).records().map(|row| row.unwrap()).collect()
    }

    /// Whatever stands in it, pieces are the file, and no row is cut.
    #[test]
    fn no_row_is_cut() {
        for end in ["\n", "\r\n", "\r"] {
            let mut all = format!("q1_deg,station{end}");
            for k in 0..80_000 {
                all += match k % 9 {
                    0 => "# a remark with one \" in it",
                    1 => "1.5,\"of two\nlines, and a \"\"word\"\"\"",
                    2 => "",
                    3 => "1.5,5\" long",
                    4 => "\"1.5\",\"\"",
                    5 => "1.5,\"quoted\" and not",
                    _ => "12.25,plain",
                };
                all += end;
            }
            let (cut, texts) = cut(&all);
            assert!(cut.pieces() > 1);
            assert_eq!(texts.concat(), all);
            let pieces = texts.iter().enumerate().flat_map(|(k, text)| rows_of(text, k == 0));
            let pieces: Vec<_> = pieces.collect();
            assert_eq!(pieces.len(), cut.rows());
            assert!(pieces == rows_of(&all, true));
            for cut in &cut.cuts {
                assert_eq!(all[..cut.from as usize].matches('\n').count(), cut.lines);
            }
        }
    }

    /// Headings are found however much stands before them, and nothing that is no row counts.
    #[test]
    fn what_is_before_the_headings() {
        for before in
            ["# a remark that is as long as others\n".repeat(40_000), "\n".repeat(2_000_000)]
        {
            let (cut, _) = cut(&format!("{before}q1_deg,station\n1,a\n2,b"));
            assert_eq!((cut.names.len(), cut.rows()), (2, 2));
        }
    }
}
