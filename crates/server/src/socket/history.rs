//! A run's history for one client: each event once, from a cursor on, first from the journal, then from the ring once it holds the
//! next event. Knows cursors and texts, but not the content of events.

use super::feed::{Feed, NextMessage};
use super::outbox::Lane;
use super::words;
use crate::history::{History, HistoryReader, before};
use crate::runs::{EventGroup, EventsPage, Run};
use crate::{Failure, ServerState};
use rafcon_protocol::api::{Before, RunNow, RunPhase};
use rafcon_protocol::socket::ToClient;
use rafcon_storage::journal::Reader;
use std::sync::Arc;
use std::time::Duration;
use tokio::select;
use tokio::sync::watch;
use tokio::time::{Instant, timeout};

/// Approximate size of a page, in bytes. A page takes four seconds on the slowest supported network (64 kbit/s), and a status
/// waits for at most one page.
const PAGE_BYTES: usize = 32 << 10;
/// Maximum number of events in a page.
const PAGE_COUNT: usize = 1000;
/// Retry interval for a journal that lacks events which its run has reported, if nothing changes before.
const STALLED: Duration = Duration::from_secs(1);

/// Position of a reader in a history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cursor {
    subscription: u32,
    /// The first event that was not sent.
    next: u64,
    values: bool,
    /// True once the client was informed that it has caught up.
    has_caught_up: bool,
}

/// The next message for a reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NextEvents {
    Events,
    /// The reader has caught up.
    CaughtUp,
    /// The history is complete.
    End,
    Nothing,
}

impl Cursor {
    /// A reader that has received everything before event `from`.
    pub(super) fn new(subscription: u32, from: u64, values: bool) -> Self {
        Self { subscription, next: from.max(1), values, has_caught_up: false }
    }

    /// The next message, if `last` is the last event and the run may be over.
    fn due(&self, last: u64, is_over: bool) -> NextEvents {
        match (self.next <= last, self.has_caught_up, is_over) {
            (true, _, _) => NextEvents::Events,
            (false, false, _) => NextEvents::CaughtUp,
            (false, true, true) => NextEvents::End,
            (false, true, false) => NextEvents::Nothing,
        }
    }

    /// Moves the cursor to `next`. Returns a frame with these events, if any.
    fn tell(&mut self, events: &[impl AsRef<str>], next: u64) -> Option<String> {
        self.next = next;
        (!events.is_empty()).then(|| words::events(self.subscription, next, events))
    }

    fn catch_up(&mut self) -> String {
        self.has_caught_up = true;
        words::events(self.subscription, self.next, &[""; 0])
    }

    fn end(&self, failure: Option<&Failure>) -> NextMessage {
        NextMessage::Last(words::text(&words::ended(self.subscription, failure)))
    }
}

/// The history of a run, followed by one client.
#[derive(Debug)]
pub(super) struct RunHistory {
    run: Arc<Run>,
    now: watch::Receiver<Arc<RunNow>>,
    last: watch::Receiver<u64>,
    journal: HistoryReader,
    cursor: Cursor,
    /// True if the journal lacked expected events, so that a retry is due.
    is_stalled: bool,
    history: History,
    /// Limit on the existing events to send. `None` for no limit, or once it was applied.
    most: Option<Most>,
}

/// Beyond `most` events, only the `newest` are sent.
#[derive(Debug, Clone, Copy)]
struct Most {
    most: u64,
    newest: u64,
}

impl RunHistory {
    pub(super) fn new(server: &ServerState, run: Arc<Run>, cursor: Cursor) -> Self {
        let (now, last) = (run.now(), run.ring().last());
        let journal = HistoryReader::new(&server.history, run.folder(), cursor.values);
        let history = server.history.clone();
        Self { run, now, last, journal, cursor, is_stalled: false, history, most: None }
    }

    /// Limits the history: beyond `most` events, it begins with the `newest` ones.
    pub(super) fn newest(self, most: u64, newest: u64) -> Self {
        Self { most: Some(Most { most, newest: newest.min(most) }), ..self }
    }

    /// Applies the limit: moves to the newest events and returns the frame about the skipped ones. Ignores an unreadable journal, which
    /// the next read reports.
    async fn skip(&mut self, Most { most, newest }: Most) -> Option<NextMessage> {
        let (from, told) = (self.cursor.next, *self.last.borrow());
        let skipped = move |reader: &mut Reader| -> Result<Option<Before>, Failure> {
            let last = reader.last_sequence()?.max(told);
            if (last + 1).saturating_sub(from) <= most {
                return Ok(None);
            }
            before(reader, last + 1 - newest).map(Some)
        };
        let folder = self.run.folder().to_owned();
        let before = self.history.readers().read(folder.clone(), skipped).await.ok()??;
        self.history.begin_outline(folder);
        self.cursor.next = before.sequence + 1;
        let subscription = self.cursor.subscription;
        Some(NextMessage::Part(words::text(&ToClient::Skipped { subscription, before })))
    }

