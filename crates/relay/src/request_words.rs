//! Requests of a station in the bytes of a command. Commands without data, such as stop and pause, have a short form, because each byte
//! of an up-link counts; all others are JSON, deflated if that is shorter.

use crate::words::StationRequest;
use rafcon_link::{StreamId, deflate, inflate};
use rafcon_protocol::Command;

const PLAIN: u8 = 0;
const DEFLATED: u8 = 1;
const SHORT: u8 = 2;
/// Maximum length of the JSON of a request in bytes.
const REQUEST_MAX: usize = 1 << 20;

/// Commands with a short form, by their number in it.
fn short_commands() -> [Command; 9] {
    [
        Command::Stop,
        Command::Pause,
        Command::Resume { branch: None },
        Command::Kill,
        Command::StepMode,
        Command::StepInto { branch: None },
        Command::StepOver { branch: None },
        Command::StepOut { branch: None },
        Command::StepBack { branch: None },
    ]
}

/// The bytes of a request for the run with these events.
pub(crate) fn write(events: StreamId, request: &StationRequest) -> Vec<u8> {
    write_short(events, request).unwrap_or_else(|| {
        let json = serde_json::to_vec(&(events.0, request)).unwrap_or_default();
        let deflated = deflate(&json);
        let (kind, bytes) =
            if deflated.len() < json.len() { (DEFLATED, deflated) } else { (PLAIN, json) };
        [&[kind], &*bytes].concat()
    })
}

/// Reads the bytes of a request; an error if they are none.
pub(crate) fn read(bytes: &[u8]) -> Result<(StreamId, StationRequest), String> {
    let json = |json: &[u8]| {
        let read = serde_json::from_slice::<(u32, StationRequest)>(json);
        read.map(|(events, request)| (StreamId(events), request)).map_err(|error| error.to_string())
    };
    match bytes.split_first() {
        Some((&PLAIN, plain)) => json(plain),
        Some((&DEFLATED, deflated)) => {
            let plain = inflate(deflated, REQUEST_MAX).ok_or("it is damaged or too long")?;
            json(&plain)
        }
        Some((&SHORT, short)) => read_short(short).ok_or_else(|| "it is damaged".to_owned()),
        _ => Err("it is of an unknown kind".to_owned()),
    }
}

/// Run, number of the command, author, what follows `AUTHOR/` in the id, and the last event that the author had seen.
fn write_short(events: StreamId, request: &StationRequest) -> Option<Vec<u8>> {
    let StationRequest::Command(id, author, decided_on, command) = request else { return None };
    let number = short_commands().iter().position(|short| short == command)?;
    let own_id = id.strip_prefix(author.as_str())?.strip_prefix('/')?;
    let mut out = vec![SHORT];
    out.extend_from_slice(&events.0.to_be_bytes());
    out.push(u8::try_from(number).ok()?);
    for text in [author, own_id] {
        out.push(u8::try_from(text.len()).ok()?);
        out.extend_from_slice(text.as_bytes());
    }
    if let Some(event) = decided_on {
        let bytes = event.to_be_bytes();
        let zeros = bytes.iter().take(7).take_while(|byte| **byte == 0).count();
        out.extend_from_slice(&bytes[zeros..]);
    }
    Some(out)
}

fn read_short(bytes: &[u8]) -> Option<(StreamId, StationRequest)> {
    let (events, rest) = bytes.split_first_chunk()?;
    let (number, rest) = rest.split_first()?;
    let (author, rest) = read_text(rest)?;
    let (own_id, event) = read_text(rest)?;
    let mut decided_on = [0; 8];
    decided_on.get_mut(8_usize.checked_sub(event.len())?..)?.copy_from_slice(event);
    let decided_on = (!event.is_empty()).then(|| u64::from_be_bytes(decided_on));
    let command = short_commands().get(usize::from(*number))?.clone();
    let id = format!("{author}/{own_id}");
    let request = StationRequest::Command(id, author.to_owned(), decided_on, command);
    Some((StreamId(u32::from_be_bytes(*events)), request))
}

fn read_text(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let (length, rest) = bytes.split_first()?;
    let (text, rest) = rest.split_at_checked(usize::from(*length))?;
    Some((std::str::from_utf8(text).ok()?, rest))
}

#[cfg(test)]
mod tests {
    use super::{DEFLATED, REQUEST_MAX, read, short_commands, write};
    use crate::words::StationRequest;
    use proptest::prelude::*;
    use rafcon_link::{StreamId, deflate};
    use rafcon_protocol::Command;

    const EVENTS: StreamId = StreamId(0x1234_5679);

    fn stop(decided_on: Option<u64>) -> StationRequest {
        let (id, author) = ("ana/0123456789abcdef01-7".to_owned(), "ana".to_owned());
        StationRequest::Command(id, author, decided_on, Command::Stop)
    }

    #[test]
    fn a_stop_is_short() {
        let bytes = write(EVENTS, &stop(Some(300)));
        let expected = b"\x02\x12\x34\x56\x79\x00\x03ana\x140123456789abcdef01-7\x01\x2c";
        assert_eq!(bytes, expected);
    }

    #[test]
    fn a_script_is_deflated() {
        let script = "def execute(self, inputs, outputs, gvm):\n    return 0\n".repeat(400);
        let command = Command::EditScript { path: "R/A".to_owned(), script };
        let request = StationRequest::Command("a/1".to_owned(), "a".to_owned(), None, command);
        let bytes = write(EVENTS, &request);
        assert!(bytes.len() < 1_000, "{} bytes", bytes.len());
        assert_eq!(read(&bytes), Ok((EVENTS, request)));
    }

    #[test]
    fn what_would_become_too_long_is_refused() {
        let bomb = [&[DEFLATED], &*deflate(&vec![b' '; REQUEST_MAX + 1])].concat();
        assert!(bomb.len() < 2_000);
        assert_eq!(read(&bomb), Err("it is damaged or too long".to_owned()));
    }

    proptest! {
        #[test]
        fn requests_are_read_as_they_were_written(
            author in "[a-z]{0,4}|.{0,300}",
            own_id in "[0-9a-f]{18}-[0-9]{1,3}|.{0,300}",
            is_own in any::<bool>(),
            decided_on in prop::option::of(any::<u64>()),
            nth in 0..12_usize,
        ) {
            let id = if is_own { format!("{author}/{own_id}") } else { own_id };
            let run_to = Command::RunTo { path: author.clone() };
            let command = short_commands().get(nth).cloned().unwrap_or(run_to);
            let request = StationRequest::Command(id, author, decided_on, command);
            prop_assert_eq!(read(&write(EVENTS, &request)), Ok((EVENTS, request)));
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..80), kind in 0..4_u8) {
            let _refused = read(&[&[kind], &*bytes].concat());
        }
    }
}
