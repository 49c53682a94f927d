//! Whatever a runner sends: it is events, or broken.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_storage::journal::stream::StreamReader;

fuzz_target!(|bytes: &[u8]| {
    let mut reader = StreamReader::new(0, true, None);
    drop(reader.read(bytes, |_, _, event| drop(event)));
});
