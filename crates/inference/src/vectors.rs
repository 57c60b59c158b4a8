//! Loops on the widest vectors of the machine.

/// The outcome of `task`, compiled for the vector instructions of the machine. No sum changes its order and no product is
/// fused with a sum, so results are the same on all machines. What `task` calls must be compiled with it.
pub(crate) fn vectorised<R>(task: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(task)
}
