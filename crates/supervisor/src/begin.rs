//! The first words to a runner that was started: who we are, and what it is to run.

use rafcon_protocol::{FrameError, Hello, Launch, ToRunner, encode};
use std::io::{self, Write as _};
use std::os::unix::net::UnixStream;
use std::time::Duration;

/// How long a runner may take to read its first words.
const LAUNCH_TIMEOUT: Duration = Duration::from_mins(1);

/// Why a runner was not told what to run.
#[derive(Debug, thiserror::Error)]
pub enum BeginError {
    /// The launch is no message.
    #[error("the launch cannot be said to the runner")]
    Launch(#[from] FrameError),
    /// The runner is gone.
    #[error("the runner ended before it was told what to run; its output says why")]
    Gone(#[source] io::Error),
    /// The runner does not listen.
    #[error("the runner did not read what it is to run within {} s; its output may say why", LAUNCH_TIMEOUT.as_secs())]
    Silent(#[source] io::Error),
}

/// Says hello and what to run. What the runner says comes from the socket that is handed back, its own hello first, which is
/// to be checked. Nobody needs to listen for long: from `loaded` on the run goes on by itself.
pub fn begin(mut control: UnixStream, launch: Launch) -> Result<UnixStream, BeginError> {
    let mut words = encode(&Hello::ours())?;
    words.extend(encode(&ToRunner::Launch(launch))?);
    control.set_write_timeout(Some(LAUNCH_TIMEOUT)).map_err(BeginError::Gone)?;
    control.write_all(&words).map_err(untold)?;
    control.set_write_timeout(None).map_err(BeginError::Gone)?;
    Ok(control)
}

fn untold(error: io::Error) -> BeginError {
    match error.kind() {
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => BeginError::Silent(error),
        _ => BeginError::Gone(error),
    }
}

#[cfg(test)]
mod tests {
    use super::begin;
    use rafcon_protocol::{Hello, Launch, ToRunner, decode};
    use std::io::{BufRead as _, BufReader};
    use std::os::unix::net::UnixStream;

    #[test]
    fn a_runner_is_told_who_speaks_and_then_what_to_run() {
        let (ours, theirs) = UnixStream::pair().unwrap();
        let launch = Launch { listen: true, ..Launch::default() };
        drop(begin(ours, launch.clone()).unwrap());
        let lines: Vec<_> = BufReader::new(theirs).lines().map(Result::unwrap).collect();
        assert_eq!(decode::<Hello>(&lines[0]).unwrap(), Hello::ours());
        assert_eq!(decode::<ToRunner>(&lines[1]).unwrap(), ToRunner::Launch(launch));
        assert_eq!(lines.len(), 2);
    }

    #[test]
    fn a_runner_that_is_gone_is_told_nothing() {
        let (ours, theirs) = UnixStream::pair().unwrap();
        drop(theirs);
        let error = begin(ours, Launch::default()).unwrap_err().to_string();
        assert_eq!(error, "the runner ended before it was told what to run; its output says why");
    }
}
