//! The keyboard of a user who watches a run: the actions of keys, the next input, and the lines that show both.
//!
//! Knows keys, snapshots and commands. Knows nothing of terminals or sockets: input is keys, output is actions.

mod answering;
mod key;
mod overlays;
mod prompt;
#[cfg(test)]
mod tests;

use crate::view::{Style, TextLine};
use answering::Answering;
pub(crate) use key::Key;
pub(crate) use prompt::breakpoint;
use prompt::{Prompt, PromptStep, Purpose};
use rafcon_protocol::{ActiveState, Command, OnCrash, Phase, RunStatus, Snapshot, StateData};

/// Result of a key.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum UserAction {
    /// Send this command to the run.
    Send(Command),
    /// Request the data of this state.
    Inspect(String),
    /// End this view; the run continues if others may join it.
    Leave,
    /// Show the user a message.
    Say(String),
}

/// Current purpose of the keys.
#[derive(Debug)]
enum Mode {
    Watch,
    Help,
    Look { path: String, data: Data },
    Write(Prompt),
    Answer(Answering),
}

/// Data of a state, as far as it is known.
#[derive(Debug)]
enum Data {
    Asked,
    NotActive,
    Told(StateData),
}

/// Mode and selection of the keyboard.
#[derive(Debug)]
pub(crate) struct Console {
    mode: Mode,
    /// Path of the selected state.
    selected: Option<String>,
    /// True if the run continues when the user leaves.
    may_leave: bool,
}

impl Console {
    /// A console of a run that can be left (`may_leave`) or ends with this program.
    pub(crate) fn new(may_leave: bool) -> Self {
        Self { mode: Mode::Watch, selected: None, may_leave }
    }

