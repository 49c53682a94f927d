//! All events of a run, from every source, in one queue.
//!
//! Each source has a thread. The queue is bounded, so that a slow terminal blocks the sources instead of filling the
//! memory.

use crate::console::{Key, UserAction};
use crate::follow::StopSignal;
use anyhow::{Context as _, Result};
use rafcon_protocol::{Hello, Stream, ToRunner, ToViewer, decode, encode, read_frame};
use rafcon_storage::journal::About;
use rafcon_storage::journal::stream::StreamReader;
use rafcon_supervisor::clock::since_1970_ms;
use rafcon_supervisor::{Exit, Process};
use rustix::event::{PollFd, PollFlags, Timespec};
use rustix::io::Errno;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGTSTP};
use signal_hook::iterator::Signals;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write as _};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Child;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::Duration;

/// Capacity of the queue of causes.
const QUEUE: usize = 256;
/// Maximum number of messages in one cause.
const BATCH: usize = 512;
/// Interval of checks that the keyboard belongs to this process group.
const KEYS_EVERY: Duration = Duration::from_millis(200);
/// Longer lines of raw output are cut into pieces.
const RAW_LINE: u64 = 64 * 1024;

/// Message about an engine that takes no inputs.
pub(crate) const STUCK: &str = "the run hangs: its process answers, but its engine takes no inputs; a stop ends the process if necessary";

/// An event of any source.
#[derive(Debug, PartialEq)]
pub(crate) enum Cause {
    /// First message of the runner, with its identity.
    Hello(Hello),
    /// Messages of the runner, in order.
    Messages(Vec<ToViewer>),
    /// Data of the runner that is not a valid message.
    Nonsense(String),
    /// The runner closed its connection.
    Silence,
    /// The connection to the run broke, with the reason. The follower reconnects.
    Cut(String),
    /// The connection is restored; with a message.
    Mended(String),
    /// The server revoked our access.
    Refused(String),
    /// A line of output that the runner did not log: after its run, or from a dying interpreter.
    Raw(Stream, String),
    /// The pipe ended: its holders have closed it.
    Drained(Stream),
    /// The runner's process ended.
    Exited(Exit),
    /// A signal: Ctrl-C or SIGTERM.
    Interrupt(StopSignal),
    /// A key of the terminal.
    Key(Key),
    /// The action of a key.
    UserAction(UserAction),
    /// The terminal hung up.
    HungUp,
    /// The user pressed Ctrl-Z.
    Suspend,
    /// A while passed without another cause.
    Tick,
}

/// A connection to an external run: its socket, or a server.
pub(crate) trait Line {
    /// Sends a message to the run without blocking. False if the queue was full and the message was dropped.
    fn say(&mut self, message: &ToRunner) -> Result<bool>;
}

/// Adds a message for a run to a queue without waiting. False if the queue is full. A disconnected receiver reports itself.
pub(crate) fn offer(queue: &SyncSender<ToRunner>, message: &ToRunner) -> bool {
    !matches!(queue.try_send(message.clone()), Err(TrySendError::Full(_)))
}

impl Line for UnixStream {
    /// Sends a message, dated by this computer's clock. A dead runner is detected by its silence.
    fn say(&mut self, message: &ToRunner) -> Result<bool> {
        let line = match message {
            ToRunner::Command(envelope) => {
                encode(&ToRunner::Command(envelope.clone().dated(since_1970_ms(), None)))
            }
            message => encode(message),
        };
        self.write_all(&line?).unwrap_or_default();
        Ok(true)
    }
}

/// A connection to the station of a robot's run. The station sets the expiry of commands over its link.
struct StationLine(UnixStream);

impl Line for StationLine {
    fn say(&mut self, message: &ToRunner) -> Result<bool> {
        self.0.write_all(&encode(message)?).unwrap_or_default();
        Ok(true)
    }
}

/// A connection to the run in this folder over its socket.
pub(crate) fn line_to(folder: &Path, control: UnixStream) -> Box<dyn Line> {
    let is_replica = About::read(folder).is_ok_and(|about| about.robot.is_some());
    if is_replica { Box::new(StationLine(control)) } else { Box::new(control) }
}

