//! Notation in, machine out, and back.

use super::{Shown, parse, print, print_with};
use expect_test::{Expect, expect};
use proptest::prelude::*;

/// Prints what is read, and holds that reading that gives the same again.
fn check(text: &str, expect: &Expect) {
    let printed = match parse(text) {
        Ok(machine) => {
            let printed = print(&machine);
            assert_eq!(parse(&printed).as_ref(), Ok(&machine), "{printed}");
            printed
        }
        Err(error) => error.to_string(),
    };
    expect.assert_eq(&printed);
}

const EVERY_KIND: &str = r#"
        machine
          version "1.2"
          created "2020-02-02 02:02:02"
          extra {"a": [2], "b": 1}
        hierarchy ROOT "Root"   # the whole
          description "Finds\nthe cup"
          outcome success
          outcome 7 "not found"
          in cup: str = "red"
          out place: numpy.ndarray
          var tries: int = 3
          start -> BARRIE ; BARRIE.success -> FIRSTX ; FIRSTX.done -> .success
          FIRSTX.aborted -> ."not found" as 9
          LIBRAR.-1 -> FIRSTX
          flow .cup -> LIBRAR.question
          flow LIBRAR.answer -> .tries as 5 extra {"x": 1}
          barrier BARRIE
            outcome success
            execution AAAAAA
              outcome success
            decider unique_decider_state_id "Decider"
              outcome success
              script ""
            AAAAAA.success -> unique_decider_state_id
            unique_decider_state_id.success -> .success
          preemptive FIRSTX
            outcome done
          library LIBRAR "Ask" from "generic/dialog/ask" version "0.1"
            set in question = "Which?"
            set out answer = [1, (2,), {"a": None}] unused
            content
              execution LLLLLL "Ask the user"
                outcome success
                in question: str
                out answer: object
                script |
                  def execute(self, inputs, outputs, gvm):

                      return 0
        "#;

