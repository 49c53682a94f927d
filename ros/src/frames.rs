//! Frames between this program and the one that started it: the text of a JSON object, and bytes behind it.
//!
//! `docs/ros.md` describes them.

use std::io::{Read, Write};
use std::sync::Arc;

use tokio::sync::{Semaphore, mpsc};

use crate::json::{self, Json};

/// Bytes of a frame.
const FRAME_MAX: usize = 1 << 30;
/// Bytes of messages that wait for the program that started this one.
const WAITING_MAX: usize = 64 << 20;

/// A frame.
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

/// Writes a frame.
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

/// Where frames wait until they are written.
#[derive(Clone)]
pub(crate) struct Outbox {
    frames: mpsc::UnboundedSender<(Frame, usize)>,
    room: Arc<Semaphore>,
}

impl Outbox {
    /// One whose frames a thread of its own writes to `to`, until that fails.
    pub(crate) fn new(mut to: impl Write + Send + 'static) -> std::io::Result<Self> {
        let (frames, mut waiting) = mpsc::unbounded_channel::<(Frame, usize)>();
        let room = Arc::new(Semaphore::new(WAITING_MAX));
        let given_back = Arc::clone(&room);
        std::thread::Builder::new().name("frames".to_owned()).spawn(move || {
            while let Some((frame, size)) = waiting.blocking_recv() {
                // The input ends as well, and with it the program.
                if write(&frame, &mut to).is_err() {
                    break;
                }
                given_back.add_permits(size);
            }
        })?;
        Ok(Self { frames, room })
    }

    /// Sends an answer, or something of which there are few.
    pub(crate) fn tell(&self, text: String) {
        let _ = self.frames.send((Frame { text, bytes: Vec::new() }, 0));
    }

    /// Sends a message, when there is room for it.
    pub(crate) async fn message(&self, frame: Frame) {
        let size = (frame.text.len() + frame.bytes.len()).min(WAITING_MAX);
        if let Ok(room) = self.room.acquire_many(u32::try_from(size).unwrap_or(u32::MAX)).await {
            room.forget();
            let _ = self.frames.send((frame, size));
        }
    }

    /// Sends a line for the log.
    pub(crate) fn say(&self, level: &str, text: &str) {
        self.tell(format!(r#"{{"say":"{level}","text":{}}}"#, json::quoted(text)));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Frame, read, write};
    use crate::json::Json;

    #[test]
    fn a_frame_comes_back() {
        let mut bytes = Vec::new();
        write(&Frame { text: "[1]".to_owned(), bytes: vec![7; 3] }, &mut bytes).unwrap();
        assert_eq!(read(&mut &bytes[..]), Ok(Some((Json::List(vec![Json::Int(1)]), vec![7; 3]))));
        assert_eq!(read(&mut &bytes[..bytes.len() - 1]), Ok(None));
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_frame_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            let _ = read(&mut &bytes[..]);
        }
    }
}
