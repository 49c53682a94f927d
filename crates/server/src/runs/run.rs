//! One run, shared by all parts of the server: its state, its newest events, its link, and its control.
//!
//! Knows the current state. Does not know its sources, and never waits for readers.

use super::control::Holding;
use super::folder_files;
use super::link::{Link, RunnerLink};
use super::pace::Pace;
use super::pulse::Onlookers;
use super::ring::Ring;
use super::watched::RunWatched;
use crate::state::ServerState;
use rafcon_locks::Mutex;
use rafcon_protocol::api::{
    Control, LinkState, LoadedMachine, RunNow, RunPhase, RunSummary, RunWait,
};
use rafcon_protocol::{EnginePulse, Envelope, Event, LinkHealth, Snapshot};
use rafcon_storage::journal::{Broken, size_of};
use rafcon_supervisor::Exit;
use rafcon_supervisor::clock::{self, CalendarSteps};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;
use tokio::sync::{Semaphore, SemaphorePermit, oneshot, watch};
use tokio::time::timeout;

/// Timeout of a wait for the link to a runner.
const LINK_TIMEOUT: Duration = Duration::from_secs(3);

/// Maximum number of parallel inspections of active states. Each uses one of the few connections of the runner.
const PARALLEL_INSPECTIONS: usize = 4;

/// One run with its shared state.
#[derive(Debug)]
pub(crate) struct Run {
    id: String,
    folder: PathBuf,
    ring: Ring,
    pace: Pace,
    now: watch::Sender<Arc<RunNow>>,
    link: RunnerLink,
    /// Receives the exit of its process, if this server started it.
    exit: Mutex<Option<oneshot::Receiver<Exit>>>,
    holding: Mutex<Holding>,
    silence: Duration,
    /// Logs faults outside of requests.
    tell: fn(&str),
    /// Counter that increments when the summary changes.
    news: watch::Sender<u64>,
    /// True while a supervisor follows its runner.
    is_followed: AtomicBool,
    /// True if it has changed since it was found.
    has_changed: AtomicBool,
    /// True if its process was killed because it did not stop.
    is_stopped_by_force: AtomicBool,
    /// Number of notes about control that were sent.
    notes: AtomicU64,
    /// Time of the last report to the robot of a replica that the holder of control is active.
    presence_ms: AtomicU64,
    inspections: Semaphore,
    audience: Onlookers,
    watched: RunWatched,
    /// Held while the state of control is written.
    keeping: Mutex<()>,
    calendar: Mutex<CalendarSteps>,
}

/// The clock was set by `step_ms`. Shifts all times, so that ages stay correct.
fn shift(now: &mut RunNow, step_ms: i64) {
    for time in [&mut now.snapshot_ms, &mut now.runner_heard_ms].into_iter().flatten() {
        *time = time.saturating_add_signed(step_ms);
    }
}

impl Run {
    /// The run in `folder`, with its state on disk.
    pub(super) fn new(server: &ServerState, folder: PathBuf, summary: &RunSummary) -> Self {
        let (silence, now_ms) = (server.settings.control_silence, clock::since_1970_ms());
        let holding = folder_files::read_holding(&folder).go_on(now_ms);
        let now = RunNow {
            run: summary.clone(),
            loaded: None,
            link: link_of(&summary.phase),
            snapshot: None,
            snapshot_ms: None,
            runner_heard_ms: None,
            now_ms,
            control: holding.told(silence),
            robot: None,
        };
        let ring = Ring::new(folder.clone());
        ring.settle(summary.events);
        Self {
            id: summary.id.clone(),
            folder,
            ring,
            calendar: Mutex::new(CalendarSteps::from(clock::since_boot(), now_ms)),
            pace: Pace::new(),
            now: watch::Sender::new(Arc::new(now)),
            link: RunnerLink::default(),
            exit: Mutex::new(None),
            holding: Mutex::new(holding),
            silence,
            tell: server.settings.tell,
            news: server.news.counter_of_runs(),
            is_followed: AtomicBool::new(false),
            has_changed: AtomicBool::new(false),
            is_stopped_by_force: AtomicBool::new(false),
            notes: AtomicU64::new(0),
            presence_ms: AtomicU64::new(0),
            inspections: Semaphore::new(PARALLEL_INSPECTIONS),
            audience: Onlookers::default(),
            watched: RunWatched::default(),
            keeping: Mutex::default(),
        }
    }

