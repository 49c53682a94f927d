//! What the user sees of a run: JSON lines for programs, plain lines for pipes, a live picture on a terminal.
//!
//! Knows how things are shown, never what is to be done about them.

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

/// Something that shows a run. An error means that no one can see it any more; the run continues.
pub(crate) trait View {
    /// Whether states coming and going are wanted one by one.
    fn every_event(&self) -> bool;
    /// How often there should be a refresh even if nothing happens.
    fn rhythm(&self) -> Option<Duration> {
        None
    }
    /// The run begins.
    fn loaded(&mut self, name: &str, states: u64) -> io::Result<()>;
    /// Something happened, so long after the start.
    fn event(&mut self, time: Duration, event: Event) -> io::Result<()>;
    /// How things stand.
    fn snapshot(&mut self, now: Duration, snapshot: Snapshot) -> io::Result<()>;
    /// Whether the run is heard at all: what is shown is as old as the last word.
    fn heard(&mut self, _now: Duration, _silence: Option<Duration>) -> io::Result<()> {
        Ok(())
    }
    /// Something about this program.
    fn note(&mut self, text: &str) -> io::Result<()>;
    /// A key was pressed.
    fn key(&mut self, _key: Key) -> Option<UserAction> {
        None
    }
    /// What a state holds, as was asked for.
    fn inspected(&mut self, _path: &str, _data: Option<StateData>) -> io::Result<()> {
        Ok(())
    }
    /// There is a moment to bring everything to the eye.
    fn refresh(&mut self, now: Duration) -> io::Result<()>;
    /// The user puts this program aside; the next refresh is when it is back.
    fn set_aside(&mut self) -> io::Result<()>;
    /// All values at the end of the run, of which its last event has views.
    fn end_values(&mut self, _values: EndValues) -> io::Result<()> {
        Ok(())
    }
    /// Nothing more comes.
    fn end(&mut self, end: &End) -> io::Result<()>;
}

/// Shows nothing: what is left when the output is gone.
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
