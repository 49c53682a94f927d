//! The process of the bridge to ROS 2: started with a server, restarted when it ends, and stopped with the server. Knows the
//! process; does not know its communication with the server or ROS.
//!
//! Its standard input carries one line, its settings with the token, and stays open while the server lives. The bridge ends when the
//! input closes, also after a kill of the server. Each line of its output is logged.

use crate::process::{INHERITING, Start};
use crate::{ProgramEnvironment, StartError, clock};
use std::io::{self, BufRead, BufReader, Read, Write as _};
use std::os::unix::process::CommandExt as _;
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

const BOOTSTRAP: &str = include_str!("ros_bridge.py");
/// Time limit for a bridge to leave its peers. Then it is killed.
const LAST_WORDS: Duration = Duration::from_secs(4);
/// Maximum size of a logged line, in bytes.
const LINE_MAX: u64 = 64 << 10;
/// First pause before a restart. Each further pause is twice as long.
const PAUSE_MIN: Duration = Duration::from_secs(1);
/// Capacity of the queue of events: an end of the process, and a stop.
const NEWS_MAX: usize = 4;
/// The longest pause before a restart.
const PAUSE_MAX: Duration = Duration::from_mins(1);

/// Settings of a bridge.
#[derive(Debug, Clone)]
pub struct RosBridgeSettings {
    /// The interpreter of runs. `None`: selected by [`crate::Interpreter::choose`].
    pub python: Option<PathBuf>,
    /// Environment in which interpreter and extension are searched.
    pub environment: ProgramEnvironment,
    /// Settings that it receives on its standard input, as JSON. They may contain secrets.
    pub told: serde_json::Value,
    /// Logs a line for the operator of the server.
    pub tell: fn(&str),
}

/// The bridge. Dropping it lets it leave its peers; runs are not affected.
#[derive(Debug)]
pub struct RosBridge {
    news: SyncSender<News>,
    thread: Option<JoinHandle<()>>,
}

/// An event for the thread of a bridge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum News {
    /// The output is closed: the process has ended or is about to.
    Ended,
    /// The bridge must stop.
    Stop,
}

impl RosBridge {
    /// Starts the bridge on a separate thread.
    pub fn begin(settings: RosBridgeSettings) -> io::Result<Self> {
        let (news, heard) = sync_channel(NEWS_MAX);
        let from_process = news.clone();
        let work = move || keep(&settings, &from_process, &heard);
        let thread = thread::Builder::new().name("ros bridge".to_owned()).spawn(work)?;
        Ok(Self { news, thread: Some(thread) })
    }
}

impl Drop for RosBridge {
    fn drop(&mut self) {
        // The thread may have ended.
        self.news.send(News::Stop).unwrap_or_default();
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap_or_default();
        }
    }
}

/// Starts bridges one after the other. The pauses grow while they end at once.
fn keep(settings: &RosBridgeSettings, news: &SyncSender<News>, heard: &Receiver<News>) {
    let mut pause = PAUSE_MIN;
    let mut told = String::new();
    loop {
        let begun = clock::now();
        let why = match started(settings, news) {
            Ok((child, stdin)) => match attend(child, stdin, heard) {
                Some(why) => why,
                None => return,
            },
            Err(why) => why,
        };
        if begun.elapsed() > PAUSE_MAX {
            pause = PAUSE_MIN;
        }
        if why != told {
            (settings.tell)(&format!(
                "{why}. Runs continue; it is started again in {} s, then in longer and longer times",
                pause.as_secs()
            ));
            told = why;
        }
        if heard.recv_timeout(pause) != Err(RecvTimeoutError::Timeout) {
            return;
        }
        pause = (pause * 2).min(PAUSE_MAX);
    }
}

