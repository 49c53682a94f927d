//! Carries the same events over the same bad link in several ways at once, in real time, and compares what arrives:
//! `cargo xtask link-compare`.
//!
//! Each way has a link proxy of its own. It takes four and a half minutes.

#![expect(clippy::disallowed_methods, reason = "it compares in real time")]

mod datagrams;
mod events;
mod figures;
mod ours;
mod proxy;
mod quic;
mod zenoh_network;

use anyhow::{Context as _, Result, bail};
use events::Events;
use figures::{Figures, Recorder, json, table};
use proxy::{Carries, Proxy};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::time::sleep_until;
use zenoh_network::Kind;

/// All ways are ready by then.
const BEGIN: Duration = Duration::from_secs(30);
/// Since the begin: when the link is cut, when it returns, when the mission is over, when nothing more is waited for.
const CUT: Duration = Duration::from_secs(60);
const RETURN: Duration = Duration::from_secs(120);
pub(crate) const LAST: Duration = Duration::from_secs(200);
const END: Duration = Duration::from_secs(240);

/// What all ways share.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// Time counts from here.
    pub(crate) begin: Instant,
    pub(crate) events: Arc<Events>,
    proxy: PathBuf,
}

impl Trial {
    /// Waits until so long after the begin.
    pub(crate) async fn reach(&self, time: Duration) {
        sleep_until((self.begin + time).into()).await;
    }

    /// The numbers of the events.
    pub(crate) fn numbers(&self) -> std::ops::Range<usize> {
        0..self.events.list.len()
    }

    /// Waits until this event happens.
    pub(crate) async fn happens(&self, number: usize) {
        self.reach(self.events.list[number].time).await;
    }

    /// A link to this address.
    pub(crate) fn link(&self, carries: Carries, to: std::net::SocketAddr) -> Result<Proxy> {
        Proxy::start(&self.proxy, carries, to)
    }

    /// Cuts the link and mends it, waits until the end, and says what has arrived.
    pub(crate) async fn judge(&self, mut proxy: Proxy, recorder: &Recorder) -> Result<Figures> {
        self.reach(Duration::ZERO).await;
        let before = proxy.bytes()?;
        self.reach(CUT).await;
        let bytes = proxy.bytes()? - before;
        proxy.say("cut")?;
        self.reach(RETURN).await;
        proxy.say("mend")?;
        self.reach(END).await;
        Ok(recorder.figures(&self.events, bytes, (CUT, RETURN)))
    }
}

#[tokio::main]
async fn main() -> ExitCode {
    match run().await {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

async fn run() -> Result<String> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (is_json, files) = match words.split_last() {
        Some((last, files)) if last == "--json" => (true, files),
        _ => (false, &words[..]),
    };
    let [events, proxy] = files else {
        bail!("usage: link_compare EVENTS PROXY [--json]; `cargo xtask link-compare` calls it so");
    };
    let events = Events::read(events.as_ref()).with_context(|| format!("cannot use {events}"))?;
    let begin = Instant::now() + BEGIN;
    let trial = Trial { begin, events: Arc::new(events), proxy: proxy.into() };
    let (ours, plain, advanced, long, quic, datagrams) = tokio::join!(
        ours::carry(&trial),
        zenoh_network::carry(&trial, Kind::Plain),
        zenoh_network::carry(&trial, Kind::Advanced),
        zenoh_network::carry(&trial, Kind::LongLease),
        quic::carry(&trial),
        datagrams::carry(&trial),
    );
    let rows = [
        ("RAFCON's link", ours),
        ("Zenoh, as it is", plain),
        ("Zenoh, advanced publisher and subscriber", advanced),
        ("Zenoh, a lease of an hour", long),
        ("QUIC", quic),
        ("a datagram for each change", datagrams),
    ];
    let rows = rows.map(|(name, figures)| Ok((name, figures.context(name)?)));
    let rows = rows.into_iter().collect::<Result<Vec<_>>>()?;
    Ok(if is_json { json(&rows) } else { table(&rows) })
}
