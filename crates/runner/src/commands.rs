//! Commands of a viewer: each id once, none after its expiry, every one answered.

use crate::connection::{Line, Receiver, Sender};
use crate::driver::Driver;
use crate::{Clock, Scripts, tell};
use parking_lot::Mutex;
use rafcon_engine::Input;
use rafcon_protocol::{Answer, Command, Envelope, LogLevel, ToRunner, ToViewer, decode};
use std::collections::VecDeque;
use std::sync::Arc;

/// How many answers are kept, in case a command is sent again.
const ANSWERS_MAX: usize = 1024;

/// Serves one viewer until it goes away. `answering` is held from a command to its answer.
pub(crate) fn serve<S: Scripts>(
    driver: &Arc<Driver<S>>,
    mut receiver: Receiver,
    sender: &Sender,
    answering: &Mutex<()>,
) {
    let mut desk = Desk { driver, answered: VecDeque::new() };
    while let Some(line) = receiver.line() {
        let _until_it_is_answered = answering.lock();
        match line {
            Line::Text(text) => desk.read(&text, sender),
            Line::Nonsense => desk.complain("a line that is no text, or too long"),
        }
    }
}

struct Desk<'d, S: Scripts> {
    driver: &'d Arc<Driver<S>>,
    answered: VecDeque<(String, Answer)>,
}

impl<S: Scripts> Desk<'_, S> {
    fn read(&mut self, text: &str, sender: &Sender) {
        match decode::<ToRunner>(text) {
            Ok(ToRunner::Command(envelope)) => {
                let id = envelope.id.clone();
                let answer = self.answer(envelope);
                sender.send(&ToViewer::Answer { id, answer });
            }
            Ok(ToRunner::Join(_) | ToRunner::Inspect { .. }) => {
                self.complain("a request that this runner does not know yet");
            }
            Ok(ToRunner::Launch(_)) => self.complain("a second launch: this runner has its run"),
            Err(error) => match command_id(text) {
                Some(id) => {
                    let answer = Answer::Refused {
                        reason: format!("this runner does not know the command: {error}"),
                    };
                    sender.send(&ToViewer::Answer { id, answer });
                }
                None => self.complain(&error.to_string()),
            },
        }
    }

    fn complain(&self, what: &str) {
        let message = format!("the viewer sent {what}; it was ignored");
        let record = tell::log(String::new(), LogLevel::Warning, message);
        self.driver.recorder().push(self.driver.clock().now_ns(), [record]);
    }

    fn answer(&mut self, envelope: Envelope) -> Answer {
        if let Some((_, answer)) = self.answered.iter().find(|(id, _)| *id == envelope.id) {
            return answer.clone();
        }
        let expired = envelope.expiry.is_some_and(|expiry| expiry.0 < Clock::epoch_ms());
        let answer = if expired { Answer::Expired } else { self.carry_out(&envelope.command) };
        if self.answered.len() == ANSWERS_MAX {
            self.answered.pop_front();
        }
        self.answered.push_back((envelope.id, answer.clone()));
        answer
    }

    fn carry_out(&self, command: &Command) -> Answer {
        let input = match command {
            Command::Pause => Input::Pause,
            Command::Resume { branch: None } => Input::Resume(None),
            Command::Stop => Input::Stop,
            Command::Kill => kill(),
            Command::Start { .. }
            | Command::StepMode
            | Command::StepInto { .. }
            | Command::StepOver { .. }
            | Command::StepOut { .. }
            | Command::StepBack { .. }
            | Command::RunTo { .. }
            | Command::RunSelected { .. }
            | Command::RunOnlySelected { .. }
            | Command::StartFromHistory { .. }
            | Command::ForceOutcome { .. }
            | Command::Resume { branch: Some(_) }
            | Command::Preempt { .. }
            | Command::SetBreakpoint { .. }
            | Command::RemoveBreakpoint { .. }
            | Command::Recover { .. }
            | Command::Reload { .. }
            | Command::EditScript { .. }
            | Command::AnswerQuestion { .. } => {
                let reason = "this runner does not know this command yet; it knows pause, resume, stop and kill";
                return Answer::Refused { reason: reason.to_owned() };
            }
        };
        match self.driver.command(input) {
            Ok(()) => Answer::Applied,
            Err(refusal) => Answer::Refused { reason: refusal.to_string() },
        }
    }
}

/// Ends the process, whatever its scripts do. The viewer sees the connection end.
fn kill() -> ! {
    signal_hook::low_level::exit(137)
}

/// The id of a command that does not decode.
fn command_id(text: &str) -> Option<String> {
    let json: serde_json::Value = serde_json::from_str(text).ok()?;
    Some(json.get("id")?.as_str()?.to_owned())
}
