//! Records that an image under QEMU and the host both work through, to the same bits.

use std::fs;

use crate::records::{HEADER, header};
use crate::run::{Result, target_dir};
use crate::vectors::{Files, shipped};
use crate::{image, qemu};

/// A file of records.
pub struct Work {
    magic: [u8; 4],
    records: usize,
    blob: usize,
    /// As the image reads it.
    pub bytes: Vec<u8>,
}

impl Work {
    /// Of records that have so many bytes behind their blob.
    pub fn new<'a>(
        magic: [u8; 4],
        behind: usize,
        records: impl ExactSizeIterator<Item = &'a Vec<u8>>,
    ) -> Self {
        let (count, mut bytes, mut size) = (records.len(), vec![0; HEADER], behind);
        for record in records {
            size = record.len();
            bytes.extend(record);
        }
        let mut work = Self { magic, records: count, blob: size - behind, bytes };
        work.expect(0);
        work
    }

    fn expect(&mut self, hash: u64) {
        let header = header(self.magic, self.records, self.blob, hash);
        self.bytes[..HEADER].copy_from_slice(&header);
    }

    /// What the image prints that works through it, if its results have the host's hash.
    pub fn done_by(mut self, image: &str, hash: u64) -> Result<String> {
        self.expect(hash);
        let vectors = target_dir().join(format!("firmware/{image}.vectors"));
        fs::write(&vectors, &self.bytes)?;
        let files = Files { vectors, ..shipped() };
        let ended = qemu::run(&image::command_of(image, &files)?, &image::directory())?;
        if !ended.success || !ended.output.contains(&format!("hash: {hash:016x}")) {
            return Err("the image did not find what the host finds".into());
        }
        Ok(ended.output)
    }
}

/// Median of a figure of what was judged; none of nothing.
pub fn median<J>(judged: &[J], of: impl Fn(&J) -> f64) -> f64 {
    let mut all: Vec<f64> = judged.iter().map(of).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
}
