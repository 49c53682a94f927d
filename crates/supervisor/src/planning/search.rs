//! Engines as processes. Each leads its own process group and has a limit on time and on stored output. It is killed with all its
//! descendants at its end, after its time limit, and on cancellation.

use super::descendants::Descendants;
use super::engine::{Engine, Lane, PlanRequest};
use crate::clock;
use parking_lot::Mutex;
use rustix::process::{Pid, Signal, kill_process_group};
use std::io::{self, BufRead as _, BufReader, Read};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Longer lines are not plans.
const LINE_MAX: u64 = 8 << 20;
/// Size of the stored end of an engine's output besides plans, in bytes.
const SAID_BYTES: usize = 2048;
/// Time beyond the limit after which an engine is killed.
const GRACE: Duration = Duration::from_millis(300);
const QUEUE: usize = 16;

/// Cancels a search from another thread, also before it begins.
#[derive(Debug, Clone, Default)]
pub struct Cancel(Arc<Mutex<CancelState>>);

#[derive(Debug, Default)]
struct CancelState {
    is_cancelled: bool,
    wake: Option<SyncSender<Message>>,
}

impl Cancel {
    /// Cancels the search and kills all processes of the engine.
    pub fn cancel(&self) {
        let mut state = self.0.lock();
        state.is_cancelled = true;
        if let Some(wake) = &state.wake {
            // With a full queue, the search checks the flag before the next message.
            wake.try_send(Message::Cancelled).unwrap_or_default();
        }
    }

    /// True after a call of [`Self::cancel`].
    pub fn is_cancelled(&self) -> bool {
        self.0.lock().is_cancelled
    }
}

#[derive(Debug)]
enum Message {
    /// A line with the form of a plan.
    Line(usize, String),
    /// The output has ended. Contains the end of the other output.
    Closed(usize, String),
    /// The end of the error output.
    Error(usize, String),
    Cancelled,
}

/// The decision about a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Accept the plan and end the search.
    Enough,
    /// Accept the plan and search for a better one.
    More,
    /// Invalid plan: ends this lane.
    Wrong(String),
    /// A valid plan from which no machine can be built.
    Unfit(String),
}

/// The end of a search.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum SearchEnd {
    /// A plan was accepted, or the engine ended after one.
    Enough,
    /// The goal cannot be reached.
    Impossible(String),
    /// No plan was found in time.
    NotFound(String),
    /// The search failed, for this reason.
    Failed(String),
    Cancelled,
}

/// The effect of a message on a lane.
type Act = Box<dyn FnOnce(&mut Running)>;

/// A lane whose engine runs.
struct Running {
    child: Child,
    descendants: Descendants,
    /// The end of its error output, once that is closed.
    said: Option<String>,
    /// Its output besides plans.
    printed: String,
    wrong: Option<String>,
    has_ended: bool,
    /// Its exit status. `None` if it was killed.
    code: Option<i32>,
}

impl Running {
    fn new(child: Child, descendants: Descendants) -> Self {
        Self {
            child,
            descendants,
            said: None,
            printed: String::new(),
            wrong: None,
            has_ended: false,
            code: None,
        }
    }

    /// Its stored output, except plans.
    fn words(&self) -> String {
        let said = self.said.as_deref().unwrap_or_default();
        let lines = said.lines().chain(self.printed.lines());
        let lines: Vec<_> = lines.map(str::trim_end).filter(|line| !line.is_empty()).collect();
        match lines.as_slice() {
            [] => "it said nothing".to_owned(),
            [line] => line.trim().to_owned(),
            lines => format!("\n{}", lines.join("\n")),
        }
    }

    /// True if it exited with status 0 and printed nothing.
    fn is_mute(&self) -> bool {
        let said = self.said.as_deref().unwrap_or_default();
        self.code == Some(0) && said.trim().is_empty() && self.printed.trim().is_empty()
    }

    /// True if no output can follow.
    fn is_over(&self) -> bool {
        self.has_ended && (self.said.is_some() || self.wrong.is_some())
    }

    /// Kills the process and its descendants, and stores its exit status.
    fn end(&mut self) {
        if !self.has_ended {
            if let Some(group) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw) {
                // The group may no longer exist.
                kill_process_group(group, Signal::KILL).unwrap_or_default();
            }
            self.descendants.kill();
            self.has_ended = true;
            self.code = self.child.wait().ok().and_then(|status| status.code());
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.end();
    }
}

