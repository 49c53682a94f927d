//! A visit to a run, from hello to leave: what is said, shown, and how it ends. Knows no socket and no terminal.

use crate::console::Wish;
use crate::supervisor;
use crate::wires::Cause;
use rafcon_protocol::{Answer, Command, Envelope, Event, Join, Outcome, ToRunner, ToViewer};
use rafcon_supervisor::Death;

/// What is to be done.
#[derive(Debug, PartialEq)]
pub(super) enum Act {
    /// Say this to the run.
    Send(ToRunner),
    /// Show this.
    Show(ToViewer),
    /// Tell the user.
    Note(String),
}

/// How a visit ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum End {
    /// The user left; the run goes on.
    Left,
    /// The run came to its end.
    Finished(Outcome),
    /// The runner ended in the middle of the run, or went silent.
    Lost,
    /// The runner does not want us.
    Refused(String),
}

impl End {
    /// The program's exit code: that of the run, if it ended.
    pub(super) fn code(&self) -> u8 {
        match self {
            Self::Left => 0,
            Self::Finished(_) => self.for_view().code(),
            Self::Refused(_) => 1,
            Self::Lost => 7,
        }
    }

    /// The same as the views know it.
    pub(super) fn for_view(&self) -> supervisor::End {
        match self {
            Self::Finished(outcome) => {
                supervisor::End::Finished { outcome: outcome.clone(), timed_out: false }
            }
            Self::Refused(reason) => supervisor::End::LoadFailed { reason: reason.clone() },
            Self::Left => supervisor::End::Left,
            Self::Lost => supervisor::End::Died(Death {
                reason: "its runner is gone".to_owned(),
                active: Vec::new(),
                said: Vec::new(),
                is_cut_off: false,
            }),
        }
    }

    /// What the user is told besides.
    pub(super) fn text(&self, run: &str) -> Option<String> {
        match self {
            Self::Finished(_) => None,
            Self::Left => Some(format!("left; {run} goes on (rafcon attach {run} joins it again)")),
            Self::Lost => {
                Some(format!("error: the runner of {run} is gone; to go on: rafcon resume {run}"))
            }
            Self::Refused(reason) => Some(format!("error: {reason}")),
        }
    }
}

/// A visit that is going on.
#[derive(Debug)]
pub(super) struct Visit {
    join: Option<Join>,
    /// Who gives commands.
    author: String,
    commands: u32,
    end: Option<End>,
}

impl Visit {
    /// A visit that begins by saying what is wanted.
    pub(super) fn new(join: Join, author: &str) -> Self {
        Self { join: Some(join), author: author.to_owned(), commands: 0, end: None }
    }

    /// How it ended, if it has.
    pub(super) fn end(&self) -> Option<&End> {
        self.end.as_ref()
    }

    /// Takes one cause in.
    pub(super) fn handle(&mut self, cause: Cause, out: &mut Vec<Act>) {
        match cause {
            Cause::Hello(hello) => match (hello.check(), self.join.take()) {
                (Err(mismatch), _) => self.finish(End::Refused(mismatch.to_string())),
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
            Cause::Silence => self.finish(End::Lost),
            Cause::Interrupt | Cause::Wish(Wish::Leave) => self.finish(End::Left),
            Cause::Wish(wish) => self.wish(wish, out),
            Cause::Key(_)
            | Cause::Drained(_)
            | Cause::Raw(..)
            | Cause::Exited(_)
            | Cause::HungUp
            | Cause::Suspend
            | Cause::Tick => {}
        }
    }

    fn message(&mut self, message: ToViewer, out: &mut Vec<Act>) {
        match message {
            ToViewer::LoadFailed { reason } => self.finish(End::Refused(reason)),
            ToViewer::Answer { answer, .. } => out.extend(note(answer)),
            message => {
                if let ToViewer::Event { event: Event::Finished { outcome, .. }, .. } = &message {
                    self.finish(End::Finished(outcome.clone()));
                }
                out.push(Act::Show(message));
            }
        }
    }

    fn wish(&mut self, wish: Wish, out: &mut Vec<Act>) {
        self.commands += 1;
        let id = format!("attach-{}-{}", std::process::id(), self.commands);
        match wish {
            Wish::Send(command) => {
                let envelope = envelope(id, &self.author, command);
                out.push(Act::Send(ToRunner::Command(envelope)));
            }
            Wish::Inspect(path) => out.push(Act::Send(ToRunner::Inspect { id, path })),
            Wish::Say(text) => out.push(Act::Note(text)),
            Wish::Leave => {}
        }
    }

    fn finish(&mut self, end: End) {
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
    use super::{End, Visit};
    use crate::console::Wish;
    use crate::wires::Cause;
    use expect_test::{Expect, expect};
    use rafcon_protocol::{Answer, Command, Hello, Join, ToViewer};

    fn check(causes: Vec<Cause>, expect: &Expect) {
        let (mut visit, mut acts) = (Visit::new(Join::default(), "ana"), Vec::new());
        for cause in causes {
            visit.handle(cause, &mut acts);
        }
        let mut lines: Vec<String> = acts.iter().map(|act| format!("{act:?}")).collect();
        if let Some(end) = visit.end() {
            lines.push(format!("{end:?}, exit code {}", end.code()));
            lines.extend(end.text("RUN"));
        }
        let id = format!("attach-{}-", std::process::id());
        expect.assert_eq(&lines.join("\n").replace(&id, "attach-"));
    }

    #[test]
    fn a_visitor_joins_commands_and_leaves() {
        let refused = Answer::Refused { reason: "the run is running".to_owned() };
        check(
            vec![
                Cause::Hello(Hello::ours()),
                Cause::Wish(Wish::Send(Command::Pause)),
                Cause::Messages(vec![ToViewer::Answer { id: "1".to_owned(), answer: refused }]),
                Cause::Wish(Wish::Inspect("A".to_owned())),
                Cause::Wish(Wish::Leave),
            ],
            &expect![[r#"
                Send(Join(Join { from: 0, every_event: false, values: false }))
                Send(Command(Envelope { id: "attach-1", author: "ana", decided_on: None, expiry: None, command: Pause }))
                Note("refused: the run is running")
                Send(Inspect { id: "attach-2", path: "A" })
                Left, exit code 0
                left; RUN goes on (rafcon attach RUN joins it again)"#]],
        );
    }

    #[test]
    fn a_runner_that_dies_is_told_with_the_way_out() {
        check(
            vec![Cause::Hello(Hello::ours()), Cause::Silence],
            &expect![[r"
            Send(Join(Join { from: 0, every_event: false, values: false }))
            Lost, exit code 7
            error: the runner of RUN is gone; to go on: rafcon resume RUN"]],
        );
    }

    #[test]
    fn another_version_is_refused() {
        let hello = Hello { protocol: 0, program: "0.0.1".to_owned() };
        check(
            vec![Cause::Hello(hello)],
            &expect![[r#"
            Refused("the other side (version 0.0.1) speaks protocol 0, this one speaks 2: install the rafcon binary and its extension from the same build"), exit code 1
            error: the other side (version 0.0.1) speaks protocol 0, this one speaks 2: install the rafcon binary and its extension from the same build"#]],
        );
        assert_eq!(End::Left.code(), 0);
    }
}
