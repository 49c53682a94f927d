//! The breakpoints of a run in the viewers' format. This module maps them to the engine's format; the engine applies
//! them.

use crate::drive::error::CommandError;
use crate::drive::record_events::ExtraRecords;
use crate::record::tell;
use crate::{Driver, Scripts};
use rafcon_engine as engine;
use rafcon_engine::Input;
use rafcon_locks::Mutex;
use rafcon_model::StatePath;
use rafcon_protocol::{Breakpoint, Event, Scope, Unattended, When};
use rafcon_storage::journal::Record;
use std::collections::BTreeMap;
use std::sync::Arc;

/// All breakpoints by id.
#[derive(Debug, Default)]
pub(crate) struct Points {
    list: Mutex<BTreeMap<u64, Breakpoint>>,
}

impl Points {
    /// All breakpoints by rising id.
    pub(crate) fn all(&self) -> Vec<Breakpoint> {
        self.list.lock().values().cloned().collect()
    }
}

impl<S: Scripts> Driver<S> {
    /// Sets a breakpoint, and records it.
    pub(crate) fn set_breakpoint(
        self: &Arc<Self>,
        breakpoint: &Breakpoint,
    ) -> Result<(), CommandError> {
        let set = || {
            self.points().list.lock().insert(breakpoint.id, breakpoint.clone());
            tell::told(Event::BreakpointSet { breakpoint: breakpoint.clone() })
        };
        self.change_points(Input::Break(for_engine(breakpoint)), set)?;
        if breakpoint.lost_link_ms.is_some() {
            self.look_at_ground_later();
        }
        Ok(())
    }

    /// Removes a breakpoint, and records that.
    pub(crate) fn remove_breakpoint(self: &Arc<Self>, id: u64) -> Result<(), CommandError> {
        let remove = || {
            self.points().list.lock().remove(&id);
            tell::told(Event::BreakpointRemoved { id })
        };
        self.change_points(Input::Unbreak(id), remove)
    }

    /// Updates engine, list and record under one lock, so that they never differ, even with concurrent changes.
    fn change_points(
        self: &Arc<Self>,
        input: Input<S::Value>,
        note: impl FnOnce() -> Record + Send,
    ) -> Result<(), CommandError> {
        let beside = || ExtraRecords { first: Some(note()), last: None };
        self.input_beside(input, || false, beside)
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
        lost_link_ms: breakpoint.lost_link_ms,
        enabled: breakpoint.enabled,
    }
}
