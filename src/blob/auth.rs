//! HMAC-SHA-256 (RFC 2104, FIPS 180-4) over a blob.

use hmac::{Hmac, KeyInit, Mac};
use sha2::Sha256;

use super::acceptance::AcceptanceError;
use super::check::Blob;
use super::error::EncodeError;
use super::layout::{CHECKSUM, FLAG_TAG, FLAGS, LENGTH, TAG, checksum};

/// The secret that host and controller share: 32 random bytes.
pub type Key = [u8; 32];

fn mac(key: &Key, bytes: &[u8]) -> Hmac<Sha256> {
    // The block of SHA-256 is 64 bytes: a key of 32 is padded, never hashed.
    let mut block = [0; 64];
    let (front, _) = block.split_at_mut(key.len());
    front.copy_from_slice(key);
    Hmac::<Sha256>::new(&block.into()).chain_update(bytes)
}

impl Blob<'_> {
    /// Verifies the tag, in a time that does not depend on where it differs.
    ///
    /// # Errors
    /// No tag, or one that this key does not give.
    pub fn verify(&self, key: &Key) -> Result<(), AcceptanceError> {
        let tag = self.tag.ok_or(AcceptanceError::NoTag)?;
        mac(key, self.signed).verify(tag.into()).map_err(|_| AcceptanceError::WrongKey)
    }
}

/// Gives the blob in the front of `out` a tag, or a new one, and returns its
/// length.
///
/// # Errors
/// Too little room, or bytes that are no blob.
pub fn sign(out: &mut [u8], key: &Key) -> Result<usize, EncodeError> {
    let (signed, tagged) = {
        let blob = Blob::check(out)?;
        (blob.signed.len(), blob.is_tagged())
    };
    let needed = signed + TAG + CHECKSUM;
    let got = out.len();
    let no_room = EncodeError::NoRoom { needed, got };
    let out = out.get_mut(..needed).ok_or(no_room)?;
    let (body, tail) = out.split_at_mut_checked(signed).ok_or(no_room)?;
    if !tagged {
        if let Some(flags) = body.get_mut(FLAGS) {
            *flags |= FLAG_TAG;
        }
        if let Some(length) = body.get_mut(LENGTH) {
            length.copy_from_slice(&(needed as u32).to_le_bytes());
        }
    }
    let tag = mac(key, body).finalize().into_bytes();
    if let Some(place) = tail.first_chunk_mut::<TAG>() {
        *place = tag.into();
    }
    let (body, tail) = out.split_at_mut_checked(signed + TAG).ok_or(no_room)?;
    tail.copy_from_slice(&checksum(body).to_le_bytes());
    Blob::check(out)?;
    Ok(needed)
}
