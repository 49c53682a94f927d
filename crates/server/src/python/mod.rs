//! Checks a script with Python's parser and against its state, so that its author sees errors before it runs.
//! Knows the interpreter of runs; never runs a script.

mod facts;

use crate::child::{ChildLimits, ask};
use crate::extract::Body;
use crate::failure::reason;
use crate::gate::Gate;
use crate::{Failure, ServerState, Settings};
use axum::Json;
use axum::extract::State;
use facts::Known;
use rafcon_check::{Facts, Finding};
use rafcon_model::StatePath;
use rafcon_protocol::api::{CheckScript, Refusal, ScriptPlace, ScriptProblem, Severity};
use rafcon_supervisor::Interpreter;
use std::sync::Arc;
use std::time::Duration;
use tokio::process::Command;
use tokio::runtime::Handle;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const CHECK: &str = include_str!("check.py");
/// Maximum number of parallel checks.
const AT_ONCE: usize = 2;
/// Limit on the length of a checked script, in bytes.
const BYTES_MAX: usize = 1 << 20;
const BOUNDS: ChildLimits = ChildLimits { patience: Duration::from_secs(10), output: 1 << 20 };

/// Checks scripts and caches facts about them.
#[derive(Debug)]
pub(crate) struct Python {
    gate: Gate,
    known: Known,
}

impl Default for Python {
    fn default() -> Self {
        Self { gate: Gate::of(AT_ONCE), known: Known::default() }
    }
}

impl Python {
    /// The facts about each text. `None` if they are unavailable. Call it on a blocking thread.
    pub(crate) fn facts(&self, settings: &Settings, texts: &[&str]) -> Vec<Option<Arc<Facts>>> {
        self.known.facts(settings, texts)
    }
}

fn interpreter(settings: &Settings) -> Result<Interpreter, String> {
    let interpreter = Interpreter::choose(settings.python.as_deref(), &settings.environment);
    interpreter.map_err(|error| error.to_string())
}

/// The routes of this part.
pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(check))
}

/// Checks a script with Python's parser and against the given state. It is never run.
#[utoipa::path(post, path = "/api/v1/python/check", tag = "files", request_body = CheckScript, responses(
    (status = 200, description = "Errors and warnings by their place; empty if the script has no problems", body = [ScriptProblem]),
    (status = 404, description = "The machine of the state is not open", body = Refusal),
    (status = 413, description = "The script is too long", body = Refusal),
    (status = 422, description = "There is no Python, or it does not come to an end", body = Refusal),
    (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
))]
async fn check(
    State(server): State<Arc<ServerState>>,
    Body(CheckScript { script, state }): Body<CheckScript>,
) -> Result<Json<Vec<ScriptProblem>>, Failure> {
    if script.len() > BYTES_MAX {
        let message = format!("a script of more than {BYTES_MAX} bytes is not checked: divide it");
        return Err(Failure::too_large("too_large", message));
    }
    let at = Arc::clone(&server);
    let look = move || {
        let mut found = Handle::current().block_on(look(&server.settings, &script))?;
        if let (Some(state), true) =
            (state, found.iter().all(|one| one.severity != Severity::Error))
        {
            found.extend(fit(&server, &script, &state)?);
        }
        Ok(Json(found))
    };
    at.python.gate.work(look).await
}

/// Problems of a valid script in its state.
fn fit(
    server: &ServerState,
    script: &str,
    state: &ScriptPlace,
) -> Result<Vec<ScriptProblem>, Failure> {
    let machine = server.documents.machine_of(&state.machine)?;
    let facts = server.python.facts(&server.settings, &[script]);
    let Some(facts) = facts.into_iter().flatten().next() else { return Ok(Vec::new()) };
    let found = rafcon_check::of_script(&machine, &StatePath::parse(&state.path), &facts);
    let problem = |finding: Finding| ScriptProblem {
        line: finding.line.and_then(|line| u32::try_from(line).ok()).unwrap_or(1),
        column: 1,
        end_line: None,
        end_column: None,
        message: format!("{}; {}", finding.what, finding.remedy),
        severity: finding.severity,
        repairs: finding.repairs,
    };
    Ok(found.into_iter().map(problem).collect())
}

async fn look(settings: &Settings, script: &str) -> Result<Vec<ScriptProblem>, Failure> {
    let interpreter = interpreter(settings).map_err(|why| unchecked(&why))?;
    let mut python = Command::new(&interpreter.program);
    python.args(["-I", "-S", "-X", "utf8", "-c", CHECK]).current_dir("/");
    let said = ask(python, script.as_bytes().to_vec(), BOUNDS).await.map_err(|error| {
        let (why, way_out) = (reason(&error), interpreter.way_out());
        unchecked(&format!("the interpreter `{interpreter}`: {why}; {way_out}"))
    })?;
    serde_json::from_slice(&said.output).map_err(|_unread| {
        let last = said.error.lines().last().unwrap_or("it printed nothing").to_owned();
        unchecked(&format!("the interpreter `{interpreter}` ended with {}: {last}", said.status))
    })
}

fn unchecked(why: &str) -> Failure {
    let message = format!("the script cannot be checked: {why}");
    Failure::unprocessable("not_checked", message)
}
