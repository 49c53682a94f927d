//! Input of an answer to a question of a state.

use super::prompt::PromptStep;
use super::{Key, UserAction};
use crate::view::{Style, TextLine, harmless};
use rafcon_protocol::{Command, Form, Question};
use serde_json::{Value, json};

/// A question in progress.
#[derive(Debug)]
pub(super) struct Answering {
    question: Question,
    text: String,
    checked: Vec<bool>,
    /// True if the text is complete and a button is still to be chosen.
    is_written: bool,
    complaint: Option<String>,
}

impl Answering {
    pub(super) fn new(question: &Question) -> Self {
        let (text, checked) = match &question.form {
            Form::Buttons { .. } => (String::new(), Vec::new()),
            Form::Text { initial, .. } => (initial.clone(), Vec::new()),
            Form::Number { initial, .. } => {
                (initial.map(|number| number.to_string()).unwrap_or_default(), Vec::new())
            }
            Form::Checks { boxes, initial, .. } => {
                let mut checked = initial.clone();
                checked.resize(boxes.len(), false);
                (String::new(), checked)
            }
        };
        let question = question.clone();
        Self { question, text, checked, is_written: false, complaint: None }
    }

    pub(super) fn key(&mut self, key: Key) -> PromptStep {
        self.complaint = None;
        match key {
            Key::Escape => PromptStep::Left,
            Key::Enter if self.buttons().len() == 1 => self.choose(0),
            Key::Enter => {
                self.is_written = true;
                PromptStep::More
            }
            Key::Backspace if self.writes() => {
                self.text.pop();
                PromptStep::More
            }
            Key::Char(c) if self.writes() => {
                self.text.push(c);
                PromptStep::More
            }
            Key::Char(c) => self.digit(c),
            Key::Backspace | Key::Up | Key::Down => PromptStep::More,
        }
    }

    fn writes(&self) -> bool {
        matches!(self.question.form, Form::Text { .. } | Form::Number { .. }) && !self.is_written
    }

    fn digit(&mut self, c: char) -> PromptStep {
        let Some(index) = c.to_digit(10).and_then(|digit| (digit as usize).checked_sub(1)) else {
            return PromptStep::More;
        };
        if !self.is_written
            && let Some(tick) = self.checked.get_mut(index)
        {
            *tick = !*tick;
            return PromptStep::More;
        }
        self.choose(index)
    }

    fn buttons(&self) -> &[String] {
        match &self.question.form {
            Form::Buttons { buttons }
            | Form::Text { buttons, .. }
            | Form::Number { buttons, .. }
            | Form::Checks { buttons, .. } => buttons,
        }
    }

    fn choose(&mut self, button: usize) -> PromptStep {
        if button >= self.buttons().len() {
            return PromptStep::More;
        }
        match self.value(button) {
            Ok(value) => {
                let question = self.question.id;
                PromptStep::Given(UserAction::Send(Command::AnswerQuestion { question, value }))
            }
            Err(complaint) => {
                self.complaint = Some(complaint);
                self.is_written = false;
                PromptStep::More
            }
        }
    }

    fn value(&self, button: usize) -> Result<Value, String> {
        Ok(match &self.question.form {
            Form::Buttons { .. } => json!({"button": button}),
            Form::Text { .. } => json!({"button": button, "text": self.text}),
            Form::Checks { .. } => json!({"button": button, "checked": self.checked}),
            Form::Number { .. } => {
                let number: serde_json::Number =
                    self.text.trim().parse().map_err(|_no_number| "write a number".to_owned())?;
                json!({"button": button, "number": number})
            }
        })
    }

    pub(super) fn lines(&self) -> Vec<TextLine> {
        let mut lines: Vec<TextLine> =
            self.complaint.iter().map(|text| TextLine::of(Style::Bad, text.clone())).collect();
        lines.push(TextLine::of(Style::Strong, harmless(&self.question.message)));
        if let Form::Checks { boxes, .. } = &self.question.form {
            lines.extend((1..).zip(boxes.iter().zip(&self.checked)).map(|(n, (label, tick))| {
                let tick = if *tick { 'x' } else { ' ' };
                TextLine::of(Style::Plain, format!("  {n} [{tick}] {}", harmless(label)))
            }));
        }
        if matches!(self.question.form, Form::Text { .. } | Form::Number { .. }) {
            let cursor = if self.writes() { "_" } else { "" };
            lines.push(TextLine::of(Style::Plain, format!("  > {}{cursor}", harmless(&self.text))));
        }
        lines.push(self.hint());
        lines
    }

    fn hint(&self) -> TextLine {
        let buttons = self.buttons();
        let ready = self.is_written || matches!(self.question.form, Form::Buttons { .. });
        let text = match buttons {
            [one] => format!("Enter {}", harmless(one)),
            _ if ready => {
                let button = |(n, label): (i32, &String)| format!("{n} {}", harmless(label));
                (1..).zip(buttons).map(button).collect::<Vec<_>>().join("   ")
            }
            _ => "Enter moves to the buttons".to_owned(),
        };
        TextLine::of(Style::Good, text).and(Style::Dim, "   Escape leaves the question open")
    }
}
