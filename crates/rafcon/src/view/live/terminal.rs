//! A picture below scrolling text on a terminal. Knows escape sequences and modes, nothing of runs.
//!
//! The picture occupies the last lines written. To redraw it, the cursor moves up to its first line and erases all below,
//! so that scrolled text stays in the terminal's own history. The terminal modes are restored on every exit.

use crate::view::text::{Paint, TextLine};
use crossterm::cursor::{Hide, MoveToColumn, MoveUp, Show};
use crossterm::queue;
use crossterm::terminal::{self, BeginSynchronizedUpdate, Clear, ClearType, EndSynchronizedUpdate};
use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcsetattr};
use std::io::{self, Stdout, Write as _};

/// Screen with the picture in its last lines.
#[derive(Debug)]
pub(super) struct Screen {
    out: Stdout,
    paint: Paint,
    /// Widths of the drawn lines of the picture.
    drawn: Vec<usize>,
    keyboard: Option<Keyboard>,
}

impl Screen {
    /// A screen on the standard output. The first drawing hides the cursor, and switches the terminal to single keys
    /// without echo. Ctrl-C and Ctrl-Z still work.
    pub(super) fn new(paint: Paint) -> Self {
        Self { out: io::stdout(), paint, drawn: Vec::new(), keyboard: None }
    }

    /// Columns and rows; 80 and 24 if unknown.
    pub(super) fn size() -> (usize, usize) {
        let (columns, rows) = terminal::size().unwrap_or((80, 24));
        (usize::from(columns.max(1)), usize::from(rows.max(1)))
    }

    /// Writes `above` permanently, and the picture below it.
    pub(super) fn draw(&mut self, above: &[TextLine], picture: &[TextLine]) -> io::Result<()> {
        if self.keyboard.is_none() {
            self.keyboard = Some(Keyboard::quiet());
            queue!(self.out, Hide)?;
        }
        queue!(self.out, BeginSynchronizedUpdate)?;
        self.erase()?;
        let mut text = String::new();
        for line in above {
            text += &line.render(self.paint);
            text += "\r\n";
        }
        let picture_text: Vec<String> =
            picture.iter().map(|line| line.render(self.paint)).collect();
        text += &picture_text.join("\r\n");
        self.out.write_all(text.as_bytes())?;
        self.drawn = picture.iter().map(TextLine::width).collect();
        queue!(self.out, EndSynchronizedUpdate)?;
        self.out.flush()
    }

    /// Removes the picture and restores the modes; the next drawing brings both back.
    pub(super) fn leave(&mut self) -> io::Result<()> {
        if self.keyboard.take().is_none() {
            return Ok(());
        }
        self.erase()?;
        queue!(self.out, Show)?;
        self.out.flush()
    }

    /// Moves the cursor to the first line of the picture and erases all below. A terminal that became narrower has wrapped
    /// lines.
    fn erase(&mut self) -> io::Result<()> {
        let (columns, rows) = Self::size();
        let folded = |width: &usize| width.div_ceil(columns).max(1);
        let lines: usize = self.drawn.drain(..).map(|width| folded(&width)).sum();
        let up = lines.saturating_sub(1).min(rows.saturating_sub(1));
        if let Some(up) = u16::try_from(up).ok().filter(|up| *up > 0) {
            queue!(self.out, MoveUp(up))?;
        }
        queue!(self.out, MoveToColumn(0), Clear(ClearType::FromCursorDown))
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // A closed terminal needs no restoration.
        self.leave().unwrap_or_default();
    }
}

/// Switches the keyboard to single keys without echo, until dropped.
#[derive(Debug)]
struct Keyboard {
    before: Option<Termios>,
}

impl Keyboard {
    fn quiet() -> Self {
        let before = tcgetattr(io::stdin()).ok();
        if let Some(before) = &before {
            let mut modes = before.clone();
            modes.local_modes -= LocalModes::ECHO | LocalModes::ICANON;
            tcsetattr(io::stdin(), OptionalActions::Now, &modes).unwrap_or_default();
        }
        Self { before }
    }
}

impl Drop for Keyboard {
    fn drop(&mut self) {
        if let Some(before) = &self.before {
            tcsetattr(io::stdin(), OptionalActions::Flush, before).unwrap_or_default();
        }
    }
}