/// Waits for the end of a process. Returns the reason, or `None` if the bridge was stopped.
fn attend(mut child: Child, stdin: ChildStdin, heard: &Receiver<News>) -> Option<String> {
    let is_wanted = heard.recv() == Ok(News::Ended);
    drop(stdin);
    if !is_wanted && heard.recv_timeout(LAST_WORDS).is_err() {
        // It may have exited meanwhile.
        child.kill().unwrap_or_default();
    }
    let ended = child.wait();
    let how =
        ended.map_or_else(|error| error.to_string(), |status| crate::Exit(status).to_string());
    is_wanted.then(|| format!("the bridge to ROS has ended ({how})"))
}

fn started(
    settings: &RosBridgeSettings,
    news: &SyncSender<News>,
) -> Result<(Child, ChildStdin), String> {
    let start = Start::find(settings.python.as_deref(), &settings.environment);
    let start = start.map_err(|error| no_bridge(&error.to_string()))?;
    let mut command = Command::new(&start.interpreter.program);
    command
        .args(["-c", BOOTSTRAP])
        .env("RAFCON_EXTENSION_FILE", &start.extension)
        .env("PYTHONUNBUFFERED", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .process_group(0);
    if let Some(program) = &settings.environment.program {
        command.env("RAFCON_BINARY", program);
    }
    // This process must not inherit a socket that another thread is passing to a runner.
    let spawned = {
        let _inheriting = INHERITING.lock();
        command.spawn()
    };
    let mut child = spawned.map_err(|source| {
        let error = StartError::Interpreter { interpreter: start.interpreter, source };
        no_bridge(&error.to_string())
    })?;
    let piped = child.stdin.take().zip(child.stdout.take());
    let (mut stdin, stdout) = piped.ok_or_else(|| no_bridge("it has no pipes"))?;
    // A process that has already exited is detected by the end of its output.
    stdin.write_all(format!("{}\n", settings.told).as_bytes()).unwrap_or_default();
    let (tell, news) = (settings.tell, news.clone());
    let listen = move || {
        tell_lines(stdout, tell);
        news.send(News::Ended).unwrap_or_default();
    };
    let listening = thread::Builder::new().name("ros bridge output".to_owned()).spawn(listen);
    if let Err(error) = listening {
        child.kill().and_then(|()| child.wait().map(drop)).unwrap_or_default();
        return Err(no_bridge(&error.to_string()));
    }
    Ok((child, stdin))
}

/// Logs each line until the output ends. Cuts lines longer than [`LINE_MAX`], and replaces invalid bytes.
fn tell_lines(output: impl Read, mut tell: impl FnMut(&str)) {
    let mut output = BufReader::new(output);
    let mut line = Vec::new();
    loop {
        line.clear();
        let Ok(1..) = output.by_ref().take(LINE_MAX).read_until(b'\n', &mut line) else { return };
        let missing = if line.ends_with(b"\n") { 0 } else { skip_line(&mut output) };
        let mut text = String::from_utf8_lossy(&line).trim_end_matches(['\r', '\n']).to_owned();
        if missing > 0 {
            let rest = format!("… ({missing} more bytes)");
            text.push_str(&rest);
        }
        tell(&text);
    }
}

/// Skips the rest of a line. Returns the number of its bytes, without the line end.
fn skip_line(output: &mut impl BufRead) -> usize {
    let mut skipped = 0;
    loop {
        let part = match output.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Ok([]) | Err(_) => return skipped,
            Ok(part) => part,
        };
        let end = part.iter().position(|byte| *byte == b'\n');
        let (length, is_end) = (end.unwrap_or(part.len()), end.is_some());
        output.consume(length + usize::from(is_end));
        skipped += length;
        if is_end {
            return skipped;
        }
    }
}

fn no_bridge(why: &str) -> String {
    format!("the bridge to ROS cannot be started: {why}")
}

#[cfg(test)]
mod tests {
    use super::{LINE_MAX, RosBridge, RosBridgeSettings, tell_lines};
    use crate::ProgramEnvironment;
    use std::fs;
    use std::os::unix::fs::PermissionsExt as _;
    use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
    use std::sync::{Mutex, PoisonError};
    use tempfile::TempDir;

