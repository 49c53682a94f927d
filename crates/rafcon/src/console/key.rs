//! Keys as the console knows them.

use crossterm::event::{Event, KeyCode, KeyEventKind, KeyModifiers};

/// A key that was pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Key {
    /// A character.
    Char(char),
    /// Return.
    Enter,
    /// Escape.
    Escape,
    /// Rub out.
    Backspace,
    /// Arrow up.
    Up,
    /// Arrow down.
    Down,
}

impl Key {
    /// The key of a terminal's event, if it is one that means something here.
    pub(crate) fn of(event: &Event) -> Option<Self> {
        let key = event.as_key_event().filter(|key| key.kind != KeyEventKind::Release)?;
        if key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT) {
            return None;
        }
        Some(match key.code {
            KeyCode::Char(c) => Self::Char(c),
            KeyCode::Enter => Self::Enter,
            KeyCode::Esc => Self::Escape,
            KeyCode::Backspace => Self::Backspace,
            KeyCode::Up => Self::Up,
            KeyCode::Down => Self::Down,
            _ => return None,
        })
    }
}
