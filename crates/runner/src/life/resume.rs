//! Resumes runs: after the end of their runner, or at an entry of their history. This module knows what must be
//! restored, and in which order; the storage crate parses the journal.

use crate::drive::dispatch::Order;
use crate::drive::error::{CommandError, LoadFailure, ResumeError};
use crate::drive::prepare::{Prepared, prepare};
use crate::drive::record_events::ExtraRecords;
use crate::life::begun::begun_at;
use crate::life::journal::options;
use crate::life::restore_values::{RestoreContext, ValueRestorer};
use crate::record::recorder::Recorder;
use crate::record::tell;
use crate::viewers::commands::Answers;
use crate::{Driver, Host, Scripts};
use rafcon_engine::{Counted, Finish, Input, Interrupted, Restore, Start, Stopping};
use rafcon_model::OutcomeId;
use rafcon_protocol::{
    Answer, Beginning, Command, Crash, Event, Launch, LogLevel, OnCrash, Resume, RunStatus, active,
};
use rafcon_storage::journal::{
    About, Entry, GroundSilence, Hash, Journal, JournalError, Kept, Moment, Packed, Place, Reader,
    Record, ResumePoint,
};
use smol_str::SmolStr;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// Number of latest events that a resumption searches. A run records fewer after its root was left.
const LAST_EVENTS: u64 = 10_000;

/// A journal with which a runner continues, and its last moment.
pub(crate) struct Resumed {
    pub(crate) resume_point: ResumePoint,
    journal: Journal,
    reader: Reader,
    /// The state of the run at its end.
    last: Moment,
    from: Option<From>,
    crash: Crash,
    policy: OnCrash,
}

/// An entry of the history at which the run restarts.
struct From {
    sequence: u64,
    /// The moment before the entry.
    before: Moment,
    /// The root and its inputs, if the entry is that of the root.
    root: Option<(Arc<Place>, Vec<Kept>)>,
}

impl Resumed {
    /// Takes over the journal of the run.
    pub(crate) fn open(launch: &Launch, resume: Resume) -> Result<Self, ResumeError> {
        let folder = launch.run_folder.as_deref().ok_or(ResumeError::NoFolder)?;
        if let Ok(About { robot: Some(robot), .. }) = About::read(folder) {
            return Err(ResumeError::Replica { robot });
        }
        let crash = launch.crash.clone().unwrap_or_else(|| crash(folder));
        let (journal, resume_point) = Journal::resume(folder, &options(launch.size_max))?;
        match look(folder, resume_point.sequence, resume.from) {
            Ok((reader, last, from)) => {
                Ok(Self { resume_point, journal, reader, last, from, crash, policy: resume.policy })
            }
            Err(why) => {
                // If the journal cannot be closed, it remains as found: a run without a runner.
                drop(journal.close());
                Err(why)
            }
        }
    }

    /// Loads the machine that the run kept.
    pub(crate) fn prepare<H: Host>(
        &self,
        host: &mut H,
        launch: &Launch,
    ) -> Result<Prepared<crate::HostValue<H>>, LoadFailure> {
        let about = &self.resume_point.about;
        let has_entered = self.last.entries() > 0;
        // The start state may have been removed after its entry.
        let Beginning { start_from, afterwards, hold, .. } =
            if has_entered { Beginning::default() } else { about.beginning.clone() };
        let launch = &Launch {
            machine: about.machine.clone(),
            libraries: about.libraries.clone(),
            config: launch.config.clone().or_else(|| about.config.clone()),
            homes: about.homes.clone().or_else(|| launch.homes.clone()),
            inputs: about.beginning.inputs.clone(),
            start_from,
            afterwards,
            hold,
            ..launch.clone()
        };
        let packed = self.kept_machine().map(|hash| {
            let hash = Hash::parse(hash).ok_or_else(|| ResumeError::NotAHash(hash.to_owned()))?;
            Packed::read(self.reader.folder(), hash).map_err(ResumeError::from)
        });
        Ok(prepare(host, launch, packed.transpose()?)?)
    }

    /// The hash of the run's current machine, if it was kept.
    pub(crate) fn kept_machine(&self) -> Option<&str> {
        self.last.whole().root.as_deref()
    }

    /// Continues the record of the run.
    pub(crate) fn recorder(self) -> (Recorder, ResumedPast) {
        let Self { resume_point, journal, reader, last, from, crash, policy } = self;
        let About { keeping, strict, .. } = resume_point.about;
        let recorder = Recorder::with_journal(journal, Some(&resume_point), keeping, strict);
        (recorder, ResumedPast { reader, last, from, crash, policy, resume_point })
    }
}

