/// Bytes that identifying so many parameters takes.
///
/// | parameters | `f32`: state, workspace | `f64`: state, workspace |
/// |---|---|---|
/// | 10 | 1,604, 2,736 | 3,192, 4,960 |
/// | 20 | 5,564, 7,336 | 11,112, 14,160 |
/// | 30 | 11,924, 14,336 | 23,832, 28,160 |
/// | 40 | 20,684, 23,736 | 41,352, 46,960 |
///
/// What fits: 64 KB of RAM hold 40 parameters in `f32` or 34 in `f64`, 32 KB
/// hold 33 or 23, see [`most_parameters`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Memory {
    /// A [`StreamingTikhonov`](super::StreamingTikhonov), kept from point to point.
    pub state: usize,
    /// On the stack while lambda is chosen or a solution of all points computed;
    /// measured for 30 parameters in `f32` by the image in tests/firmware:
    /// 8,616 and 9,140 bytes. A point takes 700.
    pub workspace: usize,
}

impl Memory {
    /// For `parameters` unknowns of `scalar_bytes` (4 or 8) bytes.
    #[must_use]
    pub const fn of(parameters: usize, scalar_bytes: usize) -> Self {
        let p = parameters;
        Self {
            state: (3 * (p * p + 3 * p + 2) + 1) * scalar_bytes + 16,
            workspace: (3 * (p * p + 3 * p + 2) + 16 * p) * scalar_bytes + 512,
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
///
/// ```
/// use truearm::solve::{Memory, most_parameters};
///
/// // 16 KiB for an identification in `f32`.
/// let parameters = most_parameters(16 * 1024, 4);
/// assert!(Memory::of(parameters, 4).total() <= 16 * 1024);
/// ```
#[must_use]
pub const fn most_parameters(ram_bytes: usize, scalar_bytes: usize) -> usize {
    let mut parameters = 0;
    while parameters < 40 && Memory::of(parameters + 1, scalar_bytes).total() <= ram_bytes {
        parameters += 1;
    }
    parameters
}
