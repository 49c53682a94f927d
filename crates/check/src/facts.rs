//! What Python's parser says about the text of a script. Python reads many at a time and runs none of them. Knows the two sides
//! of that conversation, but not how the interpreter is started.

use serde::{Deserialize, Serialize};

/// The program that reads scripts: `python3 -I -c SCRIPT_READER`, with a [`request`] on its standard input.
pub const SCRIPT_READER: &str = include_str!("scripts.py");

/// What stands in a script, as far as it can be said without running it. Lines count from 1. The keys are those of `scripts.py`.
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
    /// Whether the script may set global variables whose names do not stand in it.
    pub(crate) sets_any_global: bool,
}

/// Why a script does not parse.
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

/// Why an interpreter's answer is none.
#[derive(Debug, thiserror::Error)]
pub enum FactsError {
    /// It is not what the program writes.
    #[error("cannot understand its answer: {0}")]
    Strange(#[from] serde_json::Error),
    /// It is about other scripts.
    #[error("it got {asked} scripts and answered for {answered}")]
    Count {
        /// So many were asked about.
        asked: usize,
        /// So many answers came.
        answered: usize,
    },
}

#[derive(Serialize)]
struct Request<'a> {
    scripts: &'a [&'a str],
}

/// What the program reads: the texts of scripts.
pub fn request(scripts: &[&str]) -> Result<Vec<u8>, FactsError> {
    Ok(serde_json::to_vec(&Request { scripts })?)
}

/// What the program has written about so many scripts, in their order.
pub fn read_facts(answer: &[u8], asked: usize) -> Result<Vec<Facts>, FactsError> {
    let facts: Vec<Facts> = serde_json::from_slice(answer)?;
    if facts.len() != asked {
        return Err(FactsError::Count { asked, answered: facts.len() });
    }
    Ok(facts)
}
