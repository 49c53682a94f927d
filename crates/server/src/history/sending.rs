//! Streams bytes from a writer thread to a client through a small queue: a slow client slows the writer down, and a client that
//! stalls is dropped.
//!
//! Knows bodies of responses. Does not know the content.

use crate::Failure;
use axum::body::{Body, Bytes};
use futures_util::{StreamExt as _, stream};
use std::io::{self, Write};
use std::time::Duration;
use tokio::runtime::Handle;
use tokio::sync::mpsc;
use tokio::time::timeout;

/// Capacity of the queue, in parts.
const PARTS: usize = 4;
/// Time limit for a client to accept a part.
const CLIENT_TIMEOUT: Duration = Duration::from_mins(1);

/// The next part. A failure aborts the response.
type SentPart = Result<Bytes, Failure>;

/// The writing end of the stream.
#[derive(Debug)]
pub(super) struct Sending {
    parts: mpsc::Sender<SentPart>,
    runtime: Handle,
    patience: Duration,
}

/// The receiving end of the stream.
#[derive(Debug)]
pub(super) struct Written(mpsc::Receiver<SentPart>);

/// Both ends of a stream. The writer must run on a blocking thread of the current runtime.
pub(super) fn sending() -> (Sending, Written) {
    let (parts, received) = mpsc::channel(PARTS);
    (Sending { parts, runtime: Handle::current(), patience: CLIENT_TIMEOUT }, Written(received))
}

impl Written {
    /// The body, once its first part has arrived. A failure before it is a refusal; a later one aborts the response.
    pub(super) async fn body(mut self) -> Result<Body, Failure> {
        let first = self.0.recv().await.transpose()?;
        // The compression layer polls again after the end.
        let rest = stream::poll_fn(move |context| self.0.poll_recv(context));
        let parts = stream::iter(first.map(Ok)).chain(rest);
        Ok(Body::from_stream(parts.map(|part| part.map_err(|failure| failure.to_string()))))
    }
}

impl Sending {
    /// Aborts the response with a failure.
    pub(super) fn fail(&self, failure: Failure) {
        // A client that has disconnected needs no notice.
        self.send(Err(failure)).unwrap_or_default();
    }

    fn send(&self, part: SentPart) -> io::Result<()> {
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
    use crate::Failure;
    use axum::body::to_bytes;
    use std::io::{self, Write as _};
    use std::time::Duration;
    use tokio::task::spawn_blocking;

    async fn on_a_thread<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
        spawn_blocking(work).await.unwrap()
    }

    fn failure() -> Failure {
        Failure::bad("no_disk", "the disk is gone")
    }

    #[tokio::test]
    async fn what_is_written_is_sent_and_a_failure_ends_it() {
        let (mut sending, written) = sending();
        let writer = spawn_blocking(move || {
            for _ in 0..100 {
                sending.write_all(b"part ").unwrap();
            }
            drop(sending);
        });
        let bytes = to_bytes(written.body().await.unwrap(), usize::MAX).await.unwrap();
        assert_eq!(bytes.len(), 500);
        writer.await.unwrap();
        let (mut sending, written) = super::sending();
        on_a_thread(move || {
            sending.write_all(b"part ").unwrap();
            sending.fail(failure());
        })
        .await;
        assert!(to_bytes(written.body().await.unwrap(), usize::MAX).await.is_err());
    }

    #[tokio::test]
    async fn what_fails_before_its_first_part_is_a_refusal() {
        let (sending, written) = sending();
        on_a_thread(move || sending.fail(failure())).await;
        assert_eq!(written.body().await.unwrap_err().code(), "no_disk");
        let (sending, written) = super::sending();
        on_a_thread(move || drop(sending)).await;
        assert_eq!(to_bytes(written.body().await.unwrap(), 1).await.unwrap().len(), 0);
    }

    #[tokio::test]
    async fn a_client_that_takes_nothing_or_goes_away_does_not_hold_a_thread() {
        let (sending, written) = sending();
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
        drop(written);
        let (mut sending, written) = super::sending();
        drop(written);
        let result = on_a_thread(move || sending.write_all(b"part")).await;
        assert_eq!(result.map_err(|error| error.kind()), Err(io::ErrorKind::BrokenPipe));
    }
}
