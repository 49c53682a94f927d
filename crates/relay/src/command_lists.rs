//! The command lists of a station's robots, between its server and its thread: what is asked about a list, and its release.
//!
//! A release is checked by the station's thread, marked on the disk, and only then sent. Knows no session.

use crate::command_list_file::{CommandListFile, CommandListFileError, LineReport, StoredList};
use parking_lot::Mutex;
use rafcon_protocol::api::{LineRequest, ListRequest, Right};
use rafcon_protocol::{Command, CommandList, ListTimes, ListedCommand};
use rafcon_supervisor::clock;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::time::Duration;

/// Capacity of the questions that wait for the station's thread, for each robot.
const QUESTIONS_MAX: usize = 64;
/// Timeout of an answer of the station's thread, which scans its questions four times a second.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(10);

/// The command lists of all robots that a station receives.
#[derive(Debug, Clone)]
pub struct CommandListStore {
    shared: Arc<SharedLists>,
    /// Right that a command needs.
    right_of: fn(&Command) -> Right,
}

#[derive(Debug, Default)]
struct SharedLists {
    robots: Mutex<BTreeMap<String, RobotList>>,
    /// Held while a list is set or released.
    changes: Mutex<()>,
}

#[derive(Debug)]
struct RobotList {
    file: CommandListFile,
    questions: Vec<ListQuestion>,
    next: u64,
}

/// A question about a list to the station's thread.
#[derive(Debug)]
pub(crate) struct ListQuestion {
    number: u64,
    pub(crate) list: StoredList,
    /// Right that each command needs.
    pub(crate) rights: Vec<Right>,
    /// True for each command that is not sent again, because it has an answer or its run is over.
    pub(crate) settled: Vec<bool>,
    /// Author of the commands if they are to be sent, all or none.
    pub(crate) author: Option<String>,
    reply: SyncSender<Vec<LineReport>>,
}

impl ListQuestion {
    /// Sends the answer, with a report for each line.
    pub(crate) fn answer(self, reports: Vec<LineReport>) {
        // After a timeout nobody receives it.
        self.reply.send(reports).unwrap_or_default();
    }
}

/// Reason why a list of commands is not known, not set or not released.
#[derive(Debug, thiserror::Error)]
pub enum CommandListError {
    /// The station does not receive this robot.
    #[error("this server does not receive the robot: run it as its station (`rafcon station`)")]
    NotReceived,
    /// The file cannot be used.
    #[error(transparent)]
    File(#[from] CommandListFileError),
    /// Too many questions wait.
    #[error("{QUESTIONS_MAX} questions about the list wait for the station: ask again in a second")]
    Busy,
    /// The station's thread did not take the question.
    #[error("the station does not answer: nothing was sent; ask again, or start the station again")]
    NoAnswer,
    /// The station's thread ended with the question.
    #[error(
        "the station ended before it answered; the list is marked as released: look at the fates, and release it again to send what the \
         robot has not received"
    )]
    Lost,
    /// The list is another one than the one that was reviewed.
    #[error("the list was changed since it was reviewed: nothing was sent; review it again")]
    Stale,
    /// The list has no commands.
    #[error("the list is empty: set one first")]
    Empty,
    /// Commands have faults, and none was sent.
    #[error("nothing was sent, because of these faults:\n{}", .0.faults().join("\n"))]
    Faults(Box<CommandList>),
    /// The mark of the release cannot be written.
    #[error("nothing was sent, because the release cannot be stored: {0}")]
    NotMarked(CommandListFileError),
    /// Nothing was sent, and the mark of the release cannot be removed.
    #[error(
        "nothing was sent, and the list stays marked as released because the disk refuses the change ({0}): set the list again"
    )]
    StaysMarked(CommandListFileError),
}

impl CommandListStore {
    /// Lists whose commands need the rights that `right_of` names.
    pub fn new(right_of: fn(&Command) -> Right) -> Self {
        Self { shared: Arc::default(), right_of }
    }

    /// The list of a robot, with the state of each command.
    pub fn list(&self, robot: &str) -> Result<CommandList, CommandListError> {
        let list = self.file(robot)?.read()?;
        let reports = self.ask(robot, &list, &[], None)?;
        Ok(list.with(reports))
    }

    /// Replaces the list of a robot. With a `revision`, only a list of this revision is replaced.
    pub fn set(
        &self,
        robot: &str,
        commands: Vec<ListedCommand>,
        revision: Option<&str>,
    ) -> Result<CommandList, CommandListError> {
        let file = self.file(robot)?;
        let changes = self.shared.changes.lock();
        file.set(commands, revision)?;
        drop(changes);
        self.list(robot)
    }

