//! Everything that can happen during a run, from every source, as one queue.
//!
//! One thread a source; the queue has a bound, so that a slow terminal holds the sources back and not this memory.

use super::Process;
use anyhow::{Context as _, Result};
use rafcon_protocol::{Hello, Stream, ToViewer, decode};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGTSTP};
use signal_hook::iterator::Signals;
use std::fmt;
use std::io::{BufRead as _, BufReader, Read};
use std::os::unix::net::UnixStream;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Child, ExitStatus};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

/// How many causes wait at most.
const QUEUE: usize = 256;
/// How many messages are handed over at once at most.
const BATCH: usize = 512;
/// Longer lines of raw output are cut into pieces.
const RAW_LINE: u64 = 64 * 1024;

/// Something that happened.
#[derive(Debug)]
pub(crate) enum Cause {
    /// The runner said who it is.
    Hello(Hello),
    /// The runner said something, in order.
    Messages(Vec<ToViewer>),
    /// The runner said something that is no message.
    Nonsense(String),
    /// The runner says nothing more.
    Silence,
    /// The runner's process wrote a line past its capture: an extension in C, a child, a dying interpreter.
    Raw(Stream, String),
    /// Nothing more comes from that pipe: whoever held it has closed it.
    Drained(Stream),
    /// The runner's process ended.
    Exited(Exit),
    /// Ctrl-C, or a polite request to end.
    Interrupt,
    /// The terminal is gone.
    HungUp,
    /// Ctrl-Z.
    Suspend,
    /// Nothing, for a while.
    Tick,
}

/// How a process ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Exit(pub(crate) ExitStatus);

impl fmt::Display for Exit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.0.signal(), self.0.code()) {
            (Some(signal), _) => {
                let name = signal_hook::low_level::signal_name(signal).unwrap_or("unknown signal");
                write!(f, "killed by signal {signal} ({name})")
            }
            (None, Some(code)) => write!(f, "exit status {code}"),
            (None, None) => f.write_str("ended"),
        }
    }
}

/// Listens to signals from now on; to be called before a runner is started, so that none is left alone by Ctrl-C.
pub(crate) fn signals() -> Result<Signals> {
    Signals::new([SIGINT, SIGTERM, SIGHUP, SIGTSTP]).context("cannot listen to signals")
}

/// Connects every source to one queue.
pub(crate) fn connect(process: Process, signals: Signals) -> Result<Receiver<Cause>> {
    let (queue, causes) = sync_channel(QUEUE);
    let Process { mut child, control } = process;
    let stdout = child.stdout.take();
    let stderr = child.stderr.take();
    source("messages", &queue, move |queue| messages(control, queue))?;
    if let Some(stdout) = stdout {
        source("stdout", &queue, move |queue| raw(Stream::Stdout, stdout, queue))?;
    }
    if let Some(stderr) = stderr {
        source("stderr", &queue, move |queue| raw(Stream::Stderr, stderr, queue))?;
    }
    source("exit", &queue, move |queue| exit(child, queue))?;
    source("signals", &queue, move |queue| forward(signals, queue))?;
    Ok(causes)
}

/// The other end went away: nobody wants to know any more.
struct Gone;

type Flow = Result<(), Gone>;

fn source(
    name: &str,
    queue: &SyncSender<Cause>,
    work: impl FnOnce(&SyncSender<Cause>) -> Flow + Send + 'static,
) -> Result<()> {
    let queue = queue.clone();
    thread::Builder::new()
        .name(name.to_owned())
        .spawn(move || work(&queue).unwrap_or(()))
        .with_context(|| format!("cannot start a thread for {name}"))?;
    Ok(())
}

fn send(queue: &SyncSender<Cause>, cause: Cause) -> Flow {
    queue.send(cause).map_err(|_gone| Gone)
}

fn messages(control: UnixStream, queue: &SyncSender<Cause>) -> Flow {
    let mut lines = BufReader::with_capacity(64 * 1024, control);
    if let Some(line) = line(&mut lines) {
        send(queue, decode(&line).map_or_else(nonsense, Cause::Hello))?;
    }
    while let Some(first) = line(&mut lines) {
        let mut batch = Vec::new();
        let mut next = Some(first);
        while let Some(text) = next {
            match decode(&text) {
                Ok(message) => batch.push(message),
                Err(error) => send(queue, nonsense(error))?,
            }
            let more = batch.len() < BATCH && lines.buffer().contains(&b'\n');
            next = if more { line(&mut lines) } else { None };
        }
        send(queue, Cause::Messages(batch))?;
    }
    send(queue, Cause::Silence)
}

#[expect(clippy::needless_pass_by_value, reason = "it is the mapping of an error")]
fn nonsense(error: rafcon_protocol::FrameError) -> Cause {
    Cause::Nonsense(error.to_string())
}

/// The next line; nothing at the end, which a broken connection is too.
fn line(lines: &mut BufReader<UnixStream>) -> Option<String> {
    let mut text = Vec::new();
    match lines.read_until(b'\n', &mut text) {
        Ok(0) | Err(_) => None,
        Ok(_) => Some(String::from_utf8_lossy(&text).into_owned()),
    }
}

fn raw(stream: Stream, pipe: impl Read, queue: &SyncSender<Cause>) -> Flow {
    let mut pipe = BufReader::new(pipe);
    loop {
        let mut text = Vec::new();
        match pipe.by_ref().take(RAW_LINE).read_until(b'\n', &mut text) {
            Ok(0) | Err(_) => return send(queue, Cause::Drained(stream)),
            Ok(_) => {
                let text = String::from_utf8_lossy(&text);
                let text = text.trim_end_matches(['\n', '\r']).to_owned();
                send(queue, Cause::Raw(stream, text))?;
            }
        }
    }
}

fn exit(mut child: Child, queue: &SyncSender<Cause>) -> Flow {
    let status = child.wait().unwrap_or_default();
    send(queue, Cause::Exited(Exit(status)))
}

fn forward(mut signals: Signals, queue: &SyncSender<Cause>) -> Flow {
    for signal in signals.forever() {
        send(
            queue,
            match signal {
                SIGHUP => Cause::HungUp,
                SIGTSTP => Cause::Suspend,
                _ => Cause::Interrupt,
            },
        )?;
    }
    Ok(())
}
