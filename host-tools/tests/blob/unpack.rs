//! Whatever a controller accepts can be unpacked, and packed to the same bytes:
//! shipped blobs with numbers at and near the ends of their ranges.

use std::path::Path;

use crc::{CRC_32_ISCSI, Crc};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::Blob;
use truearm_host::blob::unpack;
use truearm_host::blob::{PackOptions, pack_with};
use truearm_host::model::Model;

static CRC32C: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// Ends of ranges of FORMAT.md, and what is hard to write in decimal. Not -0,
/// which a controller takes for the zero of an absent range and no pack writes.
const VALUES: [f32; 14] =
    [0.0, 0.05, 0.2, -0.2, 1.0, 6.3, -6.3, 10.0, -10.0, 20.0, 100.0, 200.0, 1e4, 1e-42];

/// Puts a number of another place or of the list into a place, or turns a byte
/// of a term, where the blob stays valid.
fn change(blob: &mut Vec<u8>, dice: &mut ChaCha8Rng) -> bool {
    let before = blob.clone();
    let words = (blob.len() / 4 - 1) as u32;
    let place = 4 * dice.random_range(6..words) as usize;
    let word = match dice.random_range(0..3) {
        0 => VALUES.choose(dice).expect("values").to_le_bytes(),
        1 => {
            // Also of the neighbour, so that ranges become empty.
            let from =
                if dice.random() { place - 4 } else { 4 * dice.random_range(6..words) as usize };
            *before[from..].first_chunk().expect("a word")
        }
        _ => dice.random_range(-0.2..0.2_f32).to_le_bytes(),
    };
    blob[place..place + 4].copy_from_slice(&word);
    let (body, checksum) = blob.split_last_chunk_mut::<4>().expect("a blob's length");
    *checksum = CRC32C.checksum(body).to_le_bytes();
    let valid = Blob::check(blob).is_ok();
    if !valid {
        *blob = before;
    }
    valid
}

#[test]
fn every_valid_blob_comes_back() {
    let mut dice = ChaCha8Rng::seed_from_u64(5);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.toml");
    let mut changes = 0;
    for name in [
        "golden/layout-3-full",
        "golden/layout-3-least",
        "golden/layout-3-curves",
        "golden/layout-3-torques",
        "golden/layout-3-friction",
        "golden/layout-3-gaps",
        "firmware/ur10-terms",
    ] {
        let file = format!("{}/../tests/data/{name}.blob", env!("CARGO_MANIFEST_DIR"));
        let shipped = std::fs::read(&file).unwrap();
        for round in 0..200 {
            let mut blob = shipped.clone();
            changes += (0..60).filter(|_| change(&mut blob, &mut dice)).count();
            let model = unpack(&blob, Path::new("a.bin"), None).unwrap();
            std::fs::write(&path, model.to_toml()).unwrap();
            let again = Model::read(&path).and_then(|model| {
                let covariance = model.covariance.is_some();
                pack_with(&model, &PackOptions { covariance, ..PackOptions::default() })
            });
            let again = again.unwrap_or_else(|e| panic!("{name}, {round}: {e}; {}", e.help()));
            let differ =
                (0..blob.len() - 4).step_by(4).filter(|&at| again[at..at + 4] != blob[at..at + 4]);
            let differ: Vec<_> =
                differ.map(|at| (at, &blob[at..at + 4], &again[at..at + 4])).collect();
            assert!(again == blob, "{name}, {round}: {differ:?}");
        }
    }
    assert!(changes > 10_000, "{changes} changes of 48,000 left a valid blob");
}
