//! Two journals from text, compared.

use expect_test::{Expect, expect};
use rafcon_protocol::api::{Comparison, DataChange, Happened, TimeTaken, Timing};
use rafcon_storage::journal::{About, Journal, Options, Reader, compare};
use rafcon_testkit::journal_notation;
use std::fmt::Write as _;
use std::path::Path;

const MACHINE: &str = r#"
    place R "Root" outcome done
    place R/A "Root/Scan" script in a out b outcome ok,lost
    place R/B "Root/Both" outcome ok
    place R/B/X "Root/Both/Left" script outcome ok
    place R/B/Y "Root/Both/Right" script outcome ok
"#;

fn run(folder: &Path, text: &str) -> Reader {
    let journal = Journal::create(folder, &About::default(), &Options::default()).unwrap();
    journal.append(&journal_notation::batch(&format!("{MACHINE}{text}"), 0).unwrap()).unwrap();
    journal.close().unwrap();
    Reader::open(folder).unwrap()
}

fn check(one: &str, other: &str, expect: &Expect) {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] =
        [("one", one), ("other", other)].map(|(name, text)| run(&folder.path().join(name), text));
    let compared = compare(&mut { one }, &mut { other }).unwrap();
    expect.assert_eq(&shown(&compared));
}

fn shown(compared: &Comparison) -> String {
    let mut text = format!("{} alike, {} parted\n", compared.alike, compared.branches_parted);
    for parting in &compared.parted {
        let step = |step: &Option<Happened>| match step {
            None => "over".to_owned(),
            Some(step) => {
                let outcome = step.outcome.as_ref().map(|outcome| format!(" {}", outcome.name));
                format!("#{} {}{}", step.sequence, step.names, outcome.unwrap_or_default())
            }
        };
        let (one, other) = (step(&parting.one), step(&parting.other));
        writeln!(text, "on {}: {one} | {other}", parting.branch).unwrap();
    }
    for change in &compared.changed {
        let DataChange { names, kind, port, one, other, .. } = change;
        writeln!(text, "{names} {} {port}: {one:?} | {other:?}", kind.word()).unwrap();
    }
    for Timing { path, one, other, .. } in &compared.timing {
        let ms = |time: &TimeTaken| format!("{}x {} ms", time.count, time.total_ns / 1_000_000);
        writeln!(text, "{path}: {} | {}", ms(one), ms(other)).unwrap();
    }
    text
}

