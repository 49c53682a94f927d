//! Bytes that are written on one thread and sent on another, a few at a time: a client that takes them slowly holds up the
//! writer, and one that takes none for long is given up.
//!
//! Knows bodies of answers. Must never know what is written.

use axum::body::{Body, Bytes};
use futures_util::stream;
use std::io::{self, Write};
use std::time::Duration;
use tokio::runtime::Handle;
use tokio::sync::mpsc;
use tokio::time::timeout;

/// So many parts wait to be sent.
const PARTS: usize = 4;
/// So long a client may take for one.
const PATIENCE: Duration = Duration::from_mins(1);

/// What is sent next; an error ends the answer in the middle.
type Part = io::Result<Bytes>;

/// The writing end.
#[derive(Debug)]
pub(super) struct Sending {
    parts: mpsc::Sender<Part>,
    runtime: Handle,
    patience: Duration,
}

/// Both ends. The writer needs a thread that may wait, of the runtime that this is called in.
pub(super) fn sending() -> (Sending, Body) {
    let (parts, mut received) = mpsc::channel::<Part>(PARTS);
    // Whoever packs the answer asks again behind its end.
    let body = Body::from_stream(stream::poll_fn(move |context| received.poll_recv(context)));
    (Sending { parts, runtime: Handle::current(), patience: PATIENCE }, body)
}

impl Sending {
    /// The answer ends here, and not as it should.
    pub(super) fn fail(&self, error: impl Into<Box<dyn std::error::Error + Send + Sync>>) {
        // A client that is gone knows.
        self.send(Err(io::Error::other(error))).unwrap_or_default();
    }

    fn send(&self, part: Part) -> io::Result<()> {
        let sent = self.runtime.block_on(timeout(self.patience, self.parts.send(part)));
        match sent {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_gone)) => Err(io::ErrorKind::BrokenPipe.into()),
            Err(_elapsed) => Err(io::ErrorKind::TimedOut.into()),
        }
    }
}

impl Write for Sending {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.send(Ok(Bytes::copy_from_slice(bytes)))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{PARTS, Sending, sending};
    use std::io::{self, Write as _};
    use std::time::Duration;
    use tokio::task::spawn_blocking;

    async fn on_a_thread<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
        spawn_blocking(work).await.unwrap()
    }

    #[tokio::test]
    async fn what_is_written_is_sent_and_a_failure_ends_it() {
        let (mut sending, body) = sending();
        let writer = spawn_blocking(move || {
            for _ in 0..100 {
                sending.write_all(b"part ").unwrap();
            }
            drop(sending);
        });
        let bytes = axum::body::to_bytes(body, usize::MAX).await.unwrap();
        assert_eq!(bytes.len(), 500);
        writer.await.unwrap();
        let (sending, body) = super::sending();
        on_a_thread(move || sending.fail("the disk is gone")).await;
        assert!(axum::body::to_bytes(body, usize::MAX).await.is_err());
    }

    #[tokio::test]
    async fn a_client_that_takes_nothing_or_goes_away_does_not_hold_a_thread() {
        let (sending, body) = sending();
        let mut sending = Sending { patience: Duration::from_millis(20), ..sending };
        let refused = on_a_thread(move || {
            let results: Vec<_> = (0..=PARTS).map(|_| sending.write_all(b"part")).collect();
            results
                .into_iter()
                .map(|result| result.map_err(|error| error.kind()))
                .collect::<Vec<_>>()
        });
        let refused = refused.await;
        assert_eq!(refused[PARTS - 1], Ok(()));
        assert_eq!(refused[PARTS], Err(io::ErrorKind::TimedOut));
        drop(body);
        let (mut sending, body) = super::sending();
        drop(body);
        let result = on_a_thread(move || sending.write_all(b"part")).await;
        assert_eq!(result.map_err(|error| error.kind()), Err(io::ErrorKind::BrokenPipe));
    }
}
