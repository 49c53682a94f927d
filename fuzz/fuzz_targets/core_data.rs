//! Any document is a state or a fault; a state that is written reads back without new faults.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_storage::{core_data, state_from_core_data};

fuzz_target!(|text: &str| {
    if let Ok((state, _)) = state_from_core_data(text, "folder_FOLDER") {
        let once = core_data(&state);
        let again = state_from_core_data(&once, "folder_FOLDER").expect("our own text is a state");
        assert_eq!(core_data(&again.0), once);
    }
});
