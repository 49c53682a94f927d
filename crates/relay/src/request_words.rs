//! Requests of a station in the bytes of a command. Commands without data, such as stop and pause, have a short form, because each byte
//! of an up-link counts; all others are JSON, deflated if that is shorter.

use crate::ids;
use crate::words::StationRequest;
use rafcon_link::{BrokenFrame, CommandId, FrameReader, StreamId, deflate, inflate, write_number};
use rafcon_protocol::Command;

const PLAIN: u8 = 0;
const DEFLATED: u8 = 1;
/// Kind of the first command with a short form; the others follow.
const SHORT: u8 = 2;
/// Added to the kind of a short form that spells the id.
const SPELLED: u8 = 0x40;
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

/// Reads the bytes of the command with this id; an error if they are no request.
pub(crate) fn read(id: CommandId, bytes: &[u8]) -> Result<(StreamId, StationRequest), String> {
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
        Some((kind, short)) => {
            let nth = usize::from((kind & !SPELLED).wrapping_sub(SHORT));
            let command = short_commands().into_iter().nth(nth);
            let command = command.ok_or("it is of an unknown kind")?;
            let is_spelled = kind & SPELLED != 0;
            let parts = read_short(short, is_spelled).map_err(|error| error.to_string())?;
            parts.request(id, command).ok_or_else(|| "it is damaged".to_owned())
        }
        None => Err("it is empty".to_owned()),
    }
}

/// Number of the command, run, the last event that the author had seen, what follows `AUTHOR/` in the id unless the id of the command
/// contains it, and the author.
fn write_short(events: StreamId, request: &StationRequest) -> Option<Vec<u8>> {
    let StationRequest::Command(id, author, decided_on, command) = request else { return None };
    let number = short_commands().iter().position(|short| short == command)?;
    let own_id = id.strip_prefix(author.as_str())?.strip_prefix('/')?;
    let is_spelled = ids::own_id(ids::command(id), author).is_none_or(|known| known != own_id);
    let kind = SHORT + u8::try_from(number).ok()? + if is_spelled { SPELLED } else { 0 };
    let mut out = vec![kind];
    out.extend_from_slice(&events.0.to_be_bytes());
    write_number(decided_on.map_or(Some(0), |event| event.checked_add(1))?, &mut out);
    if is_spelled {
        write_number(own_id.len() as u64, &mut out);
        out.extend_from_slice(own_id.as_bytes());
    }
    out.extend_from_slice(author.as_bytes());
    Some(out)
}

/// Content of a short form.
struct ShortForm<'b> {
    events: StreamId,
    decided_on: Option<u64>,
    own_id: Option<&'b [u8]>,
    author: &'b [u8],
}

fn read_short(bytes: &[u8], is_spelled: bool) -> Result<ShortForm<'_>, BrokenFrame> {
    let mut reader = FrameReader::new(bytes);
    Ok(ShortForm {
        events: StreamId(u32::from_be_bytes(reader.fixed()?)),
        decided_on: reader.number()?.checked_sub(1),
        own_id: is_spelled.then(|| reader.bytes()).transpose()?,
        author: reader.rest(),
    })
}

impl ShortForm<'_> {
    fn request(self, id: CommandId, command: Command) -> Option<(StreamId, StationRequest)> {
        let author = std::str::from_utf8(self.author).ok()?;
        let own_id = match self.own_id {
            Some(spelled) => std::str::from_utf8(spelled).ok()?.to_owned(),
            None => ids::own_id(id, author)?,
        };
        let id = format!("{author}/{own_id}");
        let request = StationRequest::Command(id, author.to_owned(), self.decided_on, command);
        Some((self.events, request))
    }
}

#[cfg(test)]
mod tests {
    use super::{DEFLATED, REQUEST_MAX, read, short_commands, write};
    use crate::ids;
    use crate::words::StationRequest;
    use proptest::prelude::*;
    use rafcon_link::{StreamId, deflate};
    use rafcon_protocol::Command;

    const EVENTS: StreamId = StreamId(0x1234_5679);

    fn stop(own_id: &str) -> StationRequest {
        let (id, author) = (format!("ana/{own_id}"), "ana".to_owned());
        StationRequest::Command(id, author, Some(300), Command::Stop)
    }

    #[test]
    fn a_stop_is_short() {
        let bytes = write(EVENTS, &stop("0123456789ab"));
        assert_eq!(bytes, b"\x02\x12\x34\x56\x79\xad\x02ana");
        let bytes = write(EVENTS, &stop("7"));
        assert_eq!(bytes, b"\x42\x12\x34\x56\x79\xad\x02\x017ana");
    }

    #[test]
    fn a_script_is_deflated() {
        let script = "def execute(self, inputs, outputs, gvm):\n    return 0\n".repeat(400);
        let command = Command::EditScript { path: "R/A".to_owned(), script };
        let request = StationRequest::Command("a/1".to_owned(), "a".to_owned(), None, command);
        let bytes = write(EVENTS, &request);
        assert!(bytes.len() < 1_000, "{} bytes", bytes.len());
        assert_eq!(read(ids::command("a/1"), &bytes), Ok((EVENTS, request)));
    }

    #[test]
    fn what_would_become_too_long_is_refused() {
        let bomb = [&[DEFLATED], &*deflate(&vec![b' '; REQUEST_MAX + 1])].concat();
        assert!(bomb.len() < 2_000);
        assert_eq!(read(ids::command("a/1"), &bomb), Err("it is damaged or too long".to_owned()));
    }

    proptest! {
        #[test]
        fn requests_are_read_as_they_were_written(
            author in "[a-z]{0,4}|.{0,300}",
            own_id in "[0-9a-f]{12}|[0-9a-f]{11,13}|.{0,300}",
            is_own in any::<bool>(),
            decided_on in prop::option::of(any::<u64>()),
            nth in 0..12_usize,
        ) {
            let id = if is_own { format!("{author}/{own_id}") } else { own_id };
            let run_to = Command::RunTo { path: author.clone() };
            let command = short_commands().get(nth).cloned().unwrap_or(run_to);
            let command_id = ids::command(&id);
            let request = StationRequest::Command(id, author, decided_on, command);
            prop_assert_eq!(read(command_id, &write(EVENTS, &request)), Ok((EVENTS, request)));
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..80), kind in any::<u8>()) {
            let _refused = read(ids::command("ana/0123456789ab"), &[&[kind], &*bytes].concat());
        }
    }
}
