//! The loop that follows a run: it passes causes from the event queue to the follower, and the follower's actions to the
//! run, the process and the view. Decides nothing itself, and does not know the type of the connection.

use super::{Action, End, RunFollower};
use crate::clock::Clock;
use crate::event_queue::{Cause, EventQueue, Line};
use crate::view::{Nothing, View};
use anyhow::Result;
use rafcon_protocol::ToViewer;
use rafcon_supervisor::Group;
use std::io;
use std::time::Duration;

/// Note about a dropped message to the run.
const DROPPED: &str = "too many commands wait for the run: the last one was not sent";

/// A followed run, with its connection and its view.
pub(crate) struct RunLoop {
    pub(crate) follower: RunFollower,
    pub(crate) view: Box<dyn View>,
    pub(crate) line: Box<dyn Line>,
    /// The runner's processes, if this program started them: such a run continues without a view if its terminal hangs up.
    pub(crate) group: Option<Group>,
    pub(crate) clock: Clock,
}

impl RunLoop {
    /// Follows the run until its end.
    pub(crate) fn until_the_end(&mut self, queue: &EventQueue) -> Result<End> {
        let mut actions = Vec::new();
        loop {
            let cause = self.next(queue);
            let cause = self.by_itself(cause);
            let now = self.clock.now();
            self.follower.handle(now, cause, &mut actions);
            for action in actions.drain(..) {
                self.act(action)?;
            }
            self.show(|view| view.refresh(now))?;
            if let Some(end) = self.follower.end(now) {
                return Ok(end.clone());
            }
        }
    }

    /// Follows the run until its end, and shows the end.
    pub(crate) fn until_the_end_is_shown(mut self, queue: &EventQueue) -> Result<End> {
        let end = self.until_the_end(queue)?;
        self.show(|view| view.end(&end))?;
        Ok(end)
    }

    /// Shows something. Without a view, a run of ours continues; a guest ends.
    pub(crate) fn show(
        &mut self,
        what: impl FnOnce(&mut dyn View) -> io::Result<()>,
    ) -> Result<()> {
        let shown = what(self.view.as_mut());
        if shown.is_err() && self.group.is_some() {
            self.view = Box::new(Nothing);
            return Ok(());
        }
        Ok(shown?)
    }

    fn next(&self, queue: &EventQueue) -> Cause {
        let until = self.follower.wake_at().map(|at| at.saturating_sub(self.clock.now()));
        queue.next([until, self.view.rhythm()].into_iter().flatten().min())
    }

    /// Handles causes that concern only this program, and converts keys to actions.
    fn by_itself(&mut self, cause: Cause) -> Cause {
        match cause {
            Cause::Key(key) => return self.view.key(key).map_or(Cause::Tick, Cause::UserAction),
            Cause::HungUp if self.group.is_some() && self.view.rhythm().is_some() => {
                self.view = Box::new(Nothing);
            }
            Cause::Suspend => {
                self.view.set_aside().unwrap_or_default();
                let stop = signal_hook::consts::SIGTSTP;
                signal_hook::low_level::emulate_default_handler(stop).unwrap_or_default();
            }
            _ => {}
        }
        cause
    }

    fn act(&mut self, action: Action) -> Result<()> {
        let now = self.clock.now();
        match action {
            Action::Send(message) => {
                if self.line.say(&message)? {
                    return Ok(());
                }
                self.show(|view| view.note(DROPPED))
            }
            Action::Kill => {
                self.group.iter().for_each(|group| group.kill());
                Ok(())
            }
            Action::Show(message) => self.show(|view| show(view, now, message)),
            Action::Heard(silence) => self.show(|view| view.heard(now, silence)),
            Action::Note(text) => self.show(|view| view.note(&text)),
        }
    }
}

fn show(view: &mut dyn View, now: Duration, message: ToViewer) -> io::Result<()> {
    match message {
        ToViewer::Loaded { name, states, .. } => view.loaded(&name, states),
        ToViewer::Event { t_ns, event, .. } => view.event(Duration::from_nanos(t_ns), event),
        ToViewer::Snapshot(snapshot) => view.snapshot(now, snapshot),
        ToViewer::Inspection { path, data, .. } => view.inspected(&path, data),
        ToViewer::Control(_)
        | ToViewer::Watched { .. }
        | ToViewer::LoadFailed { .. }
        | ToViewer::Answer { .. }
        | ToViewer::Pong { .. } => Ok(()),
    }
}