/// Searches with an engine until a plan is accepted.
pub(super) fn search(
    engine: &Engine,
    wish: &PlanRequest<'_>,
    cancel: &Cancel,
    on_plan: &mut dyn FnMut(&str) -> Verdict,
) -> SearchEnd {
    let (sender, receiver) = sync_channel(QUEUE);
    {
        let mut state = cancel.0.lock();
        if state.is_cancelled {
            return SearchEnd::Cancelled;
        }
        state.wake = Some(sender.clone());
    }
    let mut search = Search {
        engine,
        lanes: engine.lanes(wish).into_iter().enumerate().collect(),
        running: Vec::new(),
        found: 0,
        sender,
    };
    let end = search.run(wish.limit, &receiver, cancel, on_plan);
    cancel.0.lock().wake = None;
    end
}

struct Search<'s> {
    engine: &'s Engine,
    lanes: std::collections::VecDeque<(usize, Lane)>,
    running: Vec<(usize, Running)>,
    found: usize,
    /// Queue of the engines' output.
    sender: SyncSender<Message>,
}

impl Search<'_> {
    fn run(
        &mut self,
        limit: Duration,
        receiver: &Receiver<Message>,
        cancel: &Cancel,
        on_plan: &mut dyn FnMut(&str) -> Verdict,
    ) -> SearchEnd {
        let begin = clock::now();
        loop {
            if cancel.is_cancelled() {
                return SearchEnd::Cancelled;
            }
            let due = self.lanes.front().map(|(_, lane)| begin + lane.after);
            let idle = self.running.iter().all(|(_, running)| running.is_over());
            if self.found == 0 && due.is_some_and(|due| idle || clock::now() >= due) {
                if let Some(end) = self.start_next() {
                    return end;
                }
                continue;
            }
            if idle {
                return self.verdict();
            }
            let end = begin + limit + GRACE;
            let next = due.filter(|_| self.found == 0).map_or(end, |due| due.min(end));
            match receiver.recv_timeout(next.saturating_duration_since(clock::now())) {
                Ok(message) => {
                    if let Some(end) = self.take(message, on_plan) {
                        return end;
                    }
                }
                Err(RecvTimeoutError::Timeout) if clock::now() >= end => {
                    return self.out_of_time(limit);
                }
                Err(_) => {}
            }
        }
    }

    /// Starts the next lane. Returns the end of the search if that fails.
    fn start_next(&mut self) -> Option<SearchEnd> {
        let (index, lane) = self.lanes.pop_front()?;
        match start(index, &lane, &self.sender) {
            Ok(running) => {
                self.running.push((index, running));
                None
            }
            Err(error) => Some(SearchEnd::Failed(self.engine.missing(&error))),
        }
    }

    /// Handles a message. Returns the end of the search if the message ends it.
    fn take(
        &mut self,
        message: Message,
        on_plan: &mut dyn FnMut(&str) -> Verdict,
    ) -> Option<SearchEnd> {
        let (index, act): (usize, Act) = match message {
            Message::Cancelled => return None,
            Message::Error(index, said) => (index, Box::new(|running| running.said = Some(said))),
            Message::Closed(index, printed) => (
                index,
                Box::new(|running| {
                    running.printed = printed;
                    running.end();
                }),
            ),
            Message::Line(index, line) => match on_plan(&line) {
                Verdict::Enough => return Some(SearchEnd::Enough),
                Verdict::Unfit(why) => return Some(SearchEnd::Failed(why)),
                Verdict::More => {
                    self.found += 1;
                    return None;
                }
                Verdict::Wrong(why) => (
                    index,
                    Box::new(|running| {
                        running.wrong = Some(why);
                        running.end();
                    }),
                ),
            },
        };
        if let Some((_, running)) = self.running.iter_mut().find(|(at, _)| *at == index) {
            act(running);
        }
        None
    }

    fn out_of_time(&self, limit: Duration) -> SearchEnd {
        match self.found {
            0 => SearchEnd::NotFound(format!(
                "the engine `{}` has found no plan within {} s: give it more time (`--time-limit`), or fewer objects",
                self.engine.name,
                limit.as_secs_f64()
            )),
            _ => SearchEnd::Enough,
        }
    }

    /// The end of the search after all lanes have ended.
    fn verdict(&self) -> SearchEnd {
        let name = &self.engine.name;
        let lanes = || self.running.iter().map(|(_, running)| running);
        if self.found > 0 {
            return SearchEnd::Enough;
        }
        if let Some(wrong) = lanes().find_map(|running| running.wrong.as_ref()) {
            return SearchEnd::Failed(format!(
                "the engine `{name}` gave a plan that is not valid: {wrong}; choose another engine"
            ));
        }
        if let Some(missing) = lanes().find_map(|running| self.engine.is_missing(running.code)) {
            return SearchEnd::Failed(missing);
        }
        if lanes().any(|running| Engine::proves_impossible(running.code)) {
            return SearchEnd::Impossible(
                "the goal cannot be reached from these facts with these skills".to_owned(),
            );
        }
        if lanes().all(Running::is_mute) {
            return SearchEnd::Failed(format!(
                "the engine `{name}` ended without a plan and said nothing; choose another engine"
            ));
        }
        match lanes().find(|running| !Engine::found_none(running.code)) {
            Some(running) => {
                let how = running.code.map_or("was killed".to_owned(), |code| {
                    format!("ended with exit status {code}")
                });
                SearchEnd::Failed(format!("the engine `{name}` {how}: {}", running.words()))
            }
            None => SearchEnd::NotFound(format!(
                "the engine `{name}` has found no plan; most likely there is none"
            )),
        }
    }
}

