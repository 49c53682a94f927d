//! Robots currently in the network, from their liveliness tokens. Nothing else depends on these tokens.

use crate::command_line::{Network, print};
use anyhow::{Result, anyhow};
use std::collections::BTreeSet;

/// Timeout of the connection to the network, in ms.
const TIMEOUT_MS: &str = "10000";

/// Prints the robots, one a line.
pub(crate) async fn list(network: &Network) -> Result<()> {
    let mut config = network.config()?;
    let session = async {
        config.insert_json5("connect/timeout_ms", TIMEOUT_MS)?;
        config.insert_json5("connect/exit_on_failure", "true")?;
        zenoh::open(config).await
    };
    let session = session.await;
    let session = session.map_err(|error| anyhow!(error).context("the network is not reached"))?;
    let tokens = session.liveliness().get(network.fleet.presence("*")).await;
    let tokens = tokens.map_err(|error| anyhow!(error))?;
    let mut robots = BTreeSet::new();
    while let Ok(reply) = tokens.recv_async().await {
        let found = reply.result().ok().map(|sample| sample.key_expr().as_str().to_owned());
        robots.extend(found.as_deref().and_then(|key| network.fleet.robot(key)).map(str::to_owned));
    }
    robots.iter().for_each(|robot| print(robot));
    session.close().await.map_err(|error| anyhow!(error))
}