    /// Folder of the run.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Newest events of the run.
    pub(crate) fn ring(&self) -> &Ring {
        &self.ring
    }

    /// Schedule of updates for its followers.
    pub(crate) fn pace(&self) -> &Pace {
        &self.pace
    }

    /// Receiver of its state.
    pub(crate) fn now(&self) -> watch::Receiver<Arc<RunNow>> {
        self.now.subscribe()
    }

    /// The current summary. Its length grows while the run is live, also between snapshots.
    pub(crate) fn summary(&self) -> RunSummary {
        let now = self.now.borrow();
        let mut run = now.run.clone();
        if let (RunPhase::Live, LinkState::Up, Some(at)) = (&run.phase, now.link, now.snapshot_ms) {
            run.length_ms += clock::since_1970_ms().saturating_sub(at);
        }
        run
    }

    /// The summary with the current size on disk. Reads the disk.
    pub(super) fn measured(&self) -> RunSummary {
        let mut run = self.summary();
        if is_live(&run.phase) {
            run.bytes = size_of(&self.folder);
        }
        run
    }

    /// Id of the run.
    pub(crate) fn id(&self) -> &str {
        &self.id
    }

    /// True if the run is active, or has changed since the server started.
    pub(crate) fn is_lively(&self) -> bool {
        self.is_live() || self.has_changed.load(Ordering::Relaxed)
    }

    /// Marks the run as new or changed since the server started.
    pub(super) fn mark_changed(&self) {
        self.has_changed.store(true, Ordering::Relaxed);
    }

    /// True if the run is active, or about to start.
    pub(crate) fn is_live(&self) -> bool {
        is_live(&self.now.borrow().run.phase)
    }

    /// The silence after which control can be taken over.
    pub(super) fn silence(&self) -> Duration {
        self.silence
    }

    /// The current link to its runner, if any.
    pub(super) fn link(&self) -> Option<Arc<Link>> {
        self.link.get()
    }

    /// Waits for a link to its runner. `None` if the run is over or the wait times out.
    pub(super) async fn linked(&self) -> Option<Arc<Link>> {
        if let Some(link) = self.link() {
            return Some(link);
        }
        let mut now = self.now();
        let is_up = |now: &Arc<RunNow>| now.link == LinkState::Up || !is_live(&now.run.phase);
        // After a timeout, the result is the missing link.
        drop(timeout(LINK_TIMEOUT, now.wait_for(is_up)).await);
        self.link()
    }

    /// Waits, for a limited time, until the supervisor of an ended runner has determined its result.
    pub(super) async fn wait_settled(&self) {
        let mut now = self.now();
        let is_known = |now: &Arc<RunNow>| now.link == LinkState::Over || is_live(&now.run.phase);
        drop(timeout(LINK_TIMEOUT, now.wait_for(is_known)).await);
    }

