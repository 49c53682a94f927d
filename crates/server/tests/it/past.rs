//! Finished runs, made from text, and a server that serves them. Knows the format of journals.

use crate::harness::TestServer;
use rafcon_protocol::api::Role;
use rafcon_storage::journal::{About, Journal, Options};
use rafcon_testkit::journal_notation;
use serde_json::Value;
use std::path::Path;

/// States of all runs.
pub(crate) const MACHINE: &str = r#"
    place R "Root" in speed scoped n outcome done
    place R/A "Root/Scan" script in a out b outcome ok,lost
    place R/H "Root/Search" scoped m outcome ok
    place R/H/X "Root/Search/Look" script out x outcome ok
"#;

/// A short run with every kind of event.
pub(crate) const RUN: &str = r#"
    enter R speed=1.5
    scoped R n=0
    global map={"rooms": [1, 2]}
    enter R/A a=[1, 2]
    log R/A info "scanning the ROOM"
    persistent R/A {"calls": 1}
    leave R/A ok b="far"
    log - warning "the battery is low"
    enter R/H
    enter R/H/X
    log R/H/X debug "looking"
    leave R/H/X ok x=7
"#;

/// The end of the run.
pub(crate) const END: &str = r#"
    leave R/H ok
    leave R done
    told {"type": "finished", "outcome": {"id": 0, "name": "done"}, "outputs": {}, "globals": {}, "scoped_variables": {}, "states_run": 4}
"#;

/// A server with these runs, given by id and events.
pub(crate) fn server(runs: &[(&str, &str)]) -> TestServer {
    let place = tempfile::tempdir().unwrap();
    for (id, text) in runs {
        write(&place.path().join("runs"), id, text).close().unwrap();
    }
    TestServer::at(place, |_settings| {})
}

/// A run that is active in this process until its journal is dropped.
pub(crate) fn write(runs: &Path, id: &str, text: &str) -> Journal {
    let about = About {
        id: id.to_owned(),
        name: "Root".to_owned(),
        started_ms: 1_795_290_001_000,
        ..About::default()
    };
    let options = Options { recorder_bytes: 1 << 18, ..Options::default() };
    let journal = Journal::create(&runs.join(id), &about, &options).unwrap();
    append(&journal, text);
    journal.commit().unwrap();
    journal
}

/// Appends events to a run.
pub(crate) fn append(journal: &Journal, text: &str) {
    journal.append(&journal_notation::batch(&format!("{MACHINE}{text}"), 0).unwrap()).unwrap();
}

/// The response for a viewer.
pub(crate) fn get(server: &TestServer, path: &str) -> Value {
    let answer = server.call(Some(Role::Viewer), "GET", &format!("/api/v1/runs/{path}"), None);
    assert_eq!(answer.status, 200, "{path}: {}", answer.text);
    answer.json()
}

/// Status and code of the response.
pub(crate) fn said(server: &TestServer, role: Role, method: &str, path: &str) -> String {
    server.call(Some(role), method, &format!("/api/v1/runs/{path}"), None).said()
}
