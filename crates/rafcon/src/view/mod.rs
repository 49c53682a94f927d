//! Views of a run for the user: JSON lines for programs, plain lines for pipes, a live picture on a terminal.
//!
//! Knows the presentation, never the actions that follow.

mod json;
mod lines;
mod live;
mod names;

mod text;
mod value;
mod words;

pub(crate) use json::Json;
pub(crate) use lines::{Lines, log_lines};
pub(crate) use live::Live;
pub(crate) use names::{Names, names_of};
pub(crate) use text::{Paint, Style, TextLine, counted, harmless, size, time};
pub(crate) use value::shown;
pub(crate) use words::outcome_style;

use crate::console::{Key, UserAction};
use crate::follow::End;
use rafcon_protocol::{Event, Snapshot, StateData};
use rafcon_storage::journal::folder::EndValues;
use std::io;
use std::time::Duration;

/// A view of a run. An error means that the output is closed; the run continues.
pub(crate) trait View {
    /// True if the view needs the begin and end of every state.
    fn every_event(&self) -> bool;
    /// Refresh interval without events.
    fn rhythm(&self) -> Option<Duration> {
        None
    }
    /// Shows the beginning of the run.
    fn loaded(&mut self, name: &str, states: u64) -> io::Result<()>;
    /// Shows an event; `time` counts from the start of the run.
    fn event(&mut self, time: Duration, event: Event) -> io::Result<()>;
    fn snapshot(&mut self, now: Duration, snapshot: Snapshot) -> io::Result<()>;
    /// Shows that the run responds, or the duration of its silence.
    fn heard(&mut self, _now: Duration, _silence: Option<Duration>) -> io::Result<()> {
        Ok(())
    }
    /// Shows a message about this program.
    fn note(&mut self, text: &str) -> io::Result<()>;
    /// Handles a key, and returns its action.
    fn key(&mut self, _key: Key) -> Option<UserAction> {
        None
    }
    /// Shows the requested data of a state.
    fn inspected(&mut self, _path: &str, _data: Option<StateData>) -> io::Result<()> {
        Ok(())
    }
    /// Writes pending output, and redraws the picture when that is due.
    fn refresh(&mut self, now: Duration) -> io::Result<()>;
    /// Restores the terminal while the program is suspended; the next refresh follows on return.
    fn set_aside(&mut self) -> io::Result<()>;
    /// Receives all values at the end of the run; its last event has only their views.
    fn end_values(&mut self, _values: EndValues) -> io::Result<()> {
        Ok(())
    }
    /// Shows the end of the run.
    fn end(&mut self, end: &End) -> io::Result<()>;
}

/// Shows nothing: the view after the output was closed.
#[derive(Debug)]
pub(crate) struct Nothing;

impl View for Nothing {
    fn every_event(&self) -> bool {
        false
    }
    fn loaded(&mut self, _name: &str, _states: u64) -> io::Result<()> {
        Ok(())
    }
    fn event(&mut self, _time: Duration, _event: Event) -> io::Result<()> {
        Ok(())
    }
    fn snapshot(&mut self, _now: Duration, _snapshot: Snapshot) -> io::Result<()> {
        Ok(())
    }
    fn note(&mut self, _text: &str) -> io::Result<()> {
        Ok(())
    }
    fn refresh(&mut self, _now: Duration) -> io::Result<()> {
        Ok(())
    }
    fn set_aside(&mut self) -> io::Result<()> {
        Ok(())
    }
    fn end(&mut self, _end: &End) -> io::Result<()> {
        Ok(())
    }
}
