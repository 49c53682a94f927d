//! Settings from the environment: `ROS_DOMAIN_ID` and the other common variables of ROS.

use std::path::PathBuf;

use crate::dds::participant::Settings;
use crate::json::Json;
use crate::types::library::Library;

/// The highest domain whose UDP ports are valid.
const DOMAIN_MAX: i128 = 232;

/// The settings of the requested node.
pub(crate) fn of(asked: &Json) -> Result<Settings, String> {
    let domain = match asked.get("domain") {
        Some(Json::Int(domain)) => *domain,
        Some(other) if *other != Json::Null => return Err("the domain is no number".to_owned()),
        _ => match variable("ROS_DOMAIN_ID") {
            None => 0,
            Some(text) => {
                text.trim().parse().map_err(|_| format!("ROS_DOMAIN_ID is no number: `{text}`"))?
            }
        },
    };
    if !(0..=DOMAIN_MAX).contains(&domain) {
        return Err(format!(
            "the domain {domain} is not between 0 and {DOMAIN_MAX}, the highest that ports of UDP allow"
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

/// A library that searches `folders`, those of `RAFCON_ROS_TYPES`, and the installations of ROS.
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

#[cfg(test)]
mod tests {
    use expect_test::{Expect, expect};

    use super::of;
    use crate::json;

    fn check(domain: &str, expected: Expect) {
        let text = format!(r#"{{"name": "a", "namespace": "/", "domain": {domain}}}"#);
        let found = of(&json::parse(text.as_bytes()).unwrap());
        expected.assert_eq(&found.map_or_else(|why| why, |made| made.domain.to_string()));
    }

    #[test]
    fn a_domain_that_ports_do_not_allow_is_refused() {
        check("0", expect!["0"]);
        check("232", expect!["232"]);
        check(
            "233",
            expect!["the domain 233 is not between 0 and 232, the highest that ports of UDP allow"],
        );
    }

    #[test]
    fn a_domain_that_is_no_domain_is_not_taken_for_none() {
        check(
            "-1",
            expect!["the domain -1 is not between 0 and 232, the highest that ports of UDP allow"],
        );
        check(r#""7""#, expect!["the domain is no number"]);
    }
}
