use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use truearm::blob::Blob;
use truearm_host::blob::image::{self, MemoryRegion, MemoryRegions};
use truearm_host::blob::{PackOptions, contents, notes, pack_with};
use truearm_host::files::{read_key, write};
use truearm_host::model::Model;
use truearm_host::report::{PackReport, to_json};
use truearm_host::{Error, ErrorKind, Result};

use super::{Said, overwrite, refused};

/// Pack a model into a parameter blob for the controller.
#[derive(Args)]
pub struct Pack {
    /// model.toml of `identify`
    model: PathBuf,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// What to write; ihex, uf2 and elf carry the address of the slot. If not
    /// given, the name says it (.hex, .ihex, .uf2, .elf, .c, .h, .rs), and bin
    /// is written under any other
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// The slot the blob is for: its address and room, from the linker script
    #[arg(long, value_enum)]
    slot: Option<Slot>,
    /// Linker script with the regions PARAM_A and PARAM_B
    #[arg(long, value_name = "FILE", default_value = "memory.x")]
    memory: PathBuf,
    /// Family id of a UF2 bootloader, as 0xe48bff56 for the RP2040
    #[arg(long, value_name = "ID", value_parser = family)]
    uf2_family: Option<u32>,
    /// Sequence number; the model's creation time in Unix seconds if not given
    #[arg(long, allow_hyphen_values = true)]
    sequence: Option<u32>,
    /// The marker that is the tool; needed where the points of several were measured, and
    /// none of them is the marker without a label
    #[arg(long, value_name = "LABEL")]
    marker: Option<String>,
    /// With the covariance, so that the controller can state the tool point's
    /// uncertainty; several kilobytes
    #[arg(long)]
    covariance: bool,
    /// With an authentication tag under this key: 32 bytes or 64 hexadecimal digits
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,
    /// Write over files that truearm did not write, or of another robot
    #[arg(long)]
    force: bool,
    /// Print JSON instead of words
    #[arg(long)]
    json: bool,
}

/// File formats.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Format {
    /// The bytes of the blob
    Bin,
    /// Intel HEX
    Ihex,
    /// USB Flashing Format
    Uf2,
    /// C source
    C,
    /// Rust source
    Rust,
    /// ELF for 32-bit Arm
    Elf,
}

impl Format {
    /// What a file of this name holds.
    fn of_name(path: &Path) -> Self {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("hex" | "ihex" | "ihx") => Self::Ihex,
            Some("uf2") => Self::Uf2,
            Some("elf") => Self::Elf,
            Some("c" | "h") => Self::C,
            Some("rs") => Self::Rust,
            _ => Self::Bin,
        }
    }
}

/// The two places for parameters.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Slot {
    A,
    B,
}

fn family(text: &str) -> std::result::Result<u32, String> {
    let digits = text.strip_prefix("0x").and_then(|digits| u32::from_str_radix(digits, 16).ok());
    digits.ok_or_else(|| "an id is 0x and up to eight hexadecimal digits".to_owned())
}

impl Pack {
    pub fn run(self) -> Result<Said> {
        let inputs = [&self.model, &self.memory].into_iter().chain(&self.key);
        overwrite::apart([self.out.as_path()], inputs.map(PathBuf::as_path))?;
        let model = self.of_tool(Model::read(&self.model)?)?;
        let key = self.key.as_deref().map(read_key).transpose()?;
        let options = PackOptions { sequence: self.sequence, covariance: self.covariance, key };
        let bytes = pack_with(&model, &options)?;
        let slot = self.region(bytes.len())?;
        let encoded = self.encoded(&bytes, slot.as_ref())?;
        if self.format() == Format::Bin {
            overwrite::blob_file(&self.out, &model, self.force)?;
        }
        write(&self.out, &encoded)?;
        let remarks = remarks(&model);
        if self.json {
            let blob = Blob::check(&bytes).map_err(|e| refused(&self.out, &bytes, &e.into()))?;
            let format = self.format().to_possible_value();
            let format = format.map_or_else(String::new, |value| value.get_name().to_owned());
            let [model, out] = [&self.model, &self.out].map(|path| path.display().to_string());
            let holds = contents(&blob, bytes.len());
            let report = PackReport::new([model, out, format], slot.as_ref(), holds, remarks);
            return Ok(to_json(&report).into());
        }
        let mut text =
            format!("wrote {}: {} bytes of parameters\n", self.out.display(), bytes.len());
        if let Some(MemoryRegion { name, origin, length }) = &slot {
            text += &format!("slot {name} at {origin:#010x}, {length} bytes\n");
        }
        Ok((text + &remarks.join("\n") + "\n").into())
    }

