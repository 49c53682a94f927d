//! The robot's side: finds its runs, follows those that continue, sends what happens, and gives commands to their runners.

mod authority;
mod early;
mod follow;
mod numbers;
mod parcels;
mod project_machines;
mod runs;
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
use crate::meter::{LinkMeter, millis, shortened};
use crate::pairing::{Paired, Pairing};
use crate::report::{REPORT_EVERY, Reporter};
use crate::request_words;
use crate::start::Start;
use crate::words::{StationRequest, at_robot, author_at_robot};
use early::EarlyCommands;
use follow::FromRun;
use parcels::SentParcels;
use rafcon_link::{CommandState, Generation, Profile, ReceivedCommand, RobotSession, StreamId};
use rafcon_protocol::api::{
    ControlMove, ResumeRequest, ResumeRun, Right, RobotAnswer, StartRequest,
};
use rafcon_protocol::{Envelope, Expiry, LinkReport};
use rafcon_supervisor::clock;
use runs::RobotRuns;
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
    let mut start = Start::begin(&settings.folder)?;
    let inbox = Inbox::new();
    let carrier = carrier(settings, &inbox, stopper)?;
    let identity = start.identity(&settings.paired.pairing);
    let mut session = RobotSession::new(&identity, settings.profile.clone());
    let list = settings.folder.join("runs");
    let clock = SessionClock::begin();
    let machines = settings.folder.join(MACHINES_FOLDER);
    let (projects, tell) = (settings.projects.clone(), settings.tell);
    let parcels = parcels::begin(&machines, projects, inbox.sender(), tell)
        .map_err(|source| RelayError::Folder { path: machines, source })?;
    let parcels = SentParcels::new(parcels);
    let mut runs = RobotRuns::new(&settings.runs, list, inbox.sender(), (tell, clock), parcels);
    runs.set_pickle_max(pickle_max(&settings.profile));
    runs.restore(&mut session);
    let (watched, age_max) = (settings.folder.join("watched"), age_max(&settings.profile));
    let watches = RobotWatches::begin(watched, age_max, clock::since_1970_ms(), &mut session);
    let meter = LinkMeter::new(&settings.paired.pairing, &settings.profile, false);
    let reporter = Reporter::open(&settings.folder)?;
    let (offered, station_start) = (None, session.station_start());
    let mut relay = RobotRelay {
        settings,
        clock,
        carrier,
        session,
        runs,
        watches,
        meter,
        offered,
        station_start,
        early: EarlyCommands::default(),
    };
    let (mut next_scan_at, mut next_step_at, mut next_save_at) =
        (Duration::ZERO, Duration::ZERO, SAVE_EVERY);
    while !stopper.is_stopped() {
        let now = relay.clock.now();
        if now >= next_scan_at {
            next_scan_at = now + REPORT_EVERY;
            relay.scan(now);
            reporter.set(vec![relay.report(now)]);
            next_step_at = relay.next_step(now);
        } else if now >= next_step_at {
            relay.go_on(now);
            next_step_at = relay.next_step(now);
        }
        if now >= next_save_at {
            next_save_at = now + SAVE_EVERY;
            relay.keep_heard(&mut start);
            relay.keep_watches(now);
        }
        relay.carry_out_due();
        relay.scan_watched(now);
        relay.send()?;
        let next =
            relay.session.next_transmit(now).min(next_scan_at).min(next_step_at).min(next_save_at);
        let mut time = next.saturating_sub(relay.clock.now());
        for _ in 0..INPUTS_AT_ONCE {
            match inbox.wait(time) {
                Some(Input::Datagram(from, datagram)) => relay.receive(&from, datagram),
                Some(Input::Other(from_run)) => relay.happened(from_run),
                None => break,
            }
            time = Duration::ZERO;
        }
    }
    relay.keep_heard(&mut start);
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
    runs: RobotRuns,
    watches: RobotWatches,
    meter: LinkMeter,
    /// The pairing that the station is offered.
    offered: Option<Pairing>,
    /// The station's newest known start.
    station_start: Option<Generation>,
    early: EarlyCommands,
}

