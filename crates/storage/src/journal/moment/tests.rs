//! Moments as text, after journals as text.

use super::{Moment, Standing};
use crate::journal::notation;
use crate::journal::record::{Item, Kept};
use expect_test::{Expect, expect};
use std::fmt::Write as _;

const PLACES: &str = r#"
    place R "Root" scoped n outcome done
    place R/A "Root/A" script in a out b outcome ok
    place R/H "Root/H" scoped m outcome ok
    place R/H/X "Root/H/X" script out x outcome ok
    place R/H/Y "Root/H/Y" script outcome ok
    place R/B "Root/B" script outcome ok
"#;

fn after(text: &str) -> Moment {
    let mut moment = Moment::default();
    let mut sequence = 0;
    for item in notation::parse(&format!("{PLACES}{text}")).unwrap() {
        match item {
            Item::Definition(definition) => moment.define(&definition),
            Item::Record(t_ns, record) => {
                sequence += 1;
                moment.apply(sequence, t_ns, &record);
            }
        }
    }
    moment
}

fn shown(moment: &Moment) -> String {
    let whole = moment.whole();
    let mut text =
        format!("#{} {:?}, {} run\n", moment.sequence(), whole.status, moment.states_run());
    let list = moment.active();
    for standing in &list {
        let depth = std::iter::successors(standing.parent, |parent| list[*parent].parent).count();
        write!(text, "{:1$}{2}", "", depth * 2, line(standing)).unwrap();
    }
    for held in &whole.held {
        let next = held.next.as_deref().unwrap_or("nothing");
        writeln!(text, "held {} before {next}", held.path).unwrap();
    }
    text
}

fn line(standing: &Standing) -> String {
    let mut text = format!("{} #{}", standing.state(), standing.order);
    for (port, value) in &standing.inputs {
        write!(text, " in {port}={}", plain(value)).unwrap();
    }
    for variable in &standing.scoped {
        write!(text, " scoped {}={}#{}", variable.port, plain(&variable.value), variable.order)
            .unwrap();
    }
    for end in &standing.ended {
        write!(text, " | {} {}#{}", end.state(), end.outcome, end.order).unwrap();
        for (port, value) in &end.outputs {
            write!(text, " {port}={}", plain(value)).unwrap();
        }
    }
    match &standing.last {
        Some(last) => text + &format!(" | last {last}\n"),
        None => text + "\n",
    }
}

fn plain(value: &Kept) -> String {
    match value {
        Kept::Int(number) => number.to_string(),
        other => format!("{other:?}"),
    }
}

fn check(text: &str, expect: &Expect) {
    let moment = after(text);
    expect.assert_eq(&shown(&moment));
    let places = moment.places().clone();
    let again = Moment::from_bytes(&moment.to_bytes(), places).unwrap();
    assert_eq!(shown(&again), shown(&moment));
    assert_eq!(again.active(), moment.active());
}