    /// The model with one marker for the tool.
    fn of_tool(&self, model: Model) -> Result<Model> {
        if let Some(marker) = &self.marker {
            let known = model.tool_marker().is_some_and(|(label, _)| label == marker);
            let own = model.with_tool(marker)?;
            return match self.covariance && !known {
                true => Err(Error::data(
                    ErrorKind::NoCovariance,
                    format!("{}: [covariance] is of another marker", self.model.display()),
                    "leave out --covariance, or --marker",
                )),
                false => Ok(own),
            };
        }
        Ok(model)
    }

    fn format(&self) -> Format {
        self.format.unwrap_or_else(|| Format::of_name(&self.out))
    }

    /// Where the blob goes, if that was asked for.
    fn region(&self, size: usize) -> Result<Option<MemoryRegion>> {
        let name = match self.slot {
            Some(Slot::A) => "PARAM_A",
            Some(Slot::B) => "PARAM_B",
            None => return Ok(None),
        };
        let regions = MemoryRegions::read(&self.memory)?;
        let region = regions.find(&self.memory, name)?;
        if size > region.length as usize {
            return Err(Error::data(
                ErrorKind::NoSlot,
                format!("{size} bytes of parameters, {name} has {}", region.length),
                match self.covariance {
                    true => {
                        "make the slot larger in the linker script, or pack without --covariance"
                    }
                    false => {
                        "make the slot larger in the linker script; of less room \
                              `truearm diagnose --most-terms N` gives the best model"
                    }
                },
            ));
        }
        Ok(Some(region.clone()))
    }

    fn encoded(&self, bytes: &[u8], slot: Option<&MemoryRegion>) -> Result<Vec<u8>> {
        let blob = Blob::check(bytes).map_err(|e| refused(Path::new(""), bytes, &e.into()))?;
        let slot = slot.ok_or_else(|| {
            Error::data(
                ErrorKind::NoSlot,
                "ihex, uf2 and elf carry an address",
                "say for which slot with --slot a or --slot b",
            )
        });
        Ok(match self.format() {
            Format::Bin => bytes.to_vec(),
            Format::C => image::c(bytes, &blob).into_bytes(),
            Format::Rust => image::rust(bytes, &blob).into_bytes(),
            Format::Ihex => image::intel_hex(bytes, slot?).into_bytes(),
            Format::Uf2 => image::uf2(bytes, slot?, self.uf2_family),
            Format::Elf => image::elf(bytes, slot?),
        })
    }
}

/// Whose point the tool of the blob is, where that is not plain.
fn tool(model: &Model) -> Option<String> {
    match model.tool_marker() {
        None => Some(
            "tool: that of robot.toml, as no row measured where a target sits on the last frame"
                .to_owned(),
        ),
        Some((label, _)) if model.markers.len() > 1 => {
            Some(format!("tool: marker \"{label}\", of {}", model.markers.len()))
        }
        Some(_) => None,
    }
}

/// What the blob says and does not say.
fn remarks(model: &Model) -> Vec<String> {
    let mut lines = notes(model);
    lines.push(format!(
        "frame: commanded poses refer to the nominal base; residual base {:.3} {:.3} {:.3} mm",
        model.frame_translation.x * 1e3,
        model.frame_translation.y * 1e3,
        model.frame_translation.z * 1e3
    ));
    if !model.orientation_identified {
        lines.push(
            "flange orientation: not identified by what was measured; it stays nominal".to_owned(),
        );
    }
    lines.extend(tool(model));
    if !model.unidentifiable.is_empty() {
        let what = "directions the data did not determine, held by nothing but the tolerances and the tool of the robot file:";
        lines.push(what.to_owned());
        lines.extend(model.unidentifiable.iter().map(|line| format!("  {line}")));
    }
    lines
}
