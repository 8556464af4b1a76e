//! Damage: no flipped bit, pair of bits or burst passes for the blob it was.

#[cfg(feature = "curves")]
use crate::blobs::{curved, full, tagged, tagged_curved};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truearm::blob::Blob;

/// Bits of magic, layout, counts, length and flags: those that decide where
/// the checksum stands.
fn structural(bit: usize) -> bool {
    bit / 8 < 12 || bit / 8 == 28
}

/// Blobs of every part that there is.
fn blobs_of_all_parts() -> Vec<Vec<u8>> {
    [
        full(),
        tagged(),
        #[cfg(feature = "curves")]
        curved(),
        #[cfg(feature = "curves")]
        tagged_curved(),
    ]
    .to_vec()
}

fn flip(bytes: &mut [u8], bit: usize) {
    bytes[bit / 8] ^= 1 << (bit % 8);
}

/// The blob in slots that were erased, zeroed, and held a longer blob before.
fn slots(blob: &[u8]) -> [Vec<u8>; 3] {
    let behind = |fill: Vec<u8>| [blob, &fill].concat();
    let older: Vec<u8> =
        (0..4096_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    [behind(vec![0xff; 4096]), behind(vec![0; 4096]), behind(older)]
}

#[test]
fn every_single_bit_flip_is_refused() {
    for blob in blobs_of_all_parts() {
        for mut slot in slots(&blob) {
            for bit in 0..blob.len() * 8 {
                flip(&mut slot, bit);
                assert!(Blob::check(&slot).is_err(), "bit {bit}");
                flip(&mut slot, bit);
            }
        }
    }
}

/// All pairs with a bit that moves the checksum, one by one.
#[test]
fn every_pair_with_a_structural_bit_is_refused() {
    let blob = blobs_of_all_parts().pop().unwrap_or_default();
    let bits = blob.len() * 8;
    for mut slot in slots(&blob) {
        for first in (0..bits).filter(|b| structural(*b)) {
            flip(&mut slot, first);
            for second in 0..bits {
                if second != first && !(structural(second) && second < first) {
                    flip(&mut slot, second);
                    assert!(Blob::check(&slot).is_err(), "bits {first} and {second}");
                    flip(&mut slot, second);
                }
            }
            flip(&mut slot, first);
        }
    }
}

/// All other pairs leave the checksum where it is. A CRC is linear: the change
/// of two flips is the exclusive or of the changes of each, which is nothing
/// only if the two are equal. So every pair is found if all changes differ;
/// `cargo xtask study flips` tries the pairs themselves.
#[test]
fn every_other_pair_is_refused() {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI);
    for mut blob in blobs_of_all_parts() {
        let body = blob.len() - 4;
        let clean = crc.checksum(&blob[..body]);
        let change = |blob: &[u8]| {
            let stored = u32::from_le_bytes(blob[body..].try_into().unwrap());
            crc.checksum(&blob[..body]) ^ stored
        };
        assert_eq!(clean.to_le_bytes(), blob[body..]);
        let mut changes: Vec<u32> = Vec::new();
        for bit in 0..blob.len() * 8 {
            flip(&mut blob, bit);
            changes.push(change(&blob));
            flip(&mut blob, bit);
        }
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..100_000 {
            let [a, b] = [0; 2].map(|_| rng.random_range(0..changes.len()));
            if a != b {
                flip(&mut blob, a);
                flip(&mut blob, b);
                assert_eq!(change(&blob), changes[a] ^ changes[b]);
                assert!(Blob::check(&blob).is_err(), "bits {a} and {b}");
                flip(&mut blob, a);
                flip(&mut blob, b);
            }
        }
        let count = changes.len();
        changes.sort_unstable();
        changes.dedup();
        assert_eq!(changes.len(), count);
        assert!(changes[0] != 0);
    }
}

#[test]
fn bursts_up_to_32_bits_are_refused() {
    let blob = blobs_of_all_parts().pop().unwrap_or_default();
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for mut slot in slots(&blob) {
        for _ in 0..200_000 {
            // First and last bit of a burst differ, those between at random.
            let length = rng.random_range(1..=32);
            let start = rng.random_range(0..=blob.len() * 8 - length);
            let pattern = rng.random::<u32>() | 1 | 1 << (length - 1);
            let hit = |slot: &mut [u8]| {
                for k in (0..length).filter(|k| pattern >> k & 1 != 0) {
                    flip(slot, start + k);
                }
            };
            hit(&mut slot);
            assert!(Blob::check(&slot).is_err(), "{pattern:#x} from bit {start}");
            hit(&mut slot);
        }
    }
}
