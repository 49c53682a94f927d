//! One run, as everyone in the server shares it: how it stands, its newest events, the way to its runner, who commands it.
//!
//! Knows the latest truth. Does not know how it is found out, nor wait for whoever wants to know it.

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

/// How long the way to a runner is waited for by those who need it.
const LINK_TIMEOUT: Duration = Duration::from_secs(3);

/// So many look into active states at a time, each over a connection of its own: the runner lets few in, and others need it more.
const GUESTS: usize = 4;

/// One run.
#[derive(Debug)]
pub(crate) struct Run {
    id: String,
    folder: PathBuf,
    ring: Ring,
    pace: Pace,
    now: watch::Sender<Arc<RunNow>>,
    link: RunnerLink,
    /// How its process ends, if it is one of ours.
    exit: Mutex<Option<oneshot::Receiver<Exit>>>,
    holding: Mutex<Holding>,
    silence: Duration,
    /// For what goes wrong and no one asked for.
    tell: fn(&str),
    /// Told whenever the run in one line is different.
    news: watch::Sender<u64>,
    /// Whether someone looks after its runner.
    is_followed: AtomicBool,
    /// Whether it is different from how it was found.
    has_changed: AtomicBool,
    /// Whether its process was ended because it did not take a stop.
    is_stopped_by_force: AtomicBool,
    /// How many notes about control were sent.
    notes: AtomicU64,
    /// When the robot of a replica was told last that the holder of control is here.
    presence_ms: AtomicU64,
    guests: Semaphore,
    audience: Onlookers,
    watched: RunWatched,
    /// Held while who holds control is written down.
    keeping: Mutex<()>,
    calendar: Mutex<CalendarSteps>,
}

/// The calendar was set by so many ms: nothing is older or younger for that.
fn shift(now: &mut RunNow, step_ms: i64) {
    for time in [&mut now.snapshot_ms, &mut now.runner_heard_ms].into_iter().flatten() {
        *time = time.saturating_add_signed(step_ms);
    }
}

