//! The loop of a run: causes from the wires to the supervisor, its actions to runner and view; and from one runner to the
//! next. Decides nothing itself.

use super::place::Place;
use crate::clock::Clock;
use crate::event_queue::{self, Cause, EventQueue};
use crate::failure::complain;
use crate::supervisor::{Action, End, Supervisor};
use crate::view::{Nothing, View};
use anyhow::Result;
use rafcon_protocol::{Hello, Launch, OnCrash, encode};
use rafcon_supervisor::clock::salt;
use rafcon_supervisor::{Group, Next, RestartPolicy, Start, remains};
use serde::Serialize;
use std::io::{self, Write as _};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

/// What a run needs from the outside.
pub(super) struct RunEnvironment<'a> {
    /// How runners are started.
    pub(super) start: &'a Start<'a>,
    /// What shows it.
    pub(super) view: Box<dyn View>,
    /// Whether there is a keyboard.
    pub(super) has_keys: bool,
    pub(super) clock: Clock,
    /// Who gives commands.
    pub(super) author: &'a str,
    /// When the machine is stopped.
    pub(super) timeout: Option<Duration>,
}

/// Runs the machine to its end, by as many runners as that takes and its policy allows.
pub(super) fn follow(launch: Launch, place: &Place, outside: RunEnvironment<'_>) -> Result<End> {
    let RunEnvironment { start, mut view, has_keys, clock, author, timeout } = outside;
    let mut wires = EventQueue::new(event_queue::signals()?, has_keys)?;
    let deadline = timeout.map(|timeout| clock.now().saturating_add(timeout));
    let (mut lives, mut launch) = (RestartPolicy::default(), launch);
    loop {
        let process = start.spawn()?;
        let (control, group) = (process.control.try_clone()?, process.group());
        wires.connect(process)?;
        let left = deadline.map(|deadline| deadline.saturating_sub(clock.now()));
        let prefix = format!("run-{}-{}", std::process::id(), salt(0));
        let supervisor = Supervisor::new(launch.clone(), clock.now(), left, (author, &prefix));
        let mut drive = Drive { supervisor, view, control, group, clock };
        drive.send(&Hello::ours());
        let mut end = drive.until_the_end(&wires);
        add_running(&mut end, place.folder());
        drive.end_as_kept(&mut end, place);
        let End::Died(death) = &end else {
            drive.show(|view| view.end(&end));
            return Ok(end);
        };
        let is_stopped = drive.supervisor.is_stopped_by_itself();
        let policy = if is_stopped { OnCrash::Ask } else { place.on_crash(launch.on_crash) };
        match lives.next(clock.now(), death, policy) {
            Next::Again(resume, crash) if place.is_kept() => {
                let (what, again) = if place.has_begun() {
                    ("taken up", (Some(resume), Some(crash)))
                } else {
                    ("begun", (launch.resume, launch.crash.clone()))
                };
                let note = format!("the runner died ({}); the run is {what} again", death.reason);
                drive.show(|view| view.note(&note));
                (launch.resume, launch.crash) = again;
                view = drive.view;
            }
            Next::Again(..) | Next::Ask(_) => {
                drive.show(|view| view.end(&end));
                return Ok(end);
            }
        }
    }
}

struct Drive {
    supervisor: Supervisor,
    view: Box<dyn View>,
    control: UnixStream,
    group: Group,
    clock: Clock,
}

impl Drive {
    fn until_the_end(&mut self, wires: &EventQueue) -> End {
        let mut actions = Vec::new();
        loop {
            let cause = self.next(wires);
            let cause = self.by_itself(cause);
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

    fn next(&self, wires: &EventQueue) -> Cause {
        let now = self.clock.now();
        let until = self.supervisor.wake_at().map(|at| at.saturating_sub(now));
        wires.next([until, self.view.rhythm()].into_iter().flatten().min())
    }

    /// What concerns this program alone; a key becomes what it stands for.
    fn by_itself(&mut self, cause: Cause) -> Cause {
        match cause {
            Cause::Key(key) => return self.view.key(key).map_or(Cause::Tick, Cause::Wish),
            Cause::HungUp if self.view.rhythm().is_some() => self.view = Box::new(Nothing),
            Cause::Suspend => {
                self.show(|view| view.set_aside());
                let stop = signal_hook::consts::SIGTSTP;
                signal_hook::low_level::emulate_default_handler(stop).unwrap_or_default();
            }
            _ => {}
        }
        cause
    }

    fn act(&mut self, action: Action) {
        let now = self.clock.now();
        match action {
            Action::Send(message) => self.send(&message),
            Action::Kill => self.group.kill(),
            Action::Loaded { name, states } => self.show(|view| view.loaded(&name, states)),
            Action::Event(time, event) => self.show(|view| view.event(time, event)),
            Action::Snapshot(snapshot) => self.show(|view| view.snapshot(now, snapshot)),
            Action::Inspected { path, data } => self.show(|view| view.inspected(&path, data)),
            Action::Note(text) => self.show(|view| view.note(&text)),
        }
    }

    /// A runner that died after the run had ended took nothing along but its last word.
    fn end_as_kept(&mut self, end: &mut End, place: &Place) {
        if !matches!(end, End::Died(_)) || !place.is_kept() {
            return;
        }
        let Some((time, event)) = remains::kept_end(place.folder()) else { return };
        if let Some(kept) = End::kept(&event) {
            self.show(|view| view.event(time, event));
            *end = kept;
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
    let running = remains::running(folder);
    if !running.is_empty() {
        *known = running;
    }
}
