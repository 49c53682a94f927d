//! The breakpoints of a run in the words of viewers. Knows both vocabularies; what holds where, the engine knows.

use crate::{Driver, Scripts};
use parking_lot::Mutex;
use rafcon_engine as engine;
use rafcon_engine::Input;
use rafcon_model::StatePath;
use rafcon_protocol::{Breakpoint, Event, Scope, Unattended, When};
use std::collections::BTreeMap;
use std::sync::Arc;

/// All breakpoints by their ids.
#[derive(Debug, Default)]
pub(crate) struct Points {
    list: Mutex<BTreeMap<u64, Breakpoint>>,
}

impl Points {
    /// All of them, by rising id.
    pub(crate) fn all(&self) -> Vec<Breakpoint> {
        self.list.lock().values().cloned().collect()
    }
}

impl<S: Scripts> Driver<S> {
    /// Sets a breakpoint; the error is for people.
    pub(crate) fn set_breakpoint(self: &Arc<Self>, breakpoint: &Breakpoint) -> Result<(), String> {
        self.input(Input::Break(for_engine(breakpoint)))?;
        self.points().list.lock().insert(breakpoint.id, breakpoint.clone());
        self.tell(Event::BreakpointSet { breakpoint: breakpoint.clone() });
        Ok(())
    }

    /// Removes a breakpoint; the error is for people.
    pub(crate) fn remove_breakpoint(self: &Arc<Self>, id: u64) -> Result<(), String> {
        self.input(Input::Unbreak(id))?;
        self.points().list.lock().remove(&id);
        self.tell(Event::BreakpointRemoved { id });
        Ok(())
    }
}

fn for_engine(breakpoint: &Breakpoint) -> engine::Breakpoint {
    engine::Breakpoint {
        id: breakpoint.id,
        path: StatePath::parse(&breakpoint.path),
        when: match breakpoint.when {
            When::Before => engine::When::Before,
            When::After => engine::When::After,
        },
        condition: breakpoint.condition.as_deref().map(Into::into),
        hit_count: breakpoint.hit_count,
        scope: match breakpoint.scope {
            Scope::Branch => engine::Scope::Branch,
            Scope::Run => engine::Scope::Run,
        },
        unattended: match breakpoint.unattended {
            Unattended::Hold => engine::Unattended::Hold,
            Unattended::Continue => engine::Unattended::Continue,
            Unattended::Stop => engine::Unattended::Stop,
        },
        enabled: breakpoint.enabled,
    }
}
