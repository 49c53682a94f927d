//! State of a followed run: its active states, the pulse of its engine, and the end of our process. Pure.

use rafcon_protocol::{EnginePulse, Event, Stream, ToRunner, ToViewer};
use rafcon_supervisor::Exit;
use std::collections::VecDeque;
use std::time::Duration;

/// Interval of pings to the engine.
const ASK_EVERY: Duration = Duration::from_secs(1);
/// Timeout for the last output of a dead process.
const OUTPUT_TIMEOUT: Duration = Duration::from_millis(500);
/// Maximum number of lines to show of a dead process's error output.
const TAIL: usize = 12;

/// Paths of the states that are active.
#[derive(Debug, Default)]
pub(super) struct Active {
    paths: Vec<String>,
    /// Number of the last known event.
    last: u64,
}

impl Active {
    /// Updates the active states from a message of the run.
    pub(super) fn told(&mut self, message: &ToViewer) {
        match message {
            // A snapshot may arrive before older events.
            ToViewer::Event { sequence, event, .. } if *sequence > self.last => {
                self.last = *sequence;
                self.happened(event);
            }
            // It may also arrive after newer events.
            ToViewer::Snapshot(snapshot) if snapshot.sequence >= self.last => {
                self.last = snapshot.sequence;
                self.paths = snapshot.active.iter().map(|state| state.path.clone()).collect();
            }
            _ => {}
        }
    }

    fn happened(&mut self, event: &Event) {
        match event {
            Event::Entered { path, .. } => self.paths.push(path.clone()),
            Event::Left { path, .. } => {
                if let Some(index) = self.paths.iter().rposition(|active| active == path) {
                    self.paths.remove(index);
                }
            }
            _ => {}
        }
    }

    /// The paths, a parent before its children.
    pub(super) fn paths(&self) -> &[String] {
        &self.paths
    }
}

/// Pings the runner periodically to learn if the engine takes inputs.
#[derive(Debug, Default)]
pub(super) struct Pulse {
    next: Duration,
    asked: u64,
    is_stuck: bool,
}

impl Pulse {
    /// Time of the next ping.
    pub(super) fn due(&self) -> Duration {
        self.next
    }

    /// The next ping, if it is due.
    pub(super) fn question(&mut self, now: Duration) -> Option<ToRunner> {
        if now < self.next {
            return None;
        }
        self.next = now + ASK_EVERY;
        self.asked += 1;
        Some(ToRunner::Ping { id: self.asked })
    }

    /// True if the engine responds again, false if it stopped; `None` without a change.
    pub(super) fn answered(&mut self, engine: EnginePulse) -> Option<bool> {
        let is_reached = engine.is_reached(!self.is_stuck);
        if is_reached != self.is_stuck {
            return None;
        }
        self.is_stuck = !is_reached;
        Some(is_reached)
    }
}

/// End of our process, with its last output.
#[derive(Debug, Default)]
pub(super) struct ProcessEnd {
    exit: Option<Exit>,
    /// Its control connection is closed.
    is_silent: bool,
    /// Its error output is closed: all its output has been read.
    is_drained: bool,
    /// End of the wait for its last output.
    settled_at: Option<Duration>,
    tail: VecDeque<String>,
}

impl ProcessEnd {
    pub(super) fn exited(&mut self, now: Duration, exit: Exit) {
        self.exit = Some(exit);
        self.settled_at = Some(now + OUTPUT_TIMEOUT);
    }

    pub(super) fn silent(&mut self) {
        self.is_silent = true;
    }

    pub(super) fn drained(&mut self, stream: Stream) {
        self.is_drained |= stream == Stream::Stderr;
    }

    /// Stores a line of its error output.
    pub(super) fn said(&mut self, line: &str) {
        self.tail.push_back(line.to_owned());
        if self.tail.len() > TAIL {
            self.tail.pop_front();
        }
    }

    /// Its last lines on the error output.
    pub(super) fn tail(&self) -> Vec<String> {
        self.tail.iter().cloned().collect()
    }

    pub(super) fn exit(&self) -> Option<Exit> {
        self.exit
    }

    /// End of the wait for its last output.
    pub(super) fn settled_at(&self) -> Option<Duration> {
        self.settled_at
    }

    /// Exit status, once its connection and error output are closed or the timeout has expired.
    pub(super) fn last_word(&self, now: Duration) -> Option<Exit> {
        self.exit.filter(|_| self.is_silent && self.is_drained || self.is_settled(now))
    }

    /// True if it has exited and its connection is closed, or the timeout has expired.
    pub(super) fn is_over(&self, now: Duration) -> bool {
        self.exit.is_some() && (self.is_silent || self.is_settled(now))
    }

    fn is_settled(&self, now: Duration) -> bool {
        self.settled_at.is_some_and(|at| now >= at)
    }
}