#[test]
fn every_kind_of_state_reads_back() {
    check(
        EVERY_KIND,
        &expect![[r#"
        machine
          version "1.2"
          created "2020-02-02 02:02:02"
          extra {"a":[2],"b":1}
        hierarchy ROOT "Root"
          description |-
            Finds
            the cup
          outcome success
          outcome 7 "not found"
          in cup: str = "red"
          out place: numpy.ndarray
          var tries: int = 3
          start -> BARRIE
          BARRIE.success -> FIRSTX
          FIRSTX.done -> .success
          FIRSTX.aborted -> ."not found" as 9
          LIBRAR.aborted -> FIRSTX
          flow .cup -> LIBRAR.question
          flow LIBRAR.answer -> .tries as 5 extra {"x":1}
          barrier BARRIE
            outcome success
            AAAAAA.success -> unique_decider_state_id
            unique_decider_state_id.success -> .success
            execution AAAAAA
              outcome success
            decider unique_decider_state_id "Decider"
              outcome success
              script ""
          preemptive FIRSTX
            outcome done
          library LIBRAR "Ask" from "generic/dialog/ask" version "0.1"
            set in question = "Which?"
            set out answer = [1, (2,), {"a": None}] unused
            content
              execution LLLLLL "Ask the user"
                outcome success
                in question: str
                out answer: object
                script |
                  def execute(self, inputs, outputs, gvm):

                      return 0
    "#]],
    );
}

#[test]
fn shared_libraries_stay_shared() {
    let text = r#"
        define inner
          execution INNERX
        define outer
          hierarchy OUTERX
            library AAAAAA from "lib/inner"
              content inner
        hierarchy ROOT
          library BBBBBB from "lib/outer"
            content outer
          library CCCCCC from "lib/outer"
            content outer
          library DDDDDD from "lib/inner"
            content inner
          library EEEEEE from "gone" "a/b"
            interface
            in 4 x: int
            set in 5 = 3
            missing "no such folder"
        "#;
    check(
        text,
        &expect![[r#"
            define L1
              execution INNERX
            define L2
              hierarchy OUTERX
                library AAAAAA from "lib/inner"
                  content L1
            hierarchy ROOT
              library BBBBBB from "lib/outer"
                content L2
              library CCCCCC from "lib/outer"
                content L2
              library DDDDDD from "lib/inner"
                content L1
              library EEEEEE from "gone" "a/b"
                in 4 x: int
                set in 5 = 3
                missing "no such folder"
        "#]],
    );
    let outline = parse(text).map(|machine| print_with(&machine, Shown::OUTLINE));
    expect![[r#"
        hierarchy ROOT
          library BBBBBB from "lib/outer"
          library CCCCCC from "lib/outer"
          library DDDDDD from "lib/inner"
          library EEEEEE from "gone" "a/b"
            in 4 x: int
            set in 5 = 3
            missing "no such folder"
    "#]]
    .assert_eq(&outline.expect("a machine"));
}

#[test]
fn faulty_machines_read_back() {
    check(
        r#"
        hierarchy "start" ""
          without -1
          outcome -2 stopped
          outcome 3 a
          outcome 4 a
          in 0 x: int
          out 0 x: int = "five"
          var 0 x: json.Weird
          start.5 -> nowhere
          GONE.3 -> "start"
          .3 -> "with space".4 as -7
          .4 -> .a
          GONE -> nowhere.2
          flow .0 -> GONE.0
          flow .x -> .0
          execution "start"
          execution "with space"
        "#,
        &expect![[r#"
            hierarchy "start" ""
              without -1
              outcome -2 stopped
              outcome 3 a
              outcome 4 a
              in x: int
              out 0 x: int = "five"
              var 0 x: json.Weird
              .a -> "with space".4 as -7
              start.5 -> nowhere
              GONE.3 -> "start"
              .4 -> .a
              GONE -> nowhere.2
              flow .x -> GONE.0
              flow .x -> .x
              execution "start"
              execution "with space"
        "#]],
    );
}

#[test]
fn values_and_texts_that_no_literal_can_say() {
    check(
        r#"
        execution A
          in a: float = json NaN
          in b: type = json {"__type__": "numpy.ndarray"}
          in c: "weird type" = json [{"__jsonqualname__": "numpy.ndarray", "items": []}]
          semantic {"a": "1", "b": {"c": "d"}}
          layout {"gui": {"editor_gaphas": {"size": [1.0, 2]}}}
          extra {"x": null}
          script "  indented\r\n"
        "#,
        &expect![[r#"
            execution A
              in a: float = json NaN
              in b: type = json {"__type__":"numpy.ndarray"}
              in c: "weird type" = json [{"__jsonqualname__":"numpy.ndarray","items":[]}]
              semantic {"a":"1","b":{"c":"d"}}
              layout {"gui":{"editor_gaphas":{"size":[1.0,2]}}}
              extra {"x":null}
              script "  indented\r\n"
        "#]],
    );
}

#[test]
fn errors_say_where() {
    for (text, expect) in [
        ("", expect!["line 1, column 1: there is no state"]),
        ("execution", expect!["line 1, column 10: expected a name"]),
        ("execution A\nexecution B", expect!["line 2, column 1: here is place for one state only"]),
        ("execution A\n  in x int", expect!["line 2, column 8: expected `:`"]),
        (
            "execution A\n  in x: int = [1",
            expect!["line 2, column 15: character 2: expected a comma or the closing bracket"],
        ),
        (
            "execution A\n  in 1 x: int\n  in 1 y: int",
            expect!["line 3, column 14: the port 1 occurs twice"],
        ),
        (
            "hierarchy A\n  start -> B.success",
            expect!["line 2, column 3: there is no such state; give the outcome by its number"],
        ),
        (
            "hierarchy A\n  start -> B oops",
            expect!["line 2, column 14: more text follows the end of the line"],
        ),
        (
            "hierarchy A\n  execution B\n  B.nope -> .aborted",
            expect!["line 3, column 3: the state B has no outcome `nope` for this end"],
        ),
        (
            "execution A\n  start -> A",
            expect![
                "line 2, column 3: only hierarchies and concurrency states have transitions and data flows"
            ],
        ),
        (
            "execution A\n  execution B",
            expect!["line 2, column 3: only hierarchies and concurrency states have children"],
        ),
        (
            "library A\n  content\n    execution B\n    execution C",
            expect!["line 4, column 5: here is place for one state only"],
        ),
        (
            "library A\n  content B",
            expect!["line 2, column 3: nothing is defined as `B` before this line"],
        ),
        ("wrong", expect!["line 1, column 1: expected `machine`, `define` or a state"]),
        (
            "machine\n  wrong 5\nexecution A",
            expect!["line 2, column 3: more text follows the end of the line"],
        ),
    ] {
        check(text, &expect);
    }
}

#[test]
fn a_thousand_levels_are_no_danger() {
    let level = |depth: usize| format!("{}hierarchy S{depth}\n", " ".repeat(depth));
    let text: String = (0..1000).map(level).collect();
    let machine = parse(&text).expect("a machine");
    assert_eq!(print(&machine).lines().count(), 1000);
}

/// Fenced blocks of the documents, with the word after `rafcon`.
fn examples(document: &str) -> Vec<(&str, &str)> {
    let blocks = document.split("```rafcon").skip(1);
    blocks.filter_map(|block| block.split("\n```").next()?.split_once('\n')).collect()
}

#[test]
fn the_examples_of_the_documents_read() {
    let examples = examples(include_str!("../../../../docs/notation.md"));
    assert!(examples.len() > 2);
    for (mark, example) in examples {
        let printed = parse(example).map(|machine| print(&machine));
        match mark.trim() {
            "short" => assert!(printed.is_ok(), "{printed:?}\n{example}"),
            _ => assert_eq!(printed.as_deref().map(str::trim_end), Ok(example)),
        }
    }
}

proptest! {
    /// Any damage to a text gives a machine or an error, and what is a machine reads back the same.
    #[test]
    fn any_text_is_an_answer(cuts in proptest::collection::vec((0..1500usize, ".{0,3}"), 0..8)) {
        let mut text: Vec<char> = EVERY_KIND.chars().collect();
        for (at, new) in cuts {
            let at = at.min(text.len());
            let end = (at + 3).min(text.len());
            text.splice(at..end, new.chars());
        }
        let text: String = text.into_iter().collect();
        if let Ok(machine) = parse(&text) {
            let printed = print(&machine);
            prop_assert_eq!(parse(&printed).map(|again| print(&again)), Ok(printed));
        }
    }
}
