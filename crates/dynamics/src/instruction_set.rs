//! Vector instructions that a kernel runs on.

use pulp::Arch;

/// A family of vector instructions, chosen when the program runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum InstructionSet {
    /// One value at a time: any machine.
    Scalar,
    /// 128-bit Arm vectors.
    Neon,
    /// 256-bit x86 vectors with fused multiply-add.
    Avx2,
    /// 512-bit x86 vectors.
    Avx512,
}

impl InstructionSet {
    /// The widest set that this machine has.
    pub fn detected() -> Self {
        Self::available().last().copied().unwrap_or(Self::Scalar)
    }

    /// Every set that this machine has, narrowest first.
    pub fn available() -> Vec<Self> {
        [Self::Scalar, Self::Neon, Self::Avx2, Self::Avx512]
            .into_iter()
            .filter(|set| set.arch().is_some())
            .collect()
    }

    /// Numbers in one vector of this set.
    pub fn lanes(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Neon => 2,
            Self::Avx2 => 4,
            Self::Avx512 => 8,
        }
    }

    /// The dispatcher of this set, if the machine has it.
    pub(crate) fn arch(self) -> Option<Arch> {
        match self {
            Self::Scalar => Some(Arch::Scalar),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => pulp::x86::V3::try_new().map(Arch::V3),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => pulp::x86::V4::try_new().map(Arch::V4),
            #[cfg(target_arch = "aarch64")]
            Self::Neon => pulp::aarch64::Neon::try_new().map(Arch::Neon),
            #[allow(unreachable_patterns, reason = "which sets are left depends on the target")]
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scalar_is_always_there_and_the_detected_set_is_available() {
        let sets = InstructionSet::available();
        assert_eq!(sets[0], InstructionSet::Scalar);
        assert!(sets.contains(&InstructionSet::detected()));
    }
}
