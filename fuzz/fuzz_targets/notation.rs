//! Any text is a machine or an error; a machine that is printed reads back as it was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_testkit::notation::{parse, print};

fuzz_target!(|text: &str| {
    if let Ok(machine) = parse(text) {
        let once = print(&machine);
        let again = parse(&once).expect("our own text is a machine");
        assert_eq!(print(&again), once);
    }
});
