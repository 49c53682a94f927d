//! A stream with a time limit for its reader: data that stays unwritten for too long ends it. Knows bytes and time; does not know
//! their meaning.

use crate::access::{ConnectionSlot, Lost};
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::{Sleep, sleep};

/// Minimum that a slow reader must accept within the time limit, so that one byte a minute is not enough.
const BYTES_MIN: usize = 16 * 1024;

/// A stream that ends if its reader accepts too little within the limit, or if another connection takes its slot. It holds the
/// slot, also after the upgrade to a WebSocket.
#[derive(Debug)]
pub(super) struct Paced<T> {
    io: T,
    limit: Duration,
    /// Active while data waits to be written.
    deadline: Option<Pin<Box<Sleep>>>,
    /// Bytes written since the deadline was set.
    written: usize,
    lost: Lost,
    _place: Arc<ConnectionSlot>,
}

impl<T> Paced<T> {
    pub(super) fn new(io: T, limit: Duration, place: Arc<ConnectionSlot>, lost: Lost) -> Self {
        Self { io, limit, deadline: None, written: 0, lost, _place: place }
    }

    /// Fails once another connection has taken the slot.
    fn keep_place(&mut self, context: &mut Context<'_>) -> io::Result<()> {
        match Pin::new(&mut self.lost).poll(context) {
            Poll::Pending => Ok(()),
            Poll::Ready(_) => Err(io::ErrorKind::ConnectionAborted.into()),
        }
    }

    fn check(
        &mut self,
        context: &mut Context<'_>,
        done: Poll<io::Result<usize>>,
    ) -> Poll<io::Result<usize>> {
        match done {
            Poll::Pending => {
                let limit = self.limit;
                let deadline = self.deadline.get_or_insert_with(|| Box::pin(sleep(limit)));
                if deadline.as_mut().poll(context).is_ready() {
                    return Poll::Ready(Err(io::ErrorKind::TimedOut.into()));
                }
            }
            Poll::Ready(Ok(bytes)) if self.deadline.is_some() => {
                self.written += bytes;
                if self.written >= BYTES_MIN {
                    self.restart();
                }
            }
            Poll::Ready(_) => {}
        }
        done
    }

    /// Restarts the limit after a flush or enough bytes.
    fn restart(&mut self) {
        self.deadline = None;
        self.written = 0;
    }
}

impl<T: AsyncRead + Unpin> AsyncRead for Paced<T> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        self.keep_place(context)?;
        Pin::new(&mut self.io).poll_read(context, buffer)
    }
}

impl<T: AsyncWrite + Unpin> AsyncWrite for Paced<T> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.keep_place(context)?;
        let done = Pin::new(&mut self.io).poll_write(context, bytes);
        self.check(context, done)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        slices: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        self.keep_place(context)?;
        let done = Pin::new(&mut self.io).poll_write_vectored(context, slices);
        self.check(context, done)
    }

    fn is_write_vectored(&self) -> bool {
        self.io.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        let done = Pin::new(&mut self.io).poll_flush(context);
        if done.is_ready() {
            self.restart();
        }
        done
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.io).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use super::{BYTES_MIN, Paced};
    use crate::access::{Capacity, ConnectionSlots, Peer};
    use std::net::{IpAddr, Ipv4Addr};
    use std::time::Duration;
    use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _, DuplexStream, duplex};
    use tokio::time::{Instant, sleep};

    const LIMIT: Duration = Duration::from_mins(1);

    /// Writes 1 MiB to a reader that accepts `bytes` bytes every 10 s. Returns success and the time.
    async fn written(bytes: usize) -> (bool, Duration) {
        let places = ConnectionSlots::new(Capacity { all: 1, anonymous: 1 });
        let peer = Peer { ip: IpAddr::V4(Ipv4Addr::LOCALHOST), is_near: true };
        let (near, far) = duplex(4096);
        let (place, lost) = places.take(peer).unwrap();
        let mut paced = Paced::new(near, LIMIT, place, lost);
        tokio::spawn(read(far, bytes));
        let begun = Instant::now();
        let done = paced.write_all(&vec![0; 1 << 20]).await;
        (done.is_ok(), begun.elapsed())
    }

    async fn read(mut far: DuplexStream, bytes: usize) {
        let mut part = vec![0; bytes];
        loop {
            sleep(Duration::from_secs(10)).await;
            if bytes > 0 && far.read_exact(&mut part).await.is_err() {
                return;
            }
        }
    }

    #[tokio::test(start_paused = true)]
    async fn who_reads_slowly_is_served_and_who_does_not_read_is_let_go() {
        assert!(written(BYTES_MIN).await.0);
        assert_eq!(written(0).await, (false, LIMIT));
        let (is_done, after) = written(100).await;
        assert!(!is_done && after <= 2 * LIMIT);
    }
}
