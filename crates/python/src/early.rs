//! Output of plugins before the run exists. It is kept here and later written at the head of the run's log.
//!
//! Knows lines. Does not know what a run does with them.

use crate::scripts::PythonScripts;
use parking_lot::Mutex;
use rafcon_protocol::{LogLevel, Stream};
use rafcon_runner::Driver;

/// Maximum size of the kept output, in bytes, so that a plugin that prints without end does not fill the memory.
const BYTES_MAX: usize = 1 << 20;

/// A line of output.
#[derive(Debug)]
pub(crate) struct Line {
    pub(crate) level: LogLevel,
    pub(crate) stream: Stream,
    pub(crate) message: String,
}

#[derive(Debug)]
struct Early {
    lines: Vec<Line>,
    bytes: usize,
    left_out: usize,
    is_over: bool,
}

static EARLY: Mutex<Early> =
    Mutex::new(Early { lines: Vec::new(), bytes: 0, left_out: 0, is_over: false });

/// Keeps a line until the run exists; returns the line if the run already exists.
pub(crate) fn keep(line: Line) -> Option<Line> {
    let mut early = EARLY.lock();
    if early.is_over {
        return Some(line);
    }
    if early.bytes + line.message.len() > BYTES_MAX {
        early.left_out += 1;
    } else {
        early.bytes += line.message.len();
        early.lines.push(line);
    }
    None
}

/// Keeps a message of RAFCON itself.
pub(crate) fn say(level: LogLevel, message: String) {
    keep(Line { level, stream: Stream::Engine, message });
}

/// Moves the kept lines to the run's log. Later lines are no longer kept.
pub(crate) fn hand_over(driver: &Driver<PythonScripts>) {
    for Line { level, stream, message } in take() {
        driver.log(None, level, stream, message);
    }
}

/// Prints the lines to the standard error if no run was started.
#[expect(clippy::print_stderr, reason = "without a run there is no other log")]
pub(crate) fn print() {
    for line in take() {
        eprintln!("{}", line.message);
    }
}

fn take() -> Vec<Line> {
    let mut early = EARLY.lock();
    early.is_over = true;
    let mut lines = std::mem::take(&mut early.lines);
    if early.left_out > 0 {
        let message = format!(
            "{} further lines from before the start of the run are left out",
            early.left_out
        );
        lines.push(Line { level: LogLevel::Warning, stream: Stream::Engine, message });
    }
    lines
}
