//! Messages recorded from `rclpy` of Jazzy and Kilted, which send identical bytes; printed by
//! `crates/python/tests/ros/record.py`.

use std::path::PathBuf;

use super::read::{Decoded, read};
use super::write::write;
use crate::json;
use crate::types::library::Library;

const RECORDED: &str = include_str!("recorded.txt");

/// Test types without a package.
const ODD: [(&str, &str); 4] = [
    ("Empty", include_str!("../../../crates/python/tests/ros/types/odd_msgs/msg/Empty.msg")),
    ("Inner", include_str!("../../../crates/python/tests/ros/types/odd_msgs/msg/Inner.msg")),
    ("Odd", include_str!("../../../crates/python/tests/ros/types/odd_msgs/msg/Odd.msg")),
    (
        "OddArrays",
        include_str!("../../../crates/python/tests/ros/types/odd_msgs/msg/OddArrays.msg"),
    ),
];

#[test]
fn messages_of_rclpy_are_written_and_read_byte_by_byte() {
    let folder = tempfile::tempdir().unwrap();
    let odd = folder.path().join("odd_msgs/msg");
    std::fs::create_dir_all(&odd).unwrap();
    for (name, text) in ODD {
        std::fs::write(odd.join(format!("{name}.msg")), text).unwrap();
    }
    let mut library = Library::new(vec![PathBuf::from(folder.path())], &[]);
    let lines: Vec<_> = RECORDED.lines().collect();
    assert_eq!(lines.len(), 8);
    for line in lines {
        let mut parts = line.splitn(3, ' ');
        let [name, hex, message] = [(); 3].map(|()| parts.next().unwrap());
        let of = library.find(name).unwrap();
        let message = json::parse(message.as_bytes()).unwrap();
        assert_eq!(shown(&write(&message, &[], &of).unwrap()), hex, "{name}");
        let bytes: Vec<u8> = (0..hex.len() / 2)
            .map(|at| u8::from_str_radix(&hex[2 * at..2 * at + 2], 16).unwrap())
            .collect();
        let mut decoded = Decoded::default();
        read(&bytes, true, &of, &mut decoded).unwrap();
        let decoded_message = json::parse(decoded.text.as_bytes()).unwrap();
        assert_eq!(shown(&write(&decoded_message, &decoded.arrays, &of).unwrap()), hex, "{name}");
    }
}

fn shown(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
