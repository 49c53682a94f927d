//! Two machines in the notation in, what differs out.

use expect_test::{Expect, expect};
use rafcon_model::{Difference, diff};
use rafcon_testkit::notation;

fn check(old: &str, new: &str, expect: &Expect) {
    let machine = |text| notation::parse(text).expect("a machine in the notation");
    let (old, new) = (machine(old), machine(new));
    let line = |difference: &Difference| match difference {
        Difference::Added(path) => format!("+ {path}\n"),
        Difference::Removed(path) => format!("- {path}\n"),
        Difference::Changed(path, aspects) => format!("~ {path} {aspects:?}\n"),
    };
    expect.assert_eq(&diff(&old, &new).iter().map(line).collect::<String>());
    assert!(diff(&old, &old.clone()).is_empty());
}

#[test]
fn every_aspect_is_told_apart() {
    check(
        "
        hierarchy ROOT
          hierarchy AAAAAA
            execution BBBBBB
          execution CCCCCC
          library DDDDDD from \"lib/one\"
          execution EEEEEE
        ",
        "
        hierarchy ROOT
          start -> AAAAAA
          hierarchy AAAAAA
            execution BBBBBB
              script \"\"
            execution BBBBBC
          preemptive CCCCCC
            execution XXXXXX
          library DDDDDD from \"lib/one\"
            layout {\"a\":1}
            semantic {\"a\":1}
            content
              execution LLLLLL
          execution FFFFFF
        ",
        &expect![[r"
            ~ ROOT [Core]
            ~ ROOT/AAAAAA/BBBBBB [Script]
            + ROOT/AAAAAA/BBBBBC
            ~ ROOT/CCCCCC [Core]
            + ROOT/CCCCCC/XXXXXX
            ~ ROOT/DDDDDD [SemanticData, Layout]
            - ROOT/EEEEEE
            + ROOT/FFFFFF
        "]],
    );
    check(
        "execution A",
        "execution B",
        &expect![[r"
        - A
        + B
    "]],
    );
}

#[test]
fn equal_machines_that_share_nothing_have_no_differences() {
    let text = "hierarchy A\n  execution B\n    script \"x\"";
    check(text, text, &expect![]);
}
