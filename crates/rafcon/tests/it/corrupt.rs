//! Runs of which a file is damaged, as the commands read them: what is told with exit code 0 is what was written.
//!
//! The seeds begin at the day's date; `RAFCON_TEST_SEED` gives another first one, `RAFCON_TEST_CORRUPTIONS` their count. Storage
//! has the same test without processes, for many more.

use crate::harness::Place;
use crate::kept_runs::{END, RUN, keep};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// So many corruptions in a usual run of the tests.
const FEW: u64 = 12;
const PAGE: usize = 4096;
const WORDS: [&str; 8] = [
    "history damaged --values --json",
    "history damaged",
    "log damaged --json",
    "replay damaged --json",
    "compare damaged whole --json",
    "export damaged --format jsonl",
    "export damaged --format csv",
    "runs --json",
];

fn number(name: &str) -> Option<u64> {
    std::env::var_os(name)?.to_str()?.parse().ok()
}

#[expect(clippy::disallowed_methods, reason = "each day begins with seeds of its own")]
fn today() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs() / 86_400 * 1_000_000
}

/// Splitmix64.
fn next(state: &mut u64, end: usize) -> usize {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut mixed = *state;
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    usize::try_from((mixed ^ (mixed >> 31)) % end.max(1) as u64).unwrap()
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
    }
}

/// Changes a file of a run; says what it did. A recorder is mostly empty: what counts is at its beginning.
fn corrupt(folder: &Path, state: &mut u64) -> String {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        files.filter(|file| fs::metadata(file).unwrap().len() > 0).collect();
    files.sort();
    let file = &files[next(state, files.len())];
    let mut bytes = fs::read(file).unwrap();
    let at = next(state, bytes.len().min(64 << 10));
    let page = at / PAGE * PAGE;
    let end = (page + PAGE).min(bytes.len());
    let what = match next(state, 6) {
        0..=2 => {
            bytes[at] ^= 1 << next(state, 8);
            format!("one bit of byte {at}")
        }
        3 => {
            bytes[page..end].fill(0);
            format!("zeros from {page}")
        }
        4 => {
            bytes.truncate(at);
            format!("cut at {at}")
        }
        _ => {
            let other = next(state, bytes.len().min(64 << 10)) / PAGE * PAGE;
            let length = (end - page).min(bytes.len() - other);
            for offset in 0..length {
                bytes.swap(page + offset, other + offset);
            }
            format!("pages at {page} and {other} swapped")
        }
    };
    fs::write(file, &bytes).unwrap();
    format!("{}: {what}", file.file_name().unwrap().display())
}

/// What a command says, its exit code, and whether it says that something is wrong.
fn said(place: &Place, words: &str) -> (Option<i32>, String, bool) {
    let answer = place.call(&format!("{words} --runs runs"));
    let is_said = !answer.stderr.is_empty() || answer.stdout.contains("\"unreadable\"");
    assert!(!answer.stderr.contains("panicked"), "{words}: {}", answer.stderr);
    (answer.code, without_size(&answer.stdout), is_said)
}

/// A file that was cut takes less.
fn without_size(text: &str) -> String {
    let line = |line: &str| match serde_json::from_str::<Value>(line) {
        Ok(mut json) if json.get("bytes").is_some() => {
            json["bytes"].take();
            json.to_string()
        }
        _ => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn what_is_told_of_a_damaged_run_is_true() {
    let clean = Place::empty();
    keep(&clean, "ended", &format!("{RUN}{END}"), false);
    keep(&clean, "died", RUN, true);
    let place_of = |which: &str| {
        let place = Place::empty();
        for name in ["damaged", "whole"] {
            copy(&clean.path("runs").join(which), &place.path("runs").join(name));
        }
        place
    };
    let truths = ["ended", "died"].map(|which| {
        let place = place_of(which);
        WORDS.map(|words| said(&place, words))
    });
    let from = number("RAFCON_TEST_SEED").unwrap_or_else(today);
    for seed in from..from + number("RAFCON_TEST_CORRUPTIONS").unwrap_or(FEW) {
        let which = usize::try_from(seed % 2).unwrap();
        let place = place_of(["ended", "died"][which]);
        let what = corrupt(&place.path("runs/damaged"), &mut seed.clone());
        for (words, (code, right, _)) in WORDS.iter().zip(&truths[which]) {
            let (told_code, told, is_said) = said(&place, words);
            let is_true = told_code == *code && told == *right;
            assert!(
                is_true || (told_code.is_some_and(|code| code > 0) && is_said),
                "RAFCON_TEST_SEED={seed}: {what}: {words}: {told_code:?} {told}\ninstead of {right}"
            );
        }
    }
}