    /// Path of the selected state, if it is still active.
    pub(crate) fn selected<'s>(&self, snapshot: &'s Snapshot) -> Option<&'s str> {
        let chosen = self.selected.as_deref();
        let found = snapshot.active.iter().find(|state| Some(state.path.as_str()) == chosen);
        let held = || snapshot.active.iter().rfind(|state| state.phase == Phase::Held);
        found.or_else(held).or(snapshot.active.last()).map(|state| state.path.as_str())
    }

    /// Handles one key; `order` are the paths of the active states as shown.
    pub(crate) fn key(
        &mut self,
        key: Key,
        snapshot: &Snapshot,
        order: &[&str],
    ) -> Option<UserAction> {
        match &mut self.mode {
            Mode::Watch => self.watch(key, snapshot, order),
            Mode::Help => {
                self.mode = Mode::Watch;
                None
            }
            Mode::Look { .. } => match key {
                Key::Up | Key::Down => {
                    self.move_selection(key == Key::Down, snapshot, order);
                    self.look(snapshot)
                }
                _ => {
                    self.mode = Mode::Watch;
                    None
                }
            },
            Mode::Write(prompt) => {
                let step = prompt.key(key);
                self.written(step)
            }
            Mode::Answer(answering) => {
                let step = answering.key(key);
                self.written(step)
            }
        }
    }

    /// Handles a step of a prompt: it is complete, cancelled, or continues.
    fn written(&mut self, step: PromptStep) -> Option<UserAction> {
        let wish = match step {
            PromptStep::More => return None,
            PromptStep::Given(wish) => Some(wish),
            PromptStep::Left => None,
        };
        self.mode = Mode::Watch;
        wish
    }

    fn watch(&mut self, key: Key, snapshot: &Snapshot, order: &[&str]) -> Option<UserAction> {
        let branch = || self.branch(snapshot);
        let send = |command| Some(UserAction::Send(command));
        match key {
            Key::Char('p') => send(Command::Pause),
            Key::Char('c' | ' ') => send(Command::Resume { branch: None }),
            Key::Char('C') => send(Command::Resume { branch: branch() }),
            Key::Char('s') => send(Command::StepInto { branch: None }),
            Key::Char('S') => send(Command::StepInto { branch: branch() }),
            Key::Char('n') => send(Command::StepOver { branch: None }),
            Key::Char('N') => send(Command::StepOver { branch: branch() }),
            Key::Char('o') => send(Command::StepOut { branch: None }),
            Key::Char('O') => send(Command::StepOut { branch: branch() }),
            Key::Char('b') => send(Command::StepBack { branch: None }),
            Key::Char('B') => send(Command::StepBack { branch: branch() }),
            Key::Char('m') => send(Command::StepMode),
            Key::Char('X') => send(Command::Stop),
            Key::Char('A') => send(Command::Recover { path: None, policy: OnCrash::Abort }),
            Key::Char('R') => send(Command::Recover { path: None, policy: OnCrash::Restart }),
            Key::Char('e') => {
                let path = self.selected(snapshot)?.to_owned();
                send(Command::Preempt { path })
            }
            Key::Char('q') if self.may_leave => Some(UserAction::Leave),
            Key::Up | Key::Down => {
                self.move_selection(key == Key::Down, snapshot, order);
                None
            }
            _ => self.open(key, snapshot),
        }
    }

    /// Handles keys that open a prompt or overlay.
    fn open(&mut self, key: Key, snapshot: &Snapshot) -> Option<UserAction> {
        let target = self.target(snapshot);
        match key {
            Key::Char('?' | 'h') => self.mode = Mode::Help,
            Key::Char('i') | Key::Enter => return self.look(snapshot),
            Key::Char('k') => {
                let id = snapshot.breakpoints.iter().map(|b| b.id).max().unwrap_or(0) + 1;
                self.mode = Mode::Write(Prompt::new(Purpose::Break { id }, target));
            }
            Key::Char('K') => self.mode = Mode::Write(Prompt::new(Purpose::Unbreak, String::new())),
            Key::Char('t') => self.mode = Mode::Write(Prompt::new(Purpose::RunTo, target)),
            Key::Char('f') => {
                self.mode =
                    Mode::Write(Prompt::new(Purpose::Force { path: target }, String::new()));
            }
            Key::Char('a') => match snapshot.questions.first() {
                Some(question) => self.mode = Mode::Answer(Answering::new(question)),
                None => return Some(UserAction::Say("no question waits for an answer".to_owned())),
            },
            _ => {}
        }
        None
    }

    fn look(&mut self, snapshot: &Snapshot) -> Option<UserAction> {
        let path = self.selected(snapshot)?.to_owned();
        self.mode = Mode::Look { path: path.clone(), data: Data::Asked };
        Some(UserAction::Inspect(path))
    }

    /// Stores the data of a state, if it was requested.
    pub(crate) fn inspected(&mut self, about: &str, answer: Option<StateData>) {
        if let Mode::Look { path, data } = &mut self.mode
            && path == about
        {
            *data = answer.map_or(Data::NotActive, Data::Told);
        }
    }

    /// The state before which the selected one is held, or the selected one itself.
    fn target(&self, snapshot: &Snapshot) -> String {
        let state = self.state(snapshot);
        let next = state.and_then(|state| state.held.iter().find_map(|hold| hold.next.as_deref()));
        next.or(state.map(|state| state.path.as_str())).unwrap_or_default().to_owned()
    }

    fn state<'s>(&self, snapshot: &'s Snapshot) -> Option<&'s ActiveState> {
        let path = self.selected(snapshot)?;
        snapshot.active.iter().find(|state| state.path == path)
    }

    fn branch(&self, snapshot: &Snapshot) -> Option<String> {
        let branch = &self.state(snapshot)?.branch;
        (!branch.is_empty()).then(|| branch.clone())
    }

    fn move_selection(&mut self, down: bool, snapshot: &Snapshot, order: &[&str]) {
        let at = self.selected(snapshot).and_then(|path| order.iter().position(|o| *o == path));
        let next = match at {
            Some(at) if down => (at + 1).min(order.len().saturating_sub(1)),
            Some(at) => at.saturating_sub(1),
            None => 0,
        };
        self.selected = order.get(next).map(|path| (*path).to_owned());
    }

    /// The lines below the picture, the most important last.
    pub(crate) fn lines(&self, snapshot: &Snapshot) -> Vec<TextLine> {
        match &self.mode {
            Mode::Watch => self.watching(snapshot),
            Mode::Help => overlays::help(self.may_leave),
            Mode::Look { path, data } => overlays::inspection(path, data),
            Mode::Write(prompt) => prompt.lines(),
            Mode::Answer(answering) => answering.lines(),
        }
    }

    fn watching(&self, snapshot: &Snapshot) -> Vec<TextLine> {
        let mut lines = Vec::new();
        if let Some(problem) = &snapshot.journal_problem {
            lines.push(TextLine::of(
                Style::Bad,
                format!("the journal cannot be written: {problem}"),
            ));
        }
        for question in &snapshot.questions {
            lines.push(
                TextLine::of(Style::Warning, "? ").and(Style::Strong, question.message.clone()),
            );
        }
        lines.push(self.hint(snapshot));
        lines
    }

    fn hint(&self, snapshot: &Snapshot) -> TextLine {
        let mut keys: Vec<&str> = Vec::new();
        if !snapshot.questions.is_empty() {
            keys.push("a answer");
        }
        if snapshot.active.iter().any(|state| state.phase == Phase::Interrupted) {
            keys.extend(["A abort", "R run again"]);
        }
        let is_held = snapshot.active.iter().any(|state| state.phase == Phase::Held);
        let is_paused =
            is_held || matches!(snapshot.status, RunStatus::Paused | RunStatus::Stepping);
        if is_paused {
            keys.extend(["s step", "n over", "o out", "b back", "c continue"]);
        } else {
            keys.push("p pause");
        }
        keys.extend(["i data", "? keys"]);
        if self.may_leave {
            keys.push("q leave");
        }
        TextLine::of(Style::Dim, keys.join("   "))
    }
}