    /// A permit to inspect an active state, held until dropped. `None` if too many are in use.
    pub(super) fn inspection_permit(&self) -> Option<SemaphorePermit<'_>> {
        self.inspections.try_acquire().ok()
    }

    /// Sets the receiver of the exit of its process, which this server started.
    pub(super) fn set_exit(&self, exit: oneshot::Receiver<Exit>) {
        *self.exit.lock() = Some(exit);
    }

    /// Takes the receiver of the exit of its process.
    pub(super) fn take_exit(&self) -> Option<oneshot::Receiver<Exit>> {
        self.exit.lock().take()
    }

    /// Claims the supervision of its runner. `false` if it is already claimed.
    pub(super) fn try_claim(&self) -> bool {
        !self.is_followed.swap(true, Ordering::AcqRel)
    }

    /// True if the supervision is claimed. The supervisor's state is newer than the one on disk.
    pub(super) fn is_claimed(&self) -> bool {
        self.is_followed.load(Ordering::Acquire)
    }

    /// Releases the supervision of its runner.
    pub(super) fn release(&self) {
        self.is_followed.store(false, Ordering::Release);
    }

    pub(super) fn set_link(&self, link: &Arc<Link>) {
        self.link.connect(link);
        self.change(|now| {
            now.link = LinkState::Up;
            now.runner_heard_ms = Some(clock::since_1970_ms());
            now.run.phase = RunPhase::Live;
        });
    }

    /// Sends a note about control to the runner. Without a link, the newest note waits for the next one.
    pub(super) fn send_note(&self, note: Envelope) {
        self.link.send_note(note);
    }

    /// Marks the link as lost. `heard_ms` is the time of the runner's last message.
    pub(super) fn clear_link(&self, heard_ms: u64) {
        self.link.disconnect();
        self.change(|now| (now.link, now.runner_heard_ms) = (LinkState::Down, Some(heard_ms)));
    }

    /// Marks the runner as silent. `heard_ms` is the time of its last message.
    pub(super) fn mark_silent(&self, heard_ms: u64) {
        self.change(|now| (now.link, now.runner_heard_ms) = (LinkState::Silent, Some(heard_ms)));
    }

    /// Marks the runner as responsive after silence.
    pub(super) fn mark_heard(&self) {
        let heard_ms = clock::since_1970_ms();
        self.change(|now| (now.link, now.runner_heard_ms) = (LinkState::Up, Some(heard_ms)));
    }

    /// Applies the runner's report about its engine: an engine that accepts no inputs is stuck.
    pub(super) fn engine_answers(&self, engine: EnginePulse) {
        let reached_ms = clock::since_1970_ms().saturating_sub(engine.unreached_ms);
        self.change(|now| {
            let link = link_with(now.link, engine);
            if link != now.link {
                (now.link, now.runner_heard_ms) = (link, Some(reached_ms));
            }
        });
    }

    /// Applies the station's report about the link to the robot of a replica.
    pub(super) fn robot_stands(&self, robot: LinkHealth) {
        self.change(|now| {
            now.link = if robot.is_heard { LinkState::Up } else { LinkState::Silent };
            // If this start of the station received nothing, the newest event gives the time.
            let newest_ms = now.run.started_ms.saturating_add(now.run.length_ms);
            now.runner_heard_ms = robot.heard_ms.or(Some(newest_ms));
            now.robot = Some(robot);
        });
    }

    /// Marks the run as stopped by force, so that it is not resumed automatically.
    pub(super) fn stop_by_force(&self) {
        self.is_stopped_by_force.store(true, Ordering::Release);
    }

    /// True if the last runner was stopped by force. Resets the mark.
    pub(super) fn take_stop_by_force(&self) -> bool {
        self.is_stopped_by_force.swap(false, Ordering::AcqRel)
    }

    /// Onlookers of its state.
    pub(crate) fn audience(&self) -> &Onlookers {
        &self.audience
    }

    /// Watched values, for the run of a robot.
    pub(super) fn watched(&self) -> &RunWatched {
        &self.watched
    }

    /// Sends the watched targets to the station, for the run of a robot.
    pub(super) fn ask_for_watched(&self) {
        if let Some(link) = self.link().filter(|_| self.is_replica()) {
            link.watch(self.watched.union());
        }
    }

    /// Applies the state on disk of a run without a link.
    pub(super) fn apply_summary(&self, summary: &RunSummary) {
        self.ring.settle(summary.events);
        self.change(|now| {
            now.run = summary.clone();
            now.link = link_of(&summary.phase);
        });
    }

    /// Sets the phase of the run.
    pub(super) fn set_phase(&self, phase: RunPhase) {
        self.change(|now| (now.run.phase, now.run.waits) = (phase, None));
    }

    /// Adds events as received from the runner.
    pub(super) fn happened(&self, events: &[u8]) -> Result<(), Broken> {
        let finish = self.ring.push(events)?;
        if let Some(Event::Finished { outcome, states_run, .. }) = finish {
            let events = self.ring.next() - 1;
            self.change(|now| {
                now.run.events = events;
                now.run.phase = RunPhase::Finished { outcome, states_run };
                now.run.waits = None;
            });
        }
        Ok(())
    }

    /// Sets the facts about the loaded machine.
    pub(super) fn set_loaded(&self, loaded: LoadedMachine) {
        self.change(|now| now.loaded = Some(loaded));
    }

    /// Applies a snapshot from its runner.
    pub(super) fn set_snapshot(&self, snapshot: Snapshot) {
        let (at, waits) = (clock::since_1970_ms(), RunWait::of(&snapshot));
        let mut is_news = false;
        self.now.send_modify(|now| {
            let now = Arc::make_mut(now);
            is_news = now.run.waits != waits;
            now.run.waits = waits;
            (now.now_ms, now.snapshot_ms, now.runner_heard_ms) = (at, Some(at), Some(at));
            now.run.length_ms = snapshot.elapsed_ms;
            now.run.events = now.run.events.max(snapshot.disk_safe);
            now.snapshot = Some(snapshot);
        });
        if is_news {
            self.announce();
        }
    }

    /// Checks whether the clock was set.
    pub(super) fn look_at_calendar(&self) {
        self.shift_times(&mut self.holding.lock());
    }

    fn shift_times(&self, holding: &mut Holding) {
        let step = self.calendar.lock().step_ms(clock::since_boot(), clock::since_1970_ms());
        if step != 0 {
            holding.shift(step);
            let control = holding.told(self.silence);
            self.change(|now| {
                shift(now, step);
                now.control = control;
            });
        }
    }

    /// Accesses the state of control and publishes the result.
    pub(super) fn with_holding<T>(&self, act: impl FnOnce(&mut Holding) -> T) -> T {
        let mut holding = self.holding.lock();
        self.shift_times(&mut holding);
        let done = act(&mut holding);
        let control = holding.told(self.silence);
        // Published under the lock, so that the last publication is the current state.
        self.change(|now| now.control = control);
        done
    }

    /// Stores the current state of control in the run's folder.
    pub(super) fn keep_holding(&self) {
        let _one_after_the_other = self.keeping.lock();
        // The lock is not held during the write, so that activity of users never waits for the disk.
        let holding = self.holding.lock().clone();
        if let Err(error) = folder_files::write_holding(&self.folder, &holding) {
            let (id, tell) = (&self.id, self.tell);
            tell(&format!("who commands run {id} is not kept: {error}"));
        }
    }

    /// Notes activity of a user. Publishes it only at intervals.
    pub(super) fn heard(&self, user: &str, now_ms: u64) {
        if self.is_replica() {
            return self.tell_robot(user, now_ms);
        }
        let mut holding = self.holding.lock();
        if !holding.heard(user, now_ms) {
            return;
        }
        let control = holding.told(self.silence);
        let told_ms = self.now.borrow().control.heard_ms;
        if now_ms.saturating_sub(told_ms) >= control.silence_ms / 10 {
            self.change(|now| now.control = control);
        }
    }

    /// State of control, with the last activity of the holder.
    pub(super) fn control(&self) -> Control {
        self.holding.lock().told(self.silence)
    }

    /// True for the replica of a run on a remote robot, which decides about control.
    pub(crate) fn is_replica(&self) -> bool {
        self.now.borrow().run.robot.is_some()
    }

    /// Name of the robot, for a replica.
    pub(crate) fn robot(&self) -> Option<String> {
        self.now.borrow().run.robot.clone()
    }

    /// Applies the state of control from the robot of a replica.
    pub(super) fn robot_controls(&self, control: Control) {
        self.change(|now| now.control = control);
    }

    /// A number that is unique among this server's notes about this run.
    pub(super) fn next_note(&self) -> u64 {
        self.notes.fetch_add(1, Ordering::Relaxed)
    }

    /// Reports to the robot of a replica, at intervals, that the holder of control is active.
    fn tell_robot(&self, user: &str, now_ms: u64) {
        let control = self.now.borrow().control.clone();
        let told_ms = self.presence_ms.load(Ordering::Relaxed);
        // Also covers a clock that was set back.
        let is_due = now_ms.abs_diff(told_ms) >= control.silence_ms / 3;
        if control.holder.as_deref() == Some(user)
            && is_due
            && let Some(link) = self.link()
        {
            self.presence_ms.store(now_ms, Ordering::Relaxed);
            link.tell_present(user);
        }
    }

    /// Changes the state, and wakes its followers if it differs.
    fn change(&self, change: impl FnOnce(&mut RunNow)) {
        let mut is_news = false;
        self.now.send_if_modified(|now| {
            let before = Arc::clone(now);
            let changed = Arc::make_mut(now);
            change(changed);
            changed.run.unheard_since_ms = unheard_since(changed);
            let is_same = *before == **now;
            is_news = before.run != now.run || before.control.holder != now.control.holder;
            if !is_same {
                Arc::make_mut(now).now_ms = clock::since_1970_ms();
            }
            !is_same
        });
        if is_news {
            self.announce();
        }
    }

    /// Wakes the listeners of the list of runs.
    fn announce(&self) {
        self.has_changed.store(true, Ordering::Relaxed);
        self.news.send_modify(|revision| *revision += 1);
    }
}

