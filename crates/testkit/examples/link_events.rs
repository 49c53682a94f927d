//! Prints the events of a mission for `cargo xtask link-compare`, one a line: ns since the first, items in hexadecimal digits, path,
//! names. The first line is the state of the mission in its middle, in hexadecimal digits.
//!
//! They are those of some time in the middle of an hour: in the first minutes each event has a definition with it, because its state is
//! new.

use rafcon_testkit::link_world::sample_events;
use std::fmt::Write as _;
use std::io::{self, BufWriter, Write as _};
use std::time::Duration;

/// When it begins.
const BEFORE: Duration = Duration::from_mins(30);

fn main() -> io::Result<()> {
    let seconds = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(60);
    let (events, state) = sample_events(7, BEFORE + Duration::from_secs(seconds));
    let before_ns = u64::try_from(BEFORE.as_nanos()).unwrap_or_default();
    let mut out = BufWriter::new(io::stdout().lock());
    writeln!(out, "{}", hex(&state))?;
    for event in events.iter().filter(|event| event.t_ns >= before_ns) {
        let t_ns = event.t_ns - before_ns;
        writeln!(out, "{t_ns}\t{}\t{}\t{}", hex(&event.items), event.path, event.names)?;
    }
    out.flush()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap_or_default();
        text
    })
}
