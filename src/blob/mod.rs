//! Parameter blobs: what `truearm pack` writes and a controller reads from
//! flash or EEPROM. The byte map is in [`format`].
//!
//! Reading is two steps: [`Blob::check`] verifies every byte in place and
//! copies nothing; [`Blob::parameters`] then fills a plain struct.

mod check;
mod decode;
mod encode;
#[doc = include_str!("FORMAT.md")]
pub mod format {}
mod layout;
mod term;

pub use check::{Blob, DecodeError, FieldName, Flaw, Record};
pub use encode::{EncodeError, encode};
pub use layout::{LAYOUT, MAGIC, MAX_JOINTS, encoded_len, robot_id};
