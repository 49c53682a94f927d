//! Files in, machine and problems out.

use crate::folders::{loaded, show_problems};
use expect_test::{Expect, expect};
use rafcon_model::notation::{Shown, print_with};
use rafcon_storage::{Libraries, load};
use rafcon_testkit::files::make_files;
use rafcon_testkit::machines::VERSION_0_7_13;
use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;

const HEADER: &str = r#"
== statemachine.json
{"creation_time": "2020-01-01 00:00:00", "state_machine_version": null, "used_rafcon_version": "2.2.0"}
"#;

/// A state of the current layout: class, name, id and further members.
fn core(class: &str, name: &str, id: &str, more: &str) -> String {
    format!(
        r#"{{"__jsonqualname__": "rafcon.core.states.x.{class}", "name": "{name}", "state_id": "{id}",
        "outcomes": {{}}, "input_data_ports": {{}}, "output_data_ports": {{}}, "description": null{more}}}"#
    )
}

fn hierarchy(name: &str, id: &str) -> String {
    let inside = r#", "scoped_variables": {}, "transitions": {}, "data_flows": {}"#;
    core("HierarchyState", name, id, inside)
}

fn execution(name: &str, id: &str) -> String {
    core("ExecutionState", name, id, "")
}

fn show(dir: &Path) -> String {
    match load(dir, &Libraries::default()) {
        Ok(read) => print_with(&read.machine, Shown::OUTLINE) + &show_problems(&read),
        Err(error) => format!("error: {error}").replace(&*dir.to_string_lossy(), "DIR"),
    }
}

fn check(files: &str, expect: &Expect) {
    let dir = tempfile::tempdir().unwrap();
    make_files(dir.path(), files);
    expect.assert_eq(&show(dir.path()));
}

/// With the header, a root hierarchy, and the given files.
fn check_inside(files: &str, expect: &Expect) {
    check(
        &format!("{HEADER}\n== core_data.json\n{}\n{files}", hierarchy("root", "ROOTID")),
        expect,
    );
}

