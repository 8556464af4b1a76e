//! Which instructions a batch is computed with.

use core::fmt;

use pulp::{Arch, WithSimd};

/// A class of instructions that this processor has. Results do not depend on it,
/// times do: state it beside them.
#[derive(Debug, Clone, Copy)]
pub struct Cpu(Arch);

impl Cpu {
    /// The widest that this processor has.
    #[must_use]
    pub fn best() -> Self {
        Self(Arch::new())
    }

    /// All that this processor has, the narrowest first: one number at a time.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self(Arch::Scalar)];
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(pulp::x86::V3::try_new().map(|v3| Self(Arch::V3(v3))));
            all.extend(pulp::x86::V4::try_new().map(|v4| Self(Arch::V4(v4))));
        }
        #[cfg(target_arch = "aarch64")]
        all.extend(pulp::aarch64::Neon::try_new().map(|neon| Self(Arch::Neon(neon))));
        all
    }

    /// `scalar`, `AVX2`, `AVX-512` or `NEON`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.0 {
            Arch::Scalar => "scalar",
            #[cfg(target_arch = "x86_64")]
            Arch::V3(_) => "AVX2",
            #[cfg(target_arch = "x86_64")]
            Arch::V4(_) => "AVX-512",
            #[cfg(target_arch = "aarch64")]
            Arch::Neon(_) => "NEON",
            #[allow(unreachable_patterns, reason = "the classes of some targets are all known")]
            _ => "other",
        }
    }

    pub(crate) fn run<Op: WithSimd>(self, op: Op) -> Op::Output {
        self.0.dispatch(op)
    }
}

impl fmt::Display for Cpu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