    /// Receiver of logged lines: the settings accept only a plain function.
    static TOLD: Mutex<Option<SyncSender<String>>> = Mutex::new(None);
    /// Held by one test at a time.
    static TURN: Mutex<()> = Mutex::new(());

    fn tell(line: &str) {
        let told = TOLD.lock().unwrap();
        told.as_ref().unwrap().send(line.to_owned()).unwrap_or_default();
    }

    /// A bridge whose interpreter is this script, and the logged lines.
    fn begun(script: &str) -> (TempDir, RosBridge, Receiver<String>) {
        let (sender, told) = sync_channel(64);
        *TOLD.lock().unwrap() = Some(sender);
        let folder = tempfile::tempdir().unwrap();
        let python = folder.path().join("python");
        fs::write(&python, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&python, fs::Permissions::from_mode(0o700)).unwrap();
        let bridge = RosBridge::begin(RosBridgeSettings {
            python: Some(python.clone()),
            environment: ProgramEnvironment {
                extension: Some(python),
                ..ProgramEnvironment::default()
            },
            told: serde_json::json!({"token": "secret"}),
            tell,
        });
        (folder, bridge.unwrap(), told)
    }

    #[test]
    fn it_is_told_by_its_input_and_ends_with_it() {
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let (_folder, bridge, told) = begun("read line; echo \"$line\"; cat; echo good-bye");
        assert_eq!(told.recv().unwrap(), r#"{"token":"secret"}"#);
        drop(bridge);
        assert_eq!(told.recv().unwrap(), "good-bye");
    }

    #[test]
    fn another_is_started_and_an_end_that_repeats_is_told_once() {
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let (_folder, bridge, told) = begun("read line; echo up; exit 3");
        let lines: Vec<_> = told.iter().take(3).collect();
        let ended = "the bridge to ROS has ended (exit status 3). Runs continue; it is started again in 1 s, then in longer and longer times";
        assert_eq!(lines, ["up", ended, "up"]);
        drop(bridge);
    }

    #[test]
    fn a_long_line_is_cut_and_says_how_much_is_missing() {
        let most = usize::try_from(LINE_MAX).unwrap();
        let check = |text: &str, lines: &[String]| {
            let mut told = Vec::new();
            tell_lines(text.as_bytes(), |line| told.push(line.to_owned()));
            assert_eq!(told, lines);
        };
        let (whole, rest) = ("x".repeat(most), "y".repeat(100_000));
        check(&format!("{whole}\nup"), &[whole.clone(), "up".to_owned()]);
        let cut = format!("{whole}… (100000 more bytes)");
        check(&format!("{whole}{rest}\nup\n"), &[cut.clone(), "up".to_owned()]);
        check(&format!("{whole}{rest}"), &[cut]);
        check("\na\r\n", &[String::new(), "a".to_owned()]);
    }

    #[test]
    fn a_line_that_is_no_text_is_told_and_the_bridge_continues() {
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let (_folder, bridge, told) =
            begun("read line; printf 'k\\374che\\n'; echo up; cat; echo good-bye");
        let lines: Vec<_> = told.iter().take(2).collect();
        assert_eq!(lines, ["k\u{fffd}che", "up"]);
        drop(bridge);
        assert_eq!(told.recv().unwrap(), "good-bye");
    }

    #[test]
    fn one_that_cannot_be_started_is_told() {
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let (folder, bridge, told) = begun("exit 0");
        told.recv().unwrap();
        fs::remove_file(folder.path().join("python")).unwrap();
        let line = told.recv().unwrap();
        assert!(
            line.starts_with(
                "the bridge to ROS cannot be started: cannot find the Python extension"
            ),
            "{line}"
        );
        drop(bridge);
    }
}
