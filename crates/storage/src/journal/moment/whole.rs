//! The part of a moment that concerns the whole run: status, held branches, questions, breakpoints and end.
//!
//! Applies events of the protocol. Does not handle data of states.

use super::Moment;
use rafcon_protocol::api::Holding;
use rafcon_protocol::{
    Answer, Breakpoint, Command, Envelope, Event, HeldBy, Outcome, Question, RunStatus,
};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};

/// Number of commands, the newest ones, that are stored with their answers.
pub const ANSWERS_MAX: usize = 1024;

/// Status of the whole run at a moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Whole {
    /// Status of the run.
    pub status: RunStatus,
    /// Outcome of the run, if it has ended.
    pub outcome: Option<Outcome>,
    /// Hash of the run's machine, if the machine was recorded.
    pub root: Option<String>,
    /// Number of runners up to this moment.
    pub life: u32,
    /// All breakpoints, by id.
    pub breakpoints: BTreeMap<u64, Breakpoint>,
    /// Number of hits by breakpoint id.
    pub hits: BTreeMap<u64, u32>,
    /// Questions without an answer, by id.
    pub questions: BTreeMap<u64, Question>,
    /// Branches that are held.
    pub held: Vec<Holding>,
    /// Waiting states by path, with the reason.
    pub waiting: BTreeMap<String, String>,
    /// Request to stop, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop: Option<StopRequest>,
    /// Silence of the ground. `None` if the run has no ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub silence: Option<GroundSilence>,
    /// Newest commands by id, each with its answer. No runner executes them again.
    #[serde(default, skip_serializing_if = "VecDeque::is_empty")]
    pub answers: VecDeque<(String, Answer)>,
}

/// Silence of the ground, as measured for policies, breakpoints and questions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct GroundSilence {
    /// Time since the last contact, in ms.
    pub link_ms: u64,
    /// Time since the last command, in ms.
    pub command_ms: u64,
}

/// A request to stop the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct StopRequest {
    /// Number of the record of the last request.
    pub order: u64,
    /// True if there was more than one request.
    pub twice: bool,
    /// True if the runner ended after the request. The next runner records the stop again.
    #[serde(default)]
    repeats: bool,
}

impl Default for Whole {
    fn default() -> Self {
        Self {
            status: RunStatus::Running,
            outcome: None,
            root: None,
            life: 1,
            breakpoints: BTreeMap::new(),
            hits: BTreeMap::new(),
            questions: BTreeMap::new(),
            held: Vec::new(),
            waiting: BTreeMap::new(),
            stop: None,
            silence: None,
            answers: VecDeque::new(),
        }
    }
}

impl Whole {
    pub(super) fn entered(&mut self, path: &str) {
        self.lets_go(path);
        if let Some((around, _)) = path.rsplit_once('/') {
            self.waiting.remove(around);
            // A hierarchy continues with any next state. Among several branches, only the named one continues.
            if self.held.iter().filter(|held| held.path == around).count() == 1 {
                self.held.retain(|held| held.path != around);
            }
        }
    }

    pub(super) fn left(&mut self, path: &str) {
        self.lets_go(path);
        self.waiting.remove(path);
        self.held.retain(|held| held.path != path);
    }

    fn lets_go(&mut self, next: &str) {
        self.held.retain(|held| held.next.as_deref() != Some(next));
    }

    fn steps(&mut self) {
        if !matches!(self.status, RunStatus::Stopping | RunStatus::Finished) {
            self.status = RunStatus::Stepping;
        }
    }

    fn hold(&mut self, holding: Holding) {
        match holding.by {
            HeldBy::Step | HeldBy::RunTo | HeldBy::Start => self.steps(),
            HeldBy::Pause | HeldBy::Breakpoint { .. } | HeldBy::Loss { .. } => {}
        }
        self.held.retain(|held| (&held.path, &held.next) != (&holding.path, &holding.next));
        self.held.push(holding);
    }