/// The state of the run after its last event, and the entry at which it restarts.
fn look(
    folder: &Path,
    last: u64,
    from: Option<u64>,
) -> Result<(Reader, Moment, Option<From>), ResumeError> {
    let mut reader = Reader::open(folder)?;
    let last = reader.moment(last)?;
    if from.is_none() {
        reader.check_values(&last).map_err(damaged_value)?;
    }
    let from = from.map(|sequence| From::find(&mut reader, sequence)).transpose()?;
    if from.is_none() && last.whole().status == RunStatus::Finished {
        return Err(ResumeError::Ended);
    }
    Ok((reader, last, from))
}

/// A damaged value refuses the resumption, so that no script receives it.
fn damaged_value(error: JournalError) -> ResumeError {
    ResumeError::DamagedValue(Box::new(error))
}

/// The past of a resumed run.
pub(crate) struct ResumedPast {
    reader: Reader,
    last: Moment,
    from: Option<From>,
    crash: Crash,
    policy: OnCrash,
    pub(crate) resume_point: ResumePoint,
}

impl ResumedPast {
    /// The latest commands, each with its answer. None of them is carried out again.
    pub(crate) fn answers(&self) -> Answers {
        self.last.whole().answers.clone()
    }

    /// Restores the run and continues it, or starts it by `start` if no state was active.
    pub(crate) fn go_on<S: Scripts>(
        mut self,
        driver: &Arc<Driver<S>>,
        start: Start<S::Value>,
        hold: bool,
    ) -> Result<(), CommandError> {
        let whole = self.last.whole();
        // The number of the last event exceeds that of every question.
        driver.questions().go_on_after(self.resume_point.sequence);
        let (life, crash, policy) = (self.resume_point.life, self.crash.clone(), self.policy);
        driver.record().tell(Event::Resumed { life, crash, policy });
        if let Some(lost) = &self.resume_point.lost {
            let text =
                format!("the journal is damaged: {lost}; the run continues from before the damage");
            let line = tell::log(String::new(), LogLevel::Error, text);
            driver.record().note([line]);
        }
        let has_entered = self.last.entries() > 0;
        let first = self.resume_point.about.beginning.breakpoints.iter().filter(|_| !has_entered);
        first
            .chain(whole.breakpoints.values())
            .try_for_each(|point| driver.set_breakpoint(point))?;
        if let Some(GroundSilence { link_ms, command_ms }) = whole.silence {
            driver.ground_was(rafcon_engine::Silence { link_ms, command_ms });
        }
        if let Some(from) = &self.from {
            return driver.go_back(&self.reader, from, counted(&self.last), &Order::ours());
        }
        if let Some(finish) = driver.unreported_finish(&mut self.reader, &self.last) {
            driver.finish(finish);
            return Ok(());
        }
        let held = match whole.status {
            RunStatus::Stepping => true,
            RunStatus::Paused => somebody_paused(&mut self.reader, &self.last),
            _ => false,
        };
        let (root, around) = driver.revive(&self.reader, &self.last);
        driver.put_back(around);
        let Some(root) = root else {
            if !has_entered {
                driver.set_globals(&self.resume_point.about.beginning.globals)?;
            }
            let hold = hold || held || start.hold;
            return Ok(driver.command(Input::Start(Start { hold, ..start }))?);
        };
        let crash = driver.scripts().failure(&crash_text(&self.crash)).error;
        let interrupted = match policy {
            OnCrash::Ask => Interrupted::Wait,
            OnCrash::Abort => Interrupted::Abort,
            OnCrash::Restart => Interrupted::Again,
        };
        let counted = counted(&self.last);
        let hold = hold || held;
        let stopping = stopping(&self.last);
        let begun_at = begun_at(&mut self.reader, &self.last, &self.resume_point.about.beginning);
        let restore = Restore { root, interrupted, crash, hold, counted, stopping, begun_at };
        Ok(driver.command(Input::Restore(Box::new(restore)))?)
    }
}

/// The events at the end of a journal, up to the limit for a resumption.
pub(crate) fn latest(reader: &mut Reader, last: &Moment) -> Result<Vec<Entry>, JournalError> {
    let first = last.sequence().saturating_sub(LAST_EVENTS).max(1);
    reader.page(first, usize::try_from(LAST_EVENTS).unwrap_or(usize::MAX).saturating_add(1))
}

