//! The breakpoints of a run and their hit counts. This module knows no frame.

use crate::{Breakpoint, When};
use rafcon_model::StatePath;

#[derive(Debug)]
struct BreakpointEntry {
    breakpoint: Breakpoint,
    hits: u32,
}

/// All breakpoints by rising id.
#[derive(Debug, Default)]
pub(in crate::engine) struct Breakpoints {
    all: Vec<BreakpointEntry>,
}

impl Breakpoints {
    pub(in crate::engine) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    pub(in crate::engine) fn iter(&self) -> impl Iterator<Item = (&Breakpoint, u32)> {
        self.all.iter().map(|entry| (&entry.breakpoint, entry.hits))
    }

    pub(in crate::engine) fn get(&self, id: u64) -> Option<&Breakpoint> {
        let place = self.place(id).ok()?;
        Some(&self.all[place].breakpoint)
    }

    fn place(&self, id: u64) -> Result<usize, usize> {
        self.all.binary_search_by_key(&id, |entry| entry.breakpoint.id)
    }

    /// Adds a breakpoint. It replaces one with an equal id, and its hits count from 0.
    pub(in crate::engine) fn set(&mut self, breakpoint: Breakpoint) {
        let place = self.place(breakpoint.id);
        let entry = BreakpointEntry { breakpoint, hits: 0 };
        match place {
            Ok(place) => self.all[place] = entry,
            Err(place) => self.all.insert(place, entry),
        }
    }

    /// Removes a breakpoint; false if it does not exist.
    pub(in crate::engine) fn remove(&mut self, id: u64) -> bool {
        let place = self.place(id);
        if let Ok(place) = place {
            self.all.remove(place);
        }
        place.is_ok()
    }

    /// The enabled breakpoints at `when` whose path the predicate accepts, by falling id.
    pub(in crate::engine) fn at(&self, when: When, is_at: impl Fn(&StatePath) -> bool) -> Vec<u64> {
        let all = self.all.iter().rev().map(|entry| &entry.breakpoint);
        let here = all.filter(|b| b.enabled && b.when == when && is_at(&b.path));
        here.map(|breakpoint| breakpoint.id).collect()
    }

    /// Counts a hit; returns the number of hits and the breakpoint, if it is enabled.
    pub(in crate::engine) fn hit(&mut self, id: u64) -> Option<(u32, &Breakpoint)> {
        let place = self.place(id).ok()?;
        let entry = self.all.get_mut(place).filter(|entry| entry.breakpoint.enabled)?;
        entry.hits = entry.hits.saturating_add(1);
        Some((entry.hits, &entry.breakpoint))
    }
}
