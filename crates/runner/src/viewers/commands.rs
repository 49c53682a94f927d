//! Handles the messages of viewers: questions about active states, and commands. Each command runs once, whichever
//! viewer sends it and whichever runner the run has, and each gets an answer.

use crate::Scripts;
use crate::drive::driver::Driver;
use crate::drive::queries;
use crate::record::tell;
use crate::viewers::connection::{IncomingLine, Sender};
use rafcon_locks::{Condvar, Mutex};
use rafcon_protocol::{Answer, Envelope, LogLevel, ToRunner, ToViewer, decode};
use rafcon_storage::journal::ANSWERS_MAX;
use std::collections::VecDeque;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::sync::Arc;
use std::sync::mpsc::Receiver;

/// Commands by id, each with its answer.
pub(crate) type Answers = VecDeque<(String, Answer)>;

/// Receives the commands of all viewers of a run.
#[derive(Debug)]
pub(crate) struct CommandDispatcher<S: Scripts> {
    driver: Arc<Driver<S>>,
    /// The latest commands, by order of arrival.
    known: Mutex<VecDeque<KnownCommand>>,
    answered: Condvar,
}

/// A command that was received.
#[derive(Debug)]
struct KnownCommand {
    id: String,
    /// Hash of the command; `None` if an earlier runner answered it.
    asks: Option<u64>,
    /// `None` while the command is being carried out.
    answer: Option<Answer>,
}

impl<S: Scripts> CommandDispatcher<S> {
    /// A dispatcher that knows the commands answered by earlier runners.
    pub(crate) fn new(driver: Arc<Driver<S>>, answers: Answers) -> Self {
        let known = |(id, answer)| KnownCommand { id, asks: None, answer: Some(answer) };
        let known = Mutex::new(answers.into_iter().map(known).collect());
        Self { driver, known, answered: Condvar::new() }
    }

    /// Serves one viewer until it disconnects. `answering` is locked from a command to its answer.
    pub(crate) fn serve(
        &self,
        heard: &Receiver<IncomingLine>,
        sender: &Sender,
        answering: &Mutex<()>,
    ) {
        for words in heard {
            let _until_it_is_answered = answering.lock();
            match words {
                IncomingLine::Text(text) => self.read(&text, sender),
                IncomingLine::Nonsense => self.complain("a line that is no text, or too long"),
            }
        }
    }

    fn read(&self, text: &str, sender: &Sender) {
        match decode::<ToRunner>(text) {
            Ok(ToRunner::Command(envelope)) => {
                let answer = self.answer(&envelope);
                let id = envelope.id;
                sender.send(&ToViewer::Answer { id, answer });
            }
            Ok(ToRunner::Inspect { id, path }) => {
                let data = queries::state_data(&self.driver, &path);
                sender.send(&ToViewer::Inspection { id, path, data });
            }
            Ok(ToRunner::Ground { heard_ms_ago }) => self.driver.ground_heard(heard_ms_ago),
            // The listening thread has handled pings; the others are for stations.
            Ok(
                ToRunner::Ping { .. }
                | ToRunner::MoveControl { .. }
                | ToRunner::Present { .. }
                | ToRunner::Watch { .. },
            ) => {}
            Ok(ToRunner::Launch(_) | ToRunner::Join(_)) => {
                self.complain("a second launch or join: it has its run");
            }
            Err(error) => match command_id(text) {
                Some(id) => {
                    let reason = format!("this runner does not know the command: {error}");
                    sender.send(&ToViewer::Answer { id, answer: Answer::Refused { reason } });
                }
                None => self.complain(&error.to_string()),
            },
        }
    }

    fn complain(&self, what: &str) {
        let message = format!("a viewer sent {what}; it was ignored");
        self.driver.record().note_until_over(tell::log(String::new(), LogLevel::Warning, message));
    }

    /// Returns the answer of a command that was received before, from any viewer. Otherwise carries the command out.
    fn answer(&self, envelope: &Envelope) -> Answer {
        let id = envelope.id.as_str();
        if let Some(answer) = self.earlier(envelope) {
            return answer;
        }
        let answer = self.driver.obey(envelope);
        let mut known = self.known.lock();
        if let Some(entry) = known.iter_mut().find(|known| known.id == id) {
            entry.answer = Some(answer.clone());
        }
        self.answered.notify_all();
        answer
    }

    /// The answer to this id, after waiting for it if necessary. A new id is reserved.
    fn earlier(&self, envelope: &Envelope) -> Option<Answer> {
        let (id, asks) = (envelope.id.as_str(), asks(envelope));
        let mut known = self.known.lock();
        while let Some(entry) = known.iter().find(|known| known.id == id) {
            if entry.asks.is_some() && entry.asks != asks {
                return Some(taken(id));
            }
            if let Some(answer) = &entry.answer {
                return Some(answer.clone());
            }
            self.answered.wait(&mut known);
        }
        if known.len() >= ANSWERS_MAX
            && let Some(oldest) = known.iter().position(|known| known.answer.is_some())
        {
            known.remove(oldest);
        }
        known.push_back(KnownCommand { id: id.to_owned(), asks, answer: None });
        None
    }
}

/// The hash of a command; `None` if it cannot be encoded.
fn asks(envelope: &Envelope) -> Option<u64> {
    let mut hasher = DefaultHasher::new();
    serde_json::to_string(&envelope.command).ok()?.hash(&mut hasher);
    Some(hasher.finish())
}

fn taken(id: &str) -> Answer {
    let reason = format!("the id {id} came with another command before: choose a new id for each");
    Answer::Refused { reason }
}

/// The id of a command that cannot be decoded.
fn command_id(text: &str) -> Option<String> {
    let json: serde_json::Value = serde_json::from_str(text).ok()?;
    Some(json.get("id")?.as_str()?.to_owned())
}
