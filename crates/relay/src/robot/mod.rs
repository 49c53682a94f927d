//! The robot's side: finds its runs, follows those that continue, sends what happens, and gives commands to their runners.

mod authority;
mod commands;
mod disk;
mod early;
mod follow;
mod numbers;
mod offered_key;
mod parcels;
mod project_machines;
mod runs;
mod scanner;
mod values;
mod watches;

pub use authority::Authority;
pub use project_machines::{ProjectFolder, Projects};

use crate::carrier::{Carrier, Dialler, StationAddress, any_port};
use crate::clock::SessionClock;
use crate::error::RelayError;
use crate::ids;
use crate::inbox::{Inbox, Input, Stopper};
use crate::machine_lists::MACHINES_FOLDER;
use crate::meter::{LinkMeter, shortened};
use crate::pairing::Paired;
use crate::report::{REPORT_EVERY, Reporter};
use crate::start::Start;
use commands::outcome;
use disk::{RobotDisk, RobotFiles};
use early::EarlyCommands;
use follow::FromRun;
use numbers::RunNumbers;
use offered_key::OfferedKey;
use parcels::SentParcels;
use rafcon_link::{Generation, Profile, RobotSession, SessionTime};
use rafcon_protocol::LinkReport;
use rafcon_protocol::api::RobotAnswer;
use rafcon_supervisor::clock;
use runs::{RobotRuns, RunsPlace};
use scanner::{FoundRun, RunScanner};
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use watches::{RobotWatches, age_max};

/// Interval at which the state of the link is stored.
const SAVE_EVERY: Duration = Duration::from_secs(10);
/// Interval of the steps with ended runs.
const STEP_EVERY: Duration = Duration::from_millis(100);

/// Datagrams sent before the robot receives again, so that commands arrive at a computer slower than its link, too.
const SENDS_AT_ONCE: usize = 32;
/// Inputs processed before the robot sends again.
const INPUTS_AT_ONCE: usize = 256;

/// Settings of a robot's relay.
#[derive(Debug, Clone)]
pub struct RobotSettings {
    /// The folder for its files, one for each station.
    pub folder: PathBuf,
    /// The folder with the runs.
    pub runs: PathBuf,
    /// Projects of the server. Their machines are sent before a run uses them.
    pub projects: Projects,
    /// Pairing with the station.
    pub paired: Paired,
    /// Address of the station.
    pub station: StationAddress,
    /// Profile of the link.
    pub profile: Profile,
    /// Authority over commands.
    pub authority: Arc<dyn Authority>,
    /// Told what goes wrong.
    pub tell: fn(&str),
}

/// Carries the runs of a robot to one station until it is stopped.
pub fn relay_robot(settings: &RobotSettings, stopper: &Stopper) -> Result<(), RelayError> {
    let inbox = Inbox::new();
    let mut relay = RobotRelay::begin(settings, &inbox, stopper)?;
    let reporter = Reporter::open(&settings.folder)?;
    let (mut next_scan_at, mut next_step_at, mut next_save_at) =
        (SessionTime::BEGIN, None, SessionTime::BEGIN + SAVE_EVERY);
    while !stopper.is_stopped() {
        let now = relay.clock.now();
        if now >= next_scan_at {
            next_scan_at = now + REPORT_EVERY;
            relay.scan(now);
            reporter.set(vec![relay.report(now)]);
            next_step_at = relay.next_step(now);
        } else if next_step_at.is_some_and(|at| now >= at) {
            relay.go_on(now);
            next_step_at = relay.next_step(now);
        }
        if now >= next_save_at {
            next_save_at = now + SAVE_EVERY;
            relay.keep_heard();
            relay.keep_watches(now);
        }
        relay.carry_out_due();
        relay.scan_watched(now);
        relay.send()?;
        let due = [relay.session.poll_timeout(now), next_step_at];
        let next = next_scan_at.min(next_save_at).or_earlier(due);
        let mut time = next.since(relay.clock.now());
        for _ in 0..INPUTS_AT_ONCE {
            match inbox.wait(time) {
                Some(Input::Datagram(from, datagram)) => relay.receive(&from, datagram),
                Some(Input::Other(from_run)) => {
                    let is_scan = matches!(from_run, FromRun::Scanned(_));
                    relay.happened(from_run);
                    if is_scan {
                        next_step_at = relay.next_step(relay.clock.now());
                    }
                }
                None => break,
            }
            time = Duration::ZERO;
        }
    }
    relay.keep_heard();
    relay.disk.end();
    drop((relay, inbox));
    stopper.join();
    Ok(())
}

