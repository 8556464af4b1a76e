//! A blob in the file formats that flash tools and compilers take.

mod containers;
mod memory_x;
mod source;
mod uf2;

pub use containers::{elf, intel_hex};
pub use memory_x::{MemoryRegion, MemoryRegions};
pub use source::{c, rust};
pub use uf2::uf2;