/// Start of the silence of an active runner. It does not move during the silence.
fn unheard_since(now: &RunNow) -> Option<u64> {
    let is_unheard =
        is_live(&now.run.phase) && !matches!(now.link, LinkState::Up | LinkState::Over);
    is_unheard.then(|| now.run.unheard_since_ms.or(now.runner_heard_ms)).flatten()
}

/// True if a run in this phase is active, or about to start.
fn is_live(phase: &RunPhase) -> bool {
    matches!(phase, RunPhase::Live | RunPhase::Starting)
}

/// The state of the link after a report about the engine.
fn link_with(link: LinkState, engine: EnginePulse) -> LinkState {
    match link {
        LinkState::Up if !engine.is_reached(true) => LinkState::Stuck,
        LinkState::Stuck if engine.is_reached(false) => LinkState::Up,
        other => other,
    }
}

fn link_of(phase: &RunPhase) -> LinkState {
    if is_live(phase) { LinkState::Down } else { LinkState::Over }
}

#[cfg(test)]
mod tests {
    use super::{link_with, shift};
    use rafcon_protocol::EnginePulse;
    use rafcon_protocol::api::{LinkState, RunNow};

    #[test]
    fn what_is_known_of_a_run_gets_neither_older_nor_younger_when_the_calendar_is_set() {
        let json = r#"{"run":{"id":"r","name":"R","started_ms":5000,"phase":"live","length_ms":0,"events":0,"bytes":0,"keeping":"full"},
            "link":"up","snapshot_ms":9000,"runner_heard_ms":null,"now_ms":9000,
            "control":{"holder":null,"since_ms":0,"heard_ms":0,"silence_ms":0,"requests":[],"offered_to":null,"epoch":0}}"#;
        let mut now: RunNow = serde_json::from_str(json).unwrap();
        shift(&mut now, 3_600_000);
        assert_eq!(
            (now.snapshot_ms, now.runner_heard_ms, now.run.started_ms),
            (Some(3_609_000), None, 5_000)
        );
    }

    #[test]
    fn an_engine_that_takes_no_inputs_for_three_seconds_is_stuck_until_it_takes_one() {
        let mut link = LinkState::Up;
        let mut told = Vec::new();
        for unreached_ms in [0, 2_999, 3_000, 4_000, 1, 0, 1] {
            link = link_with(link, EnginePulse { unreached_ms, still_ms: 0, scripts: None });
            told.push(link);
        }
        let (up, stuck) = (LinkState::Up, LinkState::Stuck);
        assert_eq!(told, [up, up, stuck, stuck, stuck, up, up]);
        for link in [LinkState::Down, LinkState::Silent, LinkState::Over] {
            let engine = EnginePulse { unreached_ms: 9_000, still_ms: 0, scripts: None };
            assert_eq!(link_with(link, engine), link);
        }
    }
}