#[test]
fn what_is_active_has_its_data() {
    check(
        "enter R
         scoped R n=0
         enter R/A a=5
         leave R/A ok b=7
         scoped R n=7
         enter R/H
         scoped R/H m=1
         enter R/H/X",
        &expect![[r"
            #8 Running, 4 run
            R #1 scoped 0=7#5 | A 0#4 1=7 | last A
              H #6 scoped 0=1#7
                X #8
        "]],
    );
}

#[test]
fn an_ended_container_hands_its_outputs_on() {
    check(
        "enter R
         enter R/H
         enter R/H/X
         leave R/H/X ok x=3
         leave R/H ok
         enter R/B",
        &expect![[r"
            #6 Running, 4 run
            R #1 | H 0#5 | last H
              B #6
        "]],
    );
}

#[test]
fn a_step_back_gives_the_data_of_before() {
    let forwards = "enter R
         scoped R n=0
         enter R/A a=1
         leave R/A ok b=7
         scoped R n=7
         enter R/A a=2
         leave R/A ok b=8
         scoped R n=8";
    check(
        forwards,
        &expect![[r"
        #8 Running, 3 run
        R #1 scoped 0=8#8 | A 0#7 1=8 | last A
    "]],
    );
    let back = format!("{forwards}\nenter R/A a=2 undoes 3");
    check(
        &back,
        &expect![[r"
        #9 Running, 3 run
        R #1 scoped 0=8#8 | A 0#7 1=8 | last A
          A #6 in 0=2
    "]],
    );
    let back = format!("{back}\nleave R/A ok undoes 3");
    check(
        &back,
        &expect![[r"
        #10 Running, 3 run
        R #1 scoped 0=7#5 | A 0#4 1=7 | last A
    "]],
    );
    let said = format!("{back}\nscoped R n=7");
    check(
        &said,
        &expect![[r"
        #11 Running, 3 run
        R #1 scoped 0=7#5 | A 0#4 1=7 | last A
    "]],
    );
    let further = format!("{said}\nenter R/A a=1 undoes 2\nleave R/A ok undoes 2\nscoped R n=0");
    check(
        &further,
        &expect![[r"
        #14 Running, 3 run
        R #1 scoped 0=0#2
    "]],
    );
}

#[test]
fn a_container_is_entered_backwards_at_its_end() {
    let forwards = "enter R
         enter R/H
         scoped R/H m=1
         enter R/H/X
         leave R/H/X ok x=3
         enter R/H/Y
         leave R/H/Y ok
         leave R/H ok
         enter R/H undoes 2";
    check(
        forwards,
        &expect![[r"
        #9 Running, 4 run
        R #1 | H 0#8 | last H
          H #2 scoped 0=1#3 | X 0#5 0=3 | Y 0#7 | last Y
    "]],
    );
    let back = "enter R/H/Y undoes 4
         leave R/H/Y ok undoes 4
         enter R/H/X undoes 3
         leave R/H/X ok undoes 3
         leave R/H ok undoes 2";
    check(
        &format!("{forwards}\n{back}"),
        &expect![[r"
        #14 Running, 4 run
        R #1
    "]],
    );
    let on = "leave R/H ok\nenter R/B";
    check(
        &format!("{forwards}\n{on}"),
        &expect![[r"
        #11 Running, 5 run
        R #1 | H 0#10 | last H
          B #11
    "]],
    );
}

#[test]
fn a_run_that_begins_elsewhere_drops_what_was_active() {
    check(
        r#"enter R
         enter R/H
         enter R/H/X
         told {"type": "dropped", "path": "R"}
         told {"type": "dropped", "path": "R/H"}
         told {"type": "dropped", "path": "R/H/X"}
         enter R
         enter R/B"#,
        &expect![[r"
            #8 Running, 5 run
            R #7
              B #8
        "]],
    );
}

#[test]
fn a_run_that_is_taken_up_goes_on_with_its_data() {
    check(
        r#"enter R
         scoped R n=4
         enter R/A a=1
         leave R/A ok b=2
         enter R/H
         enter R/H/X
         told {"type": "resumed", "life": 2, "crash": {"reason": "killed", "active": ["R/H/X"]}, "policy": "abort"}
         enter R
         enter R/H
         enter R/H/X
         leave R/H/X aborted"#,
        &expect![[r"
            #11 Running, 4 run
            R #1 scoped 0=4#2 | A 0#4 1=2 | last A
              H #5 | X -1#11 | last X
        "]],
    );
}

#[test]
fn what_is_held_is_held_until_it_goes_on() {
    let held = r#"enter R
         told {"type": "held", "path": "R", "next": "R/A", "by": {"type": "step"}}"#;
    check(
        held,
        &expect![[r"
        #2 Stepping, 1 run
        R #1
        held R before R/A
    "]],
    );
    check(
        &format!("{held}\nenter R/A"),
        &expect![[r"
        #3 Stepping, 2 run
        R #1
          A #3
    "]],
    );
}
