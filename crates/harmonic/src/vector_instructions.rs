//! Plain loops compiled for the vector instructions of the processor.

/// Runs `work` compiled for the widest vector instructions that the processor has. Only what is
/// inlined into `work` is. No operation is contracted or reordered: the result is the same on all
/// processors.
#[inline]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}
