//! What is wrong with the scripts of a machine. Python reads them, all in one process, and runs none of them; what it found
//! is judged here.

use super::finding::{Complaint, Finding, Level};
use anyhow::{Context as _, Result, bail};
use rafcon_model::{Kind, LibraryContent, Machine, Outcomes, State, StatePath};
use rafcon_supervisor::Interpreter;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write as _;
use std::process::{Command, Stdio};
use std::sync::Arc;

const READER: &str = include_str!("scripts.py");

/// Everything that is wrong with scripts, state by state. Fails if Python cannot be asked.
pub(super) fn findings(machine: &Machine, interpreter: &Interpreter) -> Result<Vec<Finding>> {
    let uses = uses(machine);
    let mut texts: Vec<&str> = Vec::new();
    let mut index: BTreeMap<&str, usize> = BTreeMap::new();
    for used in &uses {
        index.entry(used.text).or_insert_with(|| {
            texts.push(used.text);
            texts.len() - 1
        });
    }
    let answers = if texts.is_empty() { Vec::new() } else { ask(interpreter, &texts)? };
    let mut found = Vec::new();
    for used in &uses {
        let Some(answer) = index.get(used.text).and_then(|index| answers.get(*index)) else {
            continue;
        };
        let complaints = judge(answer, &used.state.outcomes).into_iter();
        found.extend(complaints.map(|what| Finding::of_script(machine, &used.path, what)));
    }
    Ok(found)
}

/// A script where it is used.
struct Use<'m> {
    path: StatePath,
    state: &'m State,
    text: &'m str,
}

/// All scripts from the root down; the content of a library once, below the first state that uses it.
fn uses(machine: &Machine) -> Vec<Use<'_>> {
    let mut found = Vec::new();
    let mut seen: BTreeSet<*const State> = BTreeSet::new();
    let mut open = vec![(StatePath::root(machine.root.id.clone()), &machine.root)];
    while let Some((path, state)) = open.pop() {
        if let Some(text) = state.script().and_then(|script| script.text.as_deref()) {
            found.push(Use { path: path.clone(), state, text });
        }
        if let Kind::Library(library) = &state.kind
            && let LibraryContent::Found(root) = &library.content
            && seen.insert(Arc::as_ptr(root))
        {
            open.push((path.child(root.id.clone()), root));
        }
        let children =
            state.container().into_iter().flat_map(|inside| inside.states.values().rev());
        open.extend(children.map(|child| (path.child(child.id.clone()), child)));
    }
    found
}

#[derive(Serialize)]
struct Question<'a> {
    scripts: &'a [&'a str],
}

/// What Python found in one script,; the keys are those of `scripts.py`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "each is an answer of its own to one question")]
struct Answer {
    syntax: Option<Syntax>,
    execute: bool,
    r#async: Vec<u64>,
    line: Option<u64>,
    takes_four: bool,
    returns_nothing: bool,
    raises: bool,
    outcomes: Vec<(u64, Returned)>,
}

#[derive(Debug, Deserialize)]
struct Syntax {
    line: Option<u64>,
    message: String,
}

/// A constant that a script returns.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Returned {
    Name(String),
    Id(serde_json::Number),
}

fn ask(interpreter: &Interpreter, scripts: &[&str]) -> Result<Vec<Answer>> {
    let mut child = Command::new(&interpreter.program)
        .args(["-I", "-c", READER])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| {
            format!(
                "cannot start the Python interpreter `{interpreter}`: {}",
                interpreter.way_out()
            )
        })?;
    let question = serde_json::to_vec(&Question { scripts })?;
    if let Some(mut stdin) = child.stdin.take() {
        // An interpreter that ends before it has read all says why on its error output.
        stdin.write_all(&question).unwrap_or_default();
    }
    let output = child.wait_with_output()?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!(
            "the Python interpreter `{interpreter}` cannot read scripts ({}): {}\n{}",
            output.status,
            interpreter.way_out(),
            said.trim_end()
        );
    }
    serde_json::from_slice(&output.stdout)
        .with_context(|| format!("the Python interpreter `{interpreter}` gave a strange answer"))
}

fn judge(answer: &Answer, outcomes: &Outcomes) -> Vec<Complaint> {
    if let Some(syntax) = &answer.syntax {
        let what = format!("the script does not parse: {}", syntax.message);
        return vec![error(syntax.line, what, "correct the line; the state aborts until then")];
    }
    if let Some(line) = answer.r#async.first() {
        let remedy = "write `def execute`; the state aborts until then";
        return vec![error(Some(*line), "`execute` is a coroutine".to_owned(), remedy)];
    }
    if !answer.execute {
        let remedy =
            "write `def execute(self, inputs, outputs, gvm):`; the state aborts until then";
        return vec![error(None, "the script has no function `execute`".to_owned(), remedy)];
    }
    let mut found = Vec::new();
    if answer.line.is_some() && !answer.takes_four {
        let what = "`execute` cannot be called with four arguments".to_owned();
        found.push(error(answer.line, what, "write `def execute(self, inputs, outputs, gvm):`"));
    }
    if answer.line.is_some() && answer.returns_nothing {
        let level = if answer.raises { Level::Note } else { Level::Error };
        let what = "`execute` never returns an outcome, so the state aborts".to_owned();
        let remedy = format!("return one of {}", listed(outcomes));
        found.push(Complaint { level, line: answer.line, what, remedy });
    }
    found.extend(answer.outcomes.iter().filter_map(|(line, returned)| {
        let shown = unknown(returned, outcomes)?;
        let what = format!("`execute` returns {shown}, which is no outcome of the state");
        Some(error(
            Some(*line),
            what,
            format!("return one of {}, or add the outcome", listed(outcomes)),
        ))
    }));
    found
}

fn error(line: Option<u64>, what: String, remedy: impl Into<String>) -> Complaint {
    Complaint { level: Level::Error, line, what, remedy: remedy.into() }
}

/// What was returned, as the script has it, if it is no outcome.
fn unknown(returned: &Returned, outcomes: &Outcomes) -> Option<String> {
    match returned {
        Returned::Name(name) => outcomes.by_name(name).is_none().then(|| format!("{name:?}")),
        Returned::Id(id) => {
            let known = outcomes.iter().any(|outcome| Some(outcome.id.0) == id.as_i64());
            (!known).then(|| id.to_string())
        }
    }
}

fn listed(outcomes: &Outcomes) -> String {
    let names = outcomes.iter().filter(|outcome| !outcome.id.is_mandatory());
    let names: Vec<_> = names.map(|outcome| format!("{:?}", outcome.name)).collect();
    if names.is_empty() { "\"aborted\", \"preempted\"".to_owned() } else { names.join(", ") }
}
