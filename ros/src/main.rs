//! `rafcon-ros` provides ROS 2 to the scripts of a run whose Python has no rclpy.
//!
//! It is started by `rafcon.ros`, reads frames from its standard input, writes frames to its standard output, and ends when
//! the input ends. `docs/ros.md` describes the frames.

mod cdr;
mod dds;
mod describe;
mod frames;
mod hear;
mod json;
mod requests;
mod session;
mod settings;
mod tell;
mod types;

use std::io::{Read, Write as _};
use std::process::ExitCode;
use std::time::Duration;

use crate::frames::Outbox;
use crate::session::Session;
use crate::types::hash;

/// Timeout for writing the last frames.
const LAST_FRAMES: Duration = Duration::from_millis(500);

const USAGE: &str = "rafcon-ros speaks ROS 2 for the scripts of RAFCON; they start it themselves.

    rafcon-ros type NAME…   prints the hash of types, such as std_msgs/msg/String
    rafcon-ros types        prints the names of the types that are in this program
    rafcon-ros --version
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match &words[..] {
        ["serve"] => serve(),
        ["type", names @ ..] if !names.is_empty() => types(names),
        ["types"] => {
            types::bundled::names().for_each(|name| print(&name));
            ExitCode::SUCCESS
        }
        ["--version"] => {
            print(concat!("rafcon-ros ", env!("CARGO_PKG_VERSION")));
            ExitCode::SUCCESS
        }
        _ => {
            let _ = std::io::stderr().write_all(USAGE.as_bytes());
            ExitCode::from(2)
        }
    }
}

fn print(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

fn types(names: &[&str]) -> ExitCode {
    let mut library = settings::library(Vec::new());
    for name in names {
        match library.find(name) {
            Ok(found) => print(&format!("{name} {}", hash::rihs01(&found))),
            Err(why) => {
                let _ = writeln!(std::io::stderr(), "rafcon-ros: {why}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

fn serve() -> ExitCode {
    let runtime =
        tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build();
    let started = runtime.and_then(|runtime| Ok((runtime, Outbox::new(std::io::stdout())?)));
    let (runtime, outbox) = match started {
        Ok(started) => started,
        Err(why) => {
            let _ = writeln!(std::io::stderr(), "rafcon-ros: cannot start: {why}");
            return ExitCode::FAILURE;
        }
    };
    // A panic of one thread ends the program: a partial middleware is useless, and the run starts a new node when it needs
    // one.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |about| {
        hook(about);
        std::process::exit(70);
    }));
    let _inside = runtime.enter();
    let mut session = Session::new(outbox.clone());
    let mut input = std::io::BufReader::with_capacity(1 << 16, std::io::stdin());
    let ended = attend(&mut input, &mut session);
    if let Err(why) = &ended {
        outbox.say("error", &format!("rafcon-ros ends: {why}"));
    }
    session.end(runtime.handle());
    outbox.end(LAST_FRAMES);
    // Threads of the middleware may still run.
    std::process::exit(i32::from(ended.is_err()));
}

/// Handles frames until they end, or one is refused.
fn attend(input: &mut impl Read, session: &mut Session) -> Result<(), String> {
    while let Some((asked, bytes)) = frames::read(input)? {
        session.handle(&asked, &bytes);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io;
    use std::sync::{Arc, Mutex};

    use super::{Duration, Outbox, Session, attend, frames};

    /// Output that the test reads.
    #[derive(Clone, Default)]
    struct Written(Arc<Mutex<Vec<u8>>>);

    impl io::Write for Written {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_frame_that_is_refused_ends_the_program_after_the_answers_to_those_before() {
        let written = Written::default();
        let outbox = Outbox::new(written.clone()).unwrap();
        let asked = r#"{"do":"hashes","ask":7,"types":[]}"#.to_owned();
        let mut input = Vec::new();
        frames::write(&frames::Frame { text: asked, bytes: Vec::new() }, &mut input).unwrap();
        input.extend([0xff; 8]);
        let ended = attend(&mut &input[..], &mut Session::new(outbox.clone()));
        let why = "a frame of 4294967295 bytes with a text of 4294967295";
        assert_eq!(ended, Err(why.to_owned()));
        outbox.end(Duration::MAX);
        let written = written.0.lock().unwrap();
        assert_eq!(written[8..], *br#"{"answer":7,"value":{}}"#);
    }
}
