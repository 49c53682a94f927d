//! Records the events of the engine, and updates the places of a run from them. This module knows events, but not where
//! the record is stored.

use crate::Scripts;
use crate::drive::core::Core;
use crate::places::last::Last;
use crate::record::keep::Keep;
use crate::record::names::{self, port_number};
use crate::record::record_encoder::StateEnd;
use crate::record::recorder::{RecordWriter, Recorder};
use crate::record::tell;
use rafcon_engine::{Event, NodeId, PathId};
use rafcon_model::OutcomeId;
use rafcon_protocol::Keeping;
use rafcon_storage::journal::{Kept, PlaceNumber, Record};
use std::sync::Arc;

/// A group of events while it is being recorded.
struct RecordGroup<'p, S: Scripts> {
    core: &'p mut Core<S::Value>,
    scripts: &'p S,
    writer: RecordWriter<'p>,
    now: u64,
}

/// Records in one group with the events of an input: all of them are kept, or none.
#[derive(Debug, Default)]
pub(crate) struct ExtraRecords {
    /// Record before the events.
    pub(crate) first: Option<Record>,
    /// Record after the events.
    pub(crate) last: Option<Record>,
}

/// Records the events of the outbox with the extra records, and creates places that they name for the first time.
pub(crate) fn record<S: Scripts>(
    core: &mut Core<S::Value>,
    scripts: &S,
    now: u64,
    recorder: &Recorder,
    extra: ExtraRecords,
) {
    let ExtraRecords { first, last } = extra;
    if core.outbox.events.is_empty() && first.is_none() && last.is_none() {
        return;
    }
    let mut events = std::mem::take(&mut core.outbox.events);
    let writer = recorder.write();
    let mut page = RecordGroup { core, scripts, writer, now };
    if let Some(first) = first {
        page.writer.note(page.now, &first);
    }
    for event in &events {
        page.write(event);
    }
    if let Some(last) = last {
        page.writer.note(page.now, &last);
    }
    events.clear();
    page.core.outbox.events = events;
}

impl<S: Scripts> RecordGroup<'_, S> {
    fn write(&mut self, event: &Event<S::Value>) {
        match event {
            Event::Entered { path, node, inputs, undoes } => {
                let (place, keeps) = self.place(*path, *node);
                self.enter(*path);
                self.begin(*path, *node, inputs);
                if keeps {
                    inputs.iter().for_each(|value| self.value(value));
                }
                self.writer.entered(self.now, place, *undoes);
            }
            Event::Left { path, node, outcome, outputs, absent, error, undoes } => {
                let (place, keeps) = self.place(*path, *node);
                self.leave(*path, *outcome);
                if let Some(last) = self.last(*path) {
                    last.end(outputs, error.clone());
                }
                let error = error.as_ref().filter(|_| keeps).map(|error| self.kept(error));
                if keeps {
                    self.outputs(outputs, absent.as_deref().unwrap_or_default());
                }
                let end = StateEnd { place, outcome: outcome.0, undoes: *undoes };
                self.writer.left(self.now, end, error.as_ref());
            }
            Event::Scoped { path, port, value } => {
                if let Some(last) = self.last(*path) {
                    last.set_scoped(*port, value.clone());
                }
                if let Some((place, true)) = self.place_at(*path) {
                    let value = self.kept(value);
                    self.writer.scoped(self.now, place, port_number(*port), &value);
                }
            }
            event => self.rare(event),
        }
    }

    fn rare(&mut self, event: &Event<S::Value>) {
        match event {
            Event::Dropped { path } => {
                if let Some(place) = self.core.at(*path) {
                    place.drop_entry();
                }
            }
            Event::Stopping => {
                self.core.set_flags(0);
                self.writer.run_ends();
            }
            Event::Changed => self.core.generation += 1,
            // A forced state that never began may be unknown to the record.
            Event::Forced { path, .. } => drop(self.place_at(*path)),
            _ => {}
        }
        let record = match event {
            Event::Note { path, level, note } => {
                self.place_at(*path).map(|(place, _)| tell::note(place, *level, note))
            }
            event => tell::rare(event, &self.core.engine),
        };
        if let Some(record) = record {
            self.writer.note(self.now, &record);
        }
    }

    /// The number of a place in the record, defined on first use; true if values are kept there.
    fn place(&mut self, path: PathId, node: NodeId) -> (PlaceNumber, bool) {
        let generation = self.core.generation;
        let known = self.core.known(path, node);
        let (number, keeping) = (known.place.number, known.place.keeping);
        if known.defined != generation {
            known.defined = generation;
            self.define(number, path, node);
        }
        (number, keeping == Keeping::Full && self.writer.keeps_values())
    }

    fn place_at(&mut self, path: PathId) -> Option<(PlaceNumber, bool)> {
        let node = self.core.engine.path_node(path)?;
        Some(self.place(path, node))
    }

    fn define(&mut self, number: PlaceNumber, path: PathId, node: NodeId) {
        let place = names::definition(&self.core.engine, path, node);
        if self.writer.names().latest(number).is_none_or(|latest| *latest != place) {
            self.writer.define(number, Arc::new(place));
        }
    }

    fn value(&mut self, value: &S::Value) {
        let keep = self.scripts.keep(value);
        self.writer.value(&keep);
    }

    fn kept(&mut self, value: &S::Value) -> Kept {
        let keep: Keep<'_> = self.scripts.keep(value);
        self.writer.kept(&keep)
    }

    /// Writes the outputs, without those at the indices in `absent`.
    fn outputs(&mut self, outputs: &[S::Value], absent: &[u32]) {
        for (index, value) in (0..).zip(outputs) {
            if absent.contains(&index) {
                self.writer.absent();
            } else {
                self.value(value);
            }
        }
    }

    /// Notes the start of a container or library state. The host of a script knows that script's data itself.
    fn begin(&mut self, path: PathId, node: NodeId, inputs: &Arc<[S::Value]>) {
        let program = self.core.engine.program();
        let node = program.node(node);
        if node.is_script() {
            return;
        }
        let begun = Last::begun(node.state(), inputs);
        if let Some(known) = self.core.known.get_mut(path.index()).and_then(Option::as_mut) {
            known.last = Some(Box::new(begun));
        }
    }

    fn last(&mut self, path: PathId) -> Option<&mut Last<S::Value>> {
        let known = self.core.known.get_mut(path.index())?.as_mut()?;
        known.last.as_deref_mut()
    }

    fn enter(&self, path: PathId) {
        if let Some(place) = self.core.at(path) {
            place.enter(self.now, self.core.around(place));
        }
    }

    fn leave(&self, path: PathId, outcome: OutcomeId) {
        if let Some(place) = self.core.at(path) {
            place.leave(outcome, self.core.around(place));
        }
    }
}
