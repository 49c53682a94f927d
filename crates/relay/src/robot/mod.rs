//! The robot's side: finds its runs, follows those that continue, sends what happens, and gives commands to their runners.

mod follow;
mod health;
mod runs;

use crate::clock::SessionClock;
use crate::error::RelayError;
use crate::ids;
use crate::inbox::{Inbox, Input, Stopper};
use crate::pairing::Pairing;
use crate::report::{REPORT_EVERY, Reporter};
use crate::start::Start;
use follow::FromRun;
use health::Health;
use rafcon_link::{CommandState, Profile, ReceivedCommand, RobotSession};
use rafcon_protocol::{Answer, Envelope, Expiry};
use rafcon_supervisor::clock;
use runs::RobotRuns;
use std::net::{SocketAddr, UdpSocket};
use std::path::PathBuf;
use std::time::Duration;

/// What was heard is kept this often.
const KEEP_EVERY: Duration = Duration::from_secs(10);

/// What a robot's relay needs.
#[derive(Debug, Clone)]
pub struct RobotSettings {
    /// The folder for its files, one for each station.
    pub folder: PathBuf,
    /// The folder with the runs.
    pub runs: PathBuf,
    /// What it shares with the station.
    pub pairing: Pairing,
    /// Where the station receives.
    pub station: SocketAddr,
    /// The address that datagrams come from; port 0 for any.
    pub bind: SocketAddr,
    /// What is known of the link.
    pub profile: Profile,
    /// Told what goes wrong.
    pub tell: fn(&str),
}

/// Carries the runs of a robot to one station until it is stopped.
pub fn relay_robot(settings: &RobotSettings, stopper: &Stopper) -> Result<(), RelayError> {
    let mut start = Start::begin(&settings.folder)?;
    let inbox = Inbox::new();
    let socket = inbox.listen(settings.bind, stopper)?;
    let identity = start.identity(&settings.pairing);
    let mut session = RobotSession::new(&identity, settings.profile.clone());
    let list = settings.folder.join("runs");
    let mut runs = RobotRuns::new(&settings.runs, list, inbox.sender(), settings.tell);
    runs.restore(&mut session);
    let health = Health::new(settings);
    let reporter = Reporter::open(&settings.folder)?;
    let mut relay =
        RobotRelay { settings, clock: SessionClock::begin(), socket, session, runs, health };
    let (mut look_at, mut keep_at) = (Duration::ZERO, KEEP_EVERY);
    while !stopper.is_stopped() {
        let now = relay.clock.now();
        if now >= look_at {
            look_at = now + REPORT_EVERY;
            relay.runs.look(&mut relay.session);
            relay.session.set_calendar(now, clock::since_1970_ms());
            reporter.set(&[relay.health.report(&relay.session, now, relay.runs.ids())]);
        }
        if now >= keep_at {
            keep_at = now + KEEP_EVERY;
            start.keep_heard(relay.session.horizon())?;
        }
        relay.send()?;
        let next = relay.session.next_transmit(now).min(look_at).min(keep_at);
        match inbox.wait(next.saturating_sub(relay.clock.now())) {
            Some(Input::Datagram(_, datagram)) => relay.receive(datagram),
            Some(Input::Other(from_run)) => relay.happened(from_run),
            None => {}
        }
    }
    start.keep_heard(relay.session.horizon())
}

struct RobotRelay<'s> {
    settings: &'s RobotSettings,
    clock: SessionClock,
    socket: UdpSocket,
    session: RobotSession,
    runs: RobotRuns,
    health: Health,
}

impl RobotRelay<'_> {
    fn send(&mut self) -> Result<(), RelayError> {
        while let Some(datagram) = self.session.transmit(self.clock.now(), &mut self.runs)? {
            // A network that is not there is a link that loses everything.
            drop(self.socket.send_to(&datagram, self.settings.station));
        }
        Ok(())
    }

    fn receive(&mut self, mut datagram: Vec<u8>) {
        let (now, mut commands) = (self.clock.now(), Vec::new());
        let used = self.session.receive(now, &mut datagram, |command| commands.push(command));
        if let Err(why) = used {
            // It came twice, or from strangers: there is nothing to say to them.
            self.health.note_unusable(why.to_string());
        }
        for command in commands {
            self.command(now, command);
        }
    }

    /// Passes a command to the runner of its run, with the time that it has left.
    fn command(&mut self, now: Duration, command: ReceivedCommand) {
        let ReceivedCommand { id, not_after_ms, body, .. } = command;
        let left_ms = Duration::from_millis(not_after_ms).saturating_sub(now).as_millis();
        let left_ms = u64::try_from(left_ms).unwrap_or(u64::MAX);
        let is_sent = serde_json::from_slice::<(String, Envelope)>(&body).is_ok_and(|(run, it)| {
            let expiry = Some(Expiry(clock::since_1970_ms().saturating_add(left_ms)));
            self.runs.command(&run, Envelope { expiry, ..it })
        });
        if !is_sent {
            self.session.set_command_state(now, id, CommandState::Refused);
        }
    }

    fn happened(&mut self, from_run: FromRun) {
        match from_run {
            FromRun::Happened(run) => self.runs.happened(&run, &mut self.session),
            FromRun::Snapshot(run, snapshot) => {
                self.runs.stands(&run, snapshot, &mut self.session);
            }
            FromRun::Answered(envelope, answer) => {
                let state = match answer {
                    Answer::Applied => CommandState::Done,
                    Answer::Refused { .. } => CommandState::Refused,
                    Answer::Expired => CommandState::Expired,
                };
                let now = self.clock.now();
                self.session.set_command_state(now, ids::command(&envelope), state);
            }
            FromRun::Gone(run) => self.runs.gone(&run, &mut self.session),
        }
    }
}
