//! A run as JSON, one object a line, `finished` last (`docs/protocol.md`).

use super::View;
use crate::follow::End;
use rafcon_protocol::{Event, Snapshot};
use rafcon_storage::journal::folder::EndValues;
use rafcon_supervisor::RunnerDeath;
use serde::Serialize;
use std::io::{self, BufWriter, Write};
use std::time::Duration;

#[derive(Debug)]
pub(crate) struct Json<W: Write> {
    out: BufWriter<W>,
    /// Held back, so that it is written last.
    finished: Option<Event>,
}

/// End of a run without an outcome.
#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum CutOff<'a> {
    LoadFailed { reason: &'a str },
    NotStarted { reason: &'a str, stderr: &'a [String] },
    Killed { timed_out: bool, active: &'a [String] },
    Left,
    Died { reason: &'a str, active: &'a [String], stderr: &'a [String] },
}

impl<W: Write> Json<W> {
    pub(crate) fn new(out: W) -> Self {
        Self { out: BufWriter::with_capacity(64 * 1024, out), finished: None }
    }

    fn line(&mut self, value: &impl Serialize) -> io::Result<()> {
        serde_json::to_writer(&mut self.out, value)?;
        self.out.write_all(b"\n")
    }
}

impl<W: Write> View for Json<W> {
    fn every_event(&self) -> bool {
        true
    }

    fn loaded(&mut self, _name: &str, _states: u64) -> io::Result<()> {
        Ok(())
    }

    fn event(&mut self, _time: Duration, event: Event) -> io::Result<()> {
        if matches!(event, Event::Finished { .. }) {
            self.finished = Some(event);
            return Ok(());
        }
        self.line(&event)
    }

    fn snapshot(&mut self, _now: Duration, _snapshot: Snapshot) -> io::Result<()> {
        Ok(())
    }

    fn note(&mut self, text: &str) -> io::Result<()> {
        writeln!(io::stderr(), "rafcon: {text}").or(Ok(()))
    }

    fn refresh(&mut self, _now: Duration) -> io::Result<()> {
        self.out.flush()
    }

    fn set_aside(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    fn end_values(&mut self, values: EndValues) -> io::Result<()> {
        if let Some(Event::Finished { outputs, globals, scoped_variables, .. }) = &mut self.finished
        {
            let all = (values.outputs, values.globals, values.scoped_variables);
            (*outputs, *globals, *scoped_variables) = all;
        }
        Ok(())
    }

    fn end(&mut self, end: &End) -> io::Result<()> {
        match end {
            End::Finished { .. } | End::OnlyWaited { .. } => {
                if let Some(event) = self.finished.take() {
                    self.line(&event)?;
                }
            }
            End::LoadFailed { reason } => self.line(&CutOff::LoadFailed { reason })?,
            End::NotStarted { reason, said } => {
                self.line(&CutOff::NotStarted { reason, stderr: said })?;
            }
            End::Killed { timed_out, active, .. } => {
                self.line(&CutOff::Killed { timed_out: *timed_out, active })?;
            }
            End::Left => self.line(&CutOff::Left)?,
            End::Died(RunnerDeath { reason, active, said, .. }) => {
                self.line(&CutOff::Died { reason, active, stderr: said })?;
            }
        }
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::{Json, View as _};
    use crate::follow::End;
    use expect_test::{Expect, expect};
    use rafcon_protocol::{Event, LogLevel, Outcome, Stream};
    use rafcon_supervisor::RunnerDeath;
    use std::time::Duration;

    fn check(events: Vec<Event>, end: &End, expect: &Expect) {
        let mut out = Vec::new();
        let mut view = Json::new(&mut out);
        for event in events {
            view.event(Duration::ZERO, event).unwrap();
        }
        view.end(end).unwrap();
        drop(view);
        expect.assert_eq(&String::from_utf8(out).unwrap());
    }

    fn log() -> Event {
        Event::Log {
            path: "A".to_owned(),
            level: LogLevel::Info,
            stream: Stream::Stdout,
            message: "hi".to_owned(),
        }
    }

    #[test]
    fn finished_comes_last_whatever_comes_after_it() {
        let outcome = Outcome { id: 0, name: "success".to_owned() };
        let finished = Event::Finished {
            outcome: outcome.clone(),
            outputs: serde_json::Map::default(),
            globals: serde_json::Map::default(),
            scoped_variables: serde_json::Map::default(),
            states_run: 1,
        };
        check(
            vec![
                Event::Entered { path: "A".to_owned(), inputs: None, undoes: None },
                finished,
                log(),
            ],
            &End::Finished { outcome, timed_out: false },
            &expect![[r#"
                {"type":"entered","path":"A"}
                {"type":"log","path":"A","level":"info","stream":"stdout","message":"hi"}
                {"type":"finished","outcome":{"id":0,"name":"success"},"outputs":{},"globals":{},"scoped_variables":{},"states_run":1}
            "#]],
        );
    }

    #[test]
    fn a_death_is_the_last_line() {
        let death = RunnerDeath {
            reason: "killed by signal 11 (SIGSEGV)".to_owned(),
            active: vec!["A/B".to_owned()],
            said: vec!["Segmentation fault".to_owned()],
            ..RunnerDeath::default()
        };
        check(
            vec![log()],
            &End::Died(death),
            &expect![[r#"
                {"type":"log","path":"A","level":"info","stream":"stdout","message":"hi"}
                {"type":"died","reason":"killed by signal 11 (SIGSEGV)","active":["A/B"],"stderr":["Segmentation fault"]}
            "#]],
        );
    }
}
