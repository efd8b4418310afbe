//! Threads of a task's own.

/// Runs `work` with so many threads to share it among.
///
/// # Errors
/// Where the system has no threads left.
pub(super) fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> anyhow::Result<T> {
    if threads == rayon::current_num_threads() {
        return Ok(work());
    }
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).build()?.install(work))
}
