//! Requests of viewers to the robot that have no answer yet, and the last answers.

use super::viewers::PendingRequest;
use crate::ids;
use crate::words::StationRequest;
use rafcon_link::{CommandId, StationSession, StreamId};
use rafcon_protocol::api::RobotAnswer;
use rafcon_protocol::{CommandProgress, CommandStage, OpenCommand};
use std::collections::{BTreeMap, VecDeque};

/// Capacity of the kept answers. Beyond it, the oldest is dropped; a viewer that asks again makes the station ask the robot.
const ANSWERS_MAX: usize = 1_024;

/// Requests without an answer, and the last answers.
#[derive(Debug, Default)]
pub(super) struct PendingRequests {
    open: BTreeMap<CommandId, OpenRequest>,
    answers: BTreeMap<CommandId, RobotAnswer>,
    /// Ids of `answers`, the oldest first.
    answered: VecDeque<CommandId>,
}

/// Times of a word by the station's clock, in ms since 1970, UTC.
#[derive(Debug, Clone, Copy)]
pub(super) struct SendTimes {
    pub(super) sent: u64,
    /// Arrival at the robot if the link is whole.
    pub(super) arrival: Option<u64>,
    pub(super) expiry: Option<u64>,
}

/// The answer to a command whose time is over before the robot has answered.
pub(super) fn overdue() -> RobotAnswer {
    let reason = "it expired without an answer of the robot, which may have carried it out; the station repeats the question";
    RobotAnswer::Unknown { reason: reason.to_owned() }
}

#[derive(Debug)]
struct OpenRequest {
    stream: StreamId,
    command: OpenCommand,
    /// False for requests about control and for presence, which are not shown.
    is_command: bool,
    /// It starts or resumes a run.
    begins_run: bool,
}

impl PendingRequests {
    /// A word for this run was sent. One that is open stays as it is.
    pub(super) fn add(&mut self, stream: StreamId, given: &PendingRequest, times: SendTimes) {
        let SendTimes { sent: sent_ms, arrival: arrives_ms, expiry: expires_ms } = times;
        let (id, stage) = (given.id.clone(), CommandStage::Sent);
        let not_before_ms = given.not_before;
        let command = OpenCommand {
            id,
            stage,
            sent_ms,
            arrives_ms,
            expires_ms,
            not_before_ms,
            progress: None,
        };
        let begins_run =
            matches!(given.word, StationRequest::Resume(..) | StationRequest::Start(..));
        let is_command = begins_run || matches!(given.word, StationRequest::Command(..));
        let word = OpenRequest { stream, command, is_command, begins_run };
        self.open.entry(ids::command(&given.id)).or_insert(word);
    }

    /// A word is this far.
    pub(super) fn set_stage(&mut self, id: CommandId, stage: CommandStage) {
        // An overdue one was reported as unknown: that stays until its fate is known.
        let open = self.open.get_mut(&id).map(|word| &mut word.command);
        if let Some(command) = open.filter(|command| command.stage != CommandStage::Overdue) {
            command.stage = stage;
        }
    }

    /// Closes a word with this answer; returns its run and its name.
    pub(super) fn close(
        &mut self,
        id: CommandId,
        answer: &RobotAnswer,
    ) -> Option<(StreamId, String)> {
        let word = self.open.remove(&id)?;
        if self.answers.insert(id, answer.clone()).is_none() {
            self.answered.push_back(id);
        }
        while self.answered.len() > ANSWERS_MAX
            && let Some(oldest) = self.answered.pop_front()
        {
            self.answers.remove(&oldest);
        }
        Some((word.stream, word.command.id))
    }

    /// True if the robot has begun to start or resume a run by this request: a machine may take minutes to load.
    pub(super) fn is_beginning_run(&self, id: CommandId) -> bool {
        let word = self.open.get(&id);
        word.is_some_and(|word| word.begins_run && word.command.stage == CommandStage::Started)
    }

    /// The run and the name of a word.
    pub(super) fn find(&self, id: CommandId) -> Option<(StreamId, &str)> {
        self.open.get(&id).map(|word| (word.stream, &*word.command.id))
    }

    /// The answer to a word that was closed, or that it is overdue. None: it has to be sent, or waits for its answer in time.
    pub(super) fn known_answer(&self, id: CommandId) -> Option<RobotAnswer> {
        let is_overdue = |word: &OpenRequest| word.command.stage == CommandStage::Overdue;
        let overdue = self.open.get(&id).filter(|word| is_overdue(word)).map(|_| overdue());
        self.answers.get(&id).cloned().or(overdue)
    }

    /// True while the answer to a word is awaited.
    pub(super) fn is_open(&self, id: CommandId) -> bool {
        self.open.contains_key(&id)
    }

    /// The commands among them, of this run or of all.
    pub(super) fn commands(
        &self,
        stream: Option<StreamId>,
        session: &StationSession,
    ) -> Vec<OpenCommand> {
        let is_wanted = |word: &&OpenRequest| stream.is_none_or(|stream| word.stream == stream);
        let shown = |(id, word): (&CommandId, &OpenRequest)| {
            (word.is_command && is_wanted(&word)).then(|| {
                let progress = session.command_progress(*id);
                let progress = progress
                    .map(|it| CommandProgress { arrived_bytes: it.arrived, bytes: it.length });
                OpenCommand { progress, ..word.command.clone() }
            })
        };
        self.open.iter().filter_map(shown).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_known_up_to_the_bound() {
        let mut words = PendingRequests::default();
        let times = SendTimes { sent: 0, arrival: None, expiry: None };
        let given = |nth: usize| {
            PendingRequest::soon(nth.to_string(), StationRequest::Present(String::new()))
        };
        for nth in 0..=ANSWERS_MAX {
            let given = given(nth);
            words.add(StreamId(1), &given, times);
            assert!(words.close(ids::command(&given.id), &RobotAnswer::Expired).is_some());
        }
        let known = |nth: usize| words.known_answer(ids::command(&nth.to_string()));
        assert_eq!([known(0), known(1)], [None, Some(RobotAnswer::Expired)]);
    }

    #[test]
    fn an_overdue_word_has_an_answer_although_it_is_open() {
        let mut words = PendingRequests::default();
        let times = SendTimes { sent: 0, arrival: None, expiry: None };
        let given = PendingRequest::soon("1".to_owned(), StationRequest::Present(String::new()));
        let id = ids::command("1");
        words.add(StreamId(1), &given, times);
        assert_eq!((words.known_answer(id), words.is_open(id)), (None, true));
        words.set_stage(id, CommandStage::Overdue);
        assert!(matches!(words.known_answer(id), Some(RobotAnswer::Unknown { .. })));
    }
}