#[test]
fn equal_runs_do_not_part() {
    let run = "enter R\nenter R/A a=[1]\nleave R/A ok b={\"k\": 2}\nleave R done";
    check(
        run,
        run,
        &expect![[r"
        4 alike, 0 parted
        R: 1x 3 ms | 1x 3 ms
        R/A: 1x 1 ms | 1x 1 ms
    "]],
    );
}

#[test]
fn runs_part_where_an_outcome_differs() {
    check(
        "@0 enter R\n@1 enter R/A a=1\n@3 leave R/A ok b=[1]\n@4 leave R done",
        "@0 enter R\n@1 enter R/A a=2\n@9 leave R/A lost b=[1] error=\"no map\"\n@9 leave R done",
        &expect![[r"
            2 alike, 1 parted
            on R: #3 Root/Scan ok | #3 Root/Scan lost
            Root/Scan input a: Some(Number(1)) | Some(Number(2))
            R/A: 1x 2 ms | 1x 8 ms
            R: 1x 4 ms | 1x 9 ms
        "]],
    );
}

#[test]
fn data_may_differ_where_steps_do_not() {
    check(
        "enter R\nenter R/A a=[1]\nleave R/A ok b=1\nenter R/A a=1\nleave R/A ok b=1",
        "enter R\nenter R/A a=[2]\nleave R/A ok\nenter R/A a=7\nleave R/A ok b=1",
        &expect![[r"
            5 alike, 0 parted
            Root/Scan input a: Some(Array [Number(1)]) | Some(Array [Number(2)])
            Root/Scan output b: Some(Number(1)) | None
            R/A: 2x 2 ms | 2x 2 ms
        "]],
    );
}

#[test]
fn the_order_of_branches_means_nothing() {
    check(
        "enter R/B\nenter R/B/X\nenter R/B/Y\nleave R/B/X ok\nleave R/B/Y ok\nleave R/B ok",
        "enter R/B\nenter R/B/X\nenter R/B/Y\nleave R/B/Y ok\nleave R/B/X ok\nleave R/B ok",
        &expect![[r"
            6 alike, 0 parted
            R/B/X: 1x 2 ms | 1x 3 ms
            R/B/Y: 1x 2 ms | 1x 1 ms
            R/B: 1x 5 ms | 1x 5 ms
        "]],
    );
}

#[test]
fn every_branch_that_parts_is_told_the_earliest_first() {
    let both = "@0 enter R/B\n@1 enter R/B/X\n@2 enter R/B/Y\n";
    check(
        &format!("{both}@5 leave R/B/X ok\n@7 leave R/B/Y ok\n@9 leave R/B ok"),
        &format!("{both}@3 leave R/B/Y aborted\n@6 leave R/B/X aborted\n@9 leave R/B aborted"),
        &expect![[r"
            3 alike, 3 parted
            on R/B/Y: #5 Root/Both/Right ok | #4 Root/Both/Right aborted
            on R/B/X: #4 Root/Both/Left ok | #5 Root/Both/Left aborted
            on R: #6 Root/Both ok | #6 Root/Both aborted
            R/B/Y: 1x 5 ms | 1x 1 ms
            R/B/X: 1x 4 ms | 1x 5 ms
            R/B: 1x 9 ms | 1x 9 ms
        "]],
    );
}

#[test]
fn of_very_many_branches_that_part_the_earliest_are_told() {
    let each = |line: &dyn Fn(u32) -> String| (0..70).map(line).collect::<Vec<_>>().concat();
    let names = each(&|at| format!("place R/B/{at} \"Root/Both/{at}\" script outcome ok\n"));
    let entered = each(&|at| format!("enter R/B/{at}\n"));
    let left =
        |outcome: &str| -> String { each(&|at| format!("leave R/B/{} {outcome}\n", 69 - at)) };
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, outcome: &str| {
        let text = format!("{names}enter R/B\n{entered}{}", left(outcome));
        run(&folder.path().join(name), &text)
    };
    let compared = compare(&mut run("one", "ok"), &mut run("other", "aborted")).unwrap();
    assert_eq!((compared.branches_parted, compared.parted.len()), (70, 64));
    assert_eq!(
        [&compared.parted[0], &compared.parted[63]].map(|p| &*p.branch),
        ["R/B/69", "R/B/6"]
    );
    assert_eq!(compared.parted[0].names, "Root/Both/69");
}

#[test]
fn a_run_may_just_be_longer() {
    check(
        "enter R\nenter R/A a=1",
        "enter R\nenter R/A a=1\nleave R/A ok b=1",
        &expect![[r"
        2 alike, 1 parted
        on R: over | #3 Root/Scan ok
        R/A: 0x 0 ms | 1x 1 ms
    "]],
    );
}

#[test]
fn of_many_branches_that_part_the_earliest_are_reported_and_all_are_counted() {
    let mut places = String::from("place R/C \"Root/Many\" outcome ok\n");
    let (mut entries, mut one, mut other) = (String::new(), String::new(), String::new());
    for branch in 0..65 {
        writeln!(places, "place R/C/S{branch} \"Root/Many/S{branch}\" script outcome ok,lost")
            .unwrap();
        writeln!(entries, "enter R/C/S{branch}").unwrap();
        writeln!(one, "leave R/C/S{branch} ok").unwrap();
        writeln!(other, "leave R/C/S{branch} lost").unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let [mut one, mut other] = [("one", one), ("other", other)].map(|(name, ends)| {
        run(&folder.path().join(name), &format!("{places}enter R\nenter R/C\n{entries}{ends}"))
    });
    let compared = compare(&mut one, &mut other).unwrap();
    assert_eq!((compared.branches_parted, compared.parted.len()), (65, 64));
    assert_eq!(compared.parted[0].branch, "R/C/S0");
    assert!(compared.parted.iter().all(|parting| parting.branch != "R/C/S64"));
}

#[test]
fn of_many_values_that_differ_the_earliest_are_reported() {
    let ports: Vec<_> = (0..101).map(|port| format!("p{port}")).collect();
    let text = |value: u8| {
        let mut text = "enter R\n".to_owned();
        for (name, ports) in [("M", &ports[..60]), ("N", &ports[60..])] {
            let values: Vec<_> = ports.iter().map(|port| format!("{port}={value}")).collect();
            let (ports, values) = (ports.join(","), values.join(" "));
            writeln!(text, "place R/{name} \"Root/{name}\" script in {ports} outcome ok").unwrap();
            writeln!(text, "enter R/{name} {values}\nleave R/{name} ok").unwrap();
        }
        text
    };
    let folder = tempfile::tempdir().unwrap();
    let [mut one, mut other] =
        [1, 2].map(|value| run(&folder.path().join(value.to_string()), &text(value)));
    let compared = compare(&mut one, &mut other).unwrap();
    let reported: Vec<_> = compared.changed.iter().map(|change| change.port.as_str()).collect();
    assert_eq!((compared.alike, reported.len()), (5, 100));
    assert_eq!((reported[0], reported[99]), ("p0", "p99"));
}