    /// Returns the answer to the command with this id, if it is recent.
    pub fn answer(&self, id: &str) -> Option<&Answer> {
        self.answers.iter().rev().find(|(known, _)| known == id).map(|(_, answer)| answer)
    }

    /// A second request counts from its own record on. A repetition of the first after a crash does not count.
    fn stops(&mut self, order: u64) {
        self.status = RunStatus::Stopping;
        let twice = self.stop.is_some();
        match &mut self.stop {
            Some(stop) if stop.repeats => stop.repeats = false,
            stop => *stop = Some(StopRequest { order, twice, repeats: false }),
        }
    }

    fn commanded(&mut self, envelope: &Envelope, answer: &Answer) {
        if self.answers.len() >= ANSWERS_MAX {
            self.answers.pop_front();
        }
        self.answers.push_back((envelope.id.clone(), answer.clone()));
        if *answer == Answer::Applied {
            self.applied(&envelope.command);
        }
    }

    fn applied(&mut self, command: &Command) {
        match command {
            Command::StepMode
            | Command::StepInto { .. }
            | Command::StepOver { .. }
            | Command::StepOut { .. }
            | Command::StepBack { .. } => self.steps(),
            Command::Resume { branch: None } if self.status == RunStatus::Stepping => {
                self.status = RunStatus::Running;
            }
            _ => {}
        }
    }
}

impl Moment {
    pub(super) fn apply_event(&mut self, event: &Event) {
        let whole = &mut self.whole;
        match event {
            Event::Held { path, next, by } => {
                whole.hold(Holding { path: path.clone(), next: next.clone(), by: *by });
                if let Some(next) = next {
                    self.stands_before(next);
                }
            }
            Event::Hit { breakpoint, hits, .. } => drop(whole.hits.insert(*breakpoint, *hits)),
            Event::BreakpointSet { breakpoint } => {
                whole.breakpoints.insert(breakpoint.id, breakpoint.clone());
            }
            Event::BreakpointRemoved { id } => drop(whole.breakpoints.remove(id)),
            Event::Forced { path, outcome } => {
                whole.lets_go(path);
                self.skip(path, outcome.id);
            }
            Event::Dropped { path } => self.drop_state(path),
            Event::Root { hash, .. } => whole.root = Some(hash.clone()),
            Event::Commanded { envelope, answer } => {
                whole.commanded(envelope, answer);
                if let (Command::Preempt { path }, Answer::Applied) = (&envelope.command, answer) {
                    self.preempt(path);
                }
            }
            Event::DeadlinePassed { path, .. } | Event::LossRecovery { path, .. } => {
                self.preempt(path);
            }
            Event::Silence { link_ms, command_ms } => {
                let (link_ms, command_ms) = (*link_ms, *command_ms);
                whole.silence = Some(GroundSilence { link_ms, command_ms });
            }
            Event::Asked { question } => {
                whole.questions.insert(question.id, (**question).clone());
            }
            Event::Closed { id, .. } => drop(whole.questions.remove(id)),
            Event::Resumed { life, .. } => whole.resumed(*life),
            Event::Waiting { path, reason } => {
                whole.waiting.insert(path.clone(), reason.clone());
            }
            Event::Paused { paused: true } => whole.status = RunStatus::Paused,
            Event::Paused { paused: false } => whole.status = RunStatus::Running,
            Event::Stopping => whole.stops(self.sequence),
            Event::Finished { outcome, .. } => {
                whole.status = RunStatus::Finished;
                whole.outcome = Some(outcome.clone());
            }
            _ => {}
        }
    }
}

impl Whole {
    /// Removes data of the runner that died. The rest belongs to the run.
    fn resumed(&mut self, life: u32) {
        self.life = life;
        self.status = RunStatus::Running;
        if let Some(stop) = &mut self.stop {
            stop.repeats = true;
        }
        self.outcome = None;
        self.questions.clear();
        self.held.clear();
        self.waiting.clear();
    }
}
