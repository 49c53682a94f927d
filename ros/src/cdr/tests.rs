//! Messages go to the wire and come back; what is wrong is refused with its place.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use expect_test::{Expect, expect};
use proptest::prelude::*;

use super::read::{Decoded, read};
use super::write::write;
use crate::json;
use crate::types::library::{Library, Type};

/// A type of this text.
fn of(text: &str) -> Arc<Type> {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), "own/msg/Own.msg", text);
    put(folder.path(), "own/msg/Inner.msg", "int8 a\nfloat64 b");
    Library::new(vec![PathBuf::from(folder.path())], &[]).find("own/msg/Own").unwrap()
}

fn put(folder: &Path, name: &str, text: &str) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

fn encode(of: &Type, message: &str, arrays: &[u8]) -> Result<Vec<u8>, String> {
    write(&json::parse(message.as_bytes())?, arrays, of)
}

/// The bytes of `message`, and the message that they are read as.
fn check(type_text: &str, message: &str, arrays: &[u8], expected: Expect) {
    let of = of(type_text);
    let shown = match encode(&of, message, arrays) {
        Err(why) => why,
        Ok(bytes) => {
            let hex = bytes.iter().fold(String::new(), |mut text, byte| {
                let _ = write!(text, "{byte:02x}");
                text
            });
            format!("{hex}\n{}", decode(&of, &bytes, true))
        }
    };
    expected.assert_eq(&shown);
}

fn decode(of: &Type, bytes: &[u8], little: bool) -> String {
    let mut decoded = Decoded::default();
    match read(bytes, little, of, &mut decoded) {
        Ok(()) => format!("{} {:?}", decoded.text, decoded.arrays),
        Err(why) => why,
    }
}