/// A pickle that takes longer than 50 ms of the link is sent on request, by its hash.
fn pickle_max(profile: &Profile) -> usize {
    usize::try_from(profile.down_bits_per_s / 8 / 20).unwrap_or(usize::MAX).max(128)
}

impl RobotRelay<'_> {
    /// Stores the state of the link for the next start.
    fn keep_heard(&self, start: &mut Start) {
        if let Err(error) = start.keep_heard(self.session.key_id(), self.session.horizon()) {
            (self.settings.tell)(&format!(
                "the last packet numbers of the station cannot be stored: {error}"
            ));
        }
    }

    /// Offers the station the key that lies ready, and uses it once the station does.
    fn renew_key(&mut self) {
        let paired = &self.settings.paired;
        match &self.offered {
            None => {
                self.offered = paired.read_next().filter(|it| it.key_id != self.session.key_id());
                if let Some(next) = &self.offered {
                    self.session.offer_key(next.key_id, &next.key);
                }
            }
            Some(next) if self.session.is_offer_taken() => match paired.replace(next) {
                Ok(()) => {
                    self.session.use_offered();
                    self.offered = None;
                    (self.settings.tell)("the station uses the new key, and so does this robot");
                }
                Err(error) => {
                    (self.settings.tell)(&format!("the new key is not used yet: {error}"));
                }
            },
            Some(_) => {}
        }
    }

    /// Scans the runs, and exchanges with runners and station what changes slowly.
    fn scan(&mut self, now: Duration) {
        self.scan_runs(now);
        self.give_early();
        self.session.set_calendar(now, clock::since_1970_ms());
        self.tell_control();
        let heard = self.session.heard_before(now).map(|ago| now.saturating_sub(ago));
        self.runs.tell_ground(now, heard);
        self.renew_key();
    }

    /// Scans the runs, and releases those that are whole at the station.
    fn scan_runs(&mut self, now: Duration) {
        let is_heard = self.session.is_heard(now);
        let start = self.session.station_start();
        if self.station_start != start {
            if self.station_start.is_some() {
                self.runs.name_again(&mut self.session);
            }
            self.station_start = start;
        }
        self.runs.scan(&mut self.session, is_heard);
        self.let_go();
    }

    /// Continues with the runs that have ended.
    fn go_on(&mut self, now: Duration) {
        let is_heard = self.session.is_heard(now);
        self.runs.go_on(&mut self.session, is_heard);
        self.let_go();
    }

    fn let_go(&mut self) {
        for stream in self.runs.let_go(&mut self.session) {
            self.watches.forget(stream);
        }
    }

    /// Time of the next step with ended runs.
    fn next_step(&self, now: Duration) -> Duration {
        let is_busy = self.runs.is_busy(self.session.is_heard(now));
        if is_busy { now + STEP_EVERY } else { Duration::MAX }
    }

    /// Tells who holds control of the runs that continue.
    fn tell_control(&mut self) {
        let authority = &*self.settings.authority;
        let now_ms = clock::since_1970_ms();
        self.runs.tell_control(&mut self.session, now_ms, |run| authority.control(run));
    }

    /// State of the link.
    fn report(&mut self, now: Duration) -> LinkReport {
        let Self { session, meter, runs, .. } = self;
        let (sent, received) = session.traffic();
        let health = meter.health(now, sent, received, session.heard_before(now));
        let report = meter.report(health, sent, received, runs.progress(session));
        let waits = self
            .offered
            .as_ref()
            .map(|_| "a new key is offered, and the station does not use it yet");
        let waits = waits.into_iter().map(str::to_owned);
        let shortened = shortened(session.shortened_datagrams());
        let problems = waits.chain(shortened).chain(runs.problems()).collect();
        LinkReport { problems, send_bytes_per_s: Some(session.send_rate() / 8), ..report }
    }

    fn send(&mut self) -> Result<(), RelayError> {
        for _ in 0..SENDS_AT_ONCE {
            let Some(datagram) = self.session.transmit(self.clock.now(), &mut self.runs)? else {
                break;
            };
            self.carrier.send(&datagram);
        }
        Ok(())
    }

    /// Looks for new values that are watched and that the events do not bring in time.
    fn scan_watched(&mut self, now: Duration) {
        for stream in self.watches.due(now, &self.session) {
            self.runs.scan_watched(stream, &mut self.watches, &mut self.session);
        }
    }

    fn keep_watches(&mut self, now: Duration) {
        let (now_ms, heard_before) = (clock::since_1970_ms(), self.session.heard_before(now));
        self.watches.keep(now_ms, heard_before, &mut self.session);
    }

    fn receive(&mut self, from: &Carrier, mut datagram: Vec<u8>) {
        let (now, mut commands) = (self.clock.now(), Vec::new());
        let used = self.session.receive(now, &mut datagram, |command| commands.push(command));
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

    /// Carries out the commands whose time has come.
    fn carry_out_due(&mut self) {
        let (now, mut commands) = (self.clock.now(), Vec::new());
        self.session.take_due(now, |command| commands.push(command));
        for command in commands {
            self.command(now, command);
        }
    }

    /// Gives commands again to runs that had only just begun.
    fn give_early(&mut self) {
        let now = self.clock.now();
        for command in self.early.take(millis(now)) {
            self.command(now, command);
        }
    }

    /// Carries out the request of a station's user, if the user has the right.
    fn command(&mut self, now: Duration, command: ReceivedCommand) {
        let read = request_words::read(command.id, &command.body);
        let mut command = command;
        let late_fate = match &read {
            _ if !self.make_ready(&read, command.is_late) => Some(None),
            Ok((stream, word)) if command.is_late => Some(outcome(self.late_fate(*stream, word))),
            _ => None,
        };
        if let Some(None) = late_fate {
            let id = command.id;
            match self.early.add(command) {
                // The robot reports no fate before it has one.
                None => {
                    return self.session.set_command_state(now, id, CommandState::Received, "");
                }
                Some(refused) => command = refused,
            }
        }
        let ReceivedCommand { id, not_after_ms, epoch, is_late, .. } = command;
        let done = match read {
            _ if is_late => {
                Ok(late_fate.flatten().unwrap_or((CommandState::Started, String::new())))
            }
            Ok((stream, word)) => {
                let left_ms = not_after_ms.saturating_sub(millis(now));
                let expiry_ms = clock::since_1970_ms().saturating_add(left_ms);
                let state = self.handle(stream, word, epoch, expiry_ms);
                state.map(|state| (state, String::new()))
            }
            Err(error) => Err(format!("the robot's server does not understand it: {error}")),
        };
        let (state, text) = done.unwrap_or_else(|reason| (CommandState::Refused, reason));
        self.session.set_command_state(now, id, state, &text);
    }

    /// Prepares to carry out a request; false if that, or its fate, needs another moment.
    fn make_ready(
        &mut self,
        read: &Result<(StreamId, StationRequest), String>,
        is_late: bool,
    ) -> bool {
        match read {
            Ok((stream, StationRequest::Command(..))) => is_late || self.runs.make_ready(*stream),
            Ok((_, StationRequest::Resume(..) | StationRequest::Start(..))) => {
                self.settings.authority.is_ready()
            }
            Ok((_, StationRequest::MoveControl(..) | StationRequest::Present(_))) | Err(_) => true,
        }
    }

    /// Fate of a late request, by the run's journal and the server: an earlier start of this server may have carried it out.
    fn late_fate(&self, stream: StreamId, word: &StationRequest) -> RobotAnswer {
        let Self { settings, .. } = self;
        let authority = &settings.authority;
        let at_robot = |author| author_at_robot(author, settings.paired.pairing.station_name());
        match word {
            StationRequest::Command(id, ..) => {
                self.runs.answer_of(stream, id).map_or(RobotAnswer::Expired, RobotAnswer::from)
            }
            StationRequest::Resume(id, author, run, ..) => {
                authority.fate_of_resume(run, &at_robot(author), id)
            }
            StationRequest::Start(id, author, _) => authority.fate_of_start(&at_robot(author), id),
            StationRequest::MoveControl(..) | StationRequest::Present(_) => RobotAnswer::Expired,
        }
    }

    fn handle(
        &mut self,
        stream: StreamId,
        request: StationRequest,
        epoch: u64,
        expiry_ms: u64,
    ) -> Result<CommandState, String> {
        let authority = Arc::clone(&self.settings.authority);
        let Pairing { rights, .. } = self.settings.paired.pairing;
        let station = self.settings.paired.pairing.station_name();
        let run = match &request {
            StationRequest::Resume(_, _, run, ..) => run.clone(),
            StationRequest::Start(..) => String::new(),
            _ => self.runs.name(stream).ok_or("the robot has no such run")?.to_owned(),
        };
        match request {
            StationRequest::Command(id, author, decided_on, command) => {
                rights.check(&command, authority.right_of(&command))?;
                let author = author_at_robot(&author, station);
                if !command.is_for_everybody() {
                    authority.command(&run, &author, &id, epoch)?;
                    // A user who takes control by this command decides the next one under the new epoch.
                    self.tell_control();
                }
                let (expiry, epoch) = (Some(Expiry(expiry_ms)), Some(epoch));
                let new = Envelope::new(id, author, command);
                let envelope = Envelope { decided_on, expiry, epoch, ..new };
                if self.runs.command(&run, envelope) {
                    return Ok(CommandState::Started);
                }
                Err("the run has no program on the robot that could be commanded".to_owned())
            }
            StationRequest::MoveControl(_, author, wanted) => {
                rights.check_right(Right::Command)?;
                let wanted = match wanted {
                    ControlMove::HandOver { to } => {
                        ControlMove::HandOver { to: at_robot(&to, station) }
                    }
                    other => other,
                };
                authority.move_control(&run, &author_at_robot(&author, station), &wanted)?;
                self.tell_control();
                Ok(CommandState::Done)
            }
            StationRequest::Resume(id, author, _, policy, from) => {
                rights.check_right(Right::Start)?;
                let user = author_at_robot(&author, station);
                let answered = self.runs.answerer(id.clone());
                let (asked, expiry_ms) = (ResumeRun { id, policy, from }, Some(expiry_ms));
                authority.resume(ResumeRequest { run, user, asked, expiry_ms }, answered)?;
                Ok(CommandState::Started)
            }
            StationRequest::Start(id, author, of) => {
                rights.check_right(Right::Start)?;
                let user = author_at_robot(&author, station);
                let answered = self.runs.answerer(id.clone());
                let (expiry_ms, no_edit) = (Some(expiry_ms), rights.check_right(Right::Edit).err());
                authority.start(StartRequest { id, user, of, expiry_ms, no_edit }, answered)?;
                Ok(CommandState::Started)
            }
            StationRequest::Present(user) => {
                authority.present(&author_at_robot(&user, station));
                Ok(CommandState::Done)
            }
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
        }
    }
}

/// State of a request with its text: the reason of a refusal, or the run that was started. None while the fate is unknown.
fn outcome(answer: RobotAnswer) -> Option<(CommandState, String)> {
    match answer {
        RobotAnswer::Done { run } => Some((CommandState::Done, run)),
        RobotAnswer::Refused { reason } => Some((CommandState::Refused, reason)),
        RobotAnswer::Expired => Some((CommandState::Expired, String::new())),
        RobotAnswer::Unknown { .. } => None,
    }
}
