//! Python literals in, values out, and back.

use super::{LiteralError, MAX_DEPTH, parse, write};
use crate::Value;
use expect_test::{Expect, expect};
use proptest::prelude::*;

fn check(lines: &[&str], expect: &Expect) {
    let one = |text: &&str| match parse(text) {
        Ok(value) => format!("{text} => {}", write(&value).unwrap_or_else(|| "no literal".into())),
        Err(error) => format!("{text} !! {error}"),
    };
    expect.assert_eq(&lines.iter().map(one).collect::<Vec<_>>().join("\n"));
}

#[test]
fn numbers() {
    check(
        &[
            "1",
            "-0",
            "+ -1_000",
            "0x1F",
            "007",
            "1.5e3",
            "-.5",
            "1.",
            "1e400",
            "2j",
            "99999999999999999999",
            "1_",
        ],
        &expect![[r"
            1 => 1
            -0 => 0
            + -1_000 => -1000
            0x1F => 31
            007 !! character 0: a number does not start with 0
            1.5e3 => 1500.0
            -.5 => -0.5
            1. => 1.0
            1e400 => no literal
            2j !! only Python can read complex numbers
            99999999999999999999 => 99999999999999999999
            1_ !! character 0: not a number"]],
    );
}

#[test]
fn strings() {
    check(
        &[
            r"'a\'b'",
            r#""\x41\u00e9\101\q" 'x'"#,
            "'''a\nb'''",
            r"r'\n'",
            "b'x'",
            "'open",
            r"'\N{DASH}'",
            "f'x'",
        ],
        &expect![[r#"
            'a\'b' => "a'b"
            "\x41\u00e9\101\q" 'x' => "AéA\\qx"
            '''a
            b''' => "a\nb"
            r'\n' => "\\n"
            b'x' !! only Python can read bytes
            'open !! character 5: a string without end
            '\N{DASH}' !! only Python can read characters by name
            f'x' !! character 0: not a Python literal"#]],
    );
}

#[test]
fn containers() {
    check(
        &[
            "[1, 'a', None,]",
            "()",
            "(1)",
            "(1,)",
            "(1, 2)",
            "{}",
            "{1}",
            "{1, 1, 2}",
            "set()",
            "{'a': [1], 2: (True, False)}",
            "{1: 2, 1: 3}",
        ],
        &expect![[r#"
            [1, 'a', None,] => [1, "a", None]
            () => ()
            (1) => 1
            (1,) => (1,)
            (1, 2) => (1, 2)
            {} => {}
            {1} => {1}
            {1, 1, 2} => {1, 2}
            set() => set()
            {'a': [1], 2: (True, False)} => {"a": [1], 2: (True, False)}
            {1: 2, 1: 3} => {1: 3}"#]],
    );
}

#[test]
fn what_is_not_a_literal_says_where() {
    check(
        &["", "hello", "[1", "[1 2]", "{1: 2", "{[]: 1}", "{1 2}", "1 2", "(,)"],
        &expect![[r"
         !! character 0: the text ends where a value should be
        hello !! character 0: not a Python literal
        [1 !! character 2: expected a comma or the closing bracket
        [1 2] !! character 3: expected a comma or the closing bracket
        {1: 2 !! character 5: expected a comma or the closing brace
        {[]: 1} !! character 4: lists, dicts and sets cannot be keys or members of a set
        {1 2} !! character 3: expected a comma, a colon or the closing brace
        1 2 !! character 2: more text follows the value
        (,) !! character 1: not a Python literal"]],
    );
    let nested = |levels: usize| parse(&("[".repeat(levels) + &"]".repeat(levels)));
    // The outermost list has depth 0.
    assert!(nested(MAX_DEPTH + 1).is_ok());
    for levels in [MAX_DEPTH + 2, 100_000] {
        assert_eq!(nested(levels), Err(LiteralError::NeedsPython("nesting this deep")));
    }
}

fn values() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::None),
        any::<bool>().prop_map(Value::Bool),
        any::<i64>().prop_map(Value::Int),
        (-1e300..1e300f64).prop_map(Value::Float),
        ".*".prop_map(|text| Value::str(&text)),
    ];
    leaf.prop_recursive(4, 32, 4, |inner| {
        let items = proptest::collection::vec(inner.clone(), 0..4);
        prop_oneof![
            items.clone().prop_map(|items| Value::List(items.into())),
            items.prop_map(|items| Value::Tuple(items.into())),
            proptest::collection::btree_map(".*", inner, 0..4).prop_map(|members| Value::Dict(
                members.into_iter().map(|(k, v)| (Value::str(&k), v)).collect()
            )),
        ]
    })
}

proptest! {
    #[test]
    fn what_is_written_reads_back_the_same(value in values()) {
        let text = write(&value).expect("a literal");
        prop_assert_eq!(parse(&text), Ok(value));
    }

    #[test]
    fn no_text_makes_it_panic(text in "[\\[\\](){}:,'\"\\\\ abrufN0-9._+-]{0,30}") {
        if let Ok(value) = parse(&text) {
            prop_assert!(write(&value).is_none_or(|again| parse(&again) == Ok(value)));
        }
    }
}