#[test]
fn layout_of_0_7_13_is_read() {
    check(
        VERSION_0_7_13,
        &expect![[r#"
        machine
          version "1.0"
          created "2017-01-01 01:01:01"
          writer "0.7.13"
        hierarchy ROOTID "the root"
          outcome success
          in 3 x: float = 1.5
          var 4 v: int = 1
          start -> CHILDX
          CHILDX.success -> .success
          flow .x -> CHILDX.x
          execution CHILDX "a child"
            description "does"
            outcome success
            in x: float
    "#]],
    );
}

#[test]
fn layout_of_0_7_12_is_read() {
    let old = VERSION_0_7_13
        .replace(
            r#""root_state_storage_id": "the root$ROOTID", "state_machine_version": "1.0""#,
            r#""root_state_id": "ROOTID", "version": "None""#,
        )
        .replace("the root$ROOTID", "ROOTID")
        .replace("a child$CHILDX", "CHILDX");
    check(
        &old,
        &expect![[r#"
        machine
          created "2017-01-01 01:01:01"
          writer "0.7.13"
        hierarchy ROOTID "the root"
          outcome success
          in 3 x: float = 1.5
          var 4 v: int = 1
          start -> CHILDX
          CHILDX.success -> .success
          flow .x -> CHILDX.x
          execution CHILDX "a child"
            description "does"
            outcome success
            in x: float
    "#]],
    );
}

#[test]
fn layout_with_spaces_is_read() {
    let old = VERSION_0_7_13
        .replace("the root$ROOTID", "the root_ROOTID")
        .replace("a child$CHILDX", "a child_CHILDX")
        .replace("rafcon.statemachine.states", "rafcon.core.states")
        .replace("rafcon.statemachine", "rafcon.core.state_elements");
    let dir = tempfile::tempdir().unwrap();
    make_files(dir.path(), &old);
    assert_eq!(show_problems(&loaded(dir.path())), "");
    assert_eq!(loaded(dir.path()).machine.count(), 2);
}

#[test]
fn a_file_in_the_folder_names_the_machine_too() {
    let dir = tempfile::tempdir().unwrap();
    make_files(dir.path(), &format!("{HEADER}\n== core_data.json\n{}", execution("one", "ONEXXX")));
    let read = load(&dir.path().join("core_data.json"), &Libraries::default()).unwrap();
    assert_eq!(read.machine, loaded(dir.path()).machine);
}

#[test]
fn what_is_no_machine_is_a_clear_error() {
    check("== a.txt\n", &expect!["error: DIR is not a state machine: it has no statemachine.json"]);
    check(
        "== statemachine.yaml\na: b\n",
        &expect![
            "error: DIR has only a statemachine.yaml; save it with a RAFCON before 1.0, which writes statemachine.json"
        ],
    );
    check(
        HEADER,
        &expect!["error: DIR has no root state: a folder with core_data.json is missing"],
    );
    let dir = tempfile::tempdir().unwrap();
    expect!["error: DIR does not exist; give the folder of a state machine or a file in it"]
        .assert_eq(&show(&dir.path().join("nowhere")));
}

#[test]
fn a_damaged_state_stands_in_its_place() {
    let child = execution("good", "GOODXX");
    check_inside(
        &format!(
            "== bad_BADXXX/core_data.json\n{{\"name\": \n== bad_BADXXX/inner_INNERX/core_data.json\n{child}"
        ),
        &expect![[r#"
            machine
              created "2020-01-01 00:00:00"
              writer "2.2.0"
            hierarchy ROOTID "root"
              hierarchy BADXXX "bad"
                execution GOODXX "good"
            ROOTID/BADXXX (bad_BADXXX/core_data.json): is not JSON: line 2, column 1: the text ends where a value should be; correct the file by hand or restore it; it stays as it is until this part of the state is changed
        "#]],
    );
}

#[test]
fn an_unknown_class_is_a_problem() {
    check_inside(
        &format!("== new_NEWXXX/core_data.json\n{}", core("QuantumState", "new", "NEWXXX", "")),
        &expect![[r#"
            machine
              created "2020-01-01 00:00:00"
              writer "2.2.0"
            hierarchy ROOTID "root"
              hierarchy NEWXXX "new"
            ROOTID/NEWXXX (new_NEWXXX/core_data.json): unknown class `rafcon.core.states.x.QuantumState`; correct `__jsonqualname__`; the file stays as it is until the state is changed
        "#]],
    );
}

#[test]
fn faulty_elements_are_set_aside() {
    let child = core(
        "ExecutionState",
        "a",
        "AAAAAA",
        r#", "outcomes": {"0": {"name": "ok", "outcome_id": 0}, "x": {"name": "no"}, "1": 5, "2": {"name": [], "outcome_id": 2},
            "00": {"name": "again"}, "3": {"name": "three", "outcome_id": 4}},
           "input_data_ports": {"0": {"name": "p", "data_port_id": 0}}, "output_data_ports": []"#,
    );
    check_inside(
        &format!("== a_AAAAAA/core_data.json\n{child}"),
        &expect![[r#"
            machine
              created "2020-01-01 00:00:00"
              writer "2.2.0"
            hierarchy ROOTID "root"
              execution AAAAAA "a"
                outcome ok
                outcome 3 three
                extra {"input_data_ports":{"0":{"data_port_id":0,"name":"p"}},"outcomes":{"00":{"name":"again"},"1":5,"2":{"name":[],"outcome_id":2},"x":{"name":"no"}},"output_data_ports":[]}
            ROOTID/AAAAAA (a_AAAAAA/core_data.json): outcomes.1: should be an object, not an integer; correct it in the file; it is kept there, but has no effect
            ROOTID/AAAAAA (a_AAAAAA/core_data.json): outcomes.2: `name` should be a string, not a list; correct it in the file; it is kept there, but has no effect
            ROOTID/AAAAAA (a_AAAAAA/core_data.json): outcomes.3: the id inside is 4, the key counts; save the state to make both equal
            ROOTID/AAAAAA (a_AAAAAA/core_data.json): outcomes.x: the key is not a whole number; correct it in the file; it is kept there, but has no effect
            ROOTID/AAAAAA (a_AAAAAA/core_data.json): outcomes.00: the id occurs twice; correct it in the file; it is kept there, but has no effect
            ROOTID/AAAAAA (a_AAAAAA/core_data.json): input_data_ports.0: `data_type` is missing; correct it in the file; it is kept there, but has no effect
            ROOTID/AAAAAA (a_AAAAAA/core_data.json): `output_data_ports` should be an object, not a list; correct the key in the file, or change the state and save it
        "#]],
    );
}

#[test]
fn missing_keys_are_problems() {
    check_inside(
        "== one_ONEXXX/core_data.json\n{\"__jsonqualname__\": \"ExecutionState\"}\n== two_TWOXXX/core_data.json\n[]",
        &expect![[r#"
            machine
              created "2020-01-01 00:00:00"
              writer "2.2.0"
            hierarchy ROOTID "root"
              execution ONEXXX
              hierarchy TWOXXX "two"
            ROOTID/ONEXXX (one_ONEXXX/core_data.json): `state_id` is missing; correct the key in the file, or change the state and save it
            ROOTID/ONEXXX (one_ONEXXX/core_data.json): `name` is missing; correct the key in the file, or change the state and save it
            ROOTID/ONEXXX (one_ONEXXX/core_data.json): `outcomes` is missing; correct the key in the file, or change the state and save it
            ROOTID/ONEXXX (one_ONEXXX/core_data.json): `input_data_ports` is missing; correct the key in the file, or change the state and save it
            ROOTID/ONEXXX (one_ONEXXX/core_data.json): `output_data_ports` is missing; correct the key in the file, or change the state and save it
            ROOTID/TWOXXX (two_TWOXXX/core_data.json): should be an object, not a list; correct the key in the file, or change the state and save it
        "#]],
    );
}

#[test]
fn ids_that_are_taken_are_replaced_the_same_way_at_each_load() {
    let files = format!(
        "== a_AAAAAA/core_data.json\n{}\n== a copy/core_data.json\n{}\n== r/core_data.json\n{}",
        execution("a", "AAAAAA"),
        execution("a", "AAAAAA"),
        hierarchy("parent's id", "ROOTID"),
    );
    check_inside(
        &files,
        &expect![[r#"
        machine
          created "2020-01-01 00:00:00"
          writer "2.2.0"
        hierarchy ROOTID "root"
          execution AAAAAA "a"
          hierarchy NCZGEP "parent's id"
          execution XXTCKU "a"
        ROOTID/NCZGEP (r/core_data.json): the id ROOTID is taken; the state is now NCZGEP; save the machine to keep the new id, or give it another in its file
        ROOTID/XXTCKU (a copy/core_data.json): the id AAAAAA is taken; the state is now XXTCKU; save the machine to keep the new id, or give it another in its file
    "#]],
    );
}

#[test]
fn children_come_in_the_order_of_their_ids() {
    let file = |id: &str| format!("== {id}x/core_data.json\n{}\n", execution("x", id));
    let files = ["CCCCCC", "AAAAAA", "BBBBBB"].map(file).concat();
    check_inside(
        &files,
        &expect![[r#"
        machine
          created "2020-01-01 00:00:00"
          writer "2.2.0"
        hierarchy ROOTID "root"
          execution AAAAAA "x"
          execution BBBBBB "x"
          execution CCCCCC "x"
    "#]],
    );
}

#[test]
fn other_folders_and_files_are_ignored() {
    check_inside(
        "== m/statemachine.json\n{}\n== m/core_data.json\n{}\n== __pycache__/x.pyc\n== .git/config\n== notes/a.txt\n== b/core_data.json/x\n",
        &expect![[r#"
        machine
          created "2020-01-01 00:00:00"
          writer "2.2.0"
        hierarchy ROOTID "root"
    "#]],
    );
}

#[test]
fn damaged_layout_and_notes_are_problems() {
    check_inside(
        "== meta_data.json\n{\"a\": {\n== semantic_data.json\n[1]\n",
        &expect![[r#"
        machine
          created "2020-01-01 00:00:00"
          writer "2.2.0"
        hierarchy ROOTID "root"
        ROOTID (meta_data.json): is not JSON: line 2, column 1: expected a key in quotes; correct the file by hand or restore it; it stays as it is until this part of the state is changed
        ROOTID (semantic_data.json): should be an object, not a list; correct the key in the file, or change the state and save it
    "#]],
    );
}

#[test]
fn a_damaged_header_is_a_problem() {
    check(
        &format!("== statemachine.json\n{{\n== core_data.json\n{}", execution("a", "AAAAAA")),
        &expect![[r#"
        execution AAAAAA "a"
        statemachine.json: is not JSON: line 2, column 1: expected a key in quotes; correct the file by hand or restore it; it stays as it is until this part of the state is changed
    "#]],
    );
}

#[test]
fn a_root_elsewhere_is_found() {
    let header = HEADER
        .replace("{\"creation_time\"", "{\"root_state_storage_id\": \"gone\", \"creation_time\"");
    check(
        &format!("{header}\n== r_ROOTID/core_data.json\n{}", execution("r", "ROOTID")),
        &expect![[r#"
        machine
          created "2020-01-01 00:00:00"
          writer "2.2.0"
        execution ROOTID "r"
        statemachine.json: the root's folder gone does not exist; save the machine to bring it into the current layout
    "#]],
    );
}

#[test]
fn names_and_texts_that_are_not_utf8_are_problems() {
    let dir = tempfile::tempdir().unwrap();
    make_files(
        dir.path(),
        &format!("{HEADER}\n== core_data.json\n{}", hierarchy("root", "ROOTID")),
    );
    let folder = dir.path().join(OsStr::from_bytes(b"caf\xe9_AAAAAA"));
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("core_data.json"), execution("a", "AAAAAA")).unwrap();
    fs::write(folder.join("script.py"), b"# caf\xe9\n").unwrap();
    expect![[r#"
        machine
          created "2020-01-01 00:00:00"
          writer "2.2.0"
        hierarchy ROOTID "root"
          execution AAAAAA "a"
        ROOTID/AAAAAA (caf�_AAAAAA/script.py): is not UTF-8 text; correct the file by hand or restore it; it stays as it is until this part of the state is changed
    "#]].assert_eq(&show(dir.path()));
}

#[test]
fn scripts_are_decoded_as_python_reads_them() {
    let dir = tempfile::tempdir().unwrap();
    make_files(dir.path(), &format!("{HEADER}\n== core_data.json\n{}", execution("a", "AAAAAA")));
    for (bytes, text) in [
        (&b"\xef\xbb\xbf# caf\xc3\xa9\n"[..], "# café\n"),
        (b"# coding: latin-1\n# caf\xe9\n", "# coding: latin-1\n# café\n"),
    ] {
        fs::write(dir.path().join("script.py"), bytes).unwrap();
        let read = loaded(dir.path());
        assert_eq!(
            (read.problems.len(), read.machine.root.script().unwrap().text.as_deref()),
            (0, Some(text))
        );
    }
}

#[test]
fn pipes_and_devices_are_no_files_to_wait_for() {
    let dir = tempfile::tempdir().unwrap();
    make_files(
        dir.path(),
        &format!("{HEADER}\n== core_data.json\n{}", hierarchy("root", "ROOTID")),
    );
    let pipe = dir.path().join("meta_data.json");
    let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
    rustix::fs::mknodat(rustix::fs::CWD, &pipe, rustix::fs::FileType::Fifo, mode, 0).unwrap();
    assert_eq!(loaded(dir.path()).machine.count(), 1);
}

#[test]
fn links_that_lead_back_are_not_followed() {
    let dir = tempfile::tempdir().unwrap();
    let files = format!("== a_AAAAAA/core_data.json\n{}", hierarchy("a", "AAAAAA"));
    make_files(
        dir.path(),
        &format!("{HEADER}\n== core_data.json\n{}\n{files}", hierarchy("root", "ROOTID")),
    );
    std::os::unix::fs::symlink(dir.path(), dir.path().join("a_AAAAAA/loop")).unwrap();
    std::os::unix::fs::symlink("nowhere", dir.path().join("broken")).unwrap();
    std::os::unix::fs::symlink("self", dir.path().join("self")).unwrap();
    expect![[r#"
        machine
          created "2020-01-01 00:00:00"
          writer "2.2.0"
        hierarchy ROOTID "root"
          hierarchy AAAAAA "a"
        ROOTID/AAAAAA (a_AAAAAA/core_data.json): the folder loop leads back to one that contains it; remove the link; what lies behind it is not read
    "#]].assert_eq(&show(dir.path()));
}

#[test]
fn a_thousand_levels_are_read() {
    let dir = tempfile::tempdir().unwrap();
    make_files(dir.path(), HEADER);
    let mut at = dir.path().to_owned();
    for level in 0..1000 {
        fs::write(at.join("core_data.json"), hierarchy("x", &format!("L{level}"))).unwrap();
        at.push("x");
        fs::create_dir(&at).unwrap();
    }
    let read = loaded(dir.path());
    assert_eq!(read.machine.count(), 1000);
    assert_eq!(show_problems(&read), "");
}

#[test]
fn unknown_keys_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    let root = hierarchy("root", "ROOTID").replace(
        "\"description\": null",
        "\"description\": null, \"new\": {\"b\": 1}, \"income\": {\"x\": 2}",
    );
    let header = HEADER.replace(
        "\"state_machine_version\": null",
        "\"state_machine_version\": null, \"author\": \"me\"",
    );
    make_files(dir.path(), &format!("{header}\n== core_data.json\n{root}"));
    expect![[r#"
        machine
          created "2020-01-01 00:00:00"
          writer "2.2.0"
          extra {"author":"me"}
        hierarchy ROOTID "root"
          extra {"income":{"x":2},"new":{"b":1}}
    "#]]
    .assert_eq(&rafcon_model::notation::print(&loaded(dir.path()).machine));
}
