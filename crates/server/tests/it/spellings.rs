//! Every spelling of a machine's name leads to one open machine.

use crate::harness::TestServer;
use crate::machines::{MACHINE, get, open, write};
use proptest::prelude::*;
use std::os::unix::fs::symlink;
use std::sync::LazyLock;

/// A server with a machine in `folder/hello`, to which links lead as well.
static SERVER: LazyLock<TestServer> = LazyLock::new(|| {
    let server = TestServer::new();
    write(&server, "folder/hello", MACHINE);
    write(&server, "folder/Hello", MACHINE);
    symlink("folder", server.project().join("linked")).unwrap();
    symlink("folder/hello", server.project().join("short")).unwrap();
    server
});

/// Paths of the machine's folder in various spellings.
fn spelling() -> impl Strategy<Value = String> {
    let folder = prop_oneof![
        Just(vec!["folder", "hello"]),
        Just(vec!["linked", "hello"]),
        Just(vec!["short"]),
    ];
    let file =
        prop_oneof![Just(None), Just(Some("statemachine.json")), Just(Some("core_data.json")),];
    let between = prop_oneof![Just("/"), Just("//"), Just("/./"), Just("///")];
    let begin = prop_oneof![Just(""), Just("./")];
    let end = prop_oneof![Just(""), Just("/"), Just("/."), Just("//")];
    (folder, file, between, begin, end).prop_map(|(mut names, file, between, begin, end)| {
        names.extend(file);
        format!("{begin}{}{end}", names.join(between))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn every_spelling_of_a_machine_opens_the_same_one(spelling in spelling()) {
        let id = open(&SERVER, &spelling);
        prop_assert_eq!(&id, &open(&SERVER, "folder/hello"));
        prop_assert_ne!(&id, &open(&SERVER, "folder/Hello"));
        let summary = get(&SERVER, &format!("/{id}"))["summary"].clone();
        prop_assert_eq!(&summary["file"]["path"], "folder/hello");
        let of_this = get(&SERVER, "");
        prop_assert_eq!(of_this.as_array().map(Vec::len), Some(2));
    }
}
