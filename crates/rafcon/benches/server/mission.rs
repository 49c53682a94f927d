//! A machine of 10,000 states: opened by a client, and edited.

use crate::bench_server::BenchServer;
use crate::clock::now_ms;
use crate::{percentile, print};
use anyhow::{Context as _, Result, bail, ensure};
use rafcon_protocol::api::{EditMachine, MachineDocument};
use rafcon_protocol::document::Document;
use rafcon_protocol::edit::Edit;
use rafcon_protocol::socket::{ToClient, ToServer};
use rafcon_storage::{Libraries, load};
use serde_json::json;

/// How often it is opened.
const TIMES: u32 = 5;
/// How often it is edited.
const EDITS: usize = 200;

pub(crate) fn measure(server: &BenchServer) -> Result<()> {
    server.mission("mission", 10_000)?;
    let (mut times, mut over_load) = (Vec::new(), Vec::new());
    for _ in 0..TIMES {
        let begun = now_ms();
        load(&server.path("project/mission"), &Libraries::default())?;
        let load_ms = now_ms() - begun;
        let begun = now_ms();
        let (machine, _) = open(server, "mission")?;
        times.push(now_ms() - begun);
        over_load.extend(times.last().map(|open_ms| open_ms / load_ms));
        let close = format!("/api/v1/machines/{machine}/close");
        server.door().ask("POST", &close, Some(&json!({})))?;
    }
    print("server_open_10000_ms", percentile(times, 50)?, "ms");
    print("server_open_10000_over_load", percentile(over_load, 50)?, "ratio");
    print("server_edit_10000_ms", percentile(edits(server)?, 50)?, "ms");
    Ok(())
}

/// As a client does it: open, and read the whole of it.
pub(crate) fn open(server: &BenchServer, name: &str) -> Result<(String, Document)> {
    let at = json!({ "file": server.file(name) });
    let summary = server.door().ask("POST", "/api/v1/machines/open", Some(&at))?;
    let machine = summary["id"].as_str().context("a machine without an id")?.to_owned();
    let path = format!("/api/v1/machines/{machine}/document");
    let (status, text) = server.door().answer("GET", &path, None)?;
    ensure!(status == 200, "no document: {text}");
    let read: MachineDocument =
        serde_json::from_str(&text).context("a document that makes no sense")?;

    Ok((machine, read.document))
}

fn edits(server: &BenchServer) -> Result<Vec<f64>> {
    let (machine, document) = open(server, "mission")?;
    let mut line = server.door().line()?;
    let mut times = Vec::new();
    for number in 0..EDITS {
        let path = &document.states[number * 7919 % document.states.len()].path;
        let edit = EditMachine {
            id: number.to_string(),
            base: None,
            name: "Rename".to_owned(),
            edit: Edit::SetName { path: path.clone(), name: format!("Name {number}") },
        };
        let begun = now_ms();
        line.say(&ToServer::Edit { machine: machine.clone(), edit })?;
        match line.hear()? {
            ToClient::Edited { .. } => times.push(now_ms() - begun),
            other => bail!("an edit was answered by {other:?}"),
        }
    }
    Ok(times)
}
