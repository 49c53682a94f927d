//! One machine in a temporary folder, one call of the program, one answer. The only place that knows how it is called.

use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::io::{BufRead as _, BufReader, Lines};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Output, Stdio};

/// A folder that goes away with it, with a machine in `machine` and a home without configuration.
pub(crate) struct Place {
    folder: tempfile::TempDir,
}

/// What the program said.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Place {
    /// A place without a machine.
    pub(crate) fn empty() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A place with the machine of this notation.
    pub(crate) fn with(text: &str) -> Self {
        let place = Self::empty();
        let machine = notation::parse(text).unwrap();
        save(&machine, &place.machine(), None, Naming::default()).unwrap();
        place
    }

    /// A place with a root of one script that has the outcomes `success` (0) and `failure` (1).
    pub(crate) fn with_script(script: &str) -> Self {
        Self::with(&one_script(script))
    }

    pub(crate) fn machine(&self) -> PathBuf {
        self.folder.path().join("machine")
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file, relative to the machine's folder.
    pub(crate) fn write(&self, file: impl AsRef<Path>, text: &str) {
        let file = self.machine().join(file);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    }

    /// The program with these words, in this place; `MACHINE` stands for the machine's folder.
    pub(crate) fn command(&self, words: &str) -> Command {
        let machine = self.machine().display().to_string();
        let mut command = Command::new(env!("CARGO_BIN_EXE_rafcon"));
        command.args(words.split_whitespace().map(|word| word.replace("MACHINE", &machine)));
        command.current_dir(self.folder.path()).env("HOME", self.folder.path());
        command.env("PYTHONDONTWRITEBYTECODE", "1").stdin(Stdio::null());
        for name in ["VIRTUAL_ENV", "RAFCON_PYTHON", "RAFCON_EXTENSION", "RAFCON_LIB_PATH"] {
            command.env_remove(name);
        }
        for name in ["RAFCON_RUNS", "XDG_STATE_HOME"] {
            command.env_remove(name);
        }
        for name in ["RAFCON_LIBRARY_PATH", "RAFCON_PLUGIN_PATH", "LC_ALL"] {
            command.env_remove(name);
        }
        command.env("LANG", "C.UTF-8").env("USER", "owner");
        command
    }

    /// Calls the program and waits for its end.
    pub(crate) fn call(&self, words: &str) -> Answer {
        self.answer(&self.command(words).output().unwrap())
    }

    /// Runs the machine with JSON output.
    pub(crate) fn run(&self, more: &str) -> Answer {
        assert_extension();
        self.call(&format!("run MACHINE --output json {more}"))
    }

    /// The ids of the runs that are kept here.
    fn runs(&self) -> Vec<String> {
        let folder = self.path(".local/state/rafcon/runs");
        let entries = std::fs::read_dir(folder).into_iter().flatten().map(Result::unwrap);
        entries.map(|entry| entry.file_name().into_string().unwrap()).collect()
    }

    pub(crate) fn answer(&self, output: &Output) -> Answer {
        let folder = self.folder.path().display().to_string();
        let runs = self.runs();
        let text = |bytes: &[u8]| {
            let text = String::from_utf8_lossy(bytes).replace(&folder, "PLACE");
            runs.iter().fold(text, |text, run| text.replace(run, "RUN"))
        };
        Answer {
            code: output.status.code(),
            stdout: text(&output.stdout),
            stderr: text(&output.stderr),
        }
    }
}

/// The same command, after these words of a shell in its process: limits, say.
pub(crate) fn after(command: &Command, words: &str) -> Command {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("{words}; exec \"$0\" \"$@\"")]);
    shell.arg(command.get_program()).args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => shell.env(name, value),
            None => shell.env_remove(name),
        };
    }
    shell.current_dir(command.get_current_dir().unwrap()).stdin(Stdio::null());
    shell
}

