//! Work that waits for a disk or computes for long, away from the threads that talk. Must never know what the work is.

use crate::Failure;

/// Does the work on a thread of its own kind, and waits for it without holding anybody up.
pub(crate) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
) -> Result<T, Failure> {
    tokio::task::spawn_blocking(work).await.unwrap_or_else(|_stopped| {
        let message = "the server could not finish this request: try again, and report it";
        Err(Failure::unavailable("not_finished", message))
    })
}
