//! The widest vectors that this machine has, chosen as the program runs.
//!
//! Operations and their order are as written, so every machine gives the same bits. Nothing is fused that is not
//! written as `mul_add`, which rounds once everywhere: one instruction where the processor has it (x86-64 since 2013,
//! all of aarch64), on older ones a call of the system's `fma`, some ten times slower.

/// What is to be done: a type rather than a closure, as its `call` must be `#[inline(always)]`, and all that it calls,
/// to be compiled for those vectors.
pub(crate) use pulp::NullaryFnOnce as Work;
pub(crate) use pulp::Simd;
/// The same where vectors are named, as the compiler does not find them.
pub(crate) use pulp::WithSimd as Wide;

/// Does `work` with the widest vectors of this machine.
#[inline]
pub(crate) fn widest<W: Wide>(work: W) -> W::Output {
    #[cfg(test)]
    if WITHOUT.get() {
        return pulp::Arch::Scalar.dispatch(work);
    }
    pulp::Arch::new().dispatch(work)
}

#[cfg(test)]
thread_local! {
    static WITHOUT: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// What `work` gives on a machine that has no vectors. Only of what runs on this thread.
#[cfg(test)]
pub(crate) fn without_vectors<R>(work: impl FnOnce() -> R) -> R {
    /// Vectors are back after a panic too.
    struct Back;
    impl Drop for Back {
        fn drop(&mut self) {
            WITHOUT.set(false);
        }
    }
    WITHOUT.set(true);
    let _back = Back;
    work()
}
