//! Engines by name, as command lines. `kairos` is a program; all others are those of unified-planning, behind a bridge in Python.

use crate::{Interpreter, ProgramEnvironment};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The engine that is taken if none is named.
pub const DEFAULT_ENGINE: &str = "kairos";

/// Runs a program that ends, with all that it started, when whoever asked is gone, also by a kill: then nobody has the other end of
/// the input any more.
const WATCHED: &str =
    r#"exec 3<&0; { read -r _ <&3; kill -KILL 0; } >/dev/null 2>&1 & exec "$@" 3<&- </dev/null"#;
/// What a shell ends with that does not find the program.
const NOT_THERE: i32 = 127;

/// Talks with the engines of unified-planning; the same text is `python -m rafcon.planning`.
const BRIDGE: &str = include_str!("../../../python/python/rafcon/planning/__main__.py");

/// A second search begins where the first has found nothing for so long.
const SECOND_AFTER: Duration = Duration::from_secs(1);

/// A program that finds plans.
#[derive(Debug, Clone)]
pub struct Engine {
    /// Its name.
    pub name: String,
    program: PathBuf,
    kind: Kind,
    way_out: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Kairos,
    Unified,
}

/// One way to search, as a command line.
#[derive(Debug, Clone)]
pub(super) struct Lane {
    pub(super) program: PathBuf,
    pub(super) arguments: Vec<OsString>,
    /// It begins after this time, or when the lanes before it have ended.
    pub(super) after: Duration,
}

/// What the command line depends on.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlanRequest<'w> {
    pub(super) domain: &'w Path,
    pub(super) problem: &'w Path,
    pub(super) limit: Duration,
    pub(super) anytime: bool,
    /// Neither numbers nor durations.
    pub(super) classical: bool,
}

impl Engine {
    /// The engine with this name. `python` is the interpreter of runs: a program beside it is preferred.
    pub fn find(name: &str, python: &Interpreter, surroundings: &ProgramEnvironment) -> Self {
        if name == DEFAULT_ENGINE {
            let beside = python.program.parent().map(|folder| folder.join("kairos"));
            let active = surroundings.virtual_env.as_ref().map(|folder| folder.join("bin/kairos"));
            let found = [beside, active].into_iter().flatten().find(|program| program.is_file());
            return Self {
                name: name.to_owned(),
                program: found.unwrap_or_else(|| "kairos".into()),
                kind: Kind::Kairos,
                way_out: "install it: `pip install kairos-planner`, or choose another engine"
                    .to_owned(),
            };
        }
        Self {
            name: name.to_owned(),
            program: python.program.clone(),
            kind: Kind::Unified,
            way_out: python.way_out().to_owned(),
        }
    }

    /// Why it could not be started, with the way out.
    pub(super) fn missing(&self, error: &std::io::Error) -> String {
        match error.kind() {
            std::io::ErrorKind::NotFound => {
                format!("the engine `{}` is not there: {}", self.name, self.way_out)
            }
            _ => format!("the engine `{}` cannot be started: {error}; {}", self.name, self.way_out),
        }
    }

    pub(super) fn lanes(&self, wish: &PlanRequest<'_>) -> Vec<Lane> {
        let seconds = format!("{:.3}", wish.limit.as_secs_f64());
        let lane = |arguments: &[&str], after| {
            let files = [wish.domain.into(), wish.problem.into()];
            let arguments = arguments.iter().map(OsString::from);
            match self.kind {
                Kind::Kairos => {
                    let shell = ["-c", WATCHED, "sh"].map(OsString::from).into_iter();
                    let own = [self.program.clone().into(), "solve".into()];
                    let arguments = shell.chain(own).chain(files).chain(arguments).collect();
                    Lane { program: "/bin/sh".into(), arguments, after }
                }
                // The bridge looks at its input itself.
                Kind::Unified => {
                    let arguments = arguments.chain(files).collect();
                    Lane { program: self.program.clone(), arguments, after }
                }
            }
        };
        if self.kind == Kind::Unified {
            // As one argument, a name such as `--help` is no option.
            let engine = format!("--engine={}", self.name);
            let mut arguments = vec!["-c", BRIDGE, &engine, "--time-limit", &seconds];
            arguments.extend(wish.anytime.then_some("--anytime"));
            return vec![lane(&arguments, Duration::ZERO)];
        }
        // One thread: the same problem gives the same plan.
        let anytime = if wish.anytime { "--anytime" } else { "--no-anytime" };
        let usual = ["--format", "json", "--threads", "1", "--timeout", &seconds, anytime];
        if wish.classical {
            // Greedy search is quick where the usual one is lost, such as among many blocks; and the other way round.
            let greedy = [&usual[..], &["--search", "ff"]].concat();
            vec![lane(&greedy, Duration::ZERO), lane(&usual, SECOND_AFTER)]
        } else {
            vec![lane(&usual, Duration::ZERO)]
        }
    }

    /// Why there is no engine, if an exit status says so.
    pub(super) fn is_missing(&self, code: Option<i32>) -> Option<String> {
        let is_so = self.kind == Kind::Kairos && code == Some(NOT_THERE);
        is_so.then(|| self.missing(&std::io::ErrorKind::NotFound.into()))
    }

    /// Whether an exit status says that there is no plan at all.
    pub(super) fn proves_impossible(code: Option<i32>) -> bool {
        code == Some(10)
    }

    /// Whether an exit status says that there was none to be found.
    pub(super) fn found_none(code: Option<i32>) -> bool {
        matches!(code, Some(0 | 11 | 12 | 14))
    }
}

#[cfg(test)]
mod tests {
    use super::{Engine, Kind, PlanRequest};
    use std::path::Path;
    use std::time::Duration;

    #[test]
    fn a_name_that_looks_like_an_option_is_a_name() {
        let (name, program) = ("--help".to_owned(), "python3".into());
        let engine = Engine { name, program, kind: Kind::Unified, way_out: String::new() };
        let [domain, problem] = ["domain", "problem"].map(Path::new);
        let limit = Duration::from_secs(1);
        let wish = PlanRequest { domain, problem, limit, anytime: false, classical: true };
        let lanes = engine.lanes(&wish);
        let is_there = |word: &str| lanes[0].arguments.iter().any(|argument| argument == word);
        assert!(is_there("--engine=--help") && !is_there("--help"));
    }
}