/// Opens the transport to the station, which delivers into the inbox.
fn carrier(
    settings: &RobotSettings,
    inbox: &Inbox<FromRun>,
    stopper: &Stopper,
) -> Result<Carrier, RelayError> {
    match &settings.station {
        StationAddress::Udp(to) => Ok(Carrier::Udp(inbox.listen(any_port(*to), stopper)?, *to)),
        StationAddress::WebSocket(dial) => {
            let (dial, silence) = (Arc::clone(dial), settings.profile.silence());
            let dialler = Dialler::begin(dial, silence, inbox.deliver(), settings.tell, stopper);
            Ok(dialler.map_err(|source| RelayError::Thread { source })?.into())
        }
    }
}

struct RobotRelay<'s> {
    settings: &'s RobotSettings,
    clock: SessionClock,
    carrier: Carrier,
    session: RobotSession,
    disk: RobotDisk,
    runs: RobotRuns,
    watches: RobotWatches,
    meter: LinkMeter,
    key: OfferedKey,
    /// The station's newest known start.
    station_start: Option<Generation>,
    early: EarlyCommands,
}

/// A pickle that takes longer than 50 ms of the link is sent on request, by its hash.
fn pickle_max(profile: &Profile) -> usize {
    usize::try_from(profile.down_bits_per_s / 8 / 20).unwrap_or(usize::MAX).max(128)
}

impl<'s> RobotRelay<'s> {
    /// Restores the state of the last start.
    fn begin(
        settings: &'s RobotSettings,
        inbox: &Inbox<FromRun>,
        stopper: &Stopper,
    ) -> Result<Self, RelayError> {
        let start = Start::begin(&settings.folder)?;
        let carrier = carrier(settings, inbox, stopper)?;
        let identity = start.identity(&settings.paired.pairing);
        let mut session = RobotSession::new(&identity, settings.profile.clone());
        let clock = SessionClock::begin();
        let machines = settings.folder.join(MACHINES_FOLDER);
        let tell = settings.tell;
        let parcels = parcels::begin(&machines, settings.projects.clone(), inbox.sender(), tell)
            .map_err(|source| RelayError::Folder { path: machines, source })?;
        let place = RunsPlace {
            folder: settings.runs.clone(),
            inbox: inbox.sender(),
            tell,
            clock,
            pickle_max: pickle_max(&settings.profile),
        };
        let numbers = settings.folder.join("numbers");
        // Without the file, the station reports runs that share a number.
        let taken = RunNumbers::read(&fs::read(&numbers).unwrap_or_default());
        let mut runs = RobotRuns::new(place, taken, SentParcels::new(parcels));
        let (list, watched) = (settings.folder.join("runs"), settings.folder.join("watched"));
        // Without a list, all runs are older ones.
        runs.restore(&fs::read_to_string(&list).unwrap_or_default(), &mut session);
        let (written, age_max) =
            (fs::read(&watched).unwrap_or_default(), age_max(&settings.profile));
        let watches = RobotWatches::begin(written, age_max, clock::since_1970_ms(), &mut session);
        let scanner = RunScanner::new(&settings.runs, runs.known(), tell);
        let paired = settings.paired.clone();
        let files = RobotFiles { start, paired, list, numbers, watched, tell };
        let disk = RobotDisk::begin(files, scanner, inbox.sender())
            .map_err(|source| RelayError::Thread { source })?;
        Ok(Self {
            clock,
            carrier,
            disk,
            runs,
            watches,
            meter: LinkMeter::new(&settings.paired.pairing, &settings.profile, false),
            key: OfferedKey::default(),
            station_start: session.station_start(),
            early: EarlyCommands::default(),
            session,
            settings,
        })
    }

    /// Stores the state of the link for the next start.
    fn keep_heard(&self) {
        self.disk.keep_heard(self.session.key_id(), self.session.horizon());
    }

    /// Exchanges with runners and station what changes slowly.
    fn scan(&mut self, now: SessionTime) {
        self.runs.release(&mut self.session);
        self.go_on(now);
        self.give_early();
        self.session.set_calendar(now, clock::since_1970_ms());
        self.tell_control();
        let heard = self.session.heard_before(now).map(|ago| now - ago);
        self.runs.tell_ground(now, heard);
        self.key.renew(&self.session, &self.disk);
    }

    /// Applies a scan of the runs. A station that has started again needs to know all of them.
    fn scanned(&mut self, found: Vec<FoundRun>) {
        let start = self.session.station_start();
        if self.station_start != start {
            if self.station_start.is_some() {
                self.runs.name_again(&mut self.session);
            }
            self.station_start = start;
        }
        self.runs.scanned(found, &mut self.session);
        self.let_go();
        self.give_early();
        self.tell_control();
    }

