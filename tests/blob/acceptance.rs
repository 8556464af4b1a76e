//! Whose blob it is, how old, who wrote it: each refusal has its own error.

use crate::blobs::parameters;
use truearm::blob::{Acceptance, AcceptanceError, DecodeError, encode, robot_id};

const ROBOT: u64 = robot_id("arm", "0042");
const MINE: Acceptance = Acceptance::of(ROBOT, 3);

fn blob() -> Vec<u8> {
    let mut bytes = vec![0; 600];
    let size = encode(&parameters(), &mut bytes).unwrap();
    bytes.truncate(size);
    bytes
}

#[test]
fn another_robot_is_refused() {
    assert!(MINE.check(&blob()).is_ok());
    let other = robot_id("arm", "0043");
    let refusal = Acceptance::of(other, 3).check(&blob()).unwrap_err();
    assert_eq!(refusal, AcceptanceError::WrongRobot { blob: ROBOT, robot: other });
    let words = format!("robot id {ROBOT:#018x} where this robot is {other:#018x}");
    assert_eq!(refusal.to_string(), words);
}

#[test]
fn an_old_sequence_is_refused_the_same_one_is_not() {
    for (sequence, verdict) in
        [(6, Ok(())), (7, Ok(())), (8, Err(AcceptanceError::OldSequence { blob: 7, oldest: 8 }))]
    {
        assert_eq!(MINE.not_before(sequence).check(&blob()).map(drop), verdict);
    }
}

#[test]
fn damage_is_named_first() {
    let mut bytes = blob();
    bytes[20] ^= 1;
    let refusal = MINE.check(&bytes).unwrap_err();
    assert!(matches!(refusal, AcceptanceError::Damaged(DecodeError::Checksum { .. })), "{refusal}");
}

#[cfg(feature = "auth")]
mod auth {
    use truearm::blob::{Blob, EncodeError, Key, TAG, sign};

    use super::*;
    use crate::blobs::mend;

    const KEY: Key = *b"thirty-two bytes of a secret key";

    fn signed() -> Vec<u8> {
        let mut bytes = blob();
        bytes.extend([0; TAG]);
        assert_eq!(sign(&mut bytes, &KEY), Ok(bytes.len()));
        bytes
    }

    #[test]
    fn a_key_takes_its_own_blobs_only() {
        let keyed = MINE.with_key(KEY);
        assert!(keyed.check(&signed()).is_ok());
        assert_eq!(keyed.check(&blob()), Err(AcceptanceError::NoTag));
        let mut other = KEY;
        other[31] ^= 0x80;
        assert_eq!(MINE.with_key(other).check(&signed()), Err(AcceptanceError::WrongKey));
        // Without a key the tag is ignored and says nothing.
        let bytes = signed();
        let blob = MINE.check(&bytes).unwrap();
        assert_eq!(blob.parameters::<f32, 3>(), Ok(parameters()));
        assert!(blob.is_tagged() && blob.size() == bytes.len());
    }

    /// Whoever can mend the checksum but does not know the key changes nothing.
    #[test]
    fn no_changed_byte_passes_the_key() {
        let bytes = signed();
        let keyed = MINE.with_key(KEY);
        for at in 0..bytes.len() - 4 {
            let mut forged = bytes.clone();
            forged[at] ^= 0x11;
            mend(&mut forged);
            assert!(keyed.check(&forged).is_err(), "byte {at}");
        }
        // Cut off with its flag, the tag is missed.
        let mut stripped = blob();
        stripped[40] ^= 1;
        mend(&mut stripped);
        assert_eq!(keyed.check(&stripped), Err(AcceptanceError::NoTag));
    }

    /// RFC 4231 has no key of 32 bytes, so the reference is the definition of
    /// RFC 2104 on plain SHA-256.
    #[test]
    fn the_tag_is_hmac_sha_256() {
        use sha2::{Digest, Sha256};
        let bytes = signed();
        let (body, tag) = bytes[..bytes.len() - 4].split_at(bytes.len() - 4 - TAG);
        let pad =
            |x: u8| -> Vec<u8> { (0..64).map(|k| KEY.get(k).copied().unwrap_or(0) ^ x).collect() };
        let inner = Sha256::new().chain_update(pad(0x36)).chain_update(body).finalize();
        let outer = Sha256::new().chain_update(pad(0x5c)).chain_update(inner).finalize();
        assert_eq!(outer[..], *tag);
    }

    #[test]
    fn a_tag_can_be_renewed_and_needs_room() {
        let mut bytes = signed();
        let again = bytes.clone();
        assert_eq!(sign(&mut bytes, &KEY), Ok(again.len()));
        assert_eq!(bytes, again);
        let mut tight = blob();
        let (needed, got) = (tight.len() + TAG, tight.len());
        assert_eq!(sign(&mut tight, &KEY), Err(EncodeError::NoRoom { needed, got }));
        assert!(Blob::check(&tight).is_ok());
        assert!(sign(&mut [0; 600], &KEY).is_err());
    }
}