    fn due(&self) -> NextEvents {
        // Checked first: once a run is over, its last event is known.
        let is_over = self.is_over();
        self.cursor.due(*self.last.borrow(), is_over)
    }

    fn is_over(&self) -> bool {
        is_over(&self.now.borrow().run.phase)
    }

    /// Waits for a change of the run.
    async fn change(&mut self) {
        // The senders live as long as the run that is held here.
        select! {
            _ = self.now.changed() => {}
            _ = self.last.changed() => {}
        }
    }

    async fn events(&mut self) -> NextMessage {
        match self.run.ring().read(self.cursor.next, PAGE_COUNT as u64) {
            EventsPage::Events(groups) => self.live(&groups),
            EventsPage::Behind => self.kept().await,
        }
    }

    /// Events from the journal.
    async fn kept(&mut self) -> NextMessage {
        let (from, is_over) = (self.cursor.next, self.is_over());
        let page = self.journal.page(from, PAGE_COUNT, PAGE_BYTES).await;
        match page {
            Ok(page) if page.next > from => self
                .cursor
                .tell(&page.entries, page.next)
                .map_or(NextMessage::Nothing, NextMessage::Part),
            Ok(_) if is_over => self.cursor.end(Some(&lacks(from))),
            Ok(_) => {
                self.is_stalled = true;
                NextMessage::Nothing
            }
            Err(failure) => self.cursor.end(Some(&failure)),
        }
    }

    /// Events from the ring.
    fn live(&mut self, groups: &[Arc<EventGroup>]) -> NextMessage {
        let Cursor { next: from, values, .. } = self.cursor;
        let texts = groups.iter().flat_map(|group| group.texts(values));
        let (mut bytes, mut next, mut page) = (0, from, Vec::new());
        for event in texts.skip_while(|event| event.sequence < from) {
            if bytes >= PAGE_BYTES || page.len() == PAGE_COUNT {
                break;
            }
            next = event.sequence + 1;
            if let Some(text) = &event.text {
                bytes += text.len();
                page.push(&**text);
            }
        }
        let frame = self.cursor.tell(&page, next);
        let is_all = next > *self.last.borrow();
        frame
            .map_or(NextMessage::Nothing, if is_all { NextMessage::Now } else { NextMessage::Part })
    }
}

impl Feed for RunHistory {
    const LANE: Lane = Lane::History;

    fn next_time(&self) -> Instant {
        self.run.pace().next_time()
    }

    async fn ready(&mut self) {
        if std::mem::take(&mut self.is_stalled) {
            drop(timeout(STALLED, self.change()).await);
        }
        while self.due() == NextEvents::Nothing {
            self.change().await;
        }
    }

    async fn take(&mut self) -> NextMessage {
        if let Some(most) = self.most.take()
            && let Some(skipped) = self.skip(most).await
        {
            return skipped;
        }
        match self.due() {
            NextEvents::Events => self.events().await,
            NextEvents::CaughtUp => NextMessage::Part(self.cursor.catch_up()),
            NextEvents::End => self.cursor.end(lacking(&self.now.borrow().run.phase).as_ref()),
            NextEvents::Nothing => NextMessage::Nothing,
        }
    }
}

/// True if the history of a run in this phase is complete.
fn is_over(phase: &RunPhase) -> bool {
    match phase {
        RunPhase::Starting | RunPhase::Live | RunPhase::Crashed => false,
        RunPhase::Finished { .. }
        | RunPhase::Diverged { .. }
        | RunPhase::NotStarted { .. }
        | RunPhase::Unreadable { .. } => true,
    }
}

/// Reason why the run has no history.
fn lacking(phase: &RunPhase) -> Option<Failure> {
    match phase {
        RunPhase::NotStarted { reason } | RunPhase::Unreadable { reason } => {
            Some(Failure::conflict("no_history", format!("the run has no history: {reason}")))
        }
        RunPhase::Starting
        | RunPhase::Live
        | RunPhase::Crashed
        | RunPhase::Diverged { .. }
        | RunPhase::Finished { .. } => None,
    }
}

fn lacks(from: u64) -> Failure {
    let message = format!(
        "the run's journal ends before event {from}, which its runner has reported: its folder was changed, or its disk has lost data"
    );
    Failure::conflict("journal_too_short", message)
}
