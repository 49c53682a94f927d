//! The signals that ask this process to end.

use std::future::Future;
use std::io;
use tokio::signal::unix::{SignalKind, signal};

/// Ready once one has come. Signals count from this call on.
pub(super) fn end() -> io::Result<impl Future<Output = ()>> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    Ok(async move {
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
        }
    })
}
