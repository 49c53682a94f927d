//! Any text is a frame for the server or an error; a frame that is spelled reads back as it was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_protocol::socket::ToServer;

fuzz_target!(|text: &str| {
    if let Ok(frame) = serde_json::from_str::<ToServer>(text) {
        let once = serde_json::to_string(&frame).expect("our own frame has a spelling");
        let again: ToServer = serde_json::from_str(&once).expect("our own text is a frame");
        assert_eq!(serde_json::to_string(&again).expect("it has a spelling"), once);
    }
});
