//! Hands the repository's `memory.x` to the linker of this image, and of this
//! image only: a dependant of truearm has a memory map of its own.

use std::path::PathBuf;

fn main() {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../../memory.x");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    std::fs::copy(source, out.join("memory.x")).expect("memory.x at the repository's root");
    // No names for interrupts: there are none.
    std::fs::write(out.join("device.x"), "").expect("a file in OUT_DIR");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed={source}");
    if std::env::var_os("CARGO_FEATURE_LOG").is_some() {
        // Keeps the format strings in the file and off the controller.
        println!("cargo:rustc-link-arg-bin=log=-Tdefmt.x");
    }
}
