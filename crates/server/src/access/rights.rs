//! Rights that routes, commands and frames require. This is the only table of them. Pure.

use axum::http::Method;
use rafcon_protocol::Command;
use rafcon_protocol::api::{Right, StartRun};
use rafcon_protocol::socket::ToServer;

/// One route: its method, its path as in the router, and the required right.
pub type Row = (Method, &'static str, Right);

/// Every route. A route that is missing here is denied.
pub const ROUTES: &[Row] = &[
    // For browsers.
    (Method::GET, "/", Right::Anyone),
    (Method::GET, "/popout.html", Right::Anyone),
    (Method::GET, "/icon.svg", Right::Anyone),
    (Method::GET, "/assets/{file}", Right::Anyone),
    // People.
    (Method::GET, "/api/v1/health", Right::Anyone),
    (Method::GET, "/api/v1/openapi.json", Right::Anyone),
    (Method::POST, "/api/v1/session", Right::Anyone),
    (Method::GET, "/api/v1/session", Right::Observe),
    (Method::DELETE, "/api/v1/session", Right::Observe),
    (Method::PUT, "/api/v1/session/password", Right::Observe),
    (Method::GET, "/api/v1/tokens", Right::Observe),
    (Method::POST, "/api/v1/tokens", Right::Observe),
    (Method::DELETE, "/api/v1/tokens/{token}", Right::Observe),
    (Method::GET, "/api/v1/users", Right::Administer),
    (Method::POST, "/api/v1/users", Right::Administer),
    (Method::PATCH, "/api/v1/users/{user}", Right::Administer),
    (Method::DELETE, "/api/v1/users/{user}", Right::Administer),
    // Files.
    (Method::GET, "/api/v1/projects", Right::Observe),
    (Method::GET, "/api/v1/projects/{project}/tree", Right::Observe),
    (Method::GET, "/api/v1/libraries", Right::Observe),
    (Method::GET, "/api/v1/libraries/usages", Right::Observe),
    (Method::GET, "/api/v1/libraries/{root}/{*path}", Right::Observe),
    (Method::POST, "/api/v1/python/check", Right::Edit),
    (Method::POST, "/api/v1/plans", Right::Edit),
    (Method::POST, "/api/v1/plans/domain", Right::Observe),
    // Open machines.
    (Method::GET, "/api/v1/machines", Right::Observe),
    (Method::POST, "/api/v1/machines", Right::Edit),
    (Method::POST, "/api/v1/machines/open", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/document", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/revisions", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/problems", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/steps", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/saved", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/versions", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/versions/{commit}", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/set_aside", Right::Observe),
    (Method::GET, "/api/v1/machines/{machine}/set_aside/{draft}", Right::Observe),
    (Method::DELETE, "/api/v1/machines/{machine}/set_aside/{draft}", Right::Edit),
    (Method::POST, "/api/v1/machines/{machine}/copy", Right::Observe),
    (Method::POST, "/api/v1/machines/{machine}/edits", Right::Edit),
    (Method::POST, "/api/v1/machines/{machine}/undo", Right::Edit),
    (Method::POST, "/api/v1/machines/{machine}/redo", Right::Edit),
    (Method::POST, "/api/v1/machines/{machine}/jump", Right::Edit),
    (Method::POST, "/api/v1/machines/{machine}/save", Right::Edit),
    (Method::POST, "/api/v1/machines/{machine}/save_state", Right::Edit),
    (Method::POST, "/api/v1/machines/{machine}/reload", Right::Edit),
    (Method::POST, "/api/v1/machines/{machine}/close", Right::Edit),
    // Runs: start, state and control.
    (Method::GET, "/api/v1/runs", Right::Observe),
    (Method::POST, "/api/v1/runs", Right::Start),
    (Method::POST, "/api/v1/runs/prune", Right::Administer),
    (Method::GET, "/api/v1/runs/{run}", Right::Observe),
    (Method::DELETE, "/api/v1/runs/{run}", Right::Administer),
    (Method::POST, "/api/v1/runs/{run}/resume", Right::Start),
    (Method::POST, "/api/v1/runs/{run}/again", Right::Start),
    (Method::POST, "/api/v1/robots/{robot}/runs", Right::Start),
    (Method::GET, "/api/v1/robots", Right::Observe),
    (Method::GET, "/api/v1/robots/{robot}/contacts", Right::Observe),
    (Method::GET, "/api/v1/robots/{robot}/machines", Right::Observe),
    (Method::PUT, "/api/v1/robots/{robot}/contacts", Right::Command),
    (Method::GET, "/api/v1/robots/{robot}/commands", Right::Observe),
    (Method::PUT, "/api/v1/robots/{robot}/commands", Right::Command),
    (Method::POST, "/api/v1/robots/{robot}/commands/release", Right::Command),
    (Method::POST, "/api/v1/runs/{run}/commands", Right::Command),
    (Method::GET, "/api/v1/runs/{run}/control", Right::Observe),
    (Method::POST, "/api/v1/runs/{run}/control", Right::Command),
    (Method::GET, "/api/v1/runs/{run}/state", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/breakpoints", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/questions", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/globals", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/output", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/results", Right::Observe),
    // Runs: their records.
    (Method::GET, "/api/v1/runs/{run}/events", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/events/{sequence}", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/log", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/moments", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/moments/{sequence}", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/values/{value}", Right::Observe),
    (Method::POST, "/api/v1/runs/{run}/values/{value}/fetch", Right::Command),
    (Method::DELETE, "/api/v1/runs/{run}/values/{value}/fetch", Right::Command),
    (Method::GET, "/api/v1/runs/{run}/machine", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/window", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/earlier/{sequence}", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/overview", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/hits", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/statistics", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/compare/{other}", Right::Observe),
    (Method::GET, "/api/v1/runs/{run}/export", Right::Observe),
    // Status, and the WebSocket.
    (Method::GET, "/api/v1/status", Right::Observe),
    (Method::GET, "/api/v1/socket", Right::Observe),
];

/// The right that a route requires. `None` if it has no row.
pub fn of_route(method: &Method, path: &str) -> Option<Right> {
    let is_it = |row: &&Row| row.0 == *method && row.1 == path;
    ROUTES.iter().find(is_it).map(|row| row.2)
}

/// The right that a command of a run requires. A command that adds Python code to a run counts as an edit.
pub fn of_command(command: &Command) -> Right {
    match command {
        Command::Reload { .. } | Command::EditScript { .. } => Right::Edit,
        Command::SetBreakpoint { breakpoint } if breakpoint.condition.is_some() => Right::Edit,
        Command::Start { .. }
        | Command::Pause
        | Command::Resume { .. }
        | Command::Stop
        | Command::Kill
        | Command::StepMode
        | Command::StepInto { .. }
        | Command::StepOver { .. }
        | Command::StepOut { .. }
        | Command::StepBack { .. }
        | Command::RunTo { .. }
        | Command::RunSelected { .. }
        | Command::RunOnlySelected { .. }
        | Command::StartFromHistory { .. }
        | Command::ForceOutcome { .. }
        | Command::Preempt { .. }
        | Command::SetBreakpoint { .. }
        | Command::RemoveBreakpoint { .. }
        | Command::AnswerQuestion { .. }
        | Command::Recover { .. }
        | Command::Control { .. } => Right::Command,
    }
}

/// The right that the start of a run requires. A start that adds Python code to a run counts as an edit.
pub fn of_start(start: &StartRun) -> Right {
    let is_edit = start.breakpoints.iter().any(|breakpoint| breakpoint.condition.is_some());
    if is_edit { Right::Edit } else { Right::Start }
}

/// The right that a frame of the socket requires.
pub fn of_frame(frame: &ToServer) -> Right {
    match frame {
        ToServer::Command { envelope, .. } => of_command(&envelope.command),
        ToServer::Edit { .. } | ToServer::Undo { .. } | ToServer::Redo { .. } => Right::Edit,
        ToServer::Subscribe { .. }
        | ToServer::Unsubscribe { .. }
        | ToServer::Presence { .. }
        | ToServer::Ping { .. } => Right::Observe,
    }
}
