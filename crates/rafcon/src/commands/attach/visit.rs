//! A visit to a run, from hello to leave: what is said, shown, and how it ends. Knows no socket and no terminal.

use super::manners::{AttachOptions, MannersStep};
use super::pulse::Pulse;
use crate::console::Wish;
use crate::event_queue::{Cause, STUCK};
use crate::supervisor::{self, Active};
use rafcon_protocol::{
    Answer, Command, EnginePulse, Envelope, Event, Join, Outcome, ToRunner, ToViewer,
};
use rafcon_supervisor::RunnerDeath;
use std::time::Duration;

/// What is to be done.
#[derive(Debug, PartialEq)]
pub(in crate::commands) enum Act {
    /// Say this to the run.
    Send(ToRunner),
    /// Show this.
    Show(ToViewer),
    /// Show that nothing is heard any more, or that it is again.
    Heard(bool),
    /// Tell the user.
    Note(String),
}

/// How a visit ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::commands) enum VisitEnd {
    /// The user left; the run goes on.
    Left,
    /// The run came to its end.
    Finished {
        /// By this outcome.
        outcome: Outcome,
        /// Because its time was over.
        timed_out: bool,
    },
    /// We had the runner killed.
    Killed {
        /// Because its time was over.
        timed_out: bool,
        /// Paths of the states that were active.
        active: Vec<String>,
    },
    /// The runner ended in the middle of the run, or went silent.
    Lost {
        /// Paths of the states that were active.
        active: Vec<String>,
    },
    /// The runner does not want us.
    Refused(String),
}

impl VisitEnd {
    /// The program's exit code: that of the run, if it ended.
    pub(in crate::commands) fn code(&self) -> u8 {
        self.for_view().code()
    }

    /// The same as the views know it.
    pub(in crate::commands) fn for_view(&self) -> supervisor::End {
        match self.clone() {
            Self::Finished { outcome, timed_out } => {
                supervisor::End::Finished { outcome, timed_out }
            }
            Self::Killed { timed_out, active } => supervisor::End::Killed { timed_out, active },
            Self::Refused(reason) => supervisor::End::LoadFailed { reason },
            Self::Left => supervisor::End::Left,
            Self::Lost { active } => supervisor::End::Died(RunnerDeath {
                reason: "its runner is gone".to_owned(),
                active,
                said: Vec::new(),
                is_cut_off: false,
            }),
        }
    }
}

/// A visit that is going on.
#[derive(Debug)]
pub(in crate::commands) struct Visit {
    join: Option<Join>,
    manners: AttachOptions,
    active: Active,
    /// Who gives commands.
    author: String,
    /// What the ids of this visitor's commands begin with.
    prefix: String,
    commands: u32,
    /// Whether the engine takes inputs, if nobody else asks that.
    pulse: Option<Pulse>,
    end: Option<VisitEnd>,
}

impl Visit {
    /// A visit that begins by saying what is wanted. Nobody else's ids begin with `prefix`.
    pub(in crate::commands) fn new(
        join: Join,
        author: &str,
        prefix: String,
        manners: AttachOptions,
    ) -> Self {
        Self {
            join: Some(join),
            manners,
            active: Active::default(),
            author: author.to_owned(),
            prefix,
            commands: 0,
            pulse: None,
            end: None,
        }
    }

    /// The same visit, which also finds out whether the engine takes inputs: at a server, that one does.
    pub(in crate::commands) fn asking_for_the_engine(self) -> Self {
        Self { pulse: Some(Pulse::default()), ..self }
    }

    /// How it ended, if it has.
    pub(in crate::commands) fn end(&self) -> Option<&VisitEnd> {
        self.end.as_ref()
    }

    /// When the next tick is needed at the latest.
    pub(in crate::commands) fn wake_at(&self) -> Option<Duration> {
        let asks = self.pulse.as_ref().filter(|_| self.join.is_none()).map(Pulse::due);
        [self.manners.wake_at(), asks].into_iter().flatten().min()
    }

    /// Takes one cause in.
    pub(in crate::commands) fn handle(&mut self, now: Duration, cause: Cause, out: &mut Vec<Act>) {
        match cause {
            Cause::Hello(hello) => match (hello.check(), self.join.take()) {
                (Err(mismatch), _) => self.finish(VisitEnd::Refused(mismatch.to_string())),
                (Ok(()), Some(join)) => out.push(Act::Send(ToRunner::Join(join))),
                (Ok(()), None) => {}
            },
            Cause::Messages(messages) => {
                for message in messages {
                    self.message(message, out);
                }
            }
            Cause::Nonsense(what) => {
                out.push(Act::Note(format!("the runner's words make no sense: {what}")));
            }
            Cause::Cut(reason) => out.extend([Act::Heard(false), Act::Note(reason)]),
            Cause::Mended(how) => out.extend([Act::Heard(true), Act::Note(how)]),
            Cause::Refused(reason) => self.finish(VisitEnd::Refused(reason)),
            Cause::Silence => self.lost(),
            Cause::Interrupt => {
                let step = self.manners.interrupt();
                self.step(step, out);
            }
            Cause::Wish(Wish::Leave) => self.finish(VisitEnd::Left),
            Cause::Wish(wish) => self.wish(wish, out),
            Cause::Key(_)
            | Cause::Drained(_)
            | Cause::Raw(..)
            | Cause::Exited(_)
            | Cause::HungUp
            | Cause::Suspend
            | Cause::Tick => {}
        }
        if let Some(step) = self.manners.watch(now) {
            self.step(step, out);
        }
        let pulse = self.pulse.as_mut().filter(|_| self.join.is_none());
        out.extend(pulse.and_then(|pulse| pulse.question(now)).map(Act::Send));
    }

