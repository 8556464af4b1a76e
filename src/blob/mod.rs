//! Parameter blobs: what `truearm pack` writes and a controller reads from
//! flash or EEPROM. The byte map is in [`format`](mod@format).
//!
//! Reading is two steps: [`Blob::check`] verifies every byte in place and
//! copies nothing; [`Blob::parameters`] then fills a plain struct. A controller
//! puts [`Acceptance`] before both: whose blob it is, how old, who wrote it.

mod acceptance;
#[cfg(feature = "auth")]
mod auth;
mod check;
mod content;
mod covariance;
mod crc32c;
mod curves;
mod decode;
mod encode;
mod error;
mod fields;
#[doc = include_str!("FORMAT.md")]
pub mod format {}
mod frame;
mod layout;
mod reader;
mod term;
mod values;

pub use acceptance::{Acceptance, AcceptanceError};
#[cfg(feature = "auth")]
pub use auth::{Key, sign};
pub use check::Blob;
pub use covariance::{Covariance, CovarianceError};
pub use curves::{curve_len, encode_curve, encode_curve_with, gaps_len};
pub(crate) use encode::storable;
pub use encode::{encode, encode_with};
pub use error::{DecodeError, EncodeError, FieldName, Flaw, Record};
pub(crate) use frame::Frame;
pub use layout::{LAYOUT, MAGIC, TAG, encoded_len, factor_len, robot_id, uncertain_parameters};