/// True if a command or a breakpoint caused the pause at the end of the run. A command is recorded in the group of its
/// pause, or later. Otherwise the journal could not be written, and the resumed run is not held.
fn somebody_paused(reader: &mut Reader, last: &Moment) -> bool {
    let Ok(entries) = latest(reader, last) else { return true };
    let mut events = entries.iter().rev().filter_map(|entry| match &entry.record {
        Record::Told(event) => Some(&**event),
        _ => None,
    });
    while let Some(event) = events.next() {
        match event {
            Event::Commanded { envelope, answer: Answer::Applied }
                if envelope.command == Command::Pause =>
            {
                return true;
            }
            // A breakpoint may pause the whole run.
            Event::Paused { paused: true } => {
                return matches!(events.next(), Some(Event::Hit { held: true, .. }));
            }
            _ => {}
        }
    }
    true
}

/// The request to stop, if the run was stopping. If the journal does not record its order, all active states were asked
/// to end.
fn stopping(last: &Moment) -> Option<Stopping> {
    let whole = last.whole();
    let everything = Stopping { order: last.sequence() + 1, twice: false };
    let stop =
        whole.stop.map_or(everything, |stop| Stopping { order: stop.order, twice: stop.twice });
    (whole.status == RunStatus::Stopping).then_some(stop)
}

/// The counts of the earlier engine.
fn counted(last: &Moment) -> Counted {
    Counted { states_run: last.states_run(), entries: last.entries() }
}

impl<S: Scripts> Driver<S> {
    /// Restarts this run at an entry of its history, while no script runs.
    pub(crate) fn start_from_history(
        self: &Arc<Self>,
        sequence: u64,
        order: &Order<'_>,
    ) -> Result<(), CommandError> {
        let folder = self.recorder().folder().ok_or(CommandError::NoJournal)?;
        let mut reader = Reader::open(folder).map_err(ResumeError::from)?;
        let from = From::find(&mut reader, sequence)?;
        self.go_back(&reader, &from, Counted::default(), order)
    }

    /// The result of a run whose runner died before it reported the end: no state is active, and the root was left.
    fn unreported_finish(&self, reader: &mut Reader, last: &Moment) -> Option<Finish<S::Value>> {
        if last.entries() == 0 || !last.active().is_empty() {
            return None;
        }
        let entries = latest(reader, last).ok()?;
        let root = |record: &Record| {
            let Record::Left { place, .. } = record else { return None };
            let place = last.places().get(*place)?;
            (!place.path.contains('/')).then(|| Arc::clone(place))
        };
        let is_later = |record: &&Record| !matches!(record, Record::WentBack { .. });
        let mut left = entries.iter().rev().map(|entry| &entry.record).take_while(is_later);
        let (record, place) = left.find_map(|record| Some((record, root(record)?)))?;
        let Record::Left { outcome, outputs, error, .. } = record else { return None };
        let machine = self.machine();
        let mut reviver = ValueRestorer::new(self.scripts(), reader, &machine);
        let mut outputs = reviver.named(&place, &place.outputs, outputs);
        let port = [(0, SmolStr::new("error"))];
        outputs.extend(reviver.named(&place, &port, error.as_slice()));
        let name = place.outcomes.iter().find(|(id, _)| id == outcome);
        Some(Finish {
            outcome: OutcomeId(*outcome),
            outcome_name: name.map(|(_, name)| name.clone()).unwrap_or_default(),
            outputs,
            scoped_variables: Vec::new(),
            states_run: last.states_run(),
        })
    }

    fn go_back(
        self: &Arc<Self>,
        reader: &Reader,
        from: &From,
        counted: Counted,
        order: &Order<'_>,
    ) -> Result<(), CommandError> {
        let (root, around) = self.revive(reader, &from.before);
        let input = match root {
            Some(root) => Input::Restore(Box::new(Restore {
                root,
                interrupted: Interrupted::Again,
                crash: None,
                hold: true,
                counted,
                stopping: None,
                begun_at: None,
            })),
            None => self.begin_again(reader, from),
        };
        let moment = from.before.to_bytes();
        let record = Record::WentBack { sequence: from.sequence, moment };
        // A refused command must not change values that a script may be using.
        self.input_beside(
            input,
            || order.is_late(),
            || {
                self.put_back(around);
                ExtraRecords { first: Some(record), last: order.note() }
            },
        )
    }

    fn begin_again(&self, reader: &Reader, from: &From) -> Input<S::Value> {
        let machine = self.machine();
        let mut reviver = ValueRestorer::new(self.scripts(), reader, &machine);
        let root = from.root.as_ref();
        let inputs = root.map(|(place, inputs)| reviver.named(place, &place.inputs, inputs));
        self.note_lost_values(reviver.note_lost_values());
        Input::Start(Start { inputs: inputs.unwrap_or_default(), hold: true, ..Start::default() })
    }

