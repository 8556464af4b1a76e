//! Blobs packed, unpacked, and in the files that flash tools read.

mod images;
mod pack_terms;
mod unpack;