impl Answer {
    /// The lines of a JSON run.
    pub(crate) fn events(&self) -> Vec<Value> {
        self.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// The last line of a JSON run.
    pub(crate) fn last(&self) -> Value {
        self.events().pop().unwrap_or_else(|| panic!("nothing was printed: {}", self.stderr))
    }

    /// Messages of the log, one below the other.
    pub(crate) fn log(&self) -> String {
        let events = self.events();
        let messages = events.iter().filter(|event| event["type"] == "log");
        messages.flat_map(|event| [event["message"].as_str().unwrap(), "\n"]).collect()
    }

    /// Exit code, outcome and error output, for expectations.
    pub(crate) fn ending(&self) -> String {
        let last = self.last();
        let outcome = last["outcome"]["name"].as_str().map(|name| format!(" {name}"));
        let outcome = outcome.unwrap_or_default();
        let kind = last["type"].as_str().unwrap_or_default();
        format!("{} {kind}{outcome}\n{}", self.code.unwrap_or(-1), self.stderr)
    }
}

/// A run with JSON output in the background, read line by line.
pub(crate) struct Run {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Run {
    pub(crate) fn start(place: &Place, more: &str) -> Self {
        assert_extension();
        Self::of(place.command(&format!("run MACHINE --output json {more}")))
    }

    /// Any command that runs something.
    pub(crate) fn of(mut command: Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        Self { child, lines }
    }

    /// The next line with `word`.
    pub(crate) fn wait_for(&mut self, word: &str) -> String {
        self.wait_for_one_of(&[word.to_owned()]).unwrap()
    }

    /// The next line with one of the words.
    pub(crate) fn wait_for_one_of(&mut self, words: &[String]) -> Option<String> {
        let said = |line: &String| words.iter().any(|word| line.contains(word));
        self.lines.by_ref().map(Result::unwrap).find(said)
    }

    /// The next line, if there is one more.
    pub(crate) fn next_line(&mut self) -> Option<String> {
        self.lines.next().map(Result::unwrap)
    }

    /// The number of the program's process.
    fn id(&self) -> u32 {
        self.child.id()
    }

    /// The process of the runner, if it is there.
    pub(crate) fn runner(&self) -> Option<Pid> {
        let own = self.id();
        let children = std::fs::read_to_string(format!("/proc/{own}/task/{own}/children")).ok()?;
        Pid::from_raw(children.split_whitespace().next()?.parse().ok()?)
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.child), signal).unwrap();
    }

    /// Closes the output and waits for the exit code.
    pub(crate) fn end_unread(mut self) -> Option<i32> {
        drop(self.lines);
        self.child.wait().unwrap().code()
    }

    /// Exit code, what is left of the output, and the error output.
    pub(crate) fn end(self) -> (Option<i32>, Vec<String>, String) {
        let lines = self.lines.map(Result::unwrap).collect();
        let output = self.child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), lines, said)
    }
}

/// See [`Place::with_script`].
pub(crate) fn one_script(script: &str) -> String {
    let lines = script.trim_matches('\n').lines();
    let script: String = lines.flat_map(|line| ["    ", line, "\n"]).collect();
    format!(
        "execution LONELY \"Lonely\"\n  outcome success\n  outcome failure\n  script |\n{script}"
    )
}

/// Fails with words that help if the extension was not built.
pub(crate) fn assert_extension() {
    let binary = Path::new(env!("CARGO_BIN_EXE_rafcon"));
    let extension = binary.with_file_name("librafcon_python.so");
    assert!(extension.exists(), "build the extension first: cargo build --workspace");
}

/// A machine of so many states, one a millisecond; each has a value that only those are told who ask for values.
pub(crate) fn ticks(count: u64) -> String {
    TICKS.replace("TICKS", &count.to_string())
}

const TICKS: &str = r#"
hierarchy ROOT "Ticks"
  outcome success
  var n: int = 0
  start -> TICKXX
  TICKXX.more -> TICKXX ; TICKXX.enough -> .success
  flow .n -> TICKXX.n
  flow TICKXX.n -> .n
  execution TICKXX "Tick"
    outcome more
    outcome enough
    in n: int = 0
    out n: int
    script |
      import sys, time
      def execute(self, inputs, outputs, gvm):
          n = outputs["n"] = inputs["n"] + 1
          if n == 1:
              sys.began = time.perf_counter()
          time.sleep(max(0, sys.began + n / 1000 - time.perf_counter()))
          return "more" if n < TICKS else "enough"
"#;
