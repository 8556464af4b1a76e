//! Parameter blobs on the host: made from a model and taken apart again, told in
//! words, set side by side, and written in the containers that flash tools read.
//! What the bytes mean is in [`truearm::blob`].

mod contents;
mod describe;
mod diff;
mod explain;
pub mod image;
mod pack;
mod unpack;

pub use contents::{BlobCurve, BlobJoint, BlobLink, BlobMasses, BlobTerm, Contents, contents};
pub use describe::describe;
pub use diff::{Change, Difference, Motion, Told, diff, difference};
pub use explain::explain;
pub use pack::{PackOptions, notes, pack, pack_with};
pub(crate) use pack::{arm_terms, parameters};
pub use unpack::{Name, not_carried, unpack};