impl Run {
    /// The run in `folder`, as it was found.
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
            guests: Semaphore::new(GUESTS),
            audience: Onlookers::default(),
            watched: RunWatched::default(),
            keeping: Mutex::default(),
        }
    }

    /// The run's folder.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Its newest events.
    pub(crate) fn ring(&self) -> &Ring {
        &self.ring
    }

    /// When those who follow it are told.
    pub(crate) fn pace(&self) -> &Pace {
        &self.pace
    }

    /// How it stands; with `changed`, how it stands then.
    pub(crate) fn now(&self) -> watch::Receiver<Arc<RunNow>> {
        self.now.subscribe()
    }

    /// The run in one line. While it continues it gets longer, whether its runner has something to say or not.
    pub(crate) fn summary(&self) -> RunSummary {
        let now = self.now.borrow();
        let mut run = now.run.clone();
        if let (RunPhase::Live, LinkState::Up, Some(at)) = (&run.phase, now.link, now.snapshot_ms) {
            run.length_ms += clock::since_1970_ms().saturating_sub(at);
        }
        run
    }

    /// The same with what it takes on disk by now. Reads the disk.
    pub(super) fn measured(&self) -> RunSummary {
        let mut run = self.summary();
        if is_live(&run.phase) {
            run.bytes = size_of(&self.folder);
        }
        run
    }

    /// Its id.
    pub(crate) fn id(&self) -> &str {
        &self.id
    }

    /// Whether it continues, or has changed since the server began.
    pub(crate) fn is_lively(&self) -> bool {
        self.is_live() || self.has_changed.load(Ordering::Relaxed)
    }

    /// It was not there when the server began; it may be over already.
    pub(super) fn mark_changed(&self) {
        self.has_changed.store(true, Ordering::Relaxed);
    }

    /// Whether it continues, or is about to.
    pub(crate) fn is_live(&self) -> bool {
        is_live(&self.now.borrow().run.phase)
    }

    /// After how much silence control can be taken over.
    pub(super) fn silence(&self) -> Duration {
        self.silence
    }

    /// The way to its runner, if there is one.
    pub(super) fn link(&self) -> Option<Arc<Link>> {
        self.link.get()
    }

    /// The way to its runner, as soon as there is one; none if the run is over, or it takes too long.
    pub(super) async fn linked(&self) -> Option<Arc<Link>> {
        if let Some(link) = self.link() {
            return Some(link);
        }
        let mut now = self.now();
        let is_up = |now: &Arc<RunNow>| now.link == LinkState::Up || !is_live(&now.run.phase);
        // Too late, or never: there is no link then.
        drop(timeout(LINK_TIMEOUT, now.wait_for(is_up)).await);
        self.link()
    }

    /// Waits until someone who looks after a runner that has come to its end knows what it left; not for long.
    pub(super) async fn wait_settled(&self) {
        let mut now = self.now();
        let is_known = |now: &Arc<RunNow>| now.link == LinkState::Over || is_live(&now.run.phase);
        drop(timeout(LINK_TIMEOUT, now.wait_for(is_known)).await);
    }

    /// Lets someone look into an active state for as long as this is held; nothing if too many do.
    pub(super) fn guest(&self) -> Option<SemaphorePermit<'_>> {
        self.guests.try_acquire().ok()
    }

    /// Its process is one of ours, and ends like this.
    pub(super) fn set_exit(&self, exit: oneshot::Receiver<Exit>) {
        *self.exit.lock() = Some(exit);
    }

    /// How its process ends, for whoever waits for that.
    pub(super) fn take_exit(&self) -> Option<oneshot::Receiver<Exit>> {
        self.exit.lock().take()
    }

    /// From now on someone looks after its runner; false if someone does already.
    pub(super) fn try_claim(&self) -> bool {
        !self.is_followed.swap(true, Ordering::AcqRel)
    }

    /// Whether someone looks after its runner, and knows better than can be found.
    pub(super) fn is_claimed(&self) -> bool {
        self.is_followed.load(Ordering::Acquire)
    }

    /// No one looks after its runner any more.
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

    /// Sends a note about control to the runner. Without a connection the newest note waits for the next one.
    pub(super) fn send_note(&self, note: Envelope) {
        self.link.send_note(note);
    }

    /// The link is gone; the runner was heard last then.
    pub(super) fn clear_link(&self, heard_ms: u64) {
        self.link.disconnect();
        self.change(|now| (now.link, now.runner_heard_ms) = (LinkState::Down, Some(heard_ms)));
    }

    /// Its runner does not answer; it was heard last then.
    pub(super) fn mark_silent(&self, heard_ms: u64) {
        self.change(|now| (now.link, now.runner_heard_ms) = (LinkState::Silent, Some(heard_ms)));
    }

    /// Its runner was silent, and is heard.
    pub(super) fn mark_heard(&self) {
        let heard_ms = clock::since_1970_ms();
        self.change(|now| (now.link, now.runner_heard_ms) = (LinkState::Up, Some(heard_ms)));
    }

    /// Its runner says whether its engine takes inputs.
    pub(super) fn engine_answers(&self, engine: EnginePulse) {
        let reached_ms = clock::since_1970_ms().saturating_sub(engine.unreached_ms);
        self.change(|now| {
            let link = link_with(now.link, engine);
            if link != now.link {
                (now.link, now.runner_heard_ms) = (link, Some(reached_ms));
            }
        });
    }

    /// A station answers for its runner: this is how the link to the robot is.
    pub(super) fn robot_stands(&self, robot: LinkHealth) {
        self.change(|now| {
            now.link = if robot.is_heard { LinkState::Up } else { LinkState::Silent };
            // Not heard by this start of the station, it was true when the newest event happened.
            let newest_ms = now.run.started_ms.saturating_add(now.run.length_ms);
            now.runner_heard_ms = robot.heard_ms.or(Some(newest_ms));
            now.robot = Some(robot);
        });
    }

    /// Its process is ended because it did not take a stop: it is not to continue by itself.
    pub(super) fn stop_by_force(&self) {
        self.is_stopped_by_force.store(true, Ordering::Release);
    }

    /// Whether that is how its last runner ended; asked once.
    pub(super) fn take_stop_by_force(&self) -> bool {
        self.is_stopped_by_force.swap(false, Ordering::AcqRel)
    }

    /// Who looks at how it stands.
    pub(crate) fn audience(&self) -> &Onlookers {
        &self.audience
    }

    /// What of it is watched, if it is a robot's.
    pub(super) fn watched(&self) -> &RunWatched {
        &self.watched
    }

    /// Asks the station for what is watched, if it is a robot's.
    pub(super) fn ask_for_watched(&self) {
        if let Some(link) = self.link().filter(|_| self.is_replica()) {
            link.watch(self.watched.union());
        }
    }

    /// The run was looked at: this is what is true. No one is linked to it.
    pub(super) fn apply_summary(&self, summary: &RunSummary) {
        self.ring.settle(summary.events);
        self.change(|now| {
            now.run = summary.clone();
            now.link = link_of(&summary.phase);
        });
    }

    /// The run is in this phase.
    pub(super) fn set_phase(&self, phase: RunPhase) {
        self.change(|now| (now.run.phase, now.run.waits) = (phase, None));
    }

    /// Events happened: these are as the runner sent them.
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

    /// This is what its runner goes by.
    pub(super) fn set_loaded(&self, loaded: LoadedMachine) {
        self.change(|now| now.loaded = Some(loaded));
    }

    /// This is how its runner says that it stands.
    pub(super) fn stands(&self, snapshot: Snapshot) {
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

    /// Looks whether the calendar was set.
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

    /// Does something with who holds control; whoever follows the run is told.
    pub(super) fn with_holding<T>(&self, act: impl FnOnce(&mut Holding) -> T) -> T {
        let mut holding = self.holding.lock();
        self.shift_times(&mut holding);
        let done = act(&mut holding);
        let control = holding.told(self.silence);
        // With the lock held: what is told last is what is true.
        self.change(|now| now.control = control);
        done
    }

    /// Keeps who holds control in the run's folder: what is true when it is written.
    pub(super) fn keep_holding(&self) {
        let _one_after_the_other = self.keeping.lock();
        // No one waits for the disk to be heard.
        let holding = self.holding.lock().clone();
        if let Err(error) = folder_files::write_holding(&self.folder, &holding) {
            let (id, tell) = (&self.id, self.tell);
            tell(&format!("who commands run {id} is not kept: {error}"));
        }
    }

    /// Someone was heard. Whoever follows the run is told now and then only.
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

    /// Who holds control, and when they were heard last.
    pub(super) fn control(&self) -> Control {
        self.holding.lock().told(self.silence)
    }

    /// Whether it is the replica of a run on a robot far away: the robot decides who commands it.
    pub(crate) fn is_replica(&self) -> bool {
        self.now.borrow().run.robot.is_some()
    }

    /// The robot of a replica.
    pub(crate) fn robot(&self) -> Option<String> {
        self.now.borrow().run.robot.clone()
    }

    /// The robot of a replica says who holds control.
    pub(super) fn robot_controls(&self, control: Control) {
        self.change(|now| now.control = control);
    }

    /// A number that no note of this server about this run had.
    pub(super) fn next_note(&self) -> u64 {
        self.notes.fetch_add(1, Ordering::Relaxed)
    }

    /// Tells the robot of a replica now and then that the holder of control is here.
    fn tell_robot(&self, user: &str, now_ms: u64) {
        let control = self.now.borrow().control.clone();
        let told_ms = self.presence_ms.load(Ordering::Relaxed);
        // Also if the calendar was set back meanwhile.
        let is_due = now_ms.abs_diff(told_ms) >= control.silence_ms / 3;
        if control.holder.as_deref() == Some(user)
            && is_due
            && let Some(link) = self.link()
        {
            self.presence_ms.store(now_ms, Ordering::Relaxed);
            link.tell_present(user);
        }
    }

    /// Changes the truth, if it is another then; whoever follows is woken.
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

    /// Whoever lists runs is woken.
    fn announce(&self) {
        self.has_changed.store(true, Ordering::Relaxed);
        self.news.send_modify(|revision| *revision += 1);
    }
}

/// Since when the runner of a run that continues is not heard; the first that was said of a silence counts.
fn unheard_since(now: &RunNow) -> Option<u64> {
    let is_unheard =
        is_live(&now.run.phase) && !matches!(now.link, LinkState::Up | LinkState::Over);
    is_unheard.then(|| now.run.unheard_since_ms.or(now.runner_heard_ms)).flatten()
}

/// Whether a run in this phase continues, or is about to.
fn is_live(phase: &RunPhase) -> bool {
    matches!(phase, RunPhase::Live | RunPhase::Starting)
}

/// The link to a runner after its engine has answered so.
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
