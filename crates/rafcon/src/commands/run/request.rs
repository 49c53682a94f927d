//! Validated options of `rafcon run`.

use super::breakpoint;
use super::drive::Place;
use crate::cli;
use crate::failure::Usage;
use crate::machine::Source;
use crate::view::Names;
use anyhow::Result;
use rafcon_model::Json;
use rafcon_protocol::{Breakpoint, Keeping, Launch, OnCrash};
use serde_json::Value;
use std::time::Duration;

/// A request for a run.
#[derive(Debug)]
pub(super) struct Request {
    source: Source,
    start_from: Option<String>,
    inputs: Vec<(String, Value)>,
    globals: Vec<(String, Value)>,
    /// Time limit of the machine.
    pub(super) timeout: Option<Duration>,
    keeping: Keeping,
    strict: bool,
    size_max: Option<u64>,
    on_crash: Option<OnCrash>,
    hold: bool,
    breakpoints: Vec<String>,
}

impl Request {
    /// Checks the options of the command line.
    pub(super) fn new(raw: &cli::Run) -> Result<Self> {
        Ok(Self {
            source: Source::new(&raw.path, &raw.libraries)?,
            start_from: raw.start_from.clone(),
            inputs: named(&raw.inputs, INPUT)?,
            globals: named(&raw.globals, GLOBAL)?,
            timeout: raw.timeout.map(timeout).transpose()?,
            keeping: keeping(raw.keeping.keep),
            strict: raw.keeping.strict,
            size_max: size_max(&raw.keeping),
            on_crash: raw.keeping.on_crash.map(on_crash),
            hold: raw.hold,
            breakpoints: raw.breakpoints.clone(),
        })
    }

    /// The message that starts the run.
    pub(super) fn launch(&self, place: &Place) -> Result<Launch> {
        Ok(Launch {
            machine: self.source.machine.clone(),
            start_from: self.start_from.clone(),
            inputs: self.inputs.clone(),
            globals: self.globals.clone(),
            libraries: self.source.libraries.clone(),
            config: self.source.config.clone(),
            run_folder: Some(place.folder().to_path_buf()),
            keeping: self.keeping,
            strict: self.strict,
            size_max: self.size_max,
            hold: self.hold,
            breakpoints: self.breakpoints()?,
            on_crash: self.on_crash,
            listen: place.is_kept(),
            ..Launch::default()
        })
    }

    fn breakpoints(&self) -> Result<Vec<Breakpoint>> {
        if self.breakpoints.is_empty() {
            return Ok(Vec::new());
        }
        breakpoints(&self.breakpoints, &mut self.names())
    }

    /// Name of the machine, from its folder or file.
    pub(super) fn machine_name(&self) -> String {
        let name = self.source.machine.file_stem().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// The names of the machine's states.
    pub(super) fn names(&self) -> Names {
        self.later_names()()
    }

    /// Loads the names on each call.
    pub(super) fn later_names(&self) -> impl Fn() -> Names + 'static {
        let source = self.source.clone();
        move || {
            let source = source.clone();
            Names::new(move || source.load_quietly().ok().map(|loaded| loaded.machine))
        }
    }
}

/// Values of the root's input ports.
pub(super) const INPUT: Named = Named { option: "--input", what: "an input port" };
/// Values of global variables.
pub(super) const GLOBAL: Named = Named { option: "--global", what: "a global variable" };

/// An option that assigns values to names.
#[derive(Debug, Clone, Copy)]
pub(super) struct Named {
    option: &'static str,
    what: &'static str,
}

/// Values from the options, by name.
pub(super) fn named(texts: &[String], of: Named) -> Result<Vec<(String, Value)>> {
    let mut values: Vec<(String, Value)> = Vec::new();
    for text in texts {
        let (name, value) = of.value(text)?;
        if values.iter().any(|(other, _)| *other == name) {
            return Err(Usage(format!("{} {name} is set twice: keep one", of.option)).into());
        }
        values.push((name, value));
    }
    Ok(values)
}

impl Named {
    fn value(self, text: &str) -> Result<(String, Value)> {
        let Self { option, what } = self;
        let Some((name, json)) = text.split_once('=').filter(|(name, _)| !name.is_empty()) else {
            return Err(Usage(format!(
                "{option} {text}: write the name of {what} and a value in JSON, such as {option} count=3"
            ))
            .into());
        };
        match exact(json) {
            Ok(value) => Ok((name.to_owned(), value)),
            Err(error) => Err(Usage(format!(
                "{option} {text}: `{json}` is not JSON ({error}); put text in quotes, such as {option} '{name}=\"…\"'"
            ))
            .into()),
        }
    }
}

