//! Engines by name, as command lines. `kairos` is a program. All others belong to unified-planning and run behind a bridge in Python.

use crate::{Interpreter, ProgramEnvironment};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of the default engine.
pub const DEFAULT_ENGINE: &str = "kairos";

/// Runs a program that is killed, with its whole process group, when the caller exits or is killed: that closes the other end of its input.
const WATCHED: &str =
    r#"exec 3<&0; { read -r _ <&3; kill -KILL 0; } >/dev/null 2>&1 & exec "$@" 3<&- </dev/null"#;
/// Exit status of a shell that does not find the program.
const NOT_THERE: i32 = 127;

/// The bridge to the engines of unified-planning; also available as `python -m rafcon.planning`.
const BRIDGE: &str = include_str!("../../../python/python/rafcon/planning/__main__.py");

/// Time after which a second search starts if the first has found no plan.
const SECOND_AFTER: Duration = Duration::from_secs(1);

/// A program that finds plans.
#[derive(Debug, Clone)]
pub struct Engine {
    /// Name of the engine.
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

/// One kind of search, as a command line.
#[derive(Debug, Clone)]
pub(super) struct Lane {
    pub(super) program: PathBuf,
    pub(super) arguments: Vec<OsString>,
    /// Earliest start. The lane also starts once all earlier lanes have ended.
    pub(super) after: Duration,
}

/// Parameters of the command line.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlanRequest<'w> {
    pub(super) domain: &'w Path,
    pub(super) problem: &'w Path,
    pub(super) limit: Duration,
    pub(super) anytime: bool,
    /// True if the problem has neither numbers nor durations.
    pub(super) classical: bool,
}

impl Engine {
    /// The engine with this name. `python` is the interpreter of runs; a program beside it is preferred.
    pub fn find(name: &str, python: &Interpreter, environment: &ProgramEnvironment) -> Self {
        if name == DEFAULT_ENGINE {
            let beside = python.program.parent().map(|folder| folder.join("kairos"));
            let active = environment.virtual_env.as_ref().map(|folder| folder.join("bin/kairos"));
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

    /// Message for an engine that cannot be started, with a remedy.
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
                // The bridge watches its input itself.
                Kind::Unified => {
                    let arguments = arguments.chain(files).collect();
                    Lane { program: self.program.clone(), arguments, after }
                }
            }
        };
        if self.kind == Kind::Unified {
            // As part of one argument, a name such as `--help` is not an option.
            let engine = format!("--engine={}", self.name);
            let mut arguments = vec!["-c", BRIDGE, &engine, "--time-limit", &seconds];
            arguments.extend(wish.anytime.then_some("--anytime"));
            return vec![lane(&arguments, Duration::ZERO)];
        }
        // One thread makes the plan of a problem reproducible.
        let anytime = if wish.anytime { "--anytime" } else { "--no-anytime" };
        let usual = ["--format", "json", "--threads", "1", "--timeout", &seconds, anytime];
        if wish.classical {
            // Greedy search is fast on some problems where the usual search fails, such as those with many blocks, and vice versa.
            let greedy = [&usual[..], &["--search", "ff"]].concat();
            vec![lane(&greedy, Duration::ZERO), lane(&usual, SECOND_AFTER)]
        } else {
            vec![lane(&usual, Duration::ZERO)]
        }
    }

    /// Message if the exit status means that the engine is not installed.
    pub(super) fn is_missing(&self, code: Option<i32>) -> Option<String> {
        let is_so = self.kind == Kind::Kairos && code == Some(NOT_THERE);
        is_so.then(|| self.missing(&std::io::ErrorKind::NotFound.into()))
    }

    /// True if the exit status means that no plan exists.
    pub(super) fn proves_impossible(code: Option<i32>) -> bool {
        code == Some(10)
    }

    /// True if the exit status means that no plan was found.
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
