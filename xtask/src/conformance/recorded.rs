//! The recorded runs of the reference for the machines that it ships.

use anyhow::{Context as _, Result};
use serde_json::Value;

use super::observed::Observed;
use crate::workspace;

const FILE: &str = "tests/conformance/recorded/shipped.jsonl";

/// The recorded run of this machine, if there is one that says how it ends.
pub(crate) fn find(machine: &str) -> Result<Option<Observed>> {
    for line in workspace::read(FILE)?.lines() {
        let run: Value = serde_json::from_str(line).with_context(|| format!("{FILE}: not JSON"))?;
        if run["machine"] == machine && run["deterministic"] == true {
            return Observed::of_reference(&run).map(Some);
        }
    }
    Ok(None)
}
