//! The loop of a visit: causes from the wires to the visit, what it decides to the run and to the view. Decides nothing
//! itself, and does not know how the run is reached.

use super::visit::{Act, Visit, VisitEnd};
use crate::clock::Clock;
use crate::console::Wish;
use crate::event_queue::{Cause, EventQueue, Line};
use crate::view::View;
use anyhow::Result;
use rafcon_protocol::ToViewer;
use std::time::Duration;

/// Whoever follows a run that is another process's.
pub(in crate::commands) struct Guest {
    pub(in crate::commands) visit: Visit,
    pub(in crate::commands) view: Box<dyn View>,
    pub(in crate::commands) line: Box<dyn Line>,
    pub(in crate::commands) clock: Clock,
}

impl Guest {
    /// Follows it until it ends, or the user leaves.
    pub(in crate::commands) fn until_the_end(mut self, wires: &EventQueue) -> Result<VisitEnd> {
        let mut acts = Vec::new();
        loop {
            let cause = self.next(wires);
            let cause = self.by_itself(cause);
            self.visit.handle(self.clock.now(), cause, &mut acts);
            for act in acts.drain(..) {
                self.act(act)?;
            }
            self.view.refresh(self.clock.now())?;
            if let Some(end) = self.visit.end() {
                self.view.end(&end.for_view())?;
                return Ok(end.clone());
            }
        }
    }

    fn next(&self, wires: &EventQueue) -> Cause {
        let until = self.visit.wake_at().map(|at| at.saturating_sub(self.clock.now()));
        wires.next([until, self.view.rhythm()].into_iter().flatten().min())
    }

    /// A key becomes what it stands for; the rest concerns this program alone.
    fn by_itself(&mut self, cause: Cause) -> Cause {
        match cause {
            Cause::Key(key) => self.view.key(key).map_or(Cause::Tick, Cause::Wish),
            Cause::HungUp => Cause::Wish(Wish::Leave),
            Cause::Suspend => {
                self.view.set_aside().unwrap_or_default();
                let stop = signal_hook::consts::SIGTSTP;
                signal_hook::low_level::emulate_default_handler(stop).unwrap_or_default();
                Cause::Tick
            }
            cause => cause,
        }
    }

    fn act(&mut self, act: Act) -> Result<()> {
        let now = self.clock.now();
        match act {
            Act::Send(message) => self.line.say(&message)?,
            Act::Show(ToViewer::Loaded { name, states, .. }) => self.view.loaded(&name, states)?,
            Act::Show(ToViewer::Event { t_ns, event, .. }) => {
                self.view.event(Duration::from_nanos(t_ns), event)?;
            }
            Act::Show(ToViewer::Snapshot(snapshot)) => self.view.snapshot(now, snapshot)?,
            Act::Show(ToViewer::Inspection { path, data, .. }) => {
                self.view.inspected(&path, data)?;
            }
            Act::Show(
                ToViewer::LoadFailed { .. } | ToViewer::Answer { .. } | ToViewer::Pong { .. },
            ) => {}
            Act::Heard(is_heard) => self.view.heard(now, is_heard)?,
            Act::Note(text) => self.view.note(&text)?,
        }
        Ok(())
    }
}