    /// Whether the engine takes inputs, said when that changes.
    fn reached(&mut self, engine: EnginePulse, out: &mut Vec<Act>) {
        let Some(is_reached) = self.pulse.as_mut().and_then(|pulse| pulse.answered(engine)) else {
            return;
        };
        let text = if is_reached { "the run is heard again" } else { STUCK };
        out.extend([Act::Heard(is_reached), Act::Note(text.to_owned())]);
    }

    fn message(&mut self, message: ToViewer, out: &mut Vec<Act>) {
        self.active.told(&message);
        match message {
            ToViewer::LoadFailed { reason } => self.finish(VisitEnd::Refused(reason)),
            ToViewer::Answer { answer, .. } => out.extend(note(answer)),
            ToViewer::Pong { engine, .. } => {
                if let Some(engine) = engine {
                    self.reached(engine, out);
                }
            }
            ToViewer::Loaded { problems, name, states, run } => {
                let (told, none) = (supervisor::as_events(problems), Vec::new());
                out.push(Act::Show(ToViewer::Loaded { name, states, problems: none, run }));
                if self.manners.is_host() {
                    out.extend(
                        told.map(|event| {
                            Act::Show(ToViewer::Event { sequence: 0, t_ns: 0, event })
                        }),
                    );
                }
            }
            message => {
                if let ToViewer::Event { event: Event::Finished { outcome, .. }, .. } = &message {
                    let timed_out = self.manners.timed_out();
                    self.finish(VisitEnd::Finished { outcome: outcome.clone(), timed_out });
                }
                out.push(Act::Show(message));
            }
        }
    }

    fn step(&mut self, step: MannersStep, out: &mut Vec<Act>) {
        match step {
            MannersStep::Leave => self.finish(VisitEnd::Left),
            MannersStep::Say(text, command) => {
                out.push(Act::Note(text.to_owned()));
                self.send(command, out);
            }
        }
    }

    fn wish(&mut self, wish: Wish, out: &mut Vec<Act>) {
        match wish {
            Wish::Send(command) => self.send(command, out),
            Wish::Inspect(path) => {
                let id = self.next_id();
                out.push(Act::Send(ToRunner::Inspect { id, path }));
            }
            Wish::Say(text) => out.push(Act::Note(text)),
            Wish::Leave => {}
        }
    }

    fn send(&mut self, command: Command, out: &mut Vec<Act>) {
        let envelope = envelope(self.next_id(), &self.author, command);
        out.push(Act::Send(ToRunner::Command(envelope)));
    }

    fn next_id(&mut self) -> String {
        self.commands += 1;
        format!("{}-{}", self.prefix, self.commands)
    }

    /// The runner is gone: as we wanted, or not.
    fn lost(&mut self) {
        let active = self.active.paths().to_vec();
        self.finish(if self.manners.killed() {
            VisitEnd::Killed { timed_out: self.manners.timed_out(), active }
        } else {
            VisitEnd::Lost { active }
        });
    }

    fn finish(&mut self, end: VisitEnd) {
        self.end.get_or_insert(end);
    }
}

fn note(answer: Answer) -> Option<Act> {
    match answer {
        Answer::Applied => None,
        Answer::Refused { reason } => Some(Act::Note(format!("refused: {reason}"))),
        Answer::Expired => Some(Act::Note("the command came too late".to_owned())),
    }
}

/// A command of the person at this terminal.
pub(in crate::commands) fn envelope(id: String, author: &str, command: Command) -> Envelope {
    Envelope { id, author: author.to_owned(), decided_on: None, expiry: None, command }
}

#[cfg(test)]
mod tests {
    use super::super::words;
    use super::{AttachOptions, Visit};
    use crate::console::Wish;
    use crate::event_queue::Cause;
    use expect_test::{Expect, expect};
    use rafcon_protocol::{Answer, Command, EnginePulse, Event, Hello, Join, ToViewer};
    use std::time::Duration;

    fn check(manners: AttachOptions, causes: Vec<Cause>, expect: &Expect) {
        let mut visit = Visit::new(Join::default(), "ana", "attach".to_owned(), manners);
        let mut acts = Vec::new();
        for cause in causes {
            visit.handle(Duration::ZERO, cause, &mut acts);
        }
        let mut lines: Vec<String> = acts.iter().map(|act| format!("{act:?}")).collect();
        if let Some(end) = visit.end() {
            lines.push(format!("{end:?}, exit code {}", end.code()));
            lines.extend(words(end, "RUN"));
        }
        expect.assert_eq(&lines.join("\n"));
    }

