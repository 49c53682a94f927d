//! Encoding of messages. Both hellos and all messages of a viewer are lines of JSON. After its hello a runner sends frames, each
//! with its kind and length in front.

use crate::ToViewer;
use serde::{Serialize, de::DeserializeOwned};
use std::io::{self, BufRead, Read as _};

/// A line that is not a message.
#[derive(Debug, thiserror::Error)]
#[error("not a message of this protocol: {line}")]
pub struct FrameError {
    /// Start of the line.
    line: String,
    #[source]
    source: serde_json::Error,
}

/// Encodes one message as one line, including the newline.
pub fn encode<T: Serialize>(message: &T) -> Result<Vec<u8>, FrameError> {
    let mut line = serde_json::to_vec(message)
        .map_err(|source| FrameError { line: "(our own message)".to_owned(), source })?;
    line.push(b'\n');
    Ok(line)
}

/// Decodes one line. Unknown fields are ignored. Unknown messages are an error.
pub fn decode<T: DeserializeOwned>(line: &str) -> Result<T, FrameError> {
    serde_json::from_str(line)
        .map_err(|source| FrameError { line: line.chars().take(120).collect(), source })
}

/// Length of a frame's head: one byte for the kind, then the length of the content in little-endian.
pub const FRAME_HEAD: usize = 5;
/// Maximum length of a frame's content.
const FRAME_BYTES_MAX: u32 = 1 << 30;

/// Kind of a frame's content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameKind {
    /// A [`ToViewer`] as JSON.
    Message,
    /// Events as blocks of the journal's items (`docs/journal.md`).
    Events,
    /// Content of a newer runner, to be skipped.
    Unknown,
}

impl FrameKind {
    fn byte(self) -> u8 {
        match self {
            Self::Message => b'm',
            Self::Events => b'e',
            Self::Unknown => 0,
        }
    }
}

/// Encodes the head of a frame.
pub fn frame_head(kind: FrameKind, length: usize) -> [u8; FRAME_HEAD] {
    let length = u32::try_from(length).unwrap_or(u32::MAX).to_le_bytes();
    [kind.byte(), length[0], length[1], length[2], length[3]]
}

/// Decodes the head of a frame: its kind and the length of its content. Fails if the length exceeds the maximum.
pub fn read_frame_head(head: [u8; FRAME_HEAD]) -> io::Result<(FrameKind, usize)> {
    let [kind, length @ ..] = head;
    let length = u32::from_le_bytes(length);
    if length > FRAME_BYTES_MAX {
        let what = format!("a runner sent a frame of {length} bytes, which is more than any has");
        return Err(io::Error::new(io::ErrorKind::InvalidData, what));
    }
    let kind = match kind {
        b'm' => FrameKind::Message,
        b'e' => FrameKind::Events,
        _ => FrameKind::Unknown,
    };
    Ok((kind, length as usize))
}

/// Encodes a message of a runner as a frame.
pub fn encode_frame(message: &ToViewer) -> Result<Vec<u8>, FrameError> {
    let mut frame = vec![0; FRAME_HEAD];
    serde_json::to_writer(&mut frame, message)
        .map_err(|source| FrameError { line: "(our own message)".to_owned(), source })?;
    let head = frame_head(FrameKind::Message, frame.len() - FRAME_HEAD);
    frame[..FRAME_HEAD].copy_from_slice(&head);
    Ok(frame)
}

/// Reads the next frame into `content`. Returns `None` at the end of the stream, also in the middle of a frame.
pub fn read_frame(from: &mut impl BufRead, content: &mut Vec<u8>) -> io::Result<Option<FrameKind>> {
    let mut head = [0; FRAME_HEAD];
    if is_end(from.read_exact(&mut head))? {
        return Ok(None);
    }
    let (kind, length) = read_frame_head(head)?;
    content.clear();
    // Reads without reserving memory first, because the length may be invalid.
    let count = from.take(length as u64).read_to_end(content)?;
    Ok((count == length).then_some(kind))
}

fn is_end(read: io::Result<()>) -> io::Result<bool> {
    match read {
        Ok(()) => Ok(false),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(true),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::{FRAME_BYTES_MAX, FrameKind, encode_frame, read_frame, read_frame_head};
    use crate::{Command, Envelope, ToRunner, ToViewer, decode, encode};
    use expect_test::{Expect, expect};

    fn check(message: &ToRunner, expect: &Expect) {
        let line = encode(message).unwrap();
        let text = String::from_utf8(line).unwrap();
        expect.assert_eq(&text);
        assert_eq!(&decode::<ToRunner>(&text).unwrap(), message);
    }

    #[test]
    fn a_command_is_one_line() {
        let command = Command::StepInto { branch: None };
        let envelope = Envelope { decided_on: Some(3), ..Envelope::new("7", "ana", command) };
        check(
            &ToRunner::Command(envelope),
            &expect![[r#"
                {"message":"command","id":"7","author":"ana","decided_on":3,"expiry":null,"command":{"type":"step_into","branch":null}}
            "#]],
        );
    }

    #[test]
    fn frames_are_read_as_they_were_written_and_a_cut_one_is_the_end() {
        let message = ToViewer::Pong { id: 1, now_ms: 2, engine: None, link: None };
        let bytes = [encode_frame(&message).unwrap(), encode_frame(&message).unwrap()].concat();
        for length in 0..=bytes.len() {
            let (mut from, mut content, mut count) = (&bytes[..length], Vec::new(), 0);
            while let Some(kind) = read_frame(&mut from, &mut content).unwrap() {
                assert_eq!(kind, FrameKind::Message);
                let text = std::str::from_utf8(&content).unwrap();
                assert_eq!(decode::<ToViewer>(text).unwrap(), message);
                count += 1;
            }
            assert_eq!(count, length / (bytes.len() / 2));
        }
    }

    #[test]
    fn a_frame_without_measure_is_refused() {
        let error = read_frame(&mut &b"{\"message\":"[..], &mut Vec::new()).unwrap_err();
        expect!["a runner sent a frame of 1936026914 bytes, which is more than any has"]
            .assert_eq(&error.to_string());
    }

    #[test]
    fn a_frame_is_as_long_as_the_bound_at_most() {
        let read = |length: u32| {
            let [a, b, c, d] = length.to_le_bytes();
            read_frame_head([b'e', a, b, c, d]).ok()
        };
        assert_eq!(read(FRAME_BYTES_MAX), Some((FrameKind::Events, 1 << 30)));
        assert_eq!([FRAME_BYTES_MAX + 1, u32::MAX].map(read), [None, None]);
    }

    #[test]
    fn nonsense_is_refused_with_its_start() {
        let error = decode::<ToViewer>(r#"{"message":"hallo"}"#).unwrap_err();
        expect![[r#"not a message of this protocol: {"message":"hallo"}"#]]
            .assert_eq(&error.to_string());
    }
}
