//! Facts about the scripts of machines from Python's parser, cached by the text: after an edit, only one script is parsed.
//! Knows the interpreter of runs; never runs a script.

use super::interpreter;
use crate::child::{ChildLimits, ask};
use crate::{Settings, log};
use rafcon_check::{Facts, SCRIPT_READER, read_facts, request};
use rafcon_locks::Mutex;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::process::Command;
use tokio::runtime::Handle;

/// Capacity of the cache, in scripts.
const KEPT_MAX: usize = 100_000;
/// Approximate limit on the scripts per process, in bytes.
const PART_BYTES: usize = 1 << 20;
const BOUNDS: ChildLimits = ChildLimits { patience: Duration::from_secs(20), output: 64 << 20 };

/// The BLAKE3 of a script's text.
type Hash = [u8; 32];

/// Cached facts by the hash of the script's text.
#[derive(Debug, Default)]
pub(super) struct Known(Mutex<BTreeMap<Hash, Arc<Facts>>>);

impl Known {
    /// The facts about each text. `None` if they are unavailable. Call it on a blocking thread.
    pub(super) fn facts(&self, settings: &Settings, texts: &[&str]) -> Vec<Option<Arc<Facts>>> {
        let hashes: Vec<Hash> =
            texts.iter().map(|text| *blake3::hash(text.as_bytes()).as_bytes()).collect();
        let mut unread: Vec<(Hash, &str)> = Vec::new();
        {
            let known = self.0.lock();
            let all = hashes.iter().copied().zip(texts.iter().copied());
            unread.extend(all.filter(|(hash, _)| !known.contains_key(hash)));
        }
        for part in parts(&unread) {
            let texts: Vec<&str> = part.iter().map(|(_, text)| *text).collect();
            match Handle::current().block_on(read(settings, &texts)) {
                Ok(facts) => self.keep(part.iter().map(|(hash, _)| *hash).zip(facts)),
                Err(why) => {
                    log::say(&format!("scripts cannot be checked: {why}"));
                    break;
                }
            }
        }
        let known = self.0.lock();
        hashes.iter().map(|hash| known.get(hash).cloned()).collect()
    }

    fn keep(&self, facts: impl Iterator<Item = (Hash, Facts)>) {
        let mut known = self.0.lock();
        if known.len() >= KEPT_MAX {
            known.clear();
        }
        known.extend(facts.map(|(hash, facts)| (hash, Arc::new(facts))));
    }
}

/// Splits the texts into parts of limited size.
fn parts<'a, 't>(all: &'a [(Hash, &'t str)]) -> Vec<&'a [(Hash, &'t str)]> {
    let (mut parts, mut begin, mut bytes) = (Vec::new(), 0, 0);
    for (at, (_, text)) in all.iter().enumerate() {
        bytes += text.len();
        if bytes >= PART_BYTES {
            parts.push(&all[begin..=at]);
            (begin, bytes) = (at + 1, 0);
        }
    }
    if begin < all.len() {
        parts.push(&all[begin..]);
    }
    parts
}

async fn read(settings: &Settings, texts: &[&str]) -> Result<Vec<Facts>, String> {
    let interpreter = interpreter(settings)?;
    let mut python = Command::new(&interpreter.program);
    python.args(["-I", "-S", "-X", "utf8", "-c", SCRIPT_READER]).current_dir("/");
    let input = request(texts).map_err(|error| error.to_string())?;
    let said = ask(python, input, BOUNDS).await.map_err(|error| {
        format!("the interpreter `{interpreter}`: {error}; {}", interpreter.way_out())
    })?;
    read_facts(&said.output, texts.len()).map_err(|error| {
        let last = said.error.lines().last().unwrap_or("it printed nothing else");
        format!("the interpreter `{interpreter}`: {error}; {last}")
    })
}

#[cfg(test)]
mod tests {
    use super::{Facts, Hash, KEPT_MAX, Known};

    #[test]
    fn what_is_known_of_scripts_is_bounded() {
        let hash = |number: usize| *blake3::hash(&number.to_le_bytes()).as_bytes();
        let known = Known::default();
        let all: Vec<Hash> = (0..=KEPT_MAX).map(hash).collect();
        let keep = |some: &[Hash]| known.keep(some.iter().map(|hash| (*hash, Facts::default())));
        keep(&all[..KEPT_MAX]);
        assert_eq!(known.0.lock().len(), KEPT_MAX);
        // All of them are parsed again when needed.
        keep(&all[KEPT_MAX..]);
        assert_eq!(known.0.lock().keys().copied().collect::<Vec<_>>(), all[KEPT_MAX..]);
    }
}
