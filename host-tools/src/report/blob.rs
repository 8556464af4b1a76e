//! What the verbs about blobs print as JSON.

use schemars::JsonSchema;
use serde::Serialize;

use crate::blob::image::MemoryRegion;
use crate::blob::{Contents, Difference};

/// What `pack --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PackReport {
    /// The schema.
    #[schemars(extend("const" = PackReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "pack"))]
    pub command: &'static str,
    /// The model that was packed.
    pub model: String,
    /// The file that was written.
    pub out: String,
    /// What it holds: `bin`, `ihex`, `uf2`, `c`, `rust` or `elf`.
    pub format: String,
    /// The slot of the controller that it is for, if one was named.
    pub slot: Option<PackedSlot>,
    /// What the blob holds.
    pub blob: Contents,
    /// What it says and does not say, in words.
    pub remarks: Vec<String>,
}

/// A slot of a controller's flash.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PackedSlot {
    /// Its region in the linker script.
    pub name: String,
    /// First address.
    pub address: u32,
    /// Bytes.
    pub length: u32,
}

impl From<&MemoryRegion> for PackedSlot {
    fn from(region: &MemoryRegion) -> Self {
        let MemoryRegion { name, origin, length } = region.clone();
        Self { name, address: origin, length }
    }
}

impl PackReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-pack-1";

    /// Of a model, the file it was packed into, and what that holds.
    #[must_use]
    pub fn new(
        [model, out, format]: [String; 3],
        slot: Option<&MemoryRegion>,
        blob: Contents,
        remarks: Vec<String>,
    ) -> Self {
        let slot = slot.map(PackedSlot::from);
        Self { schema: Self::SCHEMA, command: "pack", model, out, format, slot, blob, remarks }
    }
}

/// What `inspect --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InspectReport {
    /// The schema.
    #[schemars(extend("const" = InspectReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "inspect"))]
    pub command: &'static str,
    /// The file.
    pub file: String,
    /// What the blob holds.
    pub blob: Contents,
    /// What a controller was said to have: robot, key, sequence.
    pub asked: Vec<String>,
    /// Why such a controller refuses the blob; none if it takes it.
    pub refused: Option<String>,
}

impl InspectReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-inspect-1";

    /// Of a file, what it holds and what a controller makes of it.
    #[must_use]
    pub fn new(file: String, blob: Contents, asked: Vec<String>, refused: Option<String>) -> Self {
        Self { schema: Self::SCHEMA, command: "inspect", file, blob, asked, refused }
    }
}

/// What `diff --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DiffReport {
    /// The schema.
    #[schemars(extend("const" = DiffReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "diff"))]
    pub command: &'static str,
    /// The blob before.
    pub before: String,
    /// The blob after.
    pub after: String,
    /// Seed of the poses that were drawn.
    pub seed: u64,
    /// What they differ by.
    #[serde(flatten)]
    pub difference: Difference,
}

impl DiffReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-diff-1";

    /// Of two files and what they differ by.
    #[must_use]
    pub fn new([before, after]: [String; 2], seed: u64, difference: Difference) -> Self {
        Self { schema: Self::SCHEMA, command: "diff", before, after, seed, difference }
    }
}

/// What `unpack --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct UnpackReport {
    /// The schema.
    #[schemars(extend("const" = UnpackReport::SCHEMA))]
    pub schema: &'static str,
    /// The verb.
    #[schemars(extend("const" = "unpack"))]
    pub command: &'static str,
    /// The blob.
    pub file: String,
    /// The model.toml that was written.
    pub out: String,
    /// What the blob holds.
    pub blob: Contents,
    /// What a blob does not carry, so that the model lacks it.
    pub not_carried: Vec<String>,
}

impl UnpackReport {
    /// Name of the schema.
    pub const SCHEMA: &'static str = "truearm-unpack-1";

    /// Of a blob and the model that was made of it.
    #[must_use]
    pub fn new([file, out]: [String; 2], blob: Contents, not_carried: Vec<String>) -> Self {
        Self { schema: Self::SCHEMA, command: "unpack", file, out, blob, not_carried }
    }
}
