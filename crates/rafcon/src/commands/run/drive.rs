//! The loop of a run: causes from the wires to the supervisor, its actions to runner and view. Decides nothing itself.

use super::report;
use super::request::Request;
use crate::clock::Clock;
use crate::failure::complain;
use crate::runner::process::Group;
use crate::runner::{Cause, Start, wires};
use crate::supervisor::{Action, End, Supervisor};
use crate::view::{Nothing, View};
use anyhow::{Context as _, Result};
use rafcon_protocol::{Hello, active, encode};
use serde::Serialize;
use std::io::{self, Write as _};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError};

/// Runs the machine and tells how that ended, in every sense.
pub(super) fn follow(
    request: &Request,
    start: &Start<'_>,
    view: Box<dyn View>,
    clock: Clock,
) -> Result<End> {
    let folder = tempfile::Builder::new().prefix("rafcon-run-").tempdir();
    let folder = folder.context("cannot make a folder for the run")?;
    let signals = wires::signals()?;
    let process = start.spawn()?;
    let (control, group) = (process.control.try_clone()?, process.group());
    let causes = wires::connect(process, signals)?;
    let launch = request.launch(view.every_event(), folder.path());
    let supervisor = Supervisor::new(launch, clock.now(), request.timeout);
    let mut drive = Drive { supervisor, view, control, group, clock };
    drive.send(&Hello::ours());
    let mut end = drive.until_the_end(&causes);
    add_running(&mut end, folder.path());
    drive.show(|view| view.end(&end));
    report::end(&end, || request.names());
    Ok(end)
}

struct Drive {
    supervisor: Supervisor,
    view: Box<dyn View>,
    control: UnixStream,
    group: Group,
    clock: Clock,
}

impl Drive {
    fn until_the_end(&mut self, causes: &Receiver<Cause>) -> End {
        let mut actions = Vec::new();
        loop {
            let cause = self.next(causes);
            self.by_itself(&cause);
            let now = self.clock.now();
            self.supervisor.handle(now, cause, &mut actions);
            for action in actions.drain(..) {
                self.act(action);
            }
            self.show(|view| view.refresh(now));
            if let Some(end) = self.supervisor.end(now) {
                return end.clone();
            }
        }
    }

    fn next(&self, causes: &Receiver<Cause>) -> Cause {
        let now = self.clock.now();
        let until = self.supervisor.wake_at().map(|at| at.saturating_sub(now));
        let wait = [until, self.view.rhythm()].into_iter().flatten().min();
        let received = match wait {
            Some(wait) => causes.recv_timeout(wait),
            None => causes.recv().map_err(|_gone| RecvTimeoutError::Disconnected),
        };
        received.unwrap_or(Cause::Tick)
    }

    /// What concerns this program alone.
    fn by_itself(&mut self, cause: &Cause) {
        match cause {
            Cause::HungUp if self.view.rhythm().is_some() => self.view = Box::new(Nothing),
            Cause::Suspend => {
                self.show(|view| view.set_aside());
                let stop = signal_hook::consts::SIGTSTP;
                signal_hook::low_level::emulate_default_handler(stop).unwrap_or_default();
            }
            _ => {}
        }
    }

    fn act(&mut self, action: Action) {
        let now = self.clock.now();
        match action {
            Action::Send(message) => self.send(&message),
            Action::Kill => self.group.kill(),
            Action::Loaded { name, states } => self.show(|view| view.loaded(&name, states)),
            Action::Event(time, event) => self.show(|view| view.event(time, event)),
            Action::Snapshot(snapshot) => self.show(|view| view.snapshot(now, snapshot)),
            Action::Note(text) => self.show(|view| view.note(&text)),
        }
    }

    /// A runner that does not listen any more is noticed by its silence.
    fn send(&mut self, message: &impl Serialize) {
        match encode(message) {
            Ok(line) => self.control.write_all(&line).unwrap_or_default(),
            Err(error) => {
                complain(&format!("error: this cannot be said to the runner: {error}"));
                self.group.kill();
            }
        }
    }

    /// Whoever looked on is gone: the run goes on unseen.
    fn show(&mut self, what: impl FnOnce(&mut dyn View) -> io::Result<()>) {
        if what(self.view.as_mut()).is_err() {
            self.view = Box::new(Nothing);
        }
    }
}

/// The runner's own marks of what runs are better than its last messages: they were made before each script began.
fn add_running(end: &mut End, folder: &Path) {
    let Some(known) = end.active_mut() else { return };
    let slots = std::fs::read(folder.join(active::SLOTS_FILE)).unwrap_or_default();
    let paths = std::fs::read_to_string(folder.join(active::PATHS_FILE)).unwrap_or_default();
    let running = active::running(&slots, &paths);
    if !running.is_empty() {
        *known = running;
    }
}
