//! An input line of the user, with its purpose.

use super::{Key, UserAction};
use crate::view::{Style, TextLine, harmless};
use rafcon_protocol::{Breakpoint, Command, Scope, Unattended, When};

/// Purpose of an input line.
#[derive(Debug)]
pub(super) enum Purpose {
    /// A new breakpoint: `STATE [after] [if CONDITION]`.
    Break { id: u64 },
    /// The number of a breakpoint to remove.
    Unbreak,
    /// A state to run to.
    RunTo,
    /// The id of an outcome for this state.
    Force { path: String },
}

/// A line in progress.
#[derive(Debug)]
pub(super) struct Prompt {
    purpose: Purpose,
    text: String,
    complaint: Option<String>,
}

/// Result of a key in a prompt.
#[derive(Debug)]
pub(super) enum PromptStep {
    More,
    Given(UserAction),
    Left,
}

impl Prompt {
    pub(super) fn new(purpose: Purpose, text: String) -> Self {
        Self { purpose, text, complaint: None }
    }

    pub(super) fn key(&mut self, key: Key) -> PromptStep {
        self.complaint = None;
        match key {
            Key::Escape => return PromptStep::Left,
            Key::Enter => match self.command() {
                Ok(command) => return PromptStep::Given(UserAction::Send(command)),
                Err(complaint) => self.complaint = Some(complaint),
            },
            Key::Backspace => drop(self.text.pop()),
            Key::Char(c) => self.text.push(c),
            Key::Up | Key::Down => {}
        }
        PromptStep::More
    }

    fn command(&self) -> Result<Command, String> {
        let text = self.text.trim();
        match &self.purpose {
            Purpose::Break { id } => {
                breakpoint(*id, text).map(|breakpoint| Command::SetBreakpoint { breakpoint })
            }
            Purpose::Unbreak => number(text, "the number of a breakpoint")
                .map(|id| Command::RemoveBreakpoint { id }),
            Purpose::RunTo if text.is_empty() => Err("write the path of the state".to_owned()),
            Purpose::RunTo => Ok(Command::RunTo { path: text.to_owned() }),
            Purpose::Force { path } => number(text, "the id of an outcome, such as 0 or -1")
                .map(|outcome| Command::ForceOutcome { path: path.clone(), outcome }),
        }
    }

    pub(super) fn lines(&self) -> Vec<TextLine> {
        let complaint = self.complaint.iter().map(|text| TextLine::of(Style::Bad, text.clone()));
        let question = match &self.purpose {
            Purpose::Break { .. } => "break at (STATE [after] [if CONDITION]): ".to_owned(),
            Purpose::Unbreak => "remove breakpoint: ".to_owned(),
            Purpose::RunTo => "run to: ".to_owned(),
            Purpose::Force { path } => format!("outcome of {}: ", harmless(path)),
        };
        let line = TextLine::of(Style::Strong, question).and(Style::Plain, harmless(&self.text));
        complaint.chain([line.and(Style::Dim, "_   Enter accepts, Escape cancels")]).collect()
    }
}

fn number<T: std::str::FromStr>(text: &str, what: &str) -> Result<T, String> {
    text.parse().map_err(|_no_number| format!("write {what}"))
}

/// Parses a breakpoint as people write it: `STATE [after] [if CONDITION]`.
pub(crate) fn breakpoint(id: u64, text: &str) -> Result<Breakpoint, String> {
    let (place, condition) = match text.split_once(" if ") {
        Some((place, condition)) => (place.trim(), Some(condition.trim().to_owned())),
        None => (text.trim(), None),
    };
    let (path, when) = match place.strip_suffix(" after") {
        Some(path) => (path.trim(), When::After),
        None => (place.strip_suffix(" before").unwrap_or(place).trim(), When::Before),
    };
    if path.is_empty() || condition.as_ref().is_some_and(String::is_empty) {
        return Err(
            "write STATE [after] [if CONDITION], such as ROOT/SCAN if inputs['n'] > 3".to_owned()
        );
    }
    Ok(Breakpoint {
        id,
        path: path.to_owned(),
        when,
        condition,
        hit_count: 0,
        scope: Scope::Branch,
        unattended: Unattended::Hold,
        lost_link_ms: None,
        enabled: true,
    })
}
