//! Serializes a machine's document as JSON directly from the machine, in parallel: a large document has many MB. Knows machines
//! and text, but not the client.

use rafcon_model::{Machine, State};
use rafcon_protocol::document::{HeaderDocument, StateDocument, states_of};
use serde_json::Result;
use std::thread::{self, ScopedJoinHandle};

/// Fewer states than this are not worth a thread.
const WORTH_A_THREAD: usize = 1000;
/// More threads than this bring no speed-up.
const MAX_THREADS: usize = 8;

/// A machine as [`rafcon_protocol::document::Document`] in JSON.
pub(crate) fn document_text(machine: &Machine) -> Result<Vec<u8>> {
    let states = states_of(machine);
    let threads = thread::available_parallelism().map_or(1, usize::from).min(MAX_THREADS);
    shared(machine, &states, states.len().div_ceil(threads).max(WORTH_A_THREAD))
}

/// Writes `share` states per thread.
fn shared(machine: &Machine, states: &[(String, &State)], share: usize) -> Result<Vec<u8>> {
    let parts: Result<Vec<_>> = thread::scope(|scope| {
        let parts = states.chunks(share).map(|states| scope.spawn(move || written(states)));
        let parts: Vec<_> = parts.collect();
        parts.into_iter().map(joined).collect()
    });
    let header = serde_json::to_string(&HeaderDocument::of(&machine.header))?;
    let head = format!(r#"{{"header":{header},"states":["#);
    Ok(whole(&head, &parts?))
}

/// Joins the parts with commas, and copies each once.
fn whole(head: &str, parts: &[Vec<u8>]) -> Vec<u8> {
    let bytes: usize = parts.iter().map(|part| part.len() + 1).sum();
    let mut text = Vec::with_capacity(head.len() + bytes + 1);
    text.extend_from_slice(head.as_bytes());
    for (number, part) in parts.iter().enumerate() {
        if number > 0 {
            text.push(b',');
        }
        text.extend_from_slice(part);
    }
    text.extend_from_slice(b"]}");
    text
}

fn joined(part: ScopedJoinHandle<'_, Result<Vec<u8>>>) -> Result<Vec<u8>> {
    part.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

fn written(states: &[(String, &State)]) -> Result<Vec<u8>> {
    let mut text = Vec::new();
    for (path, state) in states {
        if !text.is_empty() {
            text.push(b',');
        }
        serde_json::to_writer(&mut text, &StateDocument::of(path, state))?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rafcon_protocol::document::Document;
    use rafcon_testkit::notation;

    #[test]
    fn however_many_write_it_the_text_is_that_of_the_document() {
        let machine = notation::parse(
            "
            hierarchy ROOT
              outcome success
              in a: int = 3
              start -> AAAAAA
              AAAAAA.success -> .success
              flow .a -> AAAAAA.x
              execution AAAAAA
                outcome success
                in x: int
                script \"x = 1\"
              barrier BBBBBB
                execution DDDDDD
                decider unique_decider_state_id
              library EEEEEE from \"lib/one\"
                missing \"no folder\"
            ",
        );
        let machine = machine.expect("a machine in the notation");
        let document = serde_json::to_vec(&Document::of(&machine)).expect("JSON");
        let states = states_of(&machine);
        for share in 1..=states.len() + 1 {
            assert_eq!(shared(&machine, &states, share).expect("JSON"), document);
        }
        assert_eq!(document_text(&machine).expect("JSON"), document);
    }
}
