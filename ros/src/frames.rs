//! Frames between this program and its parent: the text of a JSON object, followed by bytes.
//!
//! `docs/ros.md` describes them.

use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::time::Duration;

use tokio::sync::{Semaphore, mpsc};

use crate::json::{self, Json};

/// Maximum size of a frame, in bytes.
const FRAME_MAX: usize = 1 << 30;
/// Capacity of the queue of messages for the parent, in bytes.
const WAITING_MAX: usize = 64 << 20;

/// A frame of the protocol.
#[derive(Debug, Default)]
pub(crate) struct Frame {
    pub(crate) text: String,
    pub(crate) bytes: Vec<u8>,
}

/// Reads the next frame; `None` at the end.
pub(crate) fn read(from: &mut impl Read) -> Result<Option<(Json, Vec<u8>)>, String> {
    let mut head = [0; 8];
    match from.read_exact(&mut head) {
        Ok(()) => {}
        Err(why) if why.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(None),
        Err(why) => return Err(why.to_string()),
    }
    let number = |at: usize| {
        u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]) as usize
    };
    let (total, text) = (number(0), number(4));
    if text > total || total > FRAME_MAX {
        return Err(format!("a frame of {total} bytes with a text of {text}"));
    }
    let mut bytes = Vec::new();
    let got = from.take(total as u64).read_to_end(&mut bytes).map_err(|why| why.to_string())?;
    if got < total {
        return Ok(None);
    }
    let value = json::parse(&bytes[..text])?;
    bytes.drain(..text);
    Ok(Some((value, bytes)))
}

/// Writes the lengths, the text and the bytes of a frame.
pub(crate) fn write(frame: &Frame, to: &mut impl Write) -> std::io::Result<()> {
    let (text, total) = (frame.text.len(), frame.text.len() + frame.bytes.len());
    let number = |value: usize| u32::try_from(value).unwrap_or(u32::MAX).to_le_bytes();
    let mut head = Vec::with_capacity(8 + text);
    head.extend_from_slice(&number(total));
    head.extend_from_slice(&number(text));
    head.extend_from_slice(frame.text.as_bytes());
    to.write_all(&head)?;
    to.write_all(&frame.bytes)?;
    to.flush()
}

/// An entry of the writer's queue.
enum Outgoing {
    /// A frame, with the capacity that it occupies.
    Frame(Frame, usize),
    /// A request for a signal once all earlier entries are written.
    End(SyncSender<()>),
}

/// Queue of frames for the parent.
#[derive(Clone)]
pub(crate) struct Outbox {
    frames: mpsc::UnboundedSender<Outgoing>,
    room: Arc<Semaphore>,
}

impl Outbox {
    /// An outbox whose own thread writes frames to `to`, until a write fails.
    pub(crate) fn new(mut to: impl Write + Send + 'static) -> std::io::Result<Self> {
        let (frames, mut waiting) = mpsc::unbounded_channel();
        let room = Arc::new(Semaphore::new(WAITING_MAX));
        let given_back = Arc::clone(&room);
        std::thread::Builder::new().name("frames".to_owned()).spawn(move || {
            while let Some(next) = waiting.blocking_recv() {
                match next {
                    // The input ends as well, which ends the program.
                    Outgoing::Frame(frame, _) if write(&frame, &mut to).is_err() => break,
                    Outgoing::Frame(_, size) => given_back.add_permits(size),
                    Outgoing::End(written) => written.send(()).unwrap_or_default(),
                }
            }
        })?;
        Ok(Self { frames, room })
    }

    /// Sends a response, or another rare frame, without a limit.
    pub(crate) fn tell(&self, text: String) {
        let _ = self.frames.send(Outgoing::Frame(Frame { text, bytes: Vec::new() }, 0));
    }

    /// Sends a message, after waiting for capacity.
    pub(crate) async fn message(&self, frame: Frame) {
        let size = (frame.text.len() + frame.bytes.len()).min(WAITING_MAX);
        if let Ok(room) = self.room.acquire_many(u32::try_from(size).unwrap_or(u32::MAX)).await {
            room.forget();
            let _ = self.frames.send(Outgoing::Frame(frame, size));
        }
    }

