//! A run as plain lines: for pipes, files and simple terminals.

use super::text::{Paint, Style, TextLine, counted, harmless};
use super::words::{notable, summary};
use super::{Names, View};
use crate::follow::End;
use rafcon_protocol::{Event, LogLevel, Snapshot};
use std::io::{self, BufWriter, Write};
use std::time::Duration;

/// Writes a line for each beginning of a state, each end other than success, and each message.
#[derive(Debug)]
pub(crate) struct Lines<W: Write> {
    out: BufWriter<W>,
    names: Names,
    machine: String,
    finished: Option<(Duration, Event)>,
}

const PAINT: Paint = Paint { colour: false, unicode: true };

impl<W: Write> Lines<W> {
    pub(crate) fn new(out: W, names: Names) -> Self {
        let out = BufWriter::with_capacity(64 * 1024, out);
        Self { out, names, machine: String::new(), finished: None }
    }

    fn moment(&mut self, time: Duration, path: &str, text: &str) -> io::Result<()> {
        let names = self.names.path(path);
        let gap = if text.is_empty() || names.is_empty() { "" } else { ": " };
        for line in text.lines().chain(text.is_empty().then_some("")) {
            writeln!(self.out, "{:9.3}  {names}{gap}{line}", time.as_secs_f64())?;
        }
        Ok(())
    }
}

/// Prefix of a message; empty for the usual level.
fn level(level: LogLevel) -> &'static str {
    match level {
        LogLevel::Verbose | LogLevel::Debug => "debug: ",
        LogLevel::Info => "",
        LogLevel::Warning => "warning: ",
        LogLevel::Error => "error: ",
    }
}

impl<W: Write> View for Lines<W> {
    fn every_event(&self) -> bool {
        true
    }

    fn loaded(&mut self, name: &str, states: u64) -> io::Result<()> {
        name.clone_into(&mut self.machine);
        // A machine has at least one state; 0 means that the number is unknown, as for a finished run.
        let size =
            if states > 0 { format!(" ({})", counted(states, "state")) } else { String::new() };
        writeln!(self.out, "running {name}{size}")
    }

    fn event(&mut self, time: Duration, event: Event) -> io::Result<()> {
        self.names.hear(&event);
        match event {
            Event::Entered { path, .. } => self.moment(time, &path, ""),
            Event::Left { outcome, .. } if outcome.id >= 0 => Ok(()),
            Event::Left { path, outcome, .. } => {
                self.moment(time, &path, &format!("ended with {}", outcome.name))
            }
            Event::Log { path, level: l, message, .. } => {
                self.moment(time, &path, &format!("{}{message}", level(l)))
            }
            Event::Held { next: Some(next), .. } => {
                self.moment(time, &next, "paused before this state")
            }
            Event::Finished { .. } => {
                self.finished = Some((time, event));
                Ok(())
            }
            event => match notable(&event) {
                Some((path, _, words)) => self.moment(time, path, &words),
                None => Ok(()),
            },
        }
    }

    fn snapshot(&mut self, _now: Duration, _snapshot: Snapshot) -> io::Result<()> {
        Ok(())
    }

    fn note(&mut self, text: &str) -> io::Result<()> {
        self.out.flush()?;
        writeln!(io::stderr(), "rafcon: {text}").or(Ok(()))
    }

    fn refresh(&mut self, _now: Duration) -> io::Result<()> {
        self.out.flush()
    }

    fn set_aside(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    fn end(&mut self, _end: &End) -> io::Result<()> {
        if let Some((time, event)) = self.finished.take() {
            for line in summary(&self.machine, time, &event) {
                writeln!(self.out, "{}", line.render(PAINT))?;
            }
        }
        self.out.flush()
    }
}

/// A log line for a terminal: time and state faint, the text in the colour of its level.
pub(crate) fn log_lines(time: Duration, name: &str, log: LogLevel, message: &str) -> Vec<TextLine> {
    let style = match log {
        LogLevel::Verbose | LogLevel::Debug => Style::Dim,
        LogLevel::Info => Style::Plain,
        LogLevel::Warning => Style::Warning,
        LogLevel::Error => Style::Bad,
    };
    let head = TextLine::of(Style::Dim, format!("{:8.3}  ", time.as_secs_f64()));
    let below = TextLine::of(Style::Plain, " ".repeat(head.width()));
    let gap = if name.is_empty() { "" } else { "  " };
    let head = head.and(Style::Strong, format!("{}{gap}", harmless(name)));
    let heads = std::iter::once(head).chain(std::iter::repeat(below));
    let text = if message.is_empty() { "\n" } else { message };
    heads.zip(text.lines()).map(|(head, text)| head.and(style, harmless(text))).collect()
}

#[cfg(test)]
mod tests {
    use super::{Lines, Names, View as _};
    use crate::follow::End;
    use expect_test::expect;
    use rafcon_protocol::{Event, LogLevel, Outcome, Stream};
    use rafcon_testkit::notation;
    use std::time::Duration;

    fn outcome(id: i64, name: &str) -> Outcome {
        Outcome { id, name: name.to_owned() }
    }

    #[test]
    fn a_run_reads_like_a_diary() {
        let text = "hierarchy ROOT \"Mission\"\n  execution SCANID \"Scan\"\n";
        let mut out = Vec::new();
        let mut view = Lines::new(&mut out, Names::new(move || notation::parse(text).ok()));
        let scan = || "ROOT/SCANID".to_owned();
        let error = serde_json::json!({"__exc__": "OSError", "msg": "no camera"});
        let events = [
            Event::Entered { path: "ROOT".to_owned(), inputs: None, undoes: None },
            Event::Entered { path: scan(), inputs: None, undoes: None },
            Event::Log {
                path: scan(),
                level: LogLevel::Error,
                stream: Stream::Logger,
                message: "Traceback:\n  no camera".to_owned(),
            },
            Event::Left {
                path: scan(),
                outcome: outcome(-1, "aborted"),
                outputs: None,
                error: None,
                undoes: None,
            },
            Event::Stopping,
            Event::Left {
                path: "ROOT".to_owned(),
                outcome: outcome(0, "done"),
                outputs: None,
                error: None,
                undoes: None,
            },
            Event::Finished {
                outcome: outcome(0, "done"),
                outputs: [("error".to_owned(), error), ("n".to_owned(), 3.into())]
                    .into_iter()
                    .collect(),
                globals: serde_json::Map::default(),
                scoped_variables: serde_json::Map::default(),
                states_run: 1234,
            },
        ];
        view.loaded("Mission", 2).unwrap();
        for (index, event) in (0_u64..).zip(events) {
            view.event(Duration::from_millis(index * 250), event).unwrap();
        }
        view.end(&End::Finished { outcome: outcome(0, "done"), timed_out: false }).unwrap();
        drop(view);
        expect![[r"
            running Mission (2 states)
                0.000  Mission
                0.250  Mission/Scan
                0.500  Mission/Scan: error: Traceback:
                0.500  Mission/Scan:   no camera
                0.750  Mission/Scan: ended with aborted
                1.000  stopping
            Mission ended with done (0) after 1.5 s, 1,234 states run
              error = OSError: no camera
              n     = 3
        "]]
        .assert_eq(&String::from_utf8(out).unwrap());
    }
}
