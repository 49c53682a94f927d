//! Records of scripts and launches, in addition to the engine's events: lines, global variables and persistent values.

use crate::drive::driver::Driver;
use crate::drive::error::CommandError;
use crate::record::tell;
use crate::{Place, Scripts};
use rafcon_engine::PathId;
use rafcon_protocol::{Event, Keeping, LogLevel, Stream};
use rafcon_storage::journal::Record;
use std::sync::Arc;

/// Limit of a line in bytes. Longer lines are cut.
const LINE_BYTES_MAX: usize = 1 << 20;

impl<S: Scripts> Driver<S> {
    /// Records a line that a state wrote.
    pub fn log(&self, path: Option<PathId>, level: LogLevel, stream: Stream, message: String) {
        let place = path.and_then(|path| self.places().get(path));
        if place.is_some_and(|place| !self.keeps_line(place, level, stream)) {
            return;
        }
        let record = self.line(place.map(|place| &**place), level, stream, cut(message));
        self.record().note([record]);
        let safety = self.recorder().safety();
        if safety.is_full() {
            self.scripts().park(&mut || safety.wait_for_room());
        }
    }

    /// Sets global variables before anything runs, and records them.
    pub(crate) fn set_globals(
        &self,
        globals: &[(String, serde_json::Value)],
    ) -> Result<(), CommandError> {
        for (name, json) in globals {
            let set = self.scripts().value(json).and_then(|value| {
                self.global(name, Some(&value));
                self.scripts().restore_global(name, value)
            });
            set.map_err(|why| CommandError::Global { name: name.clone(), why })?;
        }
        Ok(())
    }

    /// Records a new value of a global variable, or its deletion.
    pub fn global(&self, name: &str, value: Option<&S::Value>) {
        let mut writer = self.recorder().write();
        if writer.keeps_values() {
            let value = value.map(|value| writer.kept(&self.scripts().keep(value)));
            writer.note(self.clock().now_ns(), &Record::Global { name: name.into(), value });
        }
    }

    /// Records what a state keeps from one of its runs to the next, as one value.
    pub fn persistent(&self, place: &Arc<Place>, value: &S::Value) {
        let mut writer = self.recorder().write();
        if writer.keeps_values() && place.keeping == Keeping::Full {
            let value = writer.kept(&self.scripts().keep(value));
            let place = place.number;
            writer.note(self.clock().now_ns(), &Record::Persistent { place, value });
        }
    }

    /// Waits, outside the interpreter, before a script begins: while too much is not safe from a power cut, and with
    /// the strict rule while anything is not.
    pub(crate) fn wait_for_safety(&self) {
        let safety = self.recorder().safety();
        if safety.holds() {
            self.scripts().park(&mut || safety.wait());
        }
    }

    /// True if the line of a state is recorded. In a run with a journal, a state with [`Keeping::Off`] drops what its
    /// script prints, except errors.
    fn keeps_line(&self, place: &Place, level: LogLevel, stream: Stream) -> bool {
        let printed = stream != Stream::Engine && level < LogLevel::Error;
        let told = self.recorder().keeping() == Keeping::Off || place.keeping != Keeping::Off;
        told || !printed
    }

    /// The record of a line. It is short if the record knows the place.
    fn line(
        &self,
        place: Option<&Place>,
        level: LogLevel,
        stream: Stream,
        message: String,
    ) -> Record {
        let number = place.map(|place| place.number);
        match place {
            Some(place) if self.recorder().names().latest(place.number).is_none() => {
                let path = place.text.to_string();
                tell::told(Event::Log { path, level, stream, message })
            }
            _ => Record::Log { place: number, level, stream, message },
        }
    }
}

fn cut(mut line: String) -> String {
    if line.len() > LINE_BYTES_MAX {
        let ends = (0..=LINE_BYTES_MAX).rev();
        let end = ends.into_iter().find(|&end| line.is_char_boundary(end)).unwrap_or_default();
        let rest = format!("… ({} more bytes)", line.len() - end);
        line.truncate(end);
        line.push_str(&rest);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::{LINE_BYTES_MAX, cut};

    #[test]
    fn a_line_is_cut_at_a_character_and_says_how_much_is_missing() {
        let most = LINE_BYTES_MAX;
        let cases = [
            ("x".repeat(most), most, ""),
            ("x".repeat(most + 1), most, "… (1 more bytes)"),
            (format!("{}é", "x".repeat(most - 2)), most, ""),
            (format!("{}é", "x".repeat(most - 1)), most - 1, "… (2 more bytes)"),
            ("x".repeat(3 * most), most, "… (2097152 more bytes)"),
        ];
        for (line, kept, rest) in cases {
            let expected = format!("{}{rest}", &line[..kept]);
            assert!(cut(line) == expected, "{kept} bytes and {rest:?}");
        }
    }
}