    /// Waits until all frames are written, up to a timeout.
    pub(crate) fn end(&self, timeout: Duration) {
        let (written, is_written) = sync_channel(1);
        if self.frames.send(Outgoing::End(written)).is_ok() {
            // The writer has ended if the parent has closed its input.
            let _ = is_written.recv_timeout(timeout);
        }
    }

    /// Sends a line for the log.
    pub(crate) fn say(&self, level: &str, text: &str) {
        self.tell(format!(r#"{{"say":"{level}","text":{}}}"#, json::quoted(text)));
    }
}

#[cfg(test)]
mod tests {
    use std::io::{self, Write};
    use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
    use std::time::Duration;

    use futures::FutureExt as _;
    use proptest::prelude::*;

    use super::{FRAME_MAX, Frame, Outbox, WAITING_MAX, read, write};
    use crate::json::Json;

    /// A test program that reads one frame per permission.
    struct Reader {
        may_read: Receiver<()>,
        lengths: SyncSender<usize>,
        taken: usize,
    }

    impl Write for Reader {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.taken += bytes.len();
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            self.may_read.recv().map_err(io::Error::other)?;
            self.lengths.send(std::mem::take(&mut self.taken)).map_err(io::Error::other)
        }
    }

    fn frame(length: usize) -> Frame {
        Frame { text: String::new(), bytes: vec![0; length] }
    }

    #[test]
    fn a_frame_comes_back() {
        let mut bytes = Vec::new();
        write(&Frame { text: "[1]".to_owned(), bytes: vec![7; 3] }, &mut bytes).unwrap();
        assert_eq!(read(&mut &bytes[..]), Ok(Some((Json::List(vec![Json::Int(1)]), vec![7; 3]))));
        assert_eq!(read(&mut &bytes[..bytes.len() - 1]), Ok(None));
    }

    #[test]
    fn a_frame_that_is_too_long_is_refused_before_its_bytes_come() {
        let head = |total: usize| [u32::try_from(total).unwrap().to_le_bytes(), [0; 4]].concat();
        assert_eq!(read(&mut &head(FRAME_MAX)[..]), Ok(None));
        let refused = read(&mut &head(FRAME_MAX + 1)[..]);
        assert_eq!(refused, Err("a frame of 1073741825 bytes with a text of 0".to_owned()));
    }

    #[tokio::test]
    async fn a_message_waits_for_room_and_answers_do_not() {
        let ((permit, may_read), (lengths, read)) = (sync_channel(8), sync_channel(8));
        let outbox = Outbox::new(Reader { may_read, lengths, taken: 0 }).unwrap();
        // A message longer than the capacity occupies all of it.
        outbox.message(frame(WAITING_MAX + 1)).await;
        let mut next = Box::pin(outbox.message(frame(1)));
        assert_eq!(next.as_mut().now_or_never(), None);
        outbox.tell("{}".to_owned());
        permit.send(()).unwrap();
        assert_eq!(read.recv(), Ok(8 + WAITING_MAX + 1));
        next.await;
        permit.send(()).unwrap();
        permit.send(()).unwrap();
        assert_eq!([read.recv(), read.recv()], [Ok(8 + 2), Ok(8 + 1)]);
    }

    #[test]
    fn the_end_waits_for_all_frames_and_not_for_a_program_that_is_gone() {
        let ((permit, may_read), (lengths, read)) = (sync_channel(8), sync_channel(8));
        let outbox = Outbox::new(Reader { may_read, lengths, taken: 0 }).unwrap();
        outbox.tell("{}".to_owned());
        permit.send(()).unwrap();
        outbox.end(Duration::MAX);
        assert_eq!(read.try_recv(), Ok(8 + 2));
        drop(permit);
        outbox.tell("{}".to_owned());
        outbox.end(Duration::MAX);
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_frame_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            let _ = read(&mut &bytes[..]);
        }
    }
}
