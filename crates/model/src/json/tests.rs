//! Text in, text out.

use super::{MAX_DEPTH, canonical_int, parse, write, write_compact};
use expect_test::{Expect, expect};
use proptest::prelude::*;

fn check(text: &str, expect: &Expect) {
    let shown = match parse(text) {
        Ok(json) => write(&json),
        Err(error) => format!("error: {error}"),
    };
    expect.assert_eq(&shown);
}

#[test]
fn layout_is_that_of_the_reference() {
    check(
        r#"{"b": [1, 2.0], "a": {}, "c": [], "é": "é\"\\\n"}"#,
        &expect![[r#"
            {
                "a": {}, 
                "b": [
                    1, 
                    2.0
                ], 
                "c": [], 
                "\u00e9": "\u00e9\"\\\n"
            }"#]],
    );
}

#[test]
fn integer_keys_sort_as_numbers() {
    check(
        r#"{"10": 1, "-1": 2, "2": 3, "-2": 4}"#,
        &expect![[r#"
            {
                "-2": 4, 
                "-1": 2, 
                "2": 3, 
                "10": 1
            }"#]],
    );
}

#[test]
fn numbers_print_as_in_python() {
    let text = "[1e300,1e16,123456789012345.6,0.0001,0.00001,-0.0,NaN,-Infinity,Infinity,123456789012345678901234567890,5e-324]";
    let shown = parse(text).map(|json| write_compact(&json));
    expect![[r#"Ok("[1e+300,1e+16,123456789012345.6,0.0001,1e-05,-0.0,NaN,-Infinity,Infinity,123456789012345678901234567890,5e-324]")"#]]
        .assert_eq(&format!("{shown:?}"));
}

#[test]
fn a_repeated_key_keeps_its_last_value() {
    check(
        r#"{"b":1,"a":1,"b":2}"#,
        &expect![[r#"
            {
                "a": 1, 
                "b": 2
            }"#]],
    );
}

#[test]
fn errors_say_where() {
    check("{\"a\": 1,\n \"b\" 2}", &expect!["error: line 2, column 6: expected `:`"]);
    check("", &expect!["error: line 1, column 1: the text ends where a value should be"]);
    check("[1, 2", &expect!["error: line 1, column 6: expected `,` or `]`"]);
    check("{} x", &expect!["error: line 1, column 4: more text follows the document"]);
    check("\"a", &expect!["error: line 1, column 3: a string without end"]);
    check("tru", &expect!["error: line 1, column 1: not a value"]);
    check("-", &expect!["error: line 1, column 2: a sign without digits"]);
    check("01", &expect!["error: line 1, column 3: a number does not start with 0"]);
    check("\"\\u12\"", &expect!["error: line 1, column 4: `\\u` needs four hexadecimal digits"]);
}

#[test]
fn deep_nesting_is_refused_and_not_a_crash() {
    let nested = |levels: usize| parse(&("[".repeat(levels) + &"]".repeat(levels)));
    // The outermost list has depth 0.
    assert!(nested(MAX_DEPTH + 1).is_ok());
    for levels in [MAX_DEPTH + 2, 100_000] {
        assert_eq!(nested(levels).map_err(|e| e.reason), Err("nested too deep"));
    }
}

#[test]
fn surrogates_join_and_lone_ones_are_replaced() {
    check(r#""\ud83d\ude00""#, &expect![[r#""\ud83d\ude00""#]]);
    check(r#""\ud83dx""#, &expect![[r#""\ufffdx""#]]);
}

#[test]
fn an_integer_has_one_text() {
    let texts =
        ["0", "7", "-2", "01", "-0", "--1", "+1", " 1", "1_0", "", "-", "9223372036854775808"];
    let found: Vec<_> = texts.into_iter().filter_map(canonical_int).collect();
    assert_eq!(found, [0, 7, -2]);
}

proptest! {
    #[test]
    fn any_text_is_an_answer(text in ".{0,60}") {
        if let Ok(json) = parse(&text) {
            let once = write(&json);
            prop_assert_eq!(parse(&once).map(|json| write(&json)), Ok(once));
        }
    }

    #[test]
    fn floats_read_back_the_same(number in any::<f64>().prop_filter("finite", |n| n.is_finite())) {
        let text = write(&super::Json::Float(number));
        prop_assert_eq!(parse(&text), Ok(super::Json::Float(number)));
    }
}
