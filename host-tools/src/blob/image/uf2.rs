use super::memory_x::MemoryRegion;

/// Bytes of the blob in a block; what every UF2 bootloader takes.
const PAYLOAD: usize = 256;
const HAS_FAMILY: u32 = 0x2000;

/// UF2 (Microsoft's USB Flashing Format): blocks of 512 bytes with 256 of the
/// blob each. Bootloaders of some parts take only blocks of their family id,
/// see uf2families.json of the specification. The last block is filled up with
/// 0xff, as erased flash.
#[must_use]
pub fn uf2(bytes: &[u8], slot: &MemoryRegion, family: Option<u32>) -> Vec<u8> {
    let blocks = bytes.len().div_ceil(PAYLOAD);
    let mut out = Vec::with_capacity(512 * blocks);
    for (number, payload) in bytes.chunks(PAYLOAD).enumerate() {
        let header = [
            0x0a32_4655,
            0x9e5d_5157,
            family.map_or(0, |_| HAS_FAMILY),
            slot.origin.wrapping_add((number * PAYLOAD) as u32),
            PAYLOAD as u32,
            number as u32,
            blocks as u32,
            family.unwrap_or(0),
        ];
        out.extend(header.iter().flat_map(|word| word.to_le_bytes()));
        out.extend(payload);
        out.resize(512 * number + 32 + PAYLOAD, 0xff);
        out.resize(512 * number + 508, 0);
        out.extend(0x0ab1_6f30_u32.to_le_bytes());
    }
    out
}