#[test]
fn numbers_stand_at_multiples_of_their_width() {
    check(
        "bool a\nint64 b\nbyte c\nuint16 d\nchar e\nfloat32 f\nInner g",
        r#"{"a":true,"b":-2,"c":255,"d":513,"e":65,"f":1.5,"g":{"a":-1,"b":NaN}}"#,
        &[],
        expect![[r#"
            0100000000000000feffffffffffffffff000102410000000000c03fff000000000000000000f87f
            {"a":true,"b":-2,"c":255,"d":513,"e":65,"f":1.5,"g":{"a":-1,"b":NaN}} []"#]],
    );
}

#[test]
fn texts_have_their_length_and_wide_texts_units_of_four_bytes() {
    check(
        "string a\nwstring b\nstring<=2[] c",
        r#"{"a":"ä","b":"x\ud83d\ude00","c":["a",""]}"#,
        &[],
        expect![[r#"
            03000000c3a4000003000000780000003dd8000000de00000200000002000000610000000100000000
            {"a":"ä","b":"x😀","c":["a",""]} []"#]],
    );
}

#[test]
fn arrays_of_numbers_lie_behind_the_text() {
    check(
        "uint8[] a\nfloat64[2] b\nint16[<=3] c\nuint32[] d",
        r#"{"a":{"$":["B",0,3]},"b":[1,2.5],"c":{"$":["i",4,8]},"d":[]}"#,
        &[1, 2, 3, 0, 255, 255, 255, 255, 7, 0, 0, 0],
        expect![[r#"
            0300000001020300000000000000f03f000000000000044002000000ffff070000000000
            {"a":{"$":["B",0,3]},"b":{"$":["d",3,16]},"c":{"$":["h",19,4]},"d":{"$":["I",23,0]}} [1, 2, 3, 0, 0, 0, 0, 0, 0, 240, 63, 0, 0, 0, 0, 0, 0, 4, 64, 255, 255, 7, 0]"#]],
    );
}

#[test]
fn what_is_left_out_has_the_default_of_the_type() {
    check(
        "int32 a 7\nstring b 'x # y'\nbool[2] c [true, false]\nInner[2] d\nInner[] e\nint8 K=3",
        "{}",
        &[],
        expect![[r#"
            07000000060000007820232079000100000000000000000000000000000000000000000000000000000000000000000000000000
            {"a":7,"b":"x # y","c":[true,false],"d":[{"a":0,"b":0.0},{"a":0,"b":0.0}],"e":[]} []"#]],
    );
}

#[test]
fn a_message_without_fields_is_one_byte() {
    check(
        "",
        "{}",
        &[],
        expect![[r#"
        00
        {} []"#]],
    );
}

#[test]
fn what_does_not_fit_is_refused_with_its_place() {
    let refuse =
        |type_text, message: &str, expected: Expect| check(type_text, message, &[], expected);
    refuse(
        "Inner[] a",
        r#"{"a":[{"a":1},{"a":200}]}"#,
        expect!["own/msg/Own.a[1].a: 200 is out of the range of int8"],
    );
    refuse("int32 a", r#"{"b":1}"#, expect!["own/msg/Own has no field `b`; it has a"]);
    refuse(
        "uint8[<=2] a",
        r#"{"a":[1,2,3]}"#,
        expect!["own/msg/Own.a: has 3 values, of 2 at most"],
    );
    refuse("float64[2] a", r#"{"a":[1]}"#, expect!["own/msg/Own.a: has 1 values, not 2"]);
    refuse(
        "string<=2 a",
        r#"{"a":"abc"}"#,
        expect!["own/msg/Own.a: has 3 characters, of 2 at most"],
    );
    refuse(
        "string a",
        r#"{"a":"a\u0000b"}"#,
        expect!["own/msg/Own.a: a NUL character cannot be in a text of ROS"],
    );
    refuse("int32 a", r#"{"a":1.5}"#, expect!["own/msg/Own.a: 1.5 is no int32"]);
    refuse(
        "uint8[] a",
        r#"{"a":{"$":["B",0,3]}}"#,
        expect!["own/msg/Own.a: its bytes are missing"],
    );
}

#[test]
fn a_peer_cannot_make_this_program_believe_a_length() {
    let show = |type_text, bytes: &[u8], expected: Expect| {
        expected.assert_eq(&decode(&of(type_text), bytes, true))
    };
    show(
        "float64[] a",
        &[255, 255, 255, 255, 0, 0, 0, 0],
        expect![
            "the 8 bytes are no own/msg/Own: a: 4294967295 values need more bytes than there are"
        ],
    );
    show(
        "Inner[] a",
        &[255, 255, 255, 255],
        expect![
            "the 4 bytes are no own/msg/Own: a: 4294967295 values need more bytes than there are"
        ],
    );
    show(
        "string[] a",
        &[2, 0, 0, 0, 255, 255, 255, 255, 65],
        expect!["the 9 bytes are no own/msg/Own: a: 2 values need more bytes than there are"],
    );
    show(
        "wstring a",
        &[255, 255, 255, 255, 65],
        expect!["the 5 bytes are no own/msg/Own: a: they end before byte 17179869184"],
    );
    show("string a", &[4, 0, 0, 0, 65, 0, 255, 0], expect![[r#"{"a":"A\u0000�"} []"#]]);
    show(
        "int64 a",
        &[1, 2, 3],
        expect!["the 3 bytes are no own/msg/Own: a: they end before byte 8"],
    );
    show(
        "uint8[<=2] a",
        &[3, 0, 0, 0, 1, 2, 3],
        expect!["the 7 bytes are no own/msg/Own: a: 3 values, of 2 at most"],
    );
}

#[test]
fn the_other_order_of_bytes_is_read_too() {
    let bytes = [0, 0, 0, 2, 0, 1, 0, 2, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 1, 0, 0, 0, 65];
    expect![[r#"{"a":{"$":["H",0,4]},"b":5,"c":"A"} [1, 0, 2, 0]"#]].assert_eq(&decode(
        &of("uint16[] a\nint64 b\nwstring c"),
        &bytes,
        false,
    ));
}

/// A type that has everything.
const ALL: &str = "bool a\nint8 b\nuint16[] c\nfloat64[2] d\nstring[<=2] e\nwstring f\nInner[] g\nint64 h\nbool[] i";

proptest! {
    #[test]
    fn any_bytes_are_a_message_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300), little: bool) {
        let of = of(ALL);
        let mut decoded = Decoded::default();
        if read(&bytes, little, &of, &mut decoded).is_ok() {
            // What was read can be written, and reads as the same.
            let message = json::parse(decoded.text.as_bytes()).unwrap();
            if let Ok(written) = write(&message, &decoded.arrays, &of) {
                let mut again = Decoded::default();
                read(&written, true, &of, &mut again).unwrap();
                prop_assert_eq!(decoded.text, again.text);
                prop_assert_eq!(decoded.arrays, again.arrays);
            }
        }
    }
}
