//! Any text is a config.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_storage::config::parse;
use std::path::Path;

fuzz_target!(|text: &str| {
    parse(text, Path::new("/etc/rafcon"), &|name: &str| {
        (name == "HOME").then(|| "/home/me".to_owned())
    });
});
