//! What is known of a run that is followed: which states are active, whether its engine takes inputs, and how a process of ours
//! ended. Pure.

use rafcon_protocol::{EnginePulse, Event, Stream, ToRunner, ToViewer};
use rafcon_supervisor::Exit;
use std::collections::VecDeque;
use std::time::Duration;

/// From one question for the engine to the next.
const ASK_EVERY: Duration = Duration::from_secs(1);
/// How long the last words of a dead process are waited for.
const OUTPUT_TIMEOUT: Duration = Duration::from_millis(500);
/// How many lines of a dead process's error output are shown.
const TAIL: usize = 12;

/// Paths of the states that are active.
#[derive(Debug, Default)]
pub(super) struct Active {
    paths: Vec<String>,
    /// The last event that is known.
    last: u64,
}

impl Active {
    /// Takes in what the run says.
    pub(super) fn told(&mut self, message: &ToViewer) {
        match message {
            // A snapshot may come before what happened before it.
            ToViewer::Event { sequence, event, .. } if *sequence > self.last => {
                self.last = *sequence;
                self.happened(event);
            }
            // And after what happened after it.
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

/// Whether the engine takes inputs, asked of its runner from time to time.
#[derive(Debug, Default)]
pub(super) struct Pulse {
    next: Duration,
    asked: u64,
    is_stuck: bool,
}

impl Pulse {
    /// When the next question is due.
    pub(super) fn due(&self) -> Duration {
        self.next
    }

    /// The question, if it is due.
    pub(super) fn question(&mut self, now: Duration) -> Option<ToRunner> {
        if now < self.next {
            return None;
        }
        self.next = now + ASK_EVERY;
        self.asked += 1;
        Some(ToRunner::Ping { id: self.asked })
    }

    /// Whether the engine is reached again or not any more, if the answer changes that.
    pub(super) fn answered(&mut self, engine: EnginePulse) -> Option<bool> {
        let is_reached = engine.is_reached(!self.is_stuck);
        if is_reached != self.is_stuck {
            return None;
        }
        self.is_stuck = !is_reached;
        Some(is_reached)
    }
}

/// How a process of ours ended, and what it said last.
#[derive(Debug, Default)]
pub(super) struct ProcessEnd {
    exit: Option<Exit>,
    /// Its control connection is closed.
    is_silent: bool,
    /// Its error output is at the end: no last word is still on its way.
    is_drained: bool,
    /// When waiting for last words ends.
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

    /// It wrote this line to its error output.
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

    /// When waiting for its last words ends.
    pub(super) fn settled_at(&self) -> Option<Duration> {
        self.settled_at
    }

    /// How it ended, once it has said its last word.
    pub(super) fn last_word(&self, now: Duration) -> Option<Exit> {
        self.exit.filter(|_| self.is_silent && self.is_drained || self.is_settled(now))
    }

    /// Whether nothing more is heard of it, and it has ended.
    pub(super) fn is_over(&self, now: Duration) -> bool {
        self.exit.is_some() && (self.is_silent || self.is_settled(now))
    }

    fn is_settled(&self, now: Duration) -> bool {
        self.settled_at.is_some_and(|at| now >= at)
    }
}
