//! Expectations for single machines, read from `tests/conformance/expectations.json`.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::workspace;

const FILE: &str = "tests/conformance/expectations.json";
const DIFFERENCES: &str = "docs/differences.md";

#[derive(Debug)]
pub(crate) struct Expectations {
    machines: BTreeMap<String, Expected>,
}

/// Expectations for one machine.
#[derive(Debug, Clone)]
pub(crate) struct Expected {
    /// Reason for skipping the machine.
    pub(crate) skip: Option<String>,
    /// Requirement that is missing without desktop and robot; the machine takes its error path in both engines.
    pub(crate) needs: Option<String>,
    /// True if it never ends by itself: both engines are stopped, and their histories until then are compared.
    pub(crate) endless: bool,
    /// Time after which both engines stop it, in seconds.
    pub(crate) timeout_s: f64,
    /// First state of the run, as state ids joined by `/`.
    pub(crate) start_from: Option<String>,
    /// Replacements in the text of its scripts, for both engines, for example to make random numbers repeatable.
    pub(crate) replace: Vec<(String, String)>,
    /// Allowed differences, each with the explaining heading of `docs/differences.md`.
    differences: BTreeMap<String, String>,
}

impl Default for Expected {
    fn default() -> Self {
        Self {
            skip: None,
            needs: None,
            endless: false,
            timeout_s: 60.0,
            start_from: None,
            replace: Vec::new(),
            differences: BTreeMap::new(),
        }
    }
}

impl Expectations {
    /// Reads the file and checks that every explanation exists.
    pub(crate) fn read() -> Result<Self> {
        let text: Value = serde_json::from_str(&workspace::read(FILE)?)
            .with_context(|| format!("{FILE} is not JSON"))?;
        let machines =
            text["machines"].as_object().with_context(|| format!("{FILE} lacks `machines`"))?;
        let parse = |(name, entry): (&String, &Value)| {
            let expected = Expected::parse(entry).with_context(|| format!("{FILE}: {name}"))?;
            Ok((name.clone(), expected))
        };
        let read = Self { machines: machines.iter().map(parse).collect::<Result<_>>()? };
        read.check_headings()?;
        Ok(read)
    }

    /// Expectations for this machine; the default for most.
    pub(crate) fn of(&self, machine: &str) -> Expected {
        self.machines.get(machine).cloned().unwrap_or_default()
    }

    /// Names of expected machines that do not exist.
    pub(crate) fn unknown<'a>(&'a self, cases: &'a [String]) -> impl Iterator<Item = &'a String> {
        self.machines.keys().filter(|name| !cases.contains(name))
    }

    fn check_headings(&self) -> Result<()> {
        let document = workspace::read(DIFFERENCES).unwrap_or_default();
        let headings = document
            .lines()
            .filter(|line| line.starts_with('#'))
            .map(|line| line.trim_start_matches('#').trim());
        let headings = headings.collect::<Vec<_>>();
        for (machine, expected) in &self.machines {
            for heading in expected.differences.values() {
                if !headings.contains(&heading.as_str()) {
                    bail!(
                        "{FILE}: {machine} names `{heading}`, which is no heading of {DIFFERENCES}"
                    );
                }
            }
        }
        Ok(())
    }
}

impl Expected {
    /// The heading that explains a difference in `what`.
    pub(crate) fn explanation(&self, what: &str) -> Option<&str> {
        self.differences.get(what).map(String::as_str)
    }

    fn parse(entry: &Value) -> Result<Self> {
        let mut expected = Self::default();
        for (key, value) in entry.as_object().context("not an object")? {
            expected.set(key, value).with_context(|| format!("`{key}`"))?;
        }
        Ok(expected)
    }

    fn set(&mut self, key: &str, value: &Value) -> Result<()> {
        match key {
            "skip" => self.skip = Some(text(value)?),
            "needs" => self.needs = Some(text(value)?),
            "endless" => self.endless = value.as_bool().context("not true or false")?,
            "timeout_s" => self.timeout_s = value.as_f64().context("not a number")?,
            "start_from" => self.start_from = Some(text(value)?),
            "replace" => self.replace = pairs(value)?,
            "differences" => self.differences = pairs(value)?.into_iter().collect(),
            _ => bail!("unknown key"),
        }
        Ok(())
    }
}

fn text(value: &Value) -> Result<String> {
    value.as_str().map(str::to_owned).context("not a text")
}

fn pairs(value: &Value) -> Result<Vec<(String, String)>> {
    let object = value.as_object().context("not an object")?;
    object.iter().map(|(key, value)| Ok((key.clone(), text(value)?))).collect()
}