fn start(index: usize, lane: &Lane, sender: &SyncSender<Message>) -> io::Result<Running> {
    let mut command = Command::new(&lane.program);
    // Its input is a pipe that closes with the caller, so the engine ends with it, even after a kill.
    command
        .args(&lane.arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .process_group(0);
    let descendants = Descendants::of(&mut command)?;
    let mut running = Running::new(command.spawn()?, descendants);
    let (stdout, stderr) = (running.child.stdout.take(), running.child.stderr.take());
    let tell = sender.clone();
    let started = thread::Builder::new()
        .name("engine".to_owned())
        .spawn(move || read_lines(stdout, index, &tell));
    let tell = sender.clone();
    // If a thread cannot be started, dropping `running` kills the engine.
    let _reads = started?;
    thread::Builder::new()
        .name("engine errors".to_owned())
        .spawn(move || read_errors(stderr, index, &tell))?;
    Ok(running)
}

/// Forwards lines of plans, and at the end the last bytes of all other output.
fn read_lines(from: Option<impl Read>, index: usize, tell: &SyncSender<Message>) {
    let mut reader = from.map(BufReader::new);
    let (mut line, mut other) = (Vec::new(), Vec::new());
    let mut is_rest = false;
    while let Some(reader) = &mut reader {
        line.clear();
        match reader.by_ref().take(LINE_MAX).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => break,
            Ok(_) => {}
        }
        let is_whole = line.ends_with(b"\n");
        let is_plan = !is_rest && line.starts_with(b"{") && (line.len() as u64) < LINE_MAX;
        is_rest = !is_whole;
        if is_plan
            && tell.send(Message::Line(index, String::from_utf8_lossy(&line).into_owned())).is_err()
        {
            return;
        }
        if !is_plan {
            keep(&mut other, &line);
        }
    }
    // The receiver may have been dropped.
    let other = String::from_utf8_lossy(&other).into_owned();
    tell.send(Message::Closed(index, other)).unwrap_or_default();
}

fn read_errors(from: Option<impl Read>, index: usize, tell: &SyncSender<Message>) {
    let mut kept: Vec<u8> = Vec::new();
    let mut part = [0; 4096];
    let mut from = from;
    while let Some(count) =
        from.as_mut().and_then(|from| from.read(&mut part).ok()).filter(|count| *count > 0)
    {
        keep(&mut kept, &part[..count]);
    }
    tell.send(Message::Error(index, String::from_utf8_lossy(&kept).into_owned()))
        .unwrap_or_default();
}

/// Appends to the stored output, and drops its beginning beyond the limit.
fn keep(kept: &mut Vec<u8>, more: &[u8]) {
    kept.extend_from_slice(more);
    let surplus = kept.len().saturating_sub(SAID_BYTES);
    kept.drain(..surplus);
}

/// Time since `begin`, in ms.
pub(super) fn millis_since(begin: Instant) -> u64 {
    u64::try_from(clock::now().saturating_duration_since(begin).as_millis()).unwrap_or(u64::MAX)
}
