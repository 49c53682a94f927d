//! Any text is JSON or an error; what is written reads back as it was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_model::json::{parse, write};

fuzz_target!(|text: &str| {
    if let Ok(document) = parse(text) {
        let once = write(&document);
        assert_eq!(parse(&once).map(|document| write(&document)), Ok(once));
    }
});
