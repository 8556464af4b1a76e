//! Arms from and to other formats.

mod export;
#[path = "../plain_chain/mod.rs"]
mod plain_chain;
mod urdf;
