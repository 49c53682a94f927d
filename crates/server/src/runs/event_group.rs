//! Some events of a run as its runner sent them, and as clients are told them: their texts are made when a first client wants
//! them, once for all. Knows how events are spelled, but not who reads them.

use rafcon_protocol::api::HistoryEntry;
use rafcon_storage::journal::is_about_values;
use rafcon_storage::journal::stream::{EventBlock, StreamDefinitions, StreamItem};
use std::sync::{Arc, OnceLock};

/// Events that follow one another.
#[derive(Debug)]
pub(crate) struct EventGroup {
    /// Number of the first.
    pub(super) first: u64,
    /// Number of the event that follows them.
    pub(super) next: u64,
    /// The time of the event before them.
    pub(super) t_before: u64,
    /// The events as items of the journal, without definitions.
    pub(super) items: Box<[u8]>,
    definitions: Arc<StreamDefinitions>,
    whole: OnceLock<Vec<EventText>>,
    bare: OnceLock<Vec<EventText>>,
}

/// One event as clients are told it.
#[derive(Debug)]
pub(crate) struct EventText {
    /// Its number.
    pub(crate) sequence: u64,
    /// A [`HistoryEntry`] as JSON; nothing if it is about values only and none are wanted.
    pub(crate) text: Option<Box<str>>,
}

impl EventGroup {
    /// The events of a block up to before number `next`, named as `definitions` say.
    pub(super) fn new(
        block: EventBlock<'_>,
        next: u64,
        definitions: &Arc<StreamDefinitions>,
    ) -> Self {
        Self {
            first: block.first,
            next,
            t_before: block.t_before,
            items: block.items.into(),
            definitions: Arc::clone(definitions),
            whole: OnceLock::new(),
            bare: OnceLock::new(),
        }
    }

    /// The texts of all its events, with or without values.
    pub(crate) fn texts(&self, values: bool) -> &[EventText] {
        let texts = if values { &self.whole } else { &self.bare };
        texts.get_or_init(|| self.spell(values))
    }

    fn spell(&self, values: bool) -> Vec<EventText> {
        let block = EventBlock { first: self.first, t_before: self.t_before, items: &self.items };
        let events = block.items().filter_map(|item| match item {
            Ok(StreamItem::Event { sequence, t_ns, record, .. }) => {
                let is_wanted = values || !is_about_values(&record);
                let event = is_wanted.then(|| self.definitions.event(sequence, record, values));
                let entry =
                    event.and_then(Result::ok).map(|event| HistoryEntry { sequence, t_ns, event });
                let text = entry.and_then(|entry| serde_json::to_string(&entry).ok());
                Some(EventText { sequence, text: text.map(String::into_boxed_str) })
            }
            // There are no others: what was read once is read again.
            Ok(StreamItem::Place { .. } | StreamItem::Value { .. }) | Err(_) => None,
        });
        events.collect()
    }
}
