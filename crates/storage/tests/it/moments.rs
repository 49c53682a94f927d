//! Moments as text, after journals as text.

use expect_test::{Expect, expect};
use proptest::prelude::*;
use rafcon_storage::journal::{
    ActiveStateData, Definition, Item, Kept, Moment, PlaceNumber, Places, Record,
};
use rafcon_testkit::journal_notation;
use smol_str::SmolStr;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::num::NonZeroU64;

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
    for item in journal_notation::parse(&format!("{PLACES}{text}")).unwrap() {
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

fn line(standing: &ActiveStateData) -> String {
    let mut text = format!("{} #{}", standing.state(), standing.order);
    if standing.asked {
        text += " asked";
    }
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
fn a_skipped_state_has_ended_until_something_stands_before_it_again() {
    let skipped = r#"enter R
        enter R/H
        leave R/H ok
        told {"type": "held", "path": "R", "next": "R/A", "by": {"type": "step"}}
        told {"type": "forced", "path": "R/A", "outcome": {"id": 0, "name": "ok"}}"#;
    let before = |next: &str| {
        let held = r#"told {"type": "held", "path": "R", "by": {"type": "step"}, "next": "#;
        format!("{skipped}\n{held}\"{next}\"}}")
    };
    check(
        &before("R/B"),
        &expect![[r"
            #6 Stepping, 2 run
            R #1 | H 0#3 | A 0#5 | last A
            held R before R/B
        "]],
    );
    check(
        &before("R/A"),
        &expect![[r"
            #6 Stepping, 2 run
            R #1 | H 0#3 | last H
            held R before R/A
        "]],
    );
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
fn a_run_that_is_resumed_goes_on_with_its_data() {
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
fn a_run_that_goes_back_goes_on_with_the_data_of_then() {
    let before = "enter R\nscoped R n=1\nglobal g=1\nenter R/H\nscoped R/H m=2";
    let then = after(before);
    let later =
        "enter R/H/X\nleave R/H/X ok x=1\nscoped R/H m=3\nleave R/H ok\nglobal g=2\nglobal h=5";
    let mut now = after(&format!("{before}\n{later}"));
    now.apply(12, 0, &Record::WentBack { sequence: 6, moment: then.to_bytes() });
    now = Moment::from_bytes(&now.to_bytes(), now.places().clone()).unwrap();
    for path in ["R", "R/H"] {
        let place = now.places().number(path).unwrap();
        now.apply(13, 0, &Record::Entered { place, inputs: vec![], undoes: None });
    }
    assert_eq!(now.active(), then.active());
    let globals: Vec<_> =
        now.globals().iter().map(|(name, value)| (&**name, plain(value))).collect();
    assert_eq!(globals, [("g", "1".to_owned()), ("h", "5".to_owned())]);
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

/// A machine of all kinds: `C` has branches, `D` is nested twice.
const RICH: &str = r#"
    place R "R" scoped n outcome ok
    place R/A "R/A" script in a out b outcome ok,no
    place R/C "R/C" outcome ok
    place R/C/P "R/C/P" script out p outcome ok
    place R/C/Q "R/C/Q" scoped q outcome ok
    place R/C/Q/Z "R/C/Q/Z" script in z outcome ok
    place R/D "R/D" scoped d outcome ok
    place R/D/E "R/D/E" library outcome ok
    place R/D/E/F "R/D/E/F" script in f out g outcome ok
"#;

/// Returns records that can follow each other. Each choice is a place and an event to record there, if it is possible.
fn possible(choices: &[(u32, u8, i64)]) -> Vec<Record> {
    let mut places = Places::default();
    for item in journal_notation::parse(RICH).unwrap() {
        let Item::Definition(Definition::Place(number, place)) = item else { unreachable!() };
        places.define(number, place);
    }
    let mut active: BTreeSet<PlaceNumber> = BTreeSet::new();
    let mut records = Vec::new();
    for (place, what, value) in choices {
        let place = PlaceNumber(*place);
        let value = Kept::Int(*value);
        let parent = places.parent(place);
        let is_inside = parent.is_none_or(|parent| active.contains(&parent));
        let has_children = active.iter().any(|child| places.parent(*child) == Some(place));
        let ports = |ports: &[(u64, SmolStr)]| vec![value.clone(); ports.len()];
        let known = places.get(place).unwrap();
        let undoes = NonZeroU64::new(u64::from(*what == 3));
        records.extend(match what {
            0 | 3 if is_inside && active.insert(place) => {
                Some(Record::Entered { place, inputs: ports(&known.inputs), undoes })
            }
            1 | 4 if !has_children && active.remove(&place) => {
                let outputs = ports(&known.outputs);
                let undoes = NonZeroU64::new(u64::from(*what == 4));
                Some(Record::Left { place, outcome: 0, outputs, error: None, undoes })
            }
            2 if active.contains(&place) => {
                known.scoped.first().map(|(port, _)| Record::Scoped { place, port: *port, value })
            }
            _ => None,
        });
    }
    records
}

proptest! {
    #[test]
    fn a_moment_is_the_same_whatever_it_begins_from(
        choices in prop::collection::vec((0_u32..9, 0_u8..5, 0_i64..3), 0..200),
        cut in any::<prop::sample::Index>(),
    ) {
        let records = possible(&choices);
        let mut whole = Moment::default();
        for item in journal_notation::parse(RICH).unwrap() {
            let Item::Definition(definition) = item else { unreachable!() };
            whole.define(&definition);
        }
        let cut = cut.index(records.len() + 1);
        let mut resumed = None;
        for (sequence, record) in (1_u64..).zip(&records) {
            if sequence == cut as u64 + 1 {
                let bytes = whole.to_bytes();
                resumed = Some(Moment::from_bytes(&bytes, whole.places().clone()).unwrap());
            }
            for moment in [Some(&mut whole), resumed.as_mut()].into_iter().flatten() {
                moment.apply(sequence, sequence * 7, record);
            }
        }
        if let Some(resumed) = resumed {
            prop_assert_eq!(resumed.active(), whole.active());
            prop_assert_eq!(resumed.states_run(), whole.states_run());
            prop_assert_eq!(resumed.entries(), whole.entries());
        }
    }

    #[test]
    fn any_bytes_are_a_moment_or_not(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
        let mut framed = vec![1, 2, 0, 0, 0, b'{', b'}'];
        framed.extend(&bytes);
        drop(Moment::from_bytes(&bytes, Places::default()));
        drop(Moment::from_bytes(&framed, Places::default()));
    }
}

#[test]
fn a_long_loop_keeps_few_steps_and_says_when_they_do_not_reach() {
    let mut moment = after("enter R");
    let places = moment.places().clone();
    let place = places.number("R/A").unwrap();
    let entered = |undoes| Record::Entered { place, inputs: vec![], undoes };
    let left = |undoes| Record::Left { place, outcome: 0, outputs: vec![], error: None, undoes };
    for sequence in 1..30_000 {
        moment.apply(sequence * 2, 0, &entered(None));
        moment.apply(sequence * 2 + 1, 0, &left(None));
    }
    let bytes = moment.to_bytes();
    assert!(bytes.len() < 20_000, "{}", bytes.len());
    let mut short = Moment::from_bytes(&bytes, places).unwrap();
    assert_eq!(short.active(), moment.active());
    for _ in 0..5000 {
        for moment in [&mut moment, &mut short] {
            moment.apply(60_000, 0, &entered(NonZeroU64::new(1)));
            moment.apply(60_001, 0, &left(NonZeroU64::new(1)));
        }
    }
    assert!(short.lacks_steps() && !moment.lacks_steps());
}

#[test]
fn what_a_command_or_a_deadline_preempts_is_known_but_not_the_handler_that_follows() {
    check(
        r#"@1 enter R
           @1 enter R/H
           @1 enter R/H/Y
           @2 told {"type": "deadline_passed", "path": "R/H", "deadline_ms": 1}
           @3 leave R/H/Y ok
           @3 enter R/H/X"#,
        &expect![[r"
            #6 Running, 4 run
            R #1
              H #2 asked | Y 0#5 | last Y
                X #6
        "]],
    );
    check(
        r#"@1 enter R
           @1 enter R/H
           @2 enter R/H/Y
           @2 told {"type": "commanded", "envelope": {"id": "1", "command": {"type": "preempt", "path": "R/H"}}, "answer": {"answer": "applied"}}"#,
        &expect![[r"
            #4 Running, 3 run
            R #1
              H #2 asked
                Y #3
        "]],
    );
}

#[test]
fn a_stop_is_known_by_its_first_record_until_there_is_a_second() {
    let stop = |text: &str| format!("{:?}", after(text).whole().stop);
    let once = r#"enter R
        told {"type": "stopping"}
        told {"type": "resumed", "life": 2, "crash": {"reason": "", "active": []}, "policy": "restart"}
        enter R
        told {"type": "stopping"}"#;
    expect!["Some(StopRequest { order: 2, twice: false, repeats: false })"].assert_eq(&stop(once));
    let twice = format!("{once}\n told {{\"type\": \"stopping\"}}");
    expect!["Some(StopRequest { order: 6, twice: true, repeats: false })"].assert_eq(&stop(&twice));
}

#[test]
fn the_latest_commands_are_known_with_their_answers_and_older_ones_are_forgotten() {
    let commanded = |number: u64| {
        format!(
            "told {{\"type\": \"commanded\", \"envelope\": {{\"id\": \"c{number}\", \"command\": {{\"type\": \"pause\"}}}}, \
             \"answer\": {{\"answer\": \"applied\"}}}}\n"
        )
    };
    let known = |commands: u64| {
        let moment = after(&(1..=commands).map(commanded).collect::<String>());
        let again = Moment::from_bytes(&moment.to_bytes(), moment.places().clone()).unwrap();
        let is_known = |number: u64| again.whole().answer(&format!("c{number}")).is_some();
        [1, 2, commands].map(is_known)
    };
    assert_eq!(known(1_024), [true, true, true]);
    assert_eq!(known(1_025), [false, true, true]);
}