    /// Restores the active states of a moment, and the data outside of them.
    fn revive(
        &self,
        reader: &Reader,
        moment: &Moment,
    ) -> (Option<rafcon_engine::ActiveStateData<S::Value>>, RestoreContext<S::Value>) {
        let machine = self.machine();
        let mut reviver = ValueRestorer::new(self.scripts(), reader, &machine);
        let root = reviver.root(moment);
        let around = reviver.restore_context(moment);
        self.note_lost_values(reviver.note_lost_values());
        (root, around)
    }

    /// Restores global variables and persistent values of states.
    fn put_back(&self, around: RestoreContext<S::Value>) {
        let RestoreContext { globals, persistent, mut problems } = around;
        let globals = globals.into_iter().map(|(name, value)| {
            let put = self.scripts().restore_global(&name, value);
            put.map_err(|why| format!("the global variable \"{name}\" cannot be put back: {why}"))
        });
        problems.extend(globals.filter_map(Result::err));
        let persistent = persistent.into_iter().map(|(path, value)| {
            let put = self.scripts().restore_persistent(&path, value);
            put.map_err(|why| format!("what {path} keeps cannot be put back: {why}"))
        });
        problems.extend(persistent.filter_map(Result::err));
        let lines =
            problems.into_iter().map(|line| tell::log(String::new(), LogLevel::Warning, line));
        self.record().note(lines);
    }
}

impl From {
    /// Finds the entry with this number.
    fn find(reader: &mut Reader, sequence: u64) -> Result<Self, ResumeError> {
        let page = reader.page(sequence, 1)?;
        let entry = page.first().filter(|entry| entry.sequence == sequence);
        let Some(Record::Entered { place, inputs, undoes: None }) =
            entry.map(|entry| &entry.record)
        else {
            return Err(ResumeError::NotAnEntry(sequence));
        };
        let (place, inputs) = (*place, inputs.clone());
        let before = reader.moment(sequence - 1)?;
        reader.check_values(&before).map_err(damaged_value)?;
        let root = if before.active().is_empty() {
            reader.moment(sequence)?.places().get(place).map(|place| (Arc::clone(place), inputs))
        } else {
            None
        };
        Ok(Self { sequence, before, root })
    }
}

/// The crash information from the files of the last runner, if nobody observed its end.
fn crash(folder: &Path) -> Crash {
    let read = |name| fs::read(folder.join(name)).unwrap_or_default();
    let paths = read(active::PATHS_FILE);
    let active = active::running(&read(active::SLOTS_FILE), &String::from_utf8_lossy(&paths));
    Crash { reason: "nobody saw how it ended".to_owned(), active }
}

/// The error that scripts see for a state that a crash interrupted.
fn crash_text(crash: &Crash) -> String {
    let active = match crash.active.as_slice() {
        [] => "no script was running".to_owned(),
        active => format!("the scripts of {} were running", active.join(", ")),
    };
    format!("the runner of this run ended in the middle of it: {}; {active}", crash.reason)
}

#[cfg(test)]
mod tests {
    use super::somebody_paused;
    use rafcon_storage::journal::{About, Journal, Options, Reader};
    use rafcon_testkit::journal_notation;

    const PAUSED: &str = r#"told {"type":"paused","paused":true}"#;
    const LINE: &str =
        r#"told {"type":"log","path":"","level":"error","stream":"engine","message":"full"}"#;
    const COMMAND: &str = r#"told {"type":"commanded","envelope":{"id":"1","command":{"type":"pause"}},"answer":{"answer":"applied"}}"#;
    const HIT: &str = r#"told {"type":"hit","breakpoint":1,"path":"R","hits":1,"held":true}"#;

    /// Checks whether someone requested the pause at the end of this run.
    fn check(events: &[&str], expected: bool) {
        let folder = tempfile::tempdir().unwrap();
        let run = format!("place R \"Root\" outcome done\nenter R\n{}\n", events.join("\n"));
        let journal =
            Journal::create(folder.path(), &About::default(), &Options::default()).unwrap();
        journal.append(&journal_notation::batch(&run, 0).unwrap()).unwrap();
        drop(journal);
        let mut reader = Reader::open(folder.path()).unwrap();
        let last = reader.moment(events.len() as u64 + 1).unwrap();
        assert_eq!(somebody_paused(&mut reader, &last), expected, "{events:?}");
    }

    #[test]
    fn a_pause_that_the_journal_needed_holds_nobody_after_a_crash() {
        check(&[PAUSED, LINE], false);
        check(&[PAUSED, COMMAND], true);
        check(&[PAUSED, LINE, COMMAND], true);
        check(&[HIT, PAUSED], true);
    }
}
