//! The live view on a real terminal of a chosen size, byte by byte as the terminal gets it.

use crate::harness::Place;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, Winsize, tcgetattr, tcsetwinsize};
use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::{AsFd as _, OwnedFd};
use std::process::{Child, Command};

/// Both ends of a terminal.
struct Terminal {
    ours: File,
    theirs: File,
}

impl Terminal {
    fn new(columns: u16, rows: u16) -> Self {
        let ours: OwnedFd = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&ours).unwrap();
        unlockpt(&ours).unwrap();
        let name = ptsname(&ours, Vec::new()).unwrap();
        let theirs = File::options().read(true).write(true).open(name.to_str().unwrap()).unwrap();
        let size = Winsize { ws_row: rows, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
        tcsetwinsize(&ours, size).unwrap();
        Self { ours: File::from(ours), theirs }
    }

    fn run(&self, place: &Place, words: &str) -> Child {
        let end = || self.theirs.try_clone().unwrap();
        let mut command = place.command(words);
        command.env("TERM", "xterm").env_remove("NO_COLOR");
        command.stdin(end()).stdout(end()).stderr(end()).spawn().unwrap()
    }

    /// The same with this terminal as its own, which reads keys.
    fn run_in_front(&self, place: &Place, words: &str) -> Child {
        let end = || self.theirs.try_clone().unwrap();
        let plain = place.command(words);
        let mut command = Command::new("setsid");
        command.args(["--ctty", "--wait"]).arg(plain.get_program()).args(plain.get_args());
        command.current_dir(plain.get_current_dir().unwrap());
        for (name, value) in plain.get_envs() {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        command.env("TERM", "xterm").env_remove("NO_COLOR");
        command.stdin(end()).stdout(end()).stderr(end()).spawn().unwrap()
    }

    fn echoes(&self) -> bool {
        tcgetattr(self.theirs.as_fd()).unwrap().local_modes.contains(LocalModes::ECHO)
    }

    /// Answers the question that is shown.
    fn answer(&mut self, text: &str) {
        self.read_until("a answer");
        self.ours.write_all(b"a").unwrap();
        self.read_until("> _");
        self.ours.write_all(format!("{text}\r").as_bytes()).unwrap();
    }

    /// Reads until `word` was written.
    fn read_until(&mut self, word: &str) -> String {
        let mut seen = Vec::new();
        let mut byte = [0; 1];
        while !String::from_utf8_lossy(&seen).ends_with(word) {
            self.ours.read_exact(&mut byte).unwrap();
            seen.push(byte[0]);
        }
        String::from_utf8_lossy(&seen).into_owned()
    }
}

const TREE: &str = r#"
    hierarchy ROOT "Mission"
      outcome success
      start -> INSIDE
      INSIDE.success -> .success
      hierarchy INSIDE "Explore the whole wide world and what lies behind it"
        outcome success
        start -> WAITED
        WAITED.success -> .success
        execution WAITED "Wait"
          outcome success
          script |
            def execute(self, inputs, outputs, gvm):
                self.logger.warning("look \x1b[2J out")
                with open("go"):
                    pass
                return "success"
"#;

/// The machine [`TREE`] on a terminal, up to where it waits for someone who opens `go`.
fn waiting() -> (Place, Terminal, Child, String) {
    let place = Place::with(TREE);
    let go = place.path("go");
    rustix::fs::mkfifoat(rustix::fs::CWD, &go, rustix::fs::Mode::RWXU).unwrap();
    let mut terminal = Terminal::new(40, 10);
    let child = terminal.run(&place, "run MACHINE");
    let seen = terminal.read_until("\x1b[32m> \x1b[0m\x1b[1mWait");
    (place, terminal, child, seen)
}

fn has_thread(child: &Child, name: &str) -> bool {
    let threads = std::fs::read_dir(format!("/proc/{}/task", child.id())).unwrap().flatten();
    let mut names = threads.map(|thread| std::fs::read_to_string(thread.path().join("comm")));
    names.any(|found| found.is_ok_and(|found| found.trim() == name))
}

#[test]
fn a_terminal_that_goes_away_leaves_the_run_alive() {
    let (place, terminal, mut child, _) = waiting();
    drop(terminal);
    // A keyboard that is gone is not asked again and again.
    while has_thread(&child, "keys") {
        std::thread::yield_now();
    }
    File::options().write(true).open(place.path("go")).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_small_terminal_shows_the_tree_and_is_put_back() {
    let (place, mut terminal, mut child, seen) = waiting();
    assert!(seen.contains("Mission"), "{seen}");
    assert!(seen.contains("Explore the whole wide wor"), "{seen}");
    assert!(!seen.contains("what lies behind"), "{seen}");
    let warned = "look \\u{1b}[2J out";
    let seen = if seen.contains(warned) { seen } else { terminal.read_until(warned) };
    assert!(!seen.contains("look \x1b"), "{seen}");
    assert!(!terminal.echoes());
    File::options().write(true).open(place.path("go")).unwrap();
    let rest = terminal.read_until("\x1b[?25h");
    assert!(rest.contains("\x1b[32msuccess (0)"), "{rest}");
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(terminal.echoes());
}

#[test]
fn a_script_reads_what_the_user_types() {
    let place = Place::with_script(
        "def execute(self, inputs, outputs, gvm):\n    print('Your name', end='')\n    print('hello', input('? '))\n    return 0",
    );
    let mut terminal = Terminal::new(80, 24);
    let mut child = terminal.run_in_front(&place, "run MACHINE");
    terminal.read_until("Your name?");
    terminal.answer("Ada");
    terminal.read_until("hello Ada");
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_script_is_debugged_at_the_terminal() {
    for stop in ["breakpoint()", "import pdb; pdb.set_trace()"] {
        let place = Place::with_script(&format!(
            "def execute(self, inputs, outputs, gvm):\n    n = 6\n    {stop}\n    n += 1\n    return 0"
        ));
        let mut terminal = Terminal::new(80, 24);
        let mut child = terminal.run_in_front(&place, "run MACHINE");
        terminal.answer("p n * 700 ;; continue");
        terminal.read_until("4200");
        terminal.read_until("success (0)");
        assert_eq!(child.wait().unwrap().code(), Some(0));
    }
}

#[test]
fn a_terminal_without_cursor_gets_lines() {
    let place = Place::with_script("def execute(self, inputs, outputs, gvm):\n    return 0");
    let mut terminal = Terminal::new(80, 24);
    let mut command = place.command("run MACHINE");
    let end = || terminal.theirs.try_clone().unwrap();
    let mut child = command.env("TERM", "dumb").stdout(end()).stderr(end()).spawn().unwrap();
    let seen = terminal.read_until("1 state run");
    assert!(!seen.contains('\x1b'), "{seen}");
    assert_eq!(child.wait().unwrap().code(), Some(0));
}
