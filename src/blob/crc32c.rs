/// CRC-32C of bytes that come in pieces. Four bits at a time: the table has 64
/// bytes where eight bits at a time would take a kilobyte, and in words of four
/// bytes it is as fast.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crc32c(u32);

/// Polynomial of Castagnoli, reflected.
const POLYNOMIAL: u32 = 0x82f6_3b78;

const NIBBLE: [u32; 16] = {
    let mut table = [0; 16];
    let mut index = 0;
    while index < 16 {
        let mut crc = index as u32;
        let mut bit = 0;
        while bit < 4 {
            crc = if crc & 1 == 1 { crc >> 1 ^ POLYNOMIAL } else { crc >> 1 };
            bit += 1;
        }
        table[index] = crc;
        index += 1;
    }
    table
};

impl Crc32c {
    /// Value of any bytes with their own checksum behind them.
    pub const RESIDUE: u32 = 0x48674bc7;

    pub const fn new() -> Self {
        Self(!0)
    }

    // One copy for the check of a blob and for the store.
    #[inline(never)]
    pub fn update(&mut self, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks();
        let mut crc = self.0;
        for word in words {
            crc ^= u32::from_le_bytes(*word);
            for _ in 0..8 {
                crc = NIBBLE[(crc & 15) as usize] ^ crc >> 4;
            }
        }
        for byte in rest {
            crc ^= u32::from(*byte);
            for _ in 0..2 {
                crc = NIBBLE[(crc & 15) as usize] ^ crc >> 4;
            }
        }
        self.0 = crc;
    }

    pub const fn value(self) -> u32 {
        !self.0
    }
}