/// The queue with its sources. Events from sources of an earlier runner are dropped.
#[derive(Debug)]
pub(crate) struct EventQueue {
    queue: SyncSender<(u32, Cause)>,
    causes: Receiver<(u32, Cause)>,
    /// Number of the current runner.
    life: u32,
}

/// Number of sources that outlive runners.
const ALWAYS: u32 = 0;

impl EventQueue {
    /// Connects the signals, and the keyboard if there is one. Must be called before a runner is started, so that Ctrl-C
    /// never leaves a runner behind.
    pub(crate) fn new(has_keys: bool) -> Result<Self> {
        let signals = Signals::new([SIGINT, SIGTERM, SIGHUP, SIGTSTP]);
        let signals = signals.context("cannot listen to signals")?;
        let (queue, causes) = sync_channel(QUEUE);
        let wires = Self { queue, causes, life: ALWAYS };
        wires.source("signals", ALWAYS, move |queue| forward(signals, queue))?;
        if has_keys {
            wires.source("keys", ALWAYS, keys)?;
        }
        Ok(wires)
    }

    /// Connects a started runner, and replaces any before.
    pub(crate) fn connect(&mut self, process: Process) -> Result<()> {
        let Process { mut child, control } = process;
        let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
        let events = StreamReader::new(0, false, None);
        self.listen("messages", move |queue| {
            messages(control, queue, events)?;
            // Up to here the runner reads its own output.
            thread::scope(|scope| {
                scope.spawn(|| stdout.map(|stdout| raw(Stream::Stdout, stdout, queue)));
                stderr.map_or(Ok(()), |stderr| raw(Stream::Stderr, stderr, queue))
            })
        })?;
        self.source("exit", self.life, move |queue| exit(child, queue))
    }

    /// Connects an external runner; its run is in `folder`.
    pub(crate) fn join(&mut self, control: UnixStream, folder: Option<&Path>) -> Result<()> {
        let events = StreamReader::new(0, false, folder.map(Path::to_path_buf));
        self.listen("messages", move |queue| messages(control, queue, events))
    }

    /// Connects another source of causes about an external run.
    pub(crate) fn listen(
        &mut self,
        name: &str,
        work: impl FnOnce(&Queue) -> Flow + Send + 'static,
    ) -> Result<()> {
        self.life += 1;
        self.source(name, self.life, work)
    }

    /// The next cause; a tick if none arrives within `wait`.
    pub(crate) fn next(&self, wait: Option<Duration>) -> Cause {
        loop {
            let received = match wait {
                Some(wait) => self.causes.recv_timeout(wait),
                None => self.causes.recv().map_err(|_gone| RecvTimeoutError::Disconnected),
            };
            match received {
                Ok((life, cause)) if life == ALWAYS || life == self.life => return cause,
                Ok(_of_an_earlier_life) => {}
                Err(_nothing) => return Cause::Tick,
            }
        }
    }

    fn source(
        &self,
        name: &str,
        life: u32,
        work: impl FnOnce(&Queue) -> Flow + Send + 'static,
    ) -> Result<()> {
        let queue = Queue { queue: self.queue.clone(), life };
        thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || work(&queue).unwrap_or(()))
            .with_context(|| format!("cannot start a thread for {name}"))?;
        Ok(())
    }
}

/// The sending end of the queue for one source.
#[derive(Debug, Clone)]
pub(crate) struct Queue {
    queue: SyncSender<(u32, Cause)>,
    life: u32,
}

impl Queue {
    /// Adds a cause; waits while the queue is full.
    pub(crate) fn send(&self, cause: Cause) -> Flow {
        self.queue.send((self.life, cause)).map_err(|_gone| Gone)
    }
}

/// Reads the keys of the terminal, while this program is in the foreground.
fn keys(queue: &Queue) -> Flow {
    while let Some(in_front) = in_front() {
        if !in_front {
            thread::park_timeout(KEYS_EVERY);
            continue;
        }
        match has_input() {
            Some(false) => continue,
            Some(true) => {}
            None => break,
        }
        while let Ok(event) = crossterm::event::read() {
            if let Some(key) = Key::of(&event) {
                queue.send(Cause::Key(key))?;
            }
            if !crossterm::event::poll(Duration::ZERO).unwrap_or(false) {
                break;
            }
        }
    }
    Ok(())
}