/// JSON whose integers stay exact, whatever their size.
fn exact(json: &str) -> Result<Value, serde_json::Error> {
    let value = serde_json::from_str(json)?;
    // The model's parser supports integers of any size.
    Ok(match rafcon_model::json::parse(json) {
        Ok(document) => with_exact_integers(value, &document),
        Err(_deeper_than_files) => value,
    })
}

fn with_exact_integers(value: Value, exact: &Json) -> Value {
    match (value, exact) {
        (_, Json::BigInt(digits)) => serde_json::json!({ "__int__": digits.as_str() }),
        (Value::Array(items), Json::List(exact)) => items
            .into_iter()
            .zip(exact)
            .map(|(item, exact)| with_exact_integers(item, exact))
            .collect(),
        (Value::Object(members), exact @ Json::Object(_)) => {
            let member = |(key, value): (String, Value)| match exact.get(&key) {
                Some(exact) => (key, with_exact_integers(value, exact)),
                None => (key, value),
            };
            members.into_iter().map(member).collect()
        }
        (value, _) => value,
    }
}

/// Breakpoints from the options, numbered from 1.
pub(super) fn breakpoints(texts: &[String], names: &mut Names) -> Result<Vec<Breakpoint>> {
    (1..).zip(texts).map(|(id, text)| breakpoint(id, text, names)).collect()
}

/// Maximum size of the journal, in bytes.
pub(super) fn size_max(raw: &cli::Keeping) -> Option<u64> {
    raw.keep_max.map(|megabytes| megabytes.saturating_mul(1 << 20))
}

/// The protocol's value for a level of detail.
pub(super) fn keeping(level: cli::Level) -> Keeping {
    match level {
        cli::Level::Full => Keeping::Full,
        cli::Level::Status => Keeping::Status,
        cli::Level::Off => Keeping::Off,
    }
}

/// The protocol's value for a policy.
pub(super) fn on_crash(policy: cli::OnCrash) -> OnCrash {
    match policy {
        cli::OnCrash::Ask => OnCrash::Ask,
        cli::OnCrash::Abort => OnCrash::Abort,
        cli::OnCrash::Restart => OnCrash::Restart,
    }
}

/// Converts seconds to a duration.
pub(super) fn timeout(seconds: f64) -> Result<Duration> {
    match Duration::try_from_secs_f64(seconds) {
        Ok(timeout) if !timeout.is_zero() => Ok(timeout),
        _ => Err(Usage(format!("--timeout {seconds}: write a number of seconds above 0")).into()),
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
            Ok(request) => {
                format!("{:?} {:?} {:?}", request.inputs, request.globals, request.timeout)
            }
            Err(error) => error.to_string(),
        });
    }

    #[test]
    fn values_are_json() {
        check(
            r#"--input n=3 --input text="a=b" --timeout 1.5"#,
            &expect![[r#"[("n", Number(3)), ("text", String("a=b"))] [] Some(1.5s)"#]],
        );
    }

    #[test]
    fn integers_of_any_size_stay_exact() {
        check(
            r#"--input n=[123456789012345678901,{"m":-123456789012345678901}]"#,
            &expect![[
                r#"[("n", Array [Object {"__int__": String("123456789012345678901")}, Object {"m": Object {"__int__": String("-123456789012345678901")}}])] [] None"#
            ]],
        );
    }

    #[test]
    fn global_variables_are_json() {
        check(
            "--global n=3 --input n=4",
            &expect![[r#"[("n", Number(4))] [("n", Number(3))] None"#]],
        );
        check("--global n=1 --global n=2", &expect!["--global n is set twice: keep one"]);
        check(
            "--global n",
            &expect![
                "--global n: write the name of a global variable and a value in JSON, such as --global count=3"
            ],
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
                r#"--input n=abc: `abc` is not JSON (expected value at line 1 column 1); put text in quotes, such as --input 'n="…"'"#
            ]],
        );
        check("--input n=1 --input n=2", &expect!["--input n is set twice: keep one"]);
        check("--timeout 0", &expect!["--timeout 0: write a number of seconds above 0"]);
        check("--timeout=-1", &expect!["--timeout -1: write a number of seconds above 0"]);
        check("--timeout NaN", &expect!["--timeout NaN: write a number of seconds above 0"]);
        check(
            "--library-path x",
            &expect![
                "--library-path x: write NAME=DIR, such as --library-path generic=/opt/libraries"
            ],
        );
    }
}
