//! The command list of a robot: faults and times of each line, and all of its commands sent at once. Knows no files.

use super::commands::{CommandContext, StationCommands};
use super::storage::PreparedRequest;
use crate::command_list_file::LineReport;
use crate::command_lists::ListQuestion;
use crate::ids;
use crate::station::pending_requests::SendTimes;
use crate::station::viewers::PendingRequest;
use crate::words::StationRequest;
use rafcon_link::{NewCommand, StreamId};
use rafcon_protocol::calendar::utc_text;
use rafcon_protocol::{
    CommandStage, ContactPlan, Expiry, GivenTimes, ListFate, ListTimes, ListedCommand,
};
use rafcon_supervisor::clock;

/// A command of a list that can be sent, as far as is known without the others.
struct PreparedLine {
    index: usize,
    stream: StreamId,
    given: PendingRequest,
    command: NewCommand,
    times: SendTimes,
}

/// The id of a command of a list, with its times.
struct ListedId {
    id: String,
    times: ListTimes,
}

impl StationCommands {
    /// Answers the questions of the server about the command list.
    pub(super) fn answer_list_questions(&mut self, context: &mut CommandContext<'_>) {
        for question in self.lists.take(self.name.as_str()) {
            let reports = self.list_reports(context, &question);
            question.answer(reports);
        }
    }

    /// A report for each line. If the question has an author and no line has a fault, all commands without a fate are sent.
    fn list_reports(
        &mut self,
        context: &mut CommandContext<'_>,
        question: &ListQuestion,
    ) -> Vec<LineReport> {
        let (plan, now_ms) = (context.plan.clone(), clock::since_1970_ms());
        let times = question.list.times(&plan, now_ms);
        let (mut reports, mut prepared) = (Vec::with_capacity(times.len()), Vec::new());
        for (index, (id, times)) in question.list.ids().into_iter().zip(times).enumerate() {
            let report =
                LineReport { times: times.clone().unwrap_or_default(), ..LineReport::default() };
            let is_over = report.times.expiry_ms.is_some_and(|expiry_ms| expiry_ms <= now_ms);
            let is_released = question.list.is_released();
            reports.push(if let Some(fated) = self.fated(&id, &plan, now_ms) {
                LineReport { times: report.times, ..fated }
            } else if is_released && (is_over || question.settled[index]) {
                report
            } else {
                let line = times.and_then(|times| {
                    context.prepare_line(question, index, ListedId { id, times })
                });
                match line {
                    Ok(line) => {
                        let report = context.expected(&line, now_ms);
                        prepared.push(line);
                        report
                    }
                    Err(fault) => LineReport { fault: Some(fault), ..report },
                }
            });
        }
        self.send_all(context, question, prepared, &mut reports);
        reports
    }

    /// Checks the lines together, and sends them if the question has an author and no line has a fault.
    fn send_all(
        &mut self,
        context: &mut CommandContext<'_>,
        question: &ListQuestion,
        prepared: Vec<PreparedLine>,
        reports: &mut [LineReport],
    ) {
        let now = context.now;
        let commands: Vec<_> = prepared.iter().map(|line| line.command.clone()).collect();
        let is_send = question.author.is_some() && reports.iter().all(|it| it.fault.is_none());
        let checked = if is_send {
            context.session.command_all(now, commands)
        } else {
            Err(context.session.check_all(now, &commands))
        };
        match checked {
            Ok(()) => {
                for PreparedLine { index, stream, given, times, .. } in prepared {
                    self.requests.add(stream, &given, times);
                    // The mark of the release is durable, so the line waits for no disk.
                    if let Some(command) = context.session.sent(ids::command(&given.id)) {
                        let run = question.list.commands()[index].run.clone();
                        let request = PreparedRequest { stream, run, given, command, times };
                        self.storage.store_beside(&request);
                    }
                    reports[index].fate = Some(ListFate::Open { stage: CommandStage::Sent });
                }
            }
            Err(checked) => {
                for (line, checked) in prepared.iter().zip(checked) {
                    let report = &mut reports[line.index];
                    let fault = checked.err().map(|why| why.to_string());
                    report.fault = report.fault.take().or(fault);
                }
            }
        }
    }

    /// Report of a command that was sent since the station began.
    fn fated(&self, id: &str, plan: &ContactPlan, now_ms: u64) -> Option<LineReport> {
        let id = ids::command(id);
        let open = self.requests.open(id, plan, now_ms);
        let (send_at_ms, effect_ms) =
            open.as_ref().map_or((None, None), |open| (open.send_at_ms, open.effect_ms));
        let fate = match self.requests.known_answer(id) {
            Some(answer) => ListFate::Answered { answer: answer.to_command() },
            None => ListFate::Open { stage: open?.stage },
        };
        Some(LineReport { send_at_ms, effect_ms, fate: Some(fate), ..LineReport::default() })
    }
}

impl CommandContext<'_> {
    fn prepare_line(
        &self,
        question: &ListQuestion,
        index: usize,
        ListedId { id, times }: ListedId,
    ) -> Result<PreparedLine, String> {
        let ListTimes { not_before_ms, expiry_ms } = times;
        let ListedCommand { run, command, .. } = &question.list.commands()[index];
        let stream = self.stream_of(run)?;
        self.rights.check(command, question.rights[index])?;
        let author = question.author.clone().unwrap_or_default();
        let is_lasting = expiry_ms.is_none() && command.lifetime_ms().is_none();
        let word = StationRequest::Command(id.clone(), author, None, command.clone());
        let expiry = expiry_ms.map(Expiry);
        let soon = PendingRequest::soon(id, word);
        let given = PendingRequest { expiry, is_lasting, not_before: not_before_ms, ..soon };
        let (command, times) = self.prepare(stream, &given)?;
        Ok(PreparedLine { index, stream, given, command, times })
    }

    /// The stream of an open run.
    fn stream_of(&self, run: &str) -> Result<StreamId, String> {
        match self.runs.iter().find(|(_, open)| open.id == run) {
            Some((_, open)) if open.is_over => Err("the run is over: remove the line".to_owned()),
            Some((stream, _)) => Ok(*stream),
            None => Err(
                "the station has no open run of this robot with this id: write an id of `rafcon runs`"
                    .to_owned(),
            ),
        }
    }

    /// Expected times of a line that is sent now. It has a fault if it expires before it can arrive.
    fn expected(&self, line: &PreparedLine, now_ms: u64) -> LineReport {
        let PreparedLine { given, command, times, .. } = line;
        let delay_ms = times.one_way.map(|one_way_ms| one_way_ms.max(times.transfer));
        let not_before_ms = given.not_before;
        let given_times = GivenTimes { given_ms: now_ms, delay_ms, not_before_ms };
        let expected = self.plan.expected(given_times, now_ms);
        let valid_ms = crate::meter::millis(command.valid);
        let expiry_ms = now_ms.saturating_add(valid_ms);
        let late_ms = expected.arrives_ms.filter(|arrives_ms| *arrives_ms >= expiry_ms);
        let fault = late_ms.map(|arrives_ms| {
            format!(
                "it expires at {} and arrives at {} at the earliest: let it expire later",
                utc_text(expiry_ms),
                utc_text(arrives_ms)
            )
        });
        LineReport {
            times: ListTimes { not_before_ms, expiry_ms: Some(expiry_ms) },
            send_at_ms: expected.send_at_ms,
            // Without contact and without a planned one, the time of the send is unknown.
            effect_ms: expected
                .effect_ms
                .filter(|_| self.is_heard || expected.send_at_ms.is_some()),
            fault,
            fate: None,
        }
    }
}
