/// CRC-32C of bytes that come in pieces. Four bits at a time: the table has 64
/// bytes where eight bits at a time would take a kilobyte.
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

#[inline]
fn nibbles(mut crc: u32, count: u32) -> u32 {
    for _ in 0..count {
        crc = NIBBLE[(crc & 15) as usize] ^ crc >> 4;
    }
    crc
}

impl Crc32c {
    /// Value of any bytes with their own checksum behind them.
    pub const RESIDUE: u32 = 0x48674bc7;

    pub const fn new() -> Self {
        Self(!0)
    }

    // One copy for the check of a blob and for the store.
    #[inline(never)]
    pub fn update(&mut self, bytes: &[u8]) {
        // Of four words, for an optimiser would make it eight.
        let (blocks, rest) = bytes.as_chunks::<16>();
        let mut crc = self.0;
        for block in blocks {
            for word in block.as_chunks().0 {
                crc = nibbles(crc ^ u32::from_le_bytes(*word), 8);
            }
        }
        for byte in rest {
            crc = nibbles(crc ^ u32::from(*byte), 2);
        }
        self.0 = crc;
    }

    pub const fn value(self) -> u32 {
        !self.0
    }
}
