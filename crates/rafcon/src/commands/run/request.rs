//! What `rafcon run` was asked for, checked: what is here can no longer be wrong.

use crate::cli;
use crate::failure::Usage;
use crate::machine::Source;
use crate::view::Names;
use anyhow::Result;
use rafcon_protocol::Launch;
use std::path::Path;
use std::time::Duration;

/// A run to be made.
#[derive(Debug)]
pub(super) struct Request {
    source: Source,
    start_from: Option<String>,
    inputs: Vec<(String, serde_json::Value)>,
    /// What is written.
    pub(super) output: cli::Output,
    /// When the machine is stopped.
    pub(super) timeout: Option<Duration>,
}

impl Request {
    /// Checks the words of the command line.
    pub(super) fn new(raw: &cli::Run) -> Result<Self> {
        let mut inputs: Vec<(String, serde_json::Value)> = Vec::new();
        for text in &raw.inputs {
            let (name, value) = input(text)?;
            if inputs.iter().any(|(other, _)| *other == name) {
                return Err(Usage(format!("--input {name} is given twice: keep one")).into());
            }
            inputs.push((name, value));
        }
        Ok(Self {
            source: Source::new(&raw.path, &raw.libraries)?,
            start_from: raw.start_from.clone(),
            inputs,
            output: raw.output,
            timeout: raw.timeout.map(timeout).transpose()?,
        })
    }

    /// The message that begins the run.
    pub(super) fn launch(&self, every_event: bool, run_folder: &Path) -> Launch {
        Launch {
            machine: self.source.machine.clone(),
            start_from: self.start_from.clone(),
            inputs: self.inputs.clone(),
            libraries: self.source.libraries.clone(),
            config: self.source.config.clone(),
            every_event,
            run_folder: Some(run_folder.to_path_buf()),
            ..Launch::default()
        }
    }

    /// The names of the machine's states.
    pub(super) fn names(&self) -> Names {
        let source = self.source.clone();
        Names::new(move || source.load_quietly().ok().map(|loaded| loaded.machine))
    }
}

fn input(text: &str) -> Result<(String, serde_json::Value)> {
    let Some((name, json)) = text.split_once('=').filter(|(name, _)| !name.is_empty()) else {
        return Err(Usage(format!(
            "--input {text}: write the name of an input port and a value in JSON, such as --input count=3"
        ))
        .into());
    };
    match serde_json::from_str(json) {
        Ok(value) => Ok((name.to_owned(), value)),
        Err(error) => Err(Usage(format!(
            "--input {text}: `{json}` is not JSON ({error}); a text stands in quotes, such as --input '{name}=\"…\"'"
        ))
        .into()),
    }
}

fn timeout(seconds: f64) -> Result<Duration> {
    match Duration::try_from_secs_f64(seconds) {
        Ok(timeout) if !timeout.is_zero() => Ok(timeout),
        _ => Err(Usage(format!("--timeout {seconds}: write seconds, more than 0")).into()),
    }
}

#[cfg(test)]
mod tests {
    use super::Request;
    use crate::cli::{Cli, Command};
    use clap::Parser as _;
    use expect_test::{Expect, expect};

    fn check(words: &str, expect: &Expect) {
        let words = ["rafcon", "run", "machine"].into_iter().chain(words.split_whitespace());
        let Command::Run(raw) = Cli::try_parse_from(words).unwrap().command else {
            panic!("another command")
        };
        expect.assert_eq(&match Request::new(&raw) {
            Ok(request) => format!("{:?} {:?}", request.inputs, request.timeout),
            Err(error) => error.to_string(),
        });
    }

    #[test]
    fn values_are_json() {
        check(
            r#"--input n=3 --input text="a=b" --timeout 1.5"#,
            &expect![[r#"[("n", Number(3)), ("text", String("a=b"))] Some(1.5s)"#]],
        );
    }

    #[test]
    fn wrong_words_are_refused_with_the_way_out() {
        check(
            "--input n",
            &expect![
                "--input n: write the name of an input port and a value in JSON, such as --input count=3"
            ],
        );
        check(
            "--input n=abc",
            &expect![[
                r#"--input n=abc: `abc` is not JSON (expected value at line 1 column 1); a text stands in quotes, such as --input 'n="…"'"#
            ]],
        );
        check("--input n=1 --input n=2", &expect!["--input n is given twice: keep one"]);
        check("--timeout 0", &expect!["--timeout 0: write seconds, more than 0"]);
        check("--timeout=-1", &expect!["--timeout -1: write seconds, more than 0"]);
        check("--timeout NaN", &expect!["--timeout NaN: write seconds, more than 0"]);
        check(
            "--library-path x",
            &expect![
                "--library-path x: write a name and a folder, such as --library-path generic=/opt/libraries"
            ],
        );
    }
}