    /// Releases the list of a robot: all of it or nothing. A list that is released already is sent again under the same ids, as far as
    /// its fate is unknown and its time is not over.
    pub fn release(
        &self,
        robot: &str,
        request: &ListRequest,
    ) -> Result<CommandList, CommandListError> {
        let file = self.file(robot)?;
        let _changes = self.shared.changes.lock();
        let list = file.read()?;
        if list.revision() != request.revision {
            return Err(CommandListError::Stale);
        }
        if list.commands().is_empty() {
            return Err(CommandListError::Empty);
        }
        let lines = &request.lines;
        let mut reports = self.ask(robot, &list, lines, None)?;
        for (report, line) in reports.iter_mut().zip(lines) {
            if report.fate.is_none() && report.fault.is_none() {
                report.fault.clone_from(&line.fault);
            }
        }
        check(&list, &reports)?;
        let is_first = !list.is_released();
        let marked =
            if is_first { mark(&file, &list, &request.user, &reports)? } else { list.clone() };
        let sent = self.ask(robot, &marked, lines, Some(&request.user)).and_then(|reports| {
            check(&list, &reports)?;
            Ok(marked.with(reports))
        });
        if let Err(why) = &sent
            && is_first
            && !matches!(why, CommandListError::Lost)
        {
            // Nothing was sent, so the mark goes.
            match file.replace(&marked, &list) {
                // Another program has set a list that is not marked.
                Ok(()) | Err(CommandListFileError::Changed) => {}
                Err(error) => return Err(CommandListError::StaysMarked(error)),
            }
        }
        sent
    }

    /// Notes that the station receives this robot, whose folder there is `folder`.
    pub(crate) fn receive(&self, robot: &str, folder: &Path) {
        let (file, questions) = (CommandListFile::in_folder(folder), Vec::new());
        let list = RobotList { file, questions, next: 0 };
        self.shared.robots.lock().insert(robot.to_owned(), list);
    }

    /// Questions about the list of this robot that were not taken before.
    pub(crate) fn take(&self, robot: &str) -> Vec<ListQuestion> {
        let mut robots = self.shared.robots.lock();
        robots.get_mut(robot).map(|it| std::mem::take(&mut it.questions)).unwrap_or_default()
    }

    fn file(&self, robot: &str) -> Result<CommandListFile, CommandListError> {
        let robots = self.shared.robots.lock();
        Ok(robots.get(robot).ok_or(CommandListError::NotReceived)?.file.clone())
    }

    /// Asks the station's thread about a list; with an author, it sends all commands or none.
    fn ask(
        &self,
        robot: &str,
        list: &StoredList,
        lines: &[LineRequest],
        author: Option<&str>,
    ) -> Result<Vec<LineReport>, CommandListError> {
        let (reply, replied) = sync_channel(1);
        let is_settled = |line| lines.get(line).is_some_and(|it: &LineRequest| it.is_settled);
        let settled = (0..list.commands().len()).map(is_settled).collect();
        let rights = list.commands().iter().map(|it| (self.right_of)(&it.command)).collect();
        let (list, author) = (list.clone(), author.map(str::to_owned));
        let is_send = author.is_some();
        let number = {
            let mut robots = self.shared.robots.lock();
            let robot = robots.get_mut(robot).ok_or(CommandListError::NotReceived)?;
            if robot.questions.len() >= QUESTIONS_MAX {
                return Err(CommandListError::Busy);
            }
            robot.next += 1;
            let number = robot.next;
            robot.questions.push(ListQuestion { number, list, rights, settled, author, reply });
            number
        };
        replied.recv_timeout(ANSWER_TIMEOUT).or_else(|_late| {
            if self.withdraw(robot, number) {
                return Err(CommandListError::NoAnswer);
            }
            // It was taken, so it is being answered.
            let lost = if is_send { CommandListError::Lost } else { CommandListError::NoAnswer };
            replied.recv().map_err(|_ended| lost)
        })
    }

    /// Removes a question; false if it was taken before.
    fn withdraw(&self, robot: &str, number: u64) -> bool {
        let mut robots = self.shared.robots.lock();
        let Some(robot) = robots.get_mut(robot) else { return true };
        let count = robot.questions.len();
        robot.questions.retain(|question| question.number != number);
        robot.questions.len() < count
    }
}

fn check(list: &StoredList, reports: &[LineReport]) -> Result<(), CommandListError> {
    if reports.iter().all(|report| report.fault.is_none()) {
        return Ok(());
    }
    Err(CommandListError::Faults(Box::new(list.with(reports.to_vec()))))
}

/// Writes the mark of a release, with ids and times that no later release changes.
fn mark(
    file: &CommandListFile,
    list: &StoredList,
    user: &str,
    reports: &[LineReport],
) -> Result<StoredList, CommandListError> {
    let times: Vec<ListTimes> = reports.iter().map(|report| report.times).collect();
    let marked = list.released(user, clock::since_1970_ms(), times);
    file.replace(list, &marked).map_err(|error| match error {
        CommandListFileError::Changed => CommandListError::Stale,
        error => CommandListError::NotMarked(error),
    })?;
    Ok(marked)
}

#[cfg(test)]
mod tests;
