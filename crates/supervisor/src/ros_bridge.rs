//! The process of the bridge to ROS 2: started beside a server, started again when it ends, ended with the server. Knows the
//! process; does not know what it speaks with the server or with ROS.
//!
//! Its standard input carries one line, its settings with the token, and stays open for as long as the server lives: at its end
//! the bridge ends, also when the server is killed. Each line that it writes is told.

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
/// How long a bridge may take for the last words to its peers; then it is killed.
const LAST_WORDS: Duration = Duration::from_secs(4);
/// Bytes of a line of the bridge that are told.
const LINE_MAX: u64 = 64 << 10;
/// The first pause before another is started; each further one is twice as long.
const PAUSE_MIN: Duration = Duration::from_secs(1);
/// So much news waits at most: one end, and that no bridge is wanted.
const NEWS_MAX: usize = 4;
/// The longest.
const PAUSE_MAX: Duration = Duration::from_mins(1);

/// What a bridge is started with.
#[derive(Debug, Clone)]
pub struct RosBridgeSettings {
    /// The interpreter of runs; none: as [`crate::Interpreter::choose`] does.
    pub python: Option<PathBuf>,
    /// What interpreter and extension are found by.
    pub surroundings: ProgramEnvironment,
    /// What it is told on its standard input, as JSON. It may hold secrets.
    pub told: serde_json::Value,
    /// Says a line to whoever started the server.
    pub tell: fn(&str),
}

/// The bridge, until dropped; then it says good-bye to its peers, and no run ends.
#[derive(Debug)]
pub struct RosBridge {
    news: SyncSender<News>,
    thread: Option<JoinHandle<()>>,
}

/// What the thread of a bridge waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum News {
    /// The process writes no more: it has ended, or is about to.
    Ended,
    /// No bridge is wanted any more.
    Stop,
}

impl RosBridge {
    /// Starts it, on a thread of its own.
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
        // A thread that has ended needs no news.
        self.news.send(News::Stop).unwrap_or_default();
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap_or_default();
        }
    }
}

/// Starts one bridge after the other, with pauses that grow while they end at once.
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

/// Waits for the end of a process; says why it has ended, or nothing if that was wanted.
fn attend(mut child: Child, stdin: ChildStdin, heard: &Receiver<News>) -> Option<String> {
    let is_wanted = heard.recv() == Ok(News::Ended);
    drop(stdin);
    if !is_wanted && heard.recv_timeout(LAST_WORDS).is_err() {
        // One that has ended meanwhile is what was wanted.
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
    let start = Start::find(settings.python.as_deref(), &settings.surroundings);
    let start = start.map_err(|error| no_bridge(&error.to_string()))?;
    let mut command = Command::new(&start.interpreter.program);
    command
        .args(["-c", BOOTSTRAP])
        .env("RAFCON_EXTENSION_FILE", &start.extension)
        .env("PYTHONUNBUFFERED", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .process_group(0);
    if let Some(program) = &settings.surroundings.program {
        command.env("RAFCON_BINARY", program);
    }
    // A socket that a runner is to inherit at this moment must not be inherited by this one.
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
    // One that has ended already is noticed by its output.
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

/// Tells each line until the output ends. A longer line than [`LINE_MAX`] is cut, and bytes that are no text are replaced.
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

/// Skips the rest of a line. Returns the number of its bytes without the end of the line.
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

    /// Where lines go: the settings take a plain function.
    static TOLD: Mutex<Option<SyncSender<String>>> = Mutex::new(None);
    /// One test at a time has it.
    static TURN: Mutex<()> = Mutex::new(());

    fn tell(line: &str) {
        let told = TOLD.lock().unwrap();
        told.as_ref().unwrap().send(line.to_owned()).unwrap_or_default();
    }

    /// A bridge whose interpreter is this script, and what is told.
    fn begun(script: &str) -> (TempDir, RosBridge, Receiver<String>) {
        let (sender, told) = sync_channel(64);
        *TOLD.lock().unwrap() = Some(sender);
        let folder = tempfile::tempdir().unwrap();
        let python = folder.path().join("python");
        fs::write(&python, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&python, fs::Permissions::from_mode(0o700)).unwrap();
        let bridge = RosBridge::begin(RosBridgeSettings {
            python: Some(python.clone()),
            surroundings: ProgramEnvironment {
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
