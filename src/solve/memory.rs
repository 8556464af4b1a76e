/// Bytes that identifying so many parameters takes.
///
/// | parameters | `f32`: state, workspace | `f64`: state, workspace |
/// |---|---|---|
/// | 10 | 1,052, 564 | 2,088, 1,128 |
/// | 20 | 3,700, 1,920 | 7,384, 3,840 |
/// | 30 | 7,952, 4,080 | 15,880, 8,160 |
/// | 40 | 13,804, 7,040 | 27,576, 14,080 |
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Memory {
    /// A [`StreamingTikhonov`](super::StreamingTikhonov), kept from point to point.
    pub state: usize,
    /// On the stack while lambda is chosen or a solution computed.
    pub workspace: usize,
}

impl Memory {
    /// For `parameters` unknowns of `scalar_bytes` (4 or 8) bytes.
    #[must_use]
    pub const fn of(parameters: usize, scalar_bytes: usize) -> Self {
        let p = parameters;
        Self {
            state: (3 * (p * p + 3 * p + 1) + 1) * scalar_bytes + 12,
            workspace: 2 * (p * p + 5 * p + 2) * scalar_bytes,
        }
    }

    /// Both together.
    #[must_use]
    pub const fn total(&self) -> usize {
        self.state + self.workspace
    }
}

/// The most parameters, 40 at most, whose state and workspace together fit in
/// `ram_bytes`.
#[must_use]
pub const fn most_parameters(ram_bytes: usize, scalar_bytes: usize) -> usize {
    let mut parameters = 0;
    while parameters < 40 && Memory::of(parameters + 1, scalar_bytes).total() <= ram_bytes {
        parameters += 1;
    }
    parameters
}
