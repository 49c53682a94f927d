//! Messages to lines and back.

use serde::{Serialize, de::DeserializeOwned};

/// A line that is not a message.
#[derive(Debug, thiserror::Error)]
#[error("not a message of this protocol: {line}")]
pub struct FrameError {
    /// The start of the line.
    line: String,
    #[source]
    source: serde_json::Error,
}

/// One message as one line, newline included.
pub fn encode<T: Serialize>(message: &T) -> Result<Vec<u8>, FrameError> {
    let mut line = serde_json::to_vec(message)
        .map_err(|source| FrameError { line: "(our own message)".to_owned(), source })?;
    line.push(b'\n');
    Ok(line)
}

/// Reads one line. Unknown fields are ignored, unknown messages are an error.
pub fn decode<T: DeserializeOwned>(line: &str) -> Result<T, FrameError> {
    serde_json::from_str(line)
        .map_err(|source| FrameError { line: line.chars().take(120).collect(), source })
}

#[cfg(test)]
mod tests {
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
        let envelope = Envelope {
            id: "7".to_owned(),
            author: "ana".to_owned(),
            decided_on: Some(3),
            expiry: None,
            command: Command::StepInto { branch: None },
        };
        check(
            &ToRunner::Command(envelope),
            &expect![[r#"
                {"message":"command","id":"7","author":"ana","decided_on":3,"expiry":null,"command":{"type":"step_into","branch":null}}
            "#]],
        );
    }

    #[test]
    fn an_event_is_read_as_any_message_is() {
        let lines = [
            r#"{"message":"event","sequence":7,"t_ns":9,"event":{"type":"entered","path":"R/A","inputs":{"a":[1,2.5]}}}"#,
            r#"{"t_ns":9,"event":{"path":"R/A","type":"paused","more":1},"sequence":7,"message":"event"}"#,
            r#"{"message":"event","sequence":7,"t_ns":9,"event":{"type":"hallo"}}"#,
            r#"{"message":"event","sequence":-7,"t_ns":9,"event":{"type":"stopping"}}"#,
            r#"{"message":"pong","id":1,"now_ms":2}"#,
            "nonsense",
        ];
        for line in lines {
            let read =
                |read: Result<ToViewer, crate::FrameError>| read.map_err(|error| error.to_string());
            assert_eq!(read(ToViewer::read(line)), read(decode(line)), "{line}");
        }
        assert!(matches!(
            ToViewer::read(lines[0]),
            Ok(ToViewer::Event { sequence: 7, t_ns: 9, .. })
        ));
    }

    #[test]
    fn nonsense_is_refused_with_its_start() {
        let error = decode::<ToViewer>(r#"{"message":"hallo"}"#).unwrap_err();
        expect![[r#"not a message of this protocol: {"message":"hallo"}"#]]
            .assert_eq(&error.to_string());
    }
}
