//! A run on a terminal: messages scroll above the tree of active states.

mod frame;
mod terminal;

use super::lines::log_lines;
use super::text::{Paint, Style, TextLine, counted, harmless, time};
use super::words::{notable, summary};
use super::{Names, View};
use crate::console::{Console, Key, UserAction};
use crate::follow::End;
use rafcon_protocol::{Command, Event, LogLevel, Snapshot, StateData};
use std::collections::BTreeMap;
use std::io;
use std::time::Duration;
use terminal::Screen;

/// Maximum number of lines that wait for drawing.
const PENDING: usize = 2000;
/// Minimum time between two pictures.
const REDRAW: Duration = Duration::from_millis(100);

/// The picture and the scrolling lines above it.
#[derive(Debug)]
pub(crate) struct Live {
    screen: Screen,
    paint: Paint,
    names: Names,
    machine: String,
    above: Vec<TextLine>,
    snapshot: Option<(Duration, Snapshot)>,
    drawn_at: Option<Duration>,
    finished: Option<(Duration, Event)>,
    /// Time of the last contact, while the run does not respond.
    silent_since: Option<Duration>,
    /// Handler of the keyboard, if it is used.
    console: Option<Console>,
}

impl Live {
    /// A view on the terminal of the standard output.
    pub(crate) fn new(paint: Paint, names: Names, console: Option<Console>) -> Self {
        Self {
            screen: Screen::new(paint),
            paint,
            names,
            machine: String::new(),
            above: Vec::new(),
            snapshot: None,
            drawn_at: None,
            finished: None,
            silent_since: None,
            console,
        }
    }

    /// Replaces the names of a command by paths of ids.
    fn by_path(&mut self, mut command: Command) -> UserAction {
        let path = match &mut command {
            Command::RunTo { path } => path,
            Command::SetBreakpoint { breakpoint } => &mut breakpoint.path,
            _ => return UserAction::Send(command),
        };
        match self.names.resolve(path) {
            Ok(found) => {
                *path = found;
                UserAction::Send(command)
            }
            Err(reason) => UserAction::Say(reason),
        }
    }

    fn say(&mut self, time: Duration, path: &str, level: LogLevel, text: &str) -> io::Result<()> {
        let names = self.names.path(path);
        let name = names.rsplit('/').next().unwrap_or_default();
        self.above.extend(log_lines(time, name, level, text));
        if self.above.len() > PENDING {
            self.draw(self.drawn_at.unwrap_or_default())
        } else {
            Ok(())
        }
    }

    /// Names of the next states of held branches.
    fn names_of_nexts(&mut self) -> BTreeMap<String, String> {
        let active = self.snapshot.iter().flat_map(|(_, snapshot)| &snapshot.active);
        let nexts = active.flat_map(|state| &state.held).filter_map(|hold| hold.next.clone());
        let mut named = |path: String| (path.clone(), self.names.path(&path).to_string());
        nexts.map(&mut named).collect()
    }

    fn draw(&mut self, now: Duration) -> io::Result<()> {
        let (columns, rows) = Screen::size();
        // One column stays free: on some terminals a full line moves the cursor beyond it.
        let (width, height) = (columns.saturating_sub(1), (rows * 2 / 3).max(1));
        let names = self.names_of_nexts();
        let lines = self.snapshot.as_ref().map_or_else(Vec::new, |(at, snapshot)| {
            let age = self.silent_since.unwrap_or(now).saturating_sub(*at);
            let unicode = self.paint.unicode;
            let console = self.console.as_ref();
            let mut below = console.map(|console| console.lines(snapshot)).unwrap_or_default();
            below.extend(self.silent_since.map(|since| silence(now.saturating_sub(since))));
            let selected = console.and_then(|console| console.selected(snapshot));
            let machine = &self.machine;
            let picture =
                frame::Picture { machine, snapshot, age, unicode, names: &names, selected };
            let mut lines = frame::draw(&picture, width, height.saturating_sub(below.len()).max(1));
            lines.extend(below.into_iter().map(|line| line.cut(width)));
            lines
        });
        self.screen.draw(&self.above, &lines)?;
        self.above.clear();
        Ok(())
    }
}

/// Warning below an outdated picture.
fn silence(age: Duration) -> TextLine {
    TextLine::of(Style::Bad, format!("no connection: this view is {} old", time(age)))
}

impl View for Live {
    fn every_event(&self) -> bool {
        false
    }

    fn rhythm(&self) -> Option<Duration> {
        Some(REDRAW)
    }

    fn loaded(&mut self, name: &str, states: u64) -> io::Result<()> {
        self.machine = harmless(name);
        let line = TextLine::of(Style::Strong, self.machine.clone()).and(
            Style::Dim,
            if states > 0 { format!("  {}", counted(states, "state")) } else { String::new() },
        );
        self.above.push(line);
        Ok(())
    }

    fn event(&mut self, time: Duration, event: Event) -> io::Result<()> {
        self.names.hear(&event);
        match event {
            Event::Log { path, level, message, .. } => self.say(time, &path, level, &message),
            Event::Finished { .. } => {
                self.finished = Some((time, event));
                Ok(())
            }
            event => match notable(&event) {
                Some((path, level, words)) => self.say(time, path, level, &words),
                None => Ok(()),
            },
        }
    }

    fn snapshot(&mut self, now: Duration, snapshot: Snapshot) -> io::Result<()> {
        self.snapshot = Some((now, snapshot));
        Ok(())
    }

    fn heard(&mut self, now: Duration, silence: Option<Duration>) -> io::Result<()> {
        let since = silence.map(|age| now.saturating_sub(age));
        self.silent_since = since.map(|since| self.silent_since.unwrap_or(since).min(since));
        self.drawn_at = None;
        Ok(())
    }

    fn note(&mut self, text: &str) -> io::Result<()> {
        self.above.push(TextLine::of(Style::Warning, text));
        self.draw(self.drawn_at.unwrap_or_default())
    }

    fn refresh(&mut self, now: Duration) -> io::Result<()> {
        let due = self.drawn_at.is_none_or(|at| now >= at + REDRAW);
        if self.snapshot.is_none() && self.above.is_empty() || !due {
            return Ok(());
        }
        self.drawn_at = Some(now);
        self.draw(now)
    }

    fn key(&mut self, key: Key) -> Option<UserAction> {
        let (_, snapshot) = self.snapshot.as_ref()?;
        let order = frame::order(&snapshot.active);
        let wish = self.console.as_mut()?.key(key, snapshot, &order);
        self.drawn_at = None;
        match wish {
            Some(UserAction::Send(command)) => Some(self.by_path(command)),
            wish => wish,
        }
    }

    fn inspected(&mut self, path: &str, data: Option<StateData>) -> io::Result<()> {
        if let Some(console) = &mut self.console {
            console.inspected(path, data);
        }
        self.drawn_at = None;
        Ok(())
    }

    fn set_aside(&mut self) -> io::Result<()> {
        self.screen.leave()
    }

    fn end(&mut self, _end: &End) -> io::Result<()> {
        self.snapshot = None;
        if let Some((time, event)) = self.finished.take() {
            self.above.extend(summary(&self.machine, time, &event));
        }
        self.draw(self.drawn_at.unwrap_or_default())?;
        self.screen.leave()
    }
}
