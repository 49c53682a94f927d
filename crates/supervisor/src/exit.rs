//! How a runner's process ended, in words.

use std::fmt;
use std::os::unix::process::ExitStatusExt as _;
use std::process::ExitStatus;

/// Exit status of a runner that ended itself because a script ignored its grace period.
const CUT_OFF: i32 = 86;
/// Exit status of a runner that ended itself because its engine failed.
const BROKEN: i32 = 87;
/// Exit status of a runner that ended itself because its engine did not take a stop.
const UNREACHED: i32 = 88;

/// How a process ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exit(pub ExitStatus);

impl Exit {
    /// Whether the runner ended itself, because a script did not end in its grace period.
    pub fn is_cut_off(self) -> bool {
        self.0.code() == Some(CUT_OFF)
    }

    /// Whether the runner ended itself to bring the run to a stop.
    pub fn is_stopped(self) -> bool {
        self.0.code() == Some(UNREACHED)
    }
}

impl fmt::Display for Exit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.0.signal(), self.0.code()) {
            (Some(signal), _) => {
                let name = signal_hook::low_level::signal_name(signal).unwrap_or("unknown signal");
                write!(f, "killed by signal {signal} ({name})")
            }
            (None, Some(BROKEN)) => {
                f.write_str("its engine failed inside RAFCON itself; please report it")
            }
            (None, Some(UNREACHED)) => {
                f.write_str("its engine did not take a stop in time, so it ended itself")
            }
            (None, Some(code)) => write!(f, "exit status {code}"),
            (None, None) => f.write_str("ended"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Exit;
    use std::os::unix::process::ExitStatusExt as _;
    use std::process::ExitStatus;

    #[test]
    fn an_exit_is_told_in_words() {
        let told = |raw| {
            let exit = Exit(ExitStatus::from_raw(raw));
            (exit.to_string(), exit.is_cut_off())
        };
        assert_eq!(told(0), ("exit status 0".to_owned(), false));
        assert_eq!(told(86 << 8), ("exit status 86".to_owned(), true));
        let engine_failed = "its engine failed inside RAFCON itself; please report it";
        assert_eq!(told(87 << 8), (engine_failed.to_owned(), false));
        assert_eq!(told(11), ("killed by signal 11 (SIGSEGV)".to_owned(), false));
    }
}
