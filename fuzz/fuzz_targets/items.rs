//! Any bytes are items of a journal up to the first that is none; items that are written read back as they were.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rafcon_storage::journal::{Item, Moment, Places, Stored, record::Items};

fuzz_target!(|bytes: &[u8]| {
    let items: Vec<Item> = Items::new(bytes, 0).map_while(Result::ok).collect();
    let (mut once, mut before) = (Vec::new(), 0);
    items.iter().for_each(|item| item.write(&mut before, &mut once));
    let read: Vec<Item> = Items::new(&once, 0).map(|item| item.expect("our own bytes")).collect();
    // Bytes are compared, since one kind of float is not equal to itself.
    let (mut twice, mut before) = (Vec::new(), 0);
    read.iter().for_each(|item| item.write(&mut before, &mut twice));
    assert_eq!(once, twice);
    if let Ok(stored) = Stored::from_bytes(bytes) {
        let once = stored.to_bytes();
        assert_eq!(Stored::from_bytes(&once).map(|stored| stored.to_bytes()), Ok(once));
    }
    drop(Moment::from_bytes(bytes, Places::default()));
});
