//! A detached runner and its run, observed through the files and processes that outlive its starter.

use rafcon_protocol::{
    Answer, Command, Envelope, Event, FrameKind, Hello, Join, Launch, ToRunner, ToViewer, decode,
    encode, read_frame,
};
use rafcon_storage::journal::stream::StreamReader;
use rafcon_storage::{Naming, save};
use rafcon_supervisor::{
    Exit, Interpreter, NoExtension, Process, ProgramEnvironment, Start, begin, connect,
    find_extension, is_alive,
};
use rafcon_testkit::notation;
use rustix::process::{Pid, getpgid};
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};

const MACHINE: &str = r#"execution LONELY "Lonely"
  outcome success
  script |
    import os
    def execute(self, inputs, outputs, gvm):
        os.write(1, b"past every capture\n")
        return 0
"#;

/// The extension that was built together with this test.
fn extension() -> Result<PathBuf, NoExtension> {
    let test = std::env::current_exe().unwrap();
    let program = test.parent().and_then(Path::parent).map(|folder| folder.join("rafcon"));
    find_extension(&ProgramEnvironment { program, ..ProgramEnvironment::default() })
}

fn spawn(extension: &Path, output: &Path) -> Process {
    let interpreter = Interpreter::choose(None, &ProgramEnvironment::default()).unwrap();
    let extension = extension.to_path_buf();
    Start { interpreter, extension }.spawn_detached(output).unwrap()
}

/// A run that is paused before its first state, in a folder that outlives its starter.
fn held(folder: &Path) -> Launch {
    let (machine, run) = (folder.join("machine"), folder.join("run"));
    save(&notation::parse(MACHINE).unwrap(), &machine, None, Naming::default()).unwrap();
    fs::create_dir(&run).unwrap();
    Launch { machine, run_folder: Some(run), hold: true, listen: true, ..Launch::default() }
}

/// The messages of the runner after its hello.
fn messages(control: UnixStream) -> impl Iterator<Item = ToViewer> {
    let mut runner = BufReader::new(control);
    let mut hello = String::new();
    runner.read_line(&mut hello).unwrap();
    decode::<Hello>(&hello).unwrap().check().unwrap();
    let (mut events, mut content) = (StreamReader::new(0, false, None), Vec::new());
    let frames = std::iter::from_fn(move || {
        let mut messages = Vec::new();
        let kind = read_frame(&mut runner, &mut content).unwrap()?;
        assert_ne!(kind, FrameKind::Unknown);
        events.read_frame(kind, &content, |message| messages.push(message)).unwrap();
        Some(messages)
    });
    frames.flatten()
}

fn say(mut control: &UnixStream, words: &[u8]) {
    control.write_all(words).unwrap();
}

#[test]
fn a_run_outlives_whoever_started_it() {
    let place = tempfile::tempdir().unwrap();
    let launch = held(place.path());
    let run = launch.run_folder.clone().unwrap();
    let output = run.join("output");
    let mut process = spawn(&extension().unwrap(), &output);
    let child = Pid::from_child(&process.child);
    assert_eq!(getpgid(Some(child)).unwrap(), child);
    begin(&process.control, launch).unwrap();
    let mut told = messages(process.control);
    assert!(matches!(told.next(), Some(ToViewer::Loaded { .. })));
    drop(told);
    assert!(is_alive(&output));

    let control = connect(&run).unwrap();
    say(&control, &encode(&Hello::ours()).unwrap());
    let join = Join { from: 1, every_event: true };
    say(&control, &encode(&ToRunner::Join(join)).unwrap());
    let resume = Envelope::new("1", "ana", Command::Resume { branch: None });
    say(&control, &encode(&ToRunner::Command(resume)).unwrap());
    let told: Vec<_> = messages(control).collect();
    let is_applied = |message: &ToViewer| matches!(message, ToViewer::Answer { id, answer: Answer::Applied } if id == "1");
    let is_end = |message: &ToViewer| matches!(message, ToViewer::Event { event: Event::Finished { outcome, .. }, .. } if outcome.id == 0);
    assert!(told.iter().any(is_applied) && told.iter().any(is_end), "{told:?}");

    assert_eq!(Exit(process.child.wait().unwrap()).to_string(), "exit status 0");
    assert!(!is_alive(&output));
    assert_eq!(fs::read_to_string(&output).unwrap(), "past every capture\n");
    assert_eq!(fs::metadata(&output).unwrap().permissions().mode() & 0o777, 0o600);
}

#[test]
fn what_an_interpreter_says_that_is_no_runner_is_added_to_the_output() {
    let place = tempfile::tempdir().unwrap();
    let output = place.path().join("output");
    for lives in 1..=2 {
        let mut process = spawn(Path::new("/nowhere/extension.so"), &output);
        assert!(process.child.stdin.is_none() && process.child.stdout.is_none());
        assert_eq!(Exit(process.child.wait().unwrap()).to_string(), "exit status 78");
        assert!(process.child.stderr.is_none() && !is_alive(&output));
        let said = fs::read_to_string(&output).unwrap();
        assert_eq!(said.matches("/nowhere/extension.so cannot be loaded by").count(), lives);
    }
}

#[test]
fn a_group_that_is_killed_is_not_alive() {
    let place = tempfile::tempdir().unwrap();
    let output = place.path().join("output");
    let mut process = spawn(&extension().unwrap(), &output);
    assert!(is_alive(&output));
    process.group().kill();
    let exit = Exit(process.child.wait().unwrap());
    assert_eq!(exit.to_string(), "killed by signal 9 (SIGKILL)");
    assert!(!is_alive(&output));
}

#[test]
fn an_output_that_cannot_be_opened_is_named() {
    let interpreter = Interpreter::choose(None, &ProgramEnvironment::default()).unwrap();
    let start = Start { interpreter, extension: PathBuf::from("/nowhere/extension.so") };
    let error = start.spawn_detached(Path::new("/nowhere/output")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "cannot open /nowhere/output for the output of the runner: its folder must exist and belong to you"
    );
}
