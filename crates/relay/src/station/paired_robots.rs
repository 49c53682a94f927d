//! The files of a station that other programs change: pairings and planned contacts. A thread of its own reads them once a second and
//! restores new robots, so that a slow disk delays no datagram.

use super::robot::StationRobot;
use super::{StationSettings, ToStation};
use crate::clock::SessionClock;
use crate::error::RelayError;
use crate::inbox::{Input, Stopper};
use crate::pairing::Paired;
use crate::report::REPORT_EVERY;
use std::collections::BTreeSet;
use std::io;
use std::sync::mpsc::SyncSender;

/// Robots whose pairings were read.
pub(super) struct PairedRobots {
    settings: StationSettings,
    inbox: SyncSender<Input<ToStation>>,
    clock: SessionClock,
    names: BTreeSet<String>,
    /// Number of the next robot.
    next: usize,
    /// The last error of the list.
    problem: Option<String>,
}

impl PairedRobots {
    pub(super) fn new(
        settings: StationSettings,
        inbox: SyncSender<Input<ToStation>>,
        clock: SessionClock,
    ) -> Self {
        Self { settings, inbox, clock, names: BTreeSet::new(), next: 0, problem: None }
    }

    /// The robots that are paired when the station starts. One that cannot be received ends the station.
    pub(super) fn begin_all(&mut self) -> Result<Vec<StationRobot>, RelayError> {
        let paired = self.read();
        paired.iter().map(|paired| self.begin(paired)).collect()
    }

    /// Starts the thread that reads the files until the station is stopped.
    pub(super) fn watch(mut self, stopper: &Stopper) -> io::Result<()> {
        let theirs = stopper.clone();
        stopper.spawn("pairings", move || {
            while !theirs.wait(REPORT_EVERY) {
                self.begin_new();
                self.refresh_contacts();
            }
        })
    }

    fn begin(&mut self, paired: &Paired) -> Result<StationRobot, RelayError> {
        let Self { settings, inbox, clock, next, .. } = self;
        let robot = StationRobot::begin(settings, *next, paired, inbox.clone(), *clock)?;
        *next += 1;
        Ok(robot)
    }

    /// Adds robots paired after the start. Reports a robot that cannot be received, once.
    fn begin_new(&mut self) {
        for paired in self.read() {
            let (name, tell) = (&paired.pairing.robot, self.settings.tell);
            match self.begin(&paired) {
                Ok(robot) => {
                    tell(&format!("robot {name} is paired now and is received"));
                    // A station that has ended receives nobody.
                    let paired = Input::Other(ToStation::Paired(Box::new(robot)));
                    self.inbox.send(paired).unwrap_or_default();
                }
                Err(error) => tell(&format!("robot {name} is not received: {error}")),
            }
        }
    }

    /// Reads the planned contacts whose files have changed.
    fn refresh_contacts(&self) {
        for name in &self.names {
            if let Some(problem) = self.settings.contacts.refresh(name) {
                (self.settings.tell)(&format!("robot {name}: {problem}"));
            }
        }
    }

    /// Pairings of robots that were not read before.
    fn read(&mut self) -> Vec<Paired> {
        let read = self.settings.pairings.read();
        let problem = read.as_ref().err().cloned();
        if let Some(problem) = problem.as_ref().filter(|_| self.problem != problem) {
            (self.settings.tell)(problem);
        }
        self.problem = problem;
        let paired = read.unwrap_or_default().into_iter();
        paired.filter(|paired| self.names.insert(paired.pairing.robot.clone())).collect()
    }
}
