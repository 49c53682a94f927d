//! A group of events as received from the runner, with their texts for clients. Each text is made once, at the first request.
//! Knows the encoding of events, but not their readers.

use rafcon_protocol::api::HistoryEntry;
use rafcon_storage::journal::is_about_values;
use rafcon_storage::journal::stream::{StreamBlock, StreamDefinitions, StreamItem};
use std::sync::{Arc, OnceLock};

/// Consecutive events of a run.
#[derive(Debug)]
pub(crate) struct EventGroup {
    /// Number of the first event.
    pub(super) first: u64,
    /// Number of the event after the last one.
    pub(super) next: u64,
    /// Time of the event before the first.
    pub(super) t_before: u64,
    /// The events as journal items, without definitions.
    pub(super) items: Box<[u8]>,
    definitions: Arc<StreamDefinitions>,
    whole: OnceLock<Vec<EventText>>,
    bare: OnceLock<Vec<EventText>>,
}

/// Text of one event for clients.
#[derive(Debug)]
pub(crate) struct EventText {
    /// Number of the event.
    pub(crate) sequence: u64,
    /// A [`HistoryEntry`] as JSON. `None` if the event concerns only values and they are excluded.
    pub(crate) text: Option<Box<str>>,
}

impl EventGroup {
    /// The events of a block before number `next`, with names from `definitions`.
    pub(super) fn new(
        block: StreamBlock<'_>,
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

    /// The texts of all events, with or without values.
    pub(crate) fn texts(&self, values: bool) -> &[EventText] {
        let texts = if values { &self.whole } else { &self.bare };
        texts.get_or_init(|| self.spell(values))
    }

    fn spell(&self, values: bool) -> Vec<EventText> {
        let block = StreamBlock { first: self.first, t_before: self.t_before, items: &self.items };
        let events = block.items().filter_map(|item| match item {
            Ok(StreamItem::Event { sequence, t_ns, record, .. }) => {
                let is_wanted = values || !is_about_values(&record);
                let event = is_wanted.then(|| self.definitions.event(sequence, record, values));
                let entry =
                    event.and_then(Result::ok).map(|event| HistoryEntry { sequence, t_ns, event });
                let text = entry.and_then(|entry| serde_json::to_string(&entry).ok());
                Some(EventText { sequence, text: text.map(String::into_boxed_str) })
            }
            // Cannot occur: the block was already read once.
            Ok(StreamItem::Place { .. } | StreamItem::Value { .. }) | Err(_) => None,
        });
        events.collect()
    }
}
