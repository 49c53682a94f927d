//! Recorded runs of a server, read over the network: events, moments and files as for local runs.

use super::kept::nanos;
use super::remote;
use crate::cli;
use crate::client::Server;
use crate::environment::Environment;
use crate::failure::Usage;
use anyhow::{Context as _, Result, anyhow};
use rafcon_protocol::Event;
use rafcon_protocol::api::{Comparison, EventPage, ExportFormat, Moment, RunSummary};
use rafcon_storage::journal::{DAMAGED, Filter, Found};
use serde::Deserialize;
use std::io::{self, BufRead as _, BufReader, Read};
use std::sync::Arc;
use std::time::Duration;

/// Buffer size for reading from the network, in bytes.
const READ_AT_ONCE: usize = 64 * 1024;

/// A server with runs.
pub(super) struct Keeper {
    server: Arc<Server>,
}

/// A recorded run of a server.
pub(super) struct Kept<'k> {
    keeper: &'k Keeper,
    pub(super) summary: RunSummary,
}

/// An event in the export format.
#[derive(Deserialize)]
struct ExportedLine {
    sequence: u64,
    t_ns: u64,
    names: String,
    next: Option<String>,
    lasted_ns: Option<u64>,
    event: Event,
}

impl Keeper {
    /// The server from the options, if any.
    pub(super) fn named(
        raw: &cli::KeptRemote,
        runs: &cli::Runs,
        environment: &Environment,
    ) -> Result<Option<Self>> {
        if raw.server.is_none() {
            return Ok(None);
        }
        remote::refuse_runs(runs, environment)?;
        let cli::KeptRemote { server, token_file, fingerprint, server_state } = raw;
        let access = cli::Access {
            token_file: token_file.clone(),
            fingerprint: fingerprint.clone(),
            state: cli::State { folder: server_state.clone() },
        };
        let raw = cli::Remote { server: server.clone(), access };
        Ok(remote::server(&raw, environment)?.map(|server| Self { server }))
    }

    /// The run with this id, start of an id, or `last`.
    pub(super) fn run(&self, text: &str) -> Result<Kept<'_>> {
        Ok(Kept { keeper: self, summary: remote::run(&self.server, text)? })
    }

    /// Comparison of two runs.
    pub(super) fn compare(&self, one: &Kept<'_>, other: &Kept<'_>) -> Result<Comparison> {
        Ok(self.server.get(&format!("{}/compare/{}", one.path(), other.id()))?)
    }
}

impl Kept<'_> {
    fn id(&self) -> String {
        crate::client::escaped(&self.summary.id)
    }

    fn path(&self) -> String {
        format!("/runs/{}", self.id())
    }

    fn get<T: serde::de::DeserializeOwned>(&self, below: &str) -> Result<T> {
        Ok(self.keeper.server.get(&format!("{}/{below}", self.path()))?)
    }

    /// Shows the selected events that can be read. Returns the damage of the rest.
    pub(super) fn find(
        &self,
        filter: &Filter,
        mut show: impl FnMut(Found) -> Result<()>,
    ) -> Result<Result<()>> {
        let mut lines = BufReader::with_capacity(READ_AT_ONCE, self.export(&query(filter))?);
        let (mut damage, mut line): (Option<String>, _) = (None, String::new());
        loop {
            line.clear();
            match lines.read_line(&mut line) {
                Ok(0) => return Ok(damage.map_or(Ok(()), |what| Err(self.damaged(&what)))),
                Ok(_) => {}
                // The server truncates the response if it detects damage.
                Err(error) => {
                    return Ok(
                        Err(damage.map_or_else(|| ended(error), |what| self.damaged(&what))),
                    );
                }
            }
            let ExportedLine { sequence, t_ns, names, next, lasted_ns, event } =
                serde_json::from_str(&line)
                    .context("cannot understand the answer of the server")?;
            if let Event::Damaged { what, .. } = &event {
                damage = Some(what.clone());
            } else if line.contains(DAMAGED) {
                damage.get_or_insert_with(|| format!("a value of event {sequence} cannot be read"));
            }
            let lasted = lasted_ns.map(Duration::from_nanos);
            show(Found { sequence, t_ns, event, names, next, lasted })?;
        }
    }

    /// The run in an export format.
    pub(super) fn export(&self, query: &str) -> Result<impl Read + use<>> {
        Ok(self.keeper.server.open(&format!("{}/export?{query}", self.path()))?)
    }

    /// A moment of the run, by event number or time, and the number of the run's last event.
    pub(super) fn moment(&self, at: Option<u64>, time: Option<Duration>) -> Result<(Moment, u64)> {
        let EventPage { last, .. } = self.get("events?from=1&count=1")?;
        let picture: Moment = match (at, time) {
            (Some(at), _) if at > last => {
                let reason = format!("event {at} does not exist yet; the last event is {last}");
                return Err(Usage(reason).into());
            }
            (Some(at), _) => self.get(&format!("moments/{at}"))?,
            (None, Some(time)) => self.get(&format!("moments?t_ns={}", nanos(time)))?,
            (None, None) => self.get(&format!("moments/{last}"))?,
        };
        Ok((picture, last))
    }

    /// Error for a damaged journal.
    pub(super) fn damaged(&self, what: &str) -> anyhow::Error {
        anyhow!("the journal of {} is damaged: {what}", self.summary.id)
    }
}

fn ended(error: io::Error) -> anyhow::Error {
    anyhow::Error::from(error)
        .context("the answer of the server is incomplete: the journal is damaged, or the connection was lost")
}

/// The filter as the query of a request.
fn query(filter: &Filter) -> String {
    let Filter { state, outcome, text, kinds, level, from_ns, to_ns } = filter;
    let kinds = (!kinds.is_empty()).then(|| kinds.join(","));
    let level = level.map(|level| format!("{level:?}").to_lowercase());
    let [since, until] = [from_ns, to_ns].map(|ns| ns.map(|ns| ns.to_string()));
    let words = [
        ("state", state.clone()),
        ("outcome", outcome.clone()),
        ("text", text.clone()),
        ("kinds", kinds),
        ("level", level),
        ("since_ns", since),
        ("until_ns", until),
    ];
    let words = words.into_iter().filter_map(|(name, value)| Some((name, value?)));
    let words = words.map(|(name, value)| format!("&{name}={}", crate::client::escaped(&value)));
    format!("{}{}", format_query(ExportFormat::Jsonl), words.collect::<String>())
}

/// The query for the whole run in a format.
pub(super) fn format_query(format: ExportFormat) -> String {
    let name = match format {
        ExportFormat::Jsonl => "jsonl",
        ExportFormat::Csv => "csv",
        ExportFormat::Mcap => "mcap",
    };
    format!("format={name}")
}