    fn entered(path: &str) -> Cause {
        let event = Event::Entered { path: path.to_owned(), inputs: None, undoes: None };
        Cause::Messages(vec![ToViewer::Event { sequence: 1, t_ns: 0, event }])
    }

    #[test]
    fn a_visitor_joins_commands_and_leaves() {
        let refused = Answer::Refused { reason: "the run is running".to_owned() };
        check(
            AttachOptions::of_a_guest(),
            vec![
                Cause::Hello(Hello::ours()),
                Cause::Wish(Wish::Send(Command::Pause)),
                Cause::Messages(vec![ToViewer::Answer { id: "1".to_owned(), answer: refused }]),
                Cause::Wish(Wish::Inspect("A".to_owned())),
                Cause::Wish(Wish::Leave),
            ],
            &expect![[r#"
                Send(Join(Join { from: 0, every_event: false }))
                Send(Command(Envelope { id: "attach-1", author: "ana", decided_on: None, expiry: None, command: Pause }))
                Note("refused: the run is running")
                Send(Inspect { id: "attach-2", path: "A" })
                Left, exit code 0
                left; it goes on (rafcon attach RUN joins it again)"#]],
        );
    }

    #[test]
    fn a_runner_that_dies_is_told_with_the_way_out() {
        check(
            AttachOptions::of_a_guest(),
            vec![Cause::Hello(Hello::ours()), entered("A"), Cause::Silence],
            &expect![[r#"
                Send(Join(Join { from: 0, every_event: false }))
                Show(Event { sequence: 1, t_ns: 0, event: Entered { path: "A", inputs: None, undoes: None } })
                Lost { active: ["A"] }, exit code 7
                error: its runner is gone; to go on: rafcon resume RUN"#]],
        );
    }

    #[test]
    fn a_run_that_was_asked_for_is_stopped_and_killed() {
        check(
            AttachOptions::of_the_host(None),
            vec![
                Cause::Hello(Hello::ours()),
                entered("A"),
                Cause::Interrupt,
                Cause::Interrupt,
                Cause::Silence,
            ],
            &expect![[r#"
                Send(Join(Join { from: 0, every_event: false }))
                Show(Event { sequence: 1, t_ns: 0, event: Entered { path: "A", inputs: None, undoes: None } })
                Note("stopping; press Ctrl-C again to kill")
                Send(Command(Envelope { id: "attach-1", author: "ana", decided_on: None, expiry: None, command: Stop }))
                Note("killing; press Ctrl-C again to leave it alone")
                Send(Command(Envelope { id: "attach-2", author: "ana", decided_on: None, expiry: None, command: Kill }))
                Killed { timed_out: false, active: ["A"] }, exit code 5"#]],
        );
    }

    #[test]
    fn a_connection_that_breaks_is_shown_and_ends_nothing() {
        check(
            AttachOptions::of_a_guest(),
            vec![Cause::Cut("it is gone".to_owned()), Cause::Mended("it is back".to_owned())],
            &expect![[r#"
                Heard(false)
                Note("it is gone")
                Heard(true)
                Note("it is back")"#]],
        );
    }

    #[test]
    fn an_engine_that_takes_no_inputs_is_told_and_so_is_its_return() {
        let visit = Visit::new(Join::default(), "ana", String::new(), AttachOptions::of_a_guest());
        let mut visit = visit.asking_for_the_engine();
        let pong = |unreached_ms| {
            let engine = Some(EnginePulse { unreached_ms, still_ms: unreached_ms, scripts: None });
            Cause::Messages(vec![ToViewer::Pong { id: 1, now_ms: 0, engine }])
        };
        let causes = [Cause::Hello(Hello::ours()), pong(0), pong(2_900), pong(3_900), pong(0)];
        let mut acts = Vec::new();
        for (second, cause) in (0..).zip(causes) {
            visit.handle(Duration::from_secs(second), cause, &mut acts);
        }
        let lines: Vec<String> = acts.iter().map(|act| format!("{act:?}")).collect();
        expect![[r#"
            Send(Join(Join { from: 0, every_event: false }))
            Send(Ping { id: 1 })
            Send(Ping { id: 2 })
            Send(Ping { id: 3 })
            Heard(false)
            Note("the run stands still: its program is heard, but its engine takes no inputs; a stop ends the program if need be")
            Send(Ping { id: 4 })
            Heard(true)
            Note("the run is heard again")
            Send(Ping { id: 5 })"#]].assert_eq(&lines.join("\n"));
    }

    #[test]
    fn another_version_is_refused() {
        let hello = Hello { protocol: 0, program: "0.0.1".to_owned() };
        check(
            AttachOptions::of_a_guest(),
            vec![Cause::Hello(hello)],
            &expect![[r#"
            Refused("the other side (version 0.0.1) speaks protocol 0, this one speaks 3: install the rafcon binary and its extension from the same build"), exit code 1
            error: the other side (version 0.0.1) speaks protocol 0, this one speaks 3: install the rafcon binary and its extension from the same build"#]],
        );
    }
}
