//! A run on a terminal: what is said scrolls by, below it stands the tree of active states.

mod frame;
mod terminal;

use super::lines::log_lines;
use super::text::{Line, Paint, Style, counted, harmless};
use super::{Names, View, summary};
use crate::supervisor::End;
use rafcon_protocol::{Event, LogLevel, Snapshot};
use std::io;
use std::time::Duration;
use terminal::Screen;

/// Lines that wait at most until they are drawn.
const PENDING: usize = 2000;
/// Time from one picture to the next.
const REDRAW: Duration = Duration::from_millis(100);

/// The picture and what scrolls above it.
#[derive(Debug)]
pub(crate) struct Live {
    screen: Screen,
    paint: Paint,
    names: Names,
    machine: String,
    above: Vec<Line>,
    snapshot: Option<(Duration, Snapshot)>,
    drawn_at: Option<Duration>,
    finished: Option<(Duration, Event)>,
}

impl Live {
    /// On the terminal that is the standard output.
    pub(crate) fn new(paint: Paint, names: Names) -> Self {
        Self {
            screen: Screen::new(paint),
            paint,
            names,
            machine: String::new(),
            above: Vec::new(),
            snapshot: None,
            drawn_at: None,
            finished: None,
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

    fn draw(&mut self, now: Duration) -> io::Result<()> {
        let (columns, rows) = Screen::size();
        // One column stays free: a full line would leave the cursor beyond it on some terminals.
        let (width, height) = (columns.saturating_sub(1), (rows * 2 / 3).max(1));
        let lines = self.snapshot.as_ref().map_or_else(Vec::new, |(at, snapshot)| {
            let age = now.saturating_sub(*at);
            let unicode = self.paint.unicode;
            frame::draw(
                &frame::Picture { machine: &self.machine, snapshot, age, unicode },
                width,
                height,
            )
        });
        self.screen.draw(&self.above, &lines)?;
        self.above.clear();
        Ok(())
    }
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
        let line = Line::of(Style::Strong, self.machine.clone())
            .and(Style::Dim, format!("  {}", counted(states, "state")));
        self.above.push(line);
        Ok(())
    }

    fn event(&mut self, time: Duration, event: Event) -> io::Result<()> {
        match event {
            Event::Log { path, level, message, .. } => self.say(time, &path, level, &message),
            Event::Waiting { path, reason } => {
                self.say(time, &path, LogLevel::Warning, &format!("waiting: {reason}"))
            }
            Event::Paused { paused } => {
                self.say(time, "", LogLevel::Info, if paused { "paused" } else { "goes on" })
            }
            Event::Stopping => self.say(time, "", LogLevel::Info, "stopping"),
            Event::Finished { .. } => {
                self.finished = Some((time, event));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn snapshot(&mut self, now: Duration, snapshot: Snapshot) -> io::Result<()> {
        self.snapshot = Some((now, snapshot));
        Ok(())
    }

    fn note(&mut self, text: &str) -> io::Result<()> {
        self.above.push(Line::of(Style::Warning, text));
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

    fn set_aside(&mut self) -> io::Result<()> {
        self.screen.leave()
    }

    fn end(&mut self, _end: &End) -> io::Result<()> {
        self.snapshot = None;
        if let Some((time, event)) = self.finished.take() {
            self.above.extend(summary::lines(&self.machine, time, &event));
        }
        self.draw(self.drawn_at.unwrap_or_default())?;
        self.screen.leave()
    }
}
