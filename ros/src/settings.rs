//! What the environment says: `ROS_DOMAIN_ID` and what else all programs of ROS heed.

use std::path::PathBuf;

use crate::dds::participant::Settings;
use crate::json::Json;
use crate::types::library::Library;

/// The highest domain that ports of UDP allow.
const DOMAIN_MAX: u64 = 232;

/// How the node is to be.
pub(crate) fn of(asked: &Json) -> Result<Settings, String> {
    let domain = match asked.number("domain") {
        Ok(domain) => domain,
        Err(_) => match variable("ROS_DOMAIN_ID") {
            None => 0,
            Some(text) => {
                text.trim().parse().map_err(|_| format!("ROS_DOMAIN_ID is no number: `{text}`"))?
            }
        },
    };
    if domain > DOMAIN_MAX {
        return Err(format!(
            "the domain {domain} is above {DOMAIN_MAX}, the highest that ports of UDP allow"
        ));
    }
    let range = variable("ROS_AUTOMATIC_DISCOVERY_RANGE").unwrap_or_default().to_ascii_uppercase();
    let local = matches!(range.as_str(), "LOCALHOST" | "OFF")
        || variable("ROS_LOCALHOST_ONLY").as_deref() == Some("1");
    Ok(Settings {
        name: asked.text("name")?.to_owned(),
        namespace: asked.text("namespace")?.to_owned(),
        domain: u16::try_from(domain).unwrap_or_default(),
        local,
    })
}

/// A library that looks into `folders`, those of `RAFCON_ROS_TYPES`, and the installations of ROS.
pub(crate) fn library(mut folders: Vec<PathBuf>) -> Library {
    folders.extend(paths("RAFCON_ROS_TYPES"));
    Library::new(folders, &paths("AMENT_PREFIX_PATH"))
}

#[expect(clippy::disallowed_methods, reason = "this module is where the environment is read")]
fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|text| !text.is_empty())
}

fn paths(name: &str) -> Vec<PathBuf> {
    let paths = std::env::var_os(name);
    paths
        .iter()
        .flat_map(std::env::split_paths)
        .filter(|path| !path.as_os_str().is_empty())
        .collect()
}