/// True if input arrived within [`KEYS_EVERY`]. `None` if the terminal hung up: its input then stays at the end, and
/// reading it would loop forever.
fn has_input() -> Option<bool> {
    let stdin = std::io::stdin();
    let mut wanted = [PollFd::new(&stdin, PollFlags::IN)];
    let wait = Timespec::try_from(KEYS_EVERY).ok()?;
    match rustix::event::poll(&mut wanted, Some(&wait)) {
        Ok(_) | Err(Errno::INTR) => {}
        Err(_gone) => return None,
    }
    let seen = wanted[0].revents();
    let is_gone = seen.intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL);
    (!is_gone).then(|| seen.contains(PollFlags::IN))
}

/// True if the terminal's input belongs to this process group; reading it from the background would stop the program.
/// `None` if the terminal hung up.
fn in_front() -> Option<bool> {
    let group = rustix::termios::tcgetpgrp(std::io::stdin()).ok()?;
    Some(group == rustix::process::getpgrp())
}

/// The receiver has disconnected.
#[derive(Debug)]
pub(crate) struct Gone;

/// Result of a step: continue, or stop.
pub(crate) type Flow = Result<(), Gone>;

fn messages(control: UnixStream, queue: &Queue, mut events: StreamReader) -> Flow {
    let mut frames = BufReader::with_capacity(64 * 1024, control);
    if let Some(line) = line(&mut frames) {
        queue.send(decode(&line).map_or_else(nonsense, Cause::Hello))?;
    }
    let mut content = Vec::new();
    loop {
        match read_frame(&mut frames, &mut content) {
            Ok(Some(kind)) => {
                let mut batch = Vec::new();
                let read = events.read_frame(kind, &content, |message| batch.push(message));
                while !batch.is_empty() {
                    let rest = batch.split_off(batch.len().min(BATCH));
                    queue.send(Cause::Messages(std::mem::replace(&mut batch, rest)))?;
                }
                if let Err(bad) = read {
                    queue.send(nonsense(bad))?;
                }
            }
            Err(error) if error.kind() == ErrorKind::InvalidData => {
                queue.send(nonsense(error))?;
                return queue.send(Cause::Silence);
            }
            // A broken connection counts as closed.
            Ok(None) | Err(_) => return queue.send(Cause::Silence),
        }
    }
}

fn nonsense(error: impl std::error::Error) -> Cause {
    Cause::Nonsense(error.to_string())
}

/// The next line; `None` at the end or on a broken connection.
fn line(lines: &mut impl BufRead) -> Option<String> {
    let mut text = Vec::new();
    match lines.read_until(b'\n', &mut text) {
        Ok(0) | Err(_) => None,
        Ok(_) => Some(String::from_utf8_lossy(&text).into_owned()),
    }
}

fn raw(stream: Stream, pipe: impl Read, queue: &Queue) -> Flow {
    let mut pipe = BufReader::new(pipe);
    loop {
        let mut text = Vec::new();
        match pipe.by_ref().take(RAW_LINE).read_until(b'\n', &mut text) {
            Ok(0) | Err(_) => return queue.send(Cause::Drained(stream)),
            Ok(_) => {
                let text = String::from_utf8_lossy(&text);
                let text = text.trim_end_matches(['\n', '\r']).to_owned();
                queue.send(Cause::Raw(stream, text))?;
            }
        }
    }
}

fn exit(mut child: Child, queue: &Queue) -> Flow {
    let status = child.wait().unwrap_or_default();
    queue.send(Cause::Exited(Exit(status)))
}

fn forward(mut signals: Signals, queue: &Queue) -> Flow {
    for signal in signals.forever() {
        queue.send(match signal {
            SIGHUP => Cause::HungUp,
            SIGTSTP => Cause::Suspend,
            SIGINT => Cause::Interrupt(StopSignal::CtrlC),
            _ => Cause::Interrupt(StopSignal::Terminate),
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Cause, EventQueue, QUEUE};

    #[test]
    fn a_source_of_more_causes_than_the_queue_holds_waits_and_loses_none() {
        let mut queue = EventQueue::new(false).unwrap();
        let all = || (0..4 * QUEUE).map(|number| Cause::Nonsense(number.to_string()));
        queue.listen("flood", move |queue| all().try_for_each(|cause| queue.send(cause))).unwrap();
        all().for_each(|cause| assert_eq!(queue.next(None), cause));
    }
}
