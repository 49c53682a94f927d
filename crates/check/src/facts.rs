//! Facts about scripts from Python's parser. Python reads many scripts at a time and runs none of them. Knows the two sides
//! of that conversation, but not how the interpreter is started.

use serde::{Deserialize, Serialize};

/// The program that reads scripts: `python3 -I -c SCRIPT_READER`, with a [`request`] on its standard input.
pub const SCRIPT_READER: &str = include_str!("scripts.py");

/// Contents of a script that are known without running it. Lines count from 1. The keys are those of `scripts.py`.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "each answers a question of its own")]
pub struct Facts {
    pub(crate) syntax: Option<Syntax>,
    /// Line of the first conflict marker in a script that does not parse.
    pub(crate) conflict: Option<u64>,
    pub(crate) execute: bool,
    pub(crate) r#async: Vec<u64>,
    pub(crate) line: Option<u64>,
    pub(crate) takes_four: bool,
    pub(crate) returns_nothing: bool,
    pub(crate) raises: bool,
    pub(crate) outcomes: Vec<(u64, Returned)>,
    /// Input ports that `execute` reads, whatever is given to it.
    pub(crate) inputs: Vec<(u64, String)>,
    /// Output ports that `execute` writes.
    pub(crate) outputs: Vec<(u64, String)>,
    /// Global variables that are read without looking whether they exist.
    pub(crate) globals_read: Vec<(u64, String)>,
    /// Global variables that are set.
    pub(crate) globals_set: Vec<String>,
    /// True if the script may set global variables whose names it does not contain.
    pub(crate) sets_any_global: bool,
}

/// Syntax error of a script.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Syntax {
    pub(crate) line: Option<u64>,
    pub(crate) message: String,
}

/// A constant that a script returns.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub(crate) enum Returned {
    Name(String),
    Id(serde_json::Number),
}

/// Fault of an interpreter's answer.
#[derive(Debug, thiserror::Error)]
pub enum FactsError {
    /// It is not what the program writes.
    #[error("cannot understand its answer: {0}")]
    Strange(#[from] serde_json::Error),
    /// It is about other scripts.
    #[error("it got {asked} scripts and answered for {answered}")]
    Count {
        /// Number of scripts in the request.
        asked: usize,
        /// Number of scripts in the output.
        answered: usize,
    },
}

#[derive(Serialize)]
struct Request<'a> {
    scripts: &'a [&'a str],
}

/// Input of the program: the texts of scripts.
pub fn request(scripts: &[&str]) -> Result<Vec<u8>, FactsError> {
    Ok(serde_json::to_vec(&Request { scripts })?)
}

/// Parses the output of the program for this number of scripts, in their order.
pub fn read_facts(answer: &[u8], asked: usize) -> Result<Vec<Facts>, FactsError> {
    let facts: Vec<Facts> = serde_json::from_slice(answer)?;
    if facts.len() != asked {
        return Err(FactsError::Count { asked, answered: facts.len() });
    }
    Ok(facts)
}
