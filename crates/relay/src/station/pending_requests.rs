//! Open requests of viewers to the robot, and the last answers.

use super::viewers::PendingRequest;
use crate::ids;
use crate::words::StationRequest;
use rafcon_link::{CommandId, StationSession, StreamId};
use rafcon_protocol::api::RobotAnswer;
use rafcon_protocol::{CommandProgress, CommandStage, ContactPlan, GivenTimes, OpenCommand};
use std::collections::{BTreeMap, VecDeque};

/// Capacity of the kept answers. Beyond it, the oldest is dropped; a viewer that asks again makes the station ask the robot.
const ANSWERS_MAX: usize = 1_024;

/// Open requests, and the last answers.
#[derive(Debug, Default)]
pub(super) struct PendingRequests {
    open: BTreeMap<CommandId, OpenRequest>,
    answers: BTreeMap<CommandId, RobotAnswer>,
    /// Ids in `answers`, the oldest first.
    answered: VecDeque<CommandId>,
}

/// Times of a word by the station's clock, in ms since 1970, UTC.
#[derive(Debug, Clone, Copy)]
pub(super) struct SendTimes {
    pub(super) sent: u64,
    /// Time to send all of it, in ms.
    pub(super) transfer: u64,
    /// Half the measured round trip, in ms.
    pub(super) one_way: Option<u64>,
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
    transfer_ms: u64,
    one_way_ms: Option<u64>,
}

impl OpenRequest {
    /// Adds what is expected by the planned contacts.
    fn expected(&self, plan: &ContactPlan, now_ms: u64) -> OpenCommand {
        let command = self.command.clone();
        let (given_ms, not_before_ms) = (command.sent_ms, command.not_before_ms);
        let delay_ms = self.one_way_ms.map(|one_way_ms| one_way_ms.max(self.transfer_ms));
        match command.stage {
            CommandStage::Sent => {
                let given = GivenTimes { given_ms, delay_ms, not_before_ms };
                let times = plan.expected(given, now_ms);
                OpenCommand {
                    send_at_ms: times.send_at_ms,
                    arrives_ms: times.arrives_ms,
                    effect_ms: times.effect_ms,
                    ..command
                }
            }
            // It waits at the robot for its time.
            CommandStage::Received => OpenCommand { effect_ms: not_before_ms, ..command },
            CommandStage::Started | CommandStage::Overdue => command,
        }
    }
}

impl PendingRequests {
    /// A word for this run was sent. One that is open stays as it is.
    pub(super) fn add(&mut self, stream: StreamId, given: &PendingRequest, times: SendTimes) {
        let SendTimes { sent, transfer: transfer_ms, one_way: one_way_ms, expiry } = times;
        let command = OpenCommand {
            id: given.id.clone(),
            asks: given.word.asks().to_owned(),
            stage: CommandStage::Sent,
            sent_ms: sent,
            send_at_ms: None,
            arrives_ms: None,
            effect_ms: None,
            expires_ms: expiry,
            not_before_ms: given.not_before,
            progress: None,
        };
        let begins_run =
            matches!(given.word, StationRequest::Resume(..) | StationRequest::Start(..));
        let is_command = begins_run || matches!(given.word, StationRequest::Command(..));
        let word = OpenRequest { stream, command, is_command, begins_run, transfer_ms, one_way_ms };
        self.open.entry(ids::command(&given.id)).or_insert(word);
    }

    /// The round trip was measured: requests from before have their expected times from it.
    pub(super) fn set_one_way(&mut self, one_way_ms: u64) {
        for word in self.open.values_mut() {
            word.one_way_ms.get_or_insert(one_way_ms);
        }
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

    /// A command without an answer, with the times that are expected by the planned contacts.
    pub(super) fn open(
        &self,
        id: CommandId,
        plan: &ContactPlan,
        now_ms: u64,
    ) -> Option<OpenCommand> {
        self.open.get(&id).map(|request| request.expected(plan, now_ms))
    }

    /// True while the answer to a word is awaited.
    pub(super) fn is_open(&self, id: CommandId) -> bool {
        self.open.contains_key(&id)
    }

    /// The commands among them, of this run or of all, with the times that are expected by the planned contacts.
    pub(super) fn commands(
        &self,
        stream: Option<StreamId>,
        session: &StationSession,
        plan: &ContactPlan,
        now_ms: u64,
    ) -> Vec<OpenCommand> {
        let is_wanted = |word: &&OpenRequest| stream.is_none_or(|stream| word.stream == stream);
        let shown = |(id, word): (&CommandId, &OpenRequest)| {
            (word.is_command && is_wanted(&word)).then(|| {
                let progress = session.command_progress(*id);
                let progress = progress
                    .map(|it| CommandProgress { arrived_bytes: it.arrived, bytes: it.length });
                OpenCommand { progress, ..word.expected(plan, now_ms) }
            })
        };
        self.open.iter().filter_map(shown).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rafcon_protocol::Command;

    #[test]
    fn answers_are_known_up_to_the_bound() {
        let mut words = PendingRequests::default();
        let times = SendTimes { sent: 0, transfer: 0, one_way: None, expiry: None };
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
        let times = SendTimes { sent: 0, transfer: 0, one_way: None, expiry: None };
        let given = PendingRequest::soon("1".to_owned(), StationRequest::Present(String::new()));
        let id = ids::command("1");
        words.add(StreamId(1), &given, times);
        assert_eq!((words.known_answer(id), words.is_open(id)), (None, true));
        words.set_stage(id, CommandStage::Overdue);
        assert!(matches!(words.known_answer(id), Some(RobotAnswer::Unknown { .. })));
    }

    #[test]
    fn a_command_has_its_expected_times_once_the_delay_is_measured() {
        let plan = ContactPlan::of_text(
            r#"[{"begin": "1970-01-01T00:01:40Z", "end": "1970-01-01T00:02:00Z", "profile": "deep"}]"#,
        )
        .unwrap();
        let mut words = PendingRequests::default();
        let given = PendingRequest {
            not_before: Some(101_000),
            ..PendingRequest::soon(
                "ana/1".to_owned(),
                StationRequest::Command("ana/1".to_owned(), String::new(), None, Command::Pause),
            )
        };
        let times = SendTimes { sent: 1_000, transfer: 3_000, one_way: None, expiry: None };
        words.add(StreamId(1), &given, times);
        let id = ids::command("ana/1");
        let times = |words: &PendingRequests, now_ms| {
            let it = words.open[&id].expected(&plan, now_ms);
            (it.send_at_ms, it.arrives_ms, it.effect_ms)
        };
        assert_eq!(times(&words, 2_000), (Some(100_000), None, None));
        words.set_one_way(2_000);
        words.set_one_way(9_000);
        assert_eq!(times(&words, 2_000), (Some(100_000), Some(103_000), Some(103_000)));
        assert_eq!(times(&words, 100_000), (None, Some(103_000), Some(103_000)));
        words.set_stage(id, CommandStage::Received);
        assert_eq!(times(&words, 2_000), (None, None, Some(101_000)));
        words.set_stage(id, CommandStage::Started);
        assert_eq!(times(&words, 2_000), (None, None, None));
    }
}
