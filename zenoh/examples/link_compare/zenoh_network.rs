//! Zenoh over TCP: two peers, one key.

use crate::Trial;
use crate::events::number;
use crate::figures::{Figures, Recorder};
use crate::proxy::Carries;
use anyhow::{Context as _, Result, anyhow};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use zenoh::{Config, Session};
use zenoh_ext::{
    AdvancedPublisherBuilderExt as _, AdvancedSubscriberBuilderExt as _, CacheConfig,
    HistoryConfig, MissDetectionConfig, RecoveryConfig,
};

const KEY: &str = "rafcon/fleet/scout/events";

/// Which of its forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// As it is set up by itself.
    Plain,
    /// With a cache, detection of misses and recovery.
    Advanced,
    /// A connection that is silent for less than an hour is kept.
    LongLease,
}

/// Puts each event under one key.
pub(crate) async fn carry(trial: &Trial, kind: Kind) -> Result<Figures> {
    let station = open(kind, "listen/endpoints", "tcp/127.0.0.1:0").await?;
    let locator = station.info().locators().await.into_iter().next().context("it listens")?;
    let address: SocketAddr = locator.address().to_string().parse()?;
    let proxy = trial.link(Carries::Connections, address)?;
    let recorder = Arc::new(Recorder::new(trial.begin, &trial.events));
    let notes = Arc::clone(&recorder);
    let note = move |bytes: &[u8]| notes.note(number(bytes).unwrap_or(usize::MAX));
    let robot = open(kind, "connect/endpoints", &format!("tcp/{}", proxy.address)).await?;
    let sends = trial.clone();
    if kind == Kind::Advanced {
        let subscriber = station.declare_subscriber(KEY);
        let subscriber = subscriber.callback(move |sample| note(&sample.payload().to_bytes()));
        let subscriber = subscriber
            .history(HistoryConfig::default().detect_late_publishers())
            .recovery(RecoveryConfig::default().heartbeat())
            // The usual 10 s are over before an answer is here.
            .query_timeout(Duration::from_secs(120))
            .subscriber_detection();
        subscriber.background().await.map_err(|error| anyhow!(error))?;
        let publisher = robot.declare_publisher(KEY);
        let publisher = publisher
            .cache(CacheConfig::default().max_samples(100_000))
            .sample_miss_detection(
                MissDetectionConfig::default().heartbeat(Duration::from_millis(500)),
            )
            .publisher_detection();
        let publisher = publisher.await.map_err(|error| anyhow!(error))?;
        tokio::spawn(async move {
            for number in sends.numbers() {
                sends.happens(number).await;
                drop(publisher.put(sends.events.numbered(number)).await);
            }
            std::future::pending::<()>().await;
        });
    } else {
        let subscriber = station.declare_subscriber(KEY);
        let subscriber = subscriber.callback(move |sample| note(&sample.payload().to_bytes()));
        subscriber.background().await.map_err(|error| anyhow!(error))?;
        let publisher = robot.declare_publisher(KEY).await.map_err(|error| anyhow!(error))?;
        tokio::spawn(async move {
            for number in sends.numbers() {
                sends.happens(number).await;
                drop(publisher.put(sends.events.numbered(number)).await);
            }
            std::future::pending::<()>().await;
        });
    }
    let figures = trial.judge(proxy, &recorder).await;
    // Both live as long as the trial.
    drop((station, robot));
    figures
}

async fn open(kind: Kind, endpoint: &str, address: &str) -> Result<Session> {
    let mut config = Config::default();
    let endpoints = format!("[{address:?}]");
    let mut settings = vec![
        (endpoint, endpoints.as_str()),
        ("mode", "\"peer\""),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("timestamping/enabled", "true"),
        // The usual limits are shorter than it takes to connect over this delay.
        ("transport/unicast/open_timeout", "60000"),
        ("transport/unicast/accept_timeout", "60000"),
        ("connect/timeout_ms", "-1"),
        ("connect/exit_on_failure", "false"),
        (
            "connect/retry",
            "{ period_init_ms: 1000, period_max_ms: 2000, period_increase_factor: 2 }",
        ),
    ];
    if endpoint == "connect/endpoints" {
        settings.push(("listen/endpoints", "[]"));
    }
    if kind == Kind::LongLease {
        settings.push(("transport/link/tx/lease", "3600000"));
    }
    for (key, value) in settings {
        config.insert_json5(key, value).map_err(|error| anyhow!(error).context(key.to_owned()))?;
    }
    zenoh::open(config).await.map_err(|error| anyhow!(error))
}
