//! Parses commands of a run from text, for tests.

use crate::{Breakpoint, Input, Scope, Silence, Start, Stride, Then, Unattended, When};
use rafcon_model::{OutcomeId, StatePath, Value, literal};

/// The command of a line; `None` if the line is not a command.
pub(super) fn read(head: &str, rest: &str) -> Option<Input<Value>> {
    Some(match head {
        "start" => Input::Start(start(rest)),
        "pause" => Input::Pause,
        "resume" => Input::Resume(path(rest)),
        "stop" => Input::Stop,
        "step" => step(rest),
        "run" => Input::RunTo(StatePath::parse(rest.strip_prefix("to ")?)),
        "force" => {
            let (path, outcome) = rest.split_once(' ')?;
            Input::Force(StatePath::parse(path), OutcomeId(outcome.parse().ok()?))
        }
        "preempt" => Input::Preempt(StatePath::parse(rest)),
        "break" => Input::Break(breakpoint(rest)?),
        "unbreak" => Input::Unbreak(rest.parse().ok()?),
        "attended" => Input::Attended(rest.parse().ok()?),
        "silence" => Input::Silence(silence(rest)?),
        _ => return None,
    })
}

fn path(text: &str) -> Option<StatePath> {
    (!text.is_empty()).then(|| StatePath::parse(text))
}

fn step(text: &str) -> Input<Value> {
    let (stride, branch) = text.split_once(' ').unwrap_or((text, ""));
    let stride = match stride {
        "into" => Stride::Into,
        "over" => Stride::Over,
        "out" => Stride::Out,
        "back" => Stride::Back,
        _ => return Input::StepMode,
    };
    Input::Step(stride, path(branch))
}

/// `hold at ROOT/A then stop ROOT/A.x=1 y=2`: values with a path are for the state at that path.
fn start(text: &str) -> Start<Value> {
    let mut start = Start { hold: text.starts_with("hold"), ..Start::default() };
    start.start_from = after(text, "at").map(StatePath::parse);
    start.then = match after(text, "then") {
        Some("hold") => Then::Hold,
        Some("stop") => Then::Stop,
        _ => Then::GoOn,
    };
    for (name, value) in assignments(text) {
        match name.rsplit_once('.') {
            Some((path, port)) => start.given.push((StatePath::parse(path), port.into(), value)),
            None => start.inputs.push((name.into(), value)),
        }
    }
    start
}

fn after<'t>(text: &'t str, word: &str) -> Option<&'t str> {
    text.split(' ').skip_while(|other| *other != word).nth(1)
}

/// `5`: the ground was silent for 5 ms; `command 5`: no command came for 5 ms.
fn silence(text: &str) -> Option<Silence> {
    let command_ms = text.strip_prefix("command ").map(str::parse).transpose().ok()?;
    let link_ms = if command_ms.is_none() { text.parse().ok()? } else { 0 };
    Some(Silence { link_ms, command_ms: command_ms.unwrap_or_default() })
}

/// `1 before ROOT/A`, then any of `if x>1`, `count 2`, `run`, `continue`, `stop`, `off`, `lost 5`.
fn breakpoint(text: &str) -> Option<Breakpoint> {
    let mut words = text.split(' ');
    let id = words.next()?.parse().ok()?;
    let when = if words.next()? == "after" { When::After } else { When::Before };
    let path = StatePath::parse(words.next()?);
    let has = |word: &str| text.split(' ').any(|other| other == word);
    let unattended = match (has("continue"), has("stop")) {
        (true, _) => Unattended::Continue,
        (_, true) => Unattended::Stop,
        _ => Unattended::Hold,
    };
    Some(Breakpoint {
        id,
        path,
        when,
        condition: after(text, "if").map(Into::into),
        hit_count: after(text, "count").map_or(Some(0), |count| count.parse().ok())?,
        scope: if has("run") { Scope::Run } else { Scope::Branch },
        unattended,
        enabled: !has("off"),
        lost_link_ms: after(text, "lost").map(|ms| ms.parse().ok()).unwrap_or_default(),
    })
}

/// `x=1 y="a"`: a space ends a value.
pub(super) fn assignments(text: &str) -> Vec<(&str, Value)> {
    let pairs = text.split(' ').filter_map(|word| word.split_once('='));
    pairs.map(|(name, value)| (name, literal::parse(value).expect("a literal"))).collect()
}