    /// Continues with the runs that have ended.
    fn go_on(&mut self, now: SessionTime) {
        let is_heard = self.session.is_heard(now);
        self.runs.go_on(&mut self.session, is_heard);
        self.let_go();
    }

    fn let_go(&mut self) {
        for stream in self.runs.let_go(&mut self.session) {
            self.watches.forget(stream);
        }
        if let Some(list) = self.runs.take_list() {
            self.disk.keep_list(list);
        }
        let numbers = self.runs.take_numbers();
        if !numbers.is_empty() {
            self.disk.add_numbers(&numbers);
        }
    }

    /// Time of the next step with ended runs; `None` without one.
    fn next_step(&self, now: SessionTime) -> Option<SessionTime> {
        let is_busy = self.runs.is_busy(self.session.is_heard(now));
        is_busy.then(|| now + STEP_EVERY)
    }

    /// Tells who holds control of the runs that continue.
    fn tell_control(&mut self) {
        let authority = &*self.settings.authority;
        let now_ms = clock::since_1970_ms();
        self.runs.tell_control(&mut self.session, now_ms, |run| authority.control(run));
    }

    /// State of the link.
    fn report(&mut self, now: SessionTime) -> LinkReport {
        let Self { session, meter, runs, .. } = self;
        let (sent, received) = session.traffic();
        let health = meter.health(now, sent, received, session.heard_before(now));
        let report = meter.report(health, sent, received, runs.progress(session));
        let waits = self
            .key
            .is_pending()
            .then(|| "a new key is offered, and the station does not use it yet".to_owned());
        let waits = waits.into_iter();
        let shortened = shortened(session.shortened_datagrams());
        let problems = waits.chain(shortened).chain(runs.problems()).collect();
        LinkReport { problems, send_bytes_per_s: Some(session.send_rate() / 8), ..report }
    }

    fn send(&mut self) -> Result<(), RelayError> {
        for _ in 0..SENDS_AT_ONCE {
            let Some(datagram) = self.session.poll_transmit(self.clock.now(), &mut self.runs)?
            else {
                break;
            };
            self.carrier.send(&datagram);
        }
        Ok(())
    }

    /// Looks for new values that are watched and that the events do not bring in time.
    fn scan_watched(&mut self, now: SessionTime) {
        for stream in self.watches.due(now, &self.session) {
            self.runs.scan_watched(stream, &mut self.watches, &mut self.session);
        }
    }

    fn keep_watches(&mut self, now: SessionTime) {
        let (now_ms, heard_before) = (clock::since_1970_ms(), self.session.heard_before(now));
        if let Some(list) = self.watches.take_list(now_ms, heard_before, &mut self.session) {
            self.disk.keep_watched(list);
        }
    }

    fn receive(&mut self, from: &Carrier, mut datagram: Vec<u8>) {
        let (now, mut commands) = (self.clock.now(), Vec::new());
        let used =
            self.session.handle_datagram(now, &mut datagram, |command| commands.push(command));
        match used {
            Ok(()) => from.note_heard(),
            // A repeated datagram, or one from a stranger, has no answer.
            Err(why) => self.meter.note_unusable(why.to_string()),
        }
        for command in commands {
            self.command(now, command);
        }
        let mut has_subscription = false;
        while let Some(subscription) = self.session.take_subscription() {
            self.watches.take(subscription);
            has_subscription = true;
        }
        if has_subscription {
            self.keep_watches(now);
        }
    }

    fn happened(&mut self, from_run: FromRun) {
        match from_run {
            FromRun::Happened(run) => self.runs.happened(&run, &mut self.session),
            FromRun::Snapshot(run, snapshot) => {
                self.runs.reported(&run, snapshot, &mut self.session);
            }
            FromRun::Answered(run, id, answer) => {
                if let (Some(run), RobotAnswer::Refused { .. }) = (&run, &answer) {
                    self.settings.authority.refused(run, &id);
                    self.tell_control();
                }
                let Some((state, text)) = outcome(answer) else { return };
                self.session.set_command_state(self.clock.now(), ids::command(&id), state, &text);
            }
            FromRun::Gone(run) => self.runs.gone(&run, &mut self.session),
            FromRun::Parcels(parcels) => self.runs.set_parcels(parcels, &mut self.session),
            FromRun::Scanned(found) => self.scanned(found),
            FromRun::NextKey(next) => self.key.offer(*next, &mut self.session),
            FromRun::KeyReplaced(replaced) => {
                self.key.replaced(replaced, &mut self.session, self.settings.tell);
            }
        }
    }
}

#[cfg(test)]
mod tests;
