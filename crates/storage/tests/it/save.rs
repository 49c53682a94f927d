//! Machines in, files out.

use crate::folders::{loaded, show_problems};
use expect_test::expect;
use rafcon_model::{Json, Kind, Machine, OutcomeId, State, StatePath, Value};
use rafcon_storage::{Naming, Saved, core_data, format, save, state_from_core_data};
use rafcon_testkit::files::{fingerprint, make_files, show_files};
use rafcon_testkit::machines::{EVERY_KIND, VERSION_0_7_13, machine};
use rafcon_testkit::notation;
use std::fs;
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
use std::path::Path;
use std::sync::Arc;

fn put(machine: &Machine, dir: &Path, previous: Option<&Saved>) -> Saved {
    save(machine, dir, previous, Naming::default()).unwrap()
}

/// Returns the machine with the state at `path` changed. All other states are shared.
fn with(machine: &Machine, path: &str, change: impl FnOnce(&mut State)) -> Machine {
    let mut changed = machine.clone();
    let ids = StatePath::parse(path).0;
    let mut state = &mut changed.root;
    for id in &ids[1..] {
        let container = Arc::make_mut(state).container_mut().unwrap();
        state = container.states.get_mut(id).unwrap();
    }
    change(Arc::make_mut(state));
    changed
}

/// Returns paths of files that were replaced, added or removed.
fn changed_files(before: &[(String, u64)], after: &[(String, u64)]) -> Vec<String> {
    let differs = |file: &&(String, u64)| !(before.contains(file) && after.contains(file));
    let mut paths: Vec<_> =
        before.iter().chain(after).filter(differs).map(|f| f.0.clone()).collect();
    paths.sort();
    paths.dedup();
    paths
}

fn files(dir: &Path) -> Vec<(String, u64)> {
    let inode = |path: &String| fs::metadata(dir.join(path)).map_or(0, |file| file.ino());
    fingerprint(dir).into_iter().map(|(path, _)| (path.clone(), inode(&path))).collect()
}

#[test]
fn every_kind_of_state_is_read_as_it_was_written() {
    let dir = tempfile::tempdir().unwrap();
    let written = machine(EVERY_KIND);
    save(&written, dir.path(), None, Naming::default()).unwrap();
    let read = loaded(dir.path());
    assert_eq!(notation::print(&read.machine), notation::print(&written));
    assert_eq!(read.machine, written);
    assert_eq!(show_problems(&read), "");
    expect![[r#"
        all_at_once_BARRIE/Decider_unique_decider_state_id/core_data.json
        all_at_once_BARRIE/Decider_unique_decider_state_id/script.py
        all_at_once_BARRIE/core_data.json
        all_at_once_BARRIE/first_AAAAAA/core_data.json
        all_at_once_BARRIE/first_AAAAAA/script.py
        core_data.json
        last__LASTXX/core_data.json
        {
            "__jsonqualname__": "rafcon.core.states.execution_state.ExecutionState", 
            "description": null, 
            "income": {
                "__jsonqualname__": "rafcon.core.state_elements.logical_port.Income"
            }, 
            "input_data_ports": {
                "0": {
                    "__jsonqualname__": "rafcon.core.state_elements.data_port.InputDataPort", 
                    "data_port_id": 0, 
                    "data_type": {
                        "__type__": "__builtin__.str"
                    }, 
                    "default_value": null, 
                    "name": "cup"
                }
            }, 
            "name": "last \u00e9", 
            "outcomes": {
                "-2": {
                    "__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", 
                    "name": "preempted", 
                    "outcome_id": -2
                }, 
                "-1": {
                    "__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", 
                    "name": "aborted", 
                    "outcome_id": -1
                }
            }, 
            "output_data_ports": {}, 
            "state_id": "LASTXX"
        }
        last__LASTXX/meta_data.json
        last__LASTXX/script.py
        meta_data.json
        statemachine.json
        {
            "creation_time": "2020-02-02 02:02:02", 
            "state_machine_version": "1.2", 
            "used_rafcon_version": "2.2.0"
        }
        who_is_first_FIRSTX/core_data.json
        who_is_first_FIRSTX/semantic_data.json
        who_is_first_FIRSTX/slow_CCCCCC/core_data.json
        who_is_first_FIRSTX/slow_CCCCCC/script.py
    "#]]
    .assert_eq(&show_files(dir.path(), &["statemachine.json", "LASTXX/core_data.json"]));
    let before = fingerprint(dir.path());
    save(&read.machine, dir.path(), Some(&read.saved), Naming::default()).unwrap();
    assert_eq!(fingerprint(dir.path()), before);
}

#[test]
fn a_second_save_touches_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let machine = machine(EVERY_KIND);
    let saved = put(&machine, dir.path(), None);
    let before = files(dir.path());
    let saved = put(&machine, dir.path(), Some(&saved));
    put(&notation::parse(&notation::print(&machine)).unwrap(), dir.path(), Some(&saved));
    put(&machine, dir.path(), None);
    assert_eq!(files(dir.path()), before);
}

#[test]
fn one_edit_touches_one_file() {
    let dir = tempfile::tempdir().unwrap();
    let machine = machine(EVERY_KIND);
    let saved = put(&machine, dir.path(), None);
    let before = files(dir.path());
    let edited =
        with(&machine, "ROOTID/FIRSTX/CCCCCC", |state| state.description = Some("new".into()));
    let saved = put(&edited, dir.path(), Some(&saved));
    let path = "who_is_first_FIRSTX/slow_CCCCCC/core_data.json";
    assert_eq!(changed_files(&before, &files(dir.path())), [path]);
    assert_eq!(loaded(dir.path()).machine, edited);
    put(&machine, dir.path(), Some(&saved));
    assert_eq!(loaded(dir.path()).machine, machine);
}

#[test]
fn foreign_files_and_layouts_stay() {
    let dir = tempfile::tempdir().unwrap();
    let machine = machine(EVERY_KIND);
    let saved = put(&machine, dir.path(), None);
    make_files(
        dir.path(),
        "== .git/HEAD\nx\n== last__LASTXX/data.csv\n1\n== who_is_first_FIRSTX/slow_CCCCCC/n.txt\n2\n",
    );
    let edited = with(&machine, "ROOTID", |state| {
        state.container_mut().unwrap().states.remove(&"FIRSTX".into());
    });
    let edited = with(&edited, "ROOTID/LASTXX", |state| state.name = "other".into());
    put(&edited, dir.path(), Some(&saved));
    expect![[r"
        .git/HEAD
        all_at_once_BARRIE/Decider_unique_decider_state_id/core_data.json
        all_at_once_BARRIE/Decider_unique_decider_state_id/script.py
        all_at_once_BARRIE/core_data.json
        all_at_once_BARRIE/first_AAAAAA/core_data.json
        all_at_once_BARRIE/first_AAAAAA/script.py
        core_data.json
        meta_data.json
        other_LASTXX/core_data.json
        other_LASTXX/data.csv
        other_LASTXX/meta_data.json
        other_LASTXX/script.py
        statemachine.json
        who_is_first_FIRSTX/slow_CCCCCC/n.txt
    "]]
    .assert_eq(&show_files(dir.path(), &[]));
    assert_eq!(loaded(dir.path()).machine, edited);
}

#[test]
fn files_go_when_their_content_goes() {
    let dir = tempfile::tempdir().unwrap();
    let machine = machine(EVERY_KIND);
    let saved = put(&machine, dir.path(), None);
    let edited = with(&machine, "ROOTID/FIRSTX", |state| state.semantic_data = None);
    let edited = with(&edited, "ROOTID/FIRSTX/CCCCCC", |state| {
        state.kind = Kind::Hierarchy(rafcon_model::Container::default());
    });
    put(&edited, dir.path(), Some(&saved));
    assert!(!dir.path().join("who_is_first_FIRSTX/semantic_data.json").exists());
    assert!(!dir.path().join("who_is_first_FIRSTX/slow_CCCCCC/script.py").exists());
    assert_eq!(loaded(dir.path()).machine, edited);
}

#[test]
fn the_root_may_change_its_kind() {
    let dir = tempfile::tempdir().unwrap();
    let one = machine("execution ROOTID \"one\"\n  script \"x = 1\\n\"");
    let saved = put(&machine(EVERY_KIND), dir.path(), None);
    let saved = put(&one, dir.path(), Some(&saved));
    expect![[r"
        core_data.json
        script.py
        statemachine.json
    "]]
    .assert_eq(&show_files(dir.path(), &[]));
    put(&machine(EVERY_KIND), dir.path(), Some(&saved));
    assert!(!dir.path().join("script.py").exists());
}

/// Returns the machine with one state whose port has this default, as JSON.
fn with_default(json: &str) -> Machine {
    let mut machine = machine("execution ROOTID \"one\"\n  in 0 x: object");
    let root = Arc::make_mut(&mut machine.root);
    let mut port = root.inputs.as_slice()[0].clone();
    port.default = Value::from_json(&rafcon_model::json::parse(json).unwrap());
    root.inputs.insert(port);
    machine
}

#[test]
fn dict_keys_stay_what_they_were() {
    for text in
        [r#"{"01": 5, "1": 2}"#, r#"{"1": 5, "a": 2}"#, r#"{" 7 ": 1, "1_0": {"02": null}}"#]
    {
        let dir = tempfile::tempdir().unwrap();
        put(&with_default(text), dir.path(), None);
        let core = fs::read_to_string(dir.path().join("core_data.json")).unwrap();
        let core = rafcon_model::json::parse(&core).unwrap();
        let default =
            core.get("input_data_ports").and_then(|ports| ports.get("0")?.get("default_value"));
        let sorted = |json: &Json| rafcon_model::json::write_compact(json);
        assert_eq!(default.map(sorted), rafcon_model::json::parse(text).ok().as_ref().map(sorted));
        assert_eq!(loaded(dir.path()).machine.root.inputs, with_default(text).root.inputs);
    }
    let dir = tempfile::tempdir().unwrap();
    make_files(dir.path(), "== semantic_data.json\n{\"02\": 1, \"2\": 2}");
    put(&with_default("1"), dir.path(), None);
    fs::write(dir.path().join("semantic_data.json"), "{\"02\": 1, \"2\": 2}").unwrap();
    let read = loaded(dir.path());
    let copy = dir.path().join("copy");
    put(&read.machine, &copy, Some(&read.saved));
    expect![[r#"
        {
            "02": 1, 
            "2": 2
        }"#]]
    .assert_eq(&fs::read_to_string(copy.join("semantic_data.json")).unwrap());
}

#[test]
fn texts_stay_texts() {
    for text in [r#""None""#, r#""5""#, r#""$name""#, r#""[1, 2]""#] {
        let dir = tempfile::tempdir().unwrap();
        put(&with_default(text), dir.path(), None);
        assert_eq!(loaded(dir.path()).machine.root.inputs, with_default(text).root.inputs);
    }
}

#[test]
fn types_that_are_not_installed_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    let machine = machine("execution ROOTID \"one\"\n  in 0 x: no_such_module.Type");
    put(&machine, dir.path(), None);
    let read = loaded(dir.path());
    assert_eq!(
        (read.machine.root.inputs.clone(), read.problems),
        (machine.root.inputs.clone(), Vec::new())
    );
}

#[test]
fn descriptions_of_library_states_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    let library = "library ROOTID \"lib\" from \"a/b\"\n  description \"why it is here\"";
    put(&machine(library), dir.path(), None);
    assert_eq!(loaded(dir.path()).machine.root.description.as_deref(), Some("why it is here"));
}

#[test]
fn a_barrier_keeps_its_income() {
    let dir = tempfile::tempdir().unwrap();
    put(&machine("barrier ROOTID \"b\""), dir.path(), None);
    let core = fs::read_to_string(dir.path().join("core_data.json")).unwrap();
    fs::write(dir.path().join("core_data.json"), core.replace("Income\"", "Income\", \"mine\": 1"))
        .unwrap();
    let read = loaded(dir.path());
    let edited = with(&read.machine, "ROOTID", |state| state.name = "c".into());
    put(&edited, dir.path(), Some(&read.saved));
    assert!(fs::read_to_string(dir.path().join("core_data.json")).unwrap().contains("\"mine\": 1"));
}

#[test]
fn a_renamed_state_moves_its_folder_and_an_untouched_one_keeps_its_own() {
    let dir = tempfile::tempdir().unwrap();
    put(&machine(EVERY_KIND), dir.path(), None);
    fs::rename(dir.path().join("last__LASTXX"), dir.path().join("odd name")).unwrap();
    fs::rename(dir.path().join("who_is_first_FIRSTX"), dir.path().join("odd2")).unwrap();
    make_files(dir.path(), "== new_FIRSTX/mine.txt\n");
    let read = loaded(dir.path());
    let edited = with(&read.machine, "ROOTID/FIRSTX", |state| state.name = "new".into());
    let edited = with(&edited, "ROOTID/FIRSTX/CCCCCC", |state| state.name = "newer".into());
    put(&edited, dir.path(), Some(&read.saved));
    expect![[r"
        all_at_once_BARRIE/Decider_unique_decider_state_id/core_data.json
        all_at_once_BARRIE/Decider_unique_decider_state_id/script.py
        all_at_once_BARRIE/core_data.json
        all_at_once_BARRIE/first_AAAAAA/core_data.json
        all_at_once_BARRIE/first_AAAAAA/script.py
        core_data.json
        meta_data.json
        new_FIRSTX/mine.txt
        new_FIRSTX_2/core_data.json
        new_FIRSTX_2/newer_CCCCCC/core_data.json
        new_FIRSTX_2/newer_CCCCCC/script.py
        new_FIRSTX_2/semantic_data.json
        odd name/core_data.json
        odd name/meta_data.json
        odd name/script.py
        statemachine.json
    "]]
    .assert_eq(&show_files(dir.path(), &[]));
    assert_eq!(loaded(dir.path()).machine, edited);
}

#[test]
fn damaged_files_survive_saves_copies_and_formatting() {
    let dir = tempfile::tempdir().unwrap();
    put(&machine(EVERY_KIND), dir.path(), None);
    let damaged =
        [("last__LASTXX", "core_data.json"), ("who_is_first_FIRSTX", "semantic_data.json")];
    for (folder, file) in damaged {
        fs::write(dir.path().join(folder).join(file), "{ broken").unwrap();
    }
    fs::write(dir.path().join("last__LASTXX/script.py"), b"\xff").unwrap();
    let read = loaded(dir.path());
    assert_eq!(read.problems.len(), 3);
    let edited = with(&read.machine, "ROOTID", |state| state.name = "new".into());
    put(&edited, dir.path(), Some(&read.saved));
    let copy = dir.path().join("copy");
    put(&edited, &copy, Some(&loaded(dir.path()).saved));
    format(dir.path(), Naming::default(), false).unwrap();
    let kept = |at: &Path| {
        let read = |file: &str| fs::read(at.join(file)).unwrap();
        assert_eq!(read("last__LASTXX/core_data.json"), b"{ broken");
        assert_eq!(read("who_is_first_FIRSTX/semantic_data.json"), b"{ broken");
        assert_eq!(read("last__LASTXX/script.py"), b"\xff");
    };
    kept(dir.path());
    let copied = loaded(&copy);
    assert_eq!(copied.machine, edited);
    kept(&copy);
}

#[test]
fn a_script_in_another_encoding_keeps_its_bytes_until_it_is_changed() {
    for bytes in [&b"\xef\xbb\xbfx = 1\n"[..], b"# coding: latin-1\nx = '\xe9'\n"] {
        let dir = tempfile::tempdir().unwrap();
        put(&machine(EVERY_KIND), dir.path(), None);
        let script = dir.path().join("last__LASTXX/script.py");
        fs::write(&script, bytes).unwrap();
        let read = loaded(dir.path());
        let edited = with(&read.machine, "ROOTID/LASTXX", |state| state.name = "new".into());
        let copy = dir.path().join("copy");
        put(&edited, &copy, Some(&read.saved));
        assert_eq!(fs::read(copy.join("new_LASTXX/script.py")).unwrap(), bytes);
        let script_of = |text: &str| {
            with(&edited, "ROOTID/LASTXX", |state| match &mut state.kind {
                Kind::Execution(script) => script.text = Some(text.into()),
                other => panic!("{other:?}"),
            })
        };
        put(&script_of("x = 'é'\n"), &copy, Some(&loaded(&copy).saved));
        assert_eq!(fs::read_to_string(copy.join("new_LASTXX/script.py")).unwrap(), "x = 'é'\n");
    }
}

#[test]
fn a_repaired_id_is_written_by_the_next_save() {
    let dir = tempfile::tempdir().unwrap();
    put(&machine(EVERY_KIND), dir.path(), None);
    make_files(dir.path(), "== copied/a\n");
    fs::copy(
        dir.path().join("last__LASTXX/core_data.json"),
        dir.path().join("copied/core_data.json"),
    )
    .unwrap();
    let read = loaded(dir.path());
    assert_eq!(read.problems.len(), 1);
    put(&read.machine, dir.path(), Some(&read.saved));
    let again = loaded(dir.path());
    assert_eq!((again.machine, again.problems), (read.machine, Vec::new()));
}

#[test]
fn an_old_layout_becomes_the_current_one() {
    let dir = tempfile::tempdir().unwrap();
    make_files(dir.path(), VERSION_0_7_13);
    make_files(
        dir.path(),
        "== the root$ROOTID/notes.txt\nmine\n== the root$ROOTID/a child$CHILDX/notes.txt\nmine\n",
    );
    let read = loaded(dir.path());
    put(&read.machine, dir.path(), Some(&read.saved));
    expect![[r#"
        a_child_CHILDX/core_data.json
        {
            "__jsonqualname__": "rafcon.core.states.execution_state.ExecutionState", 
            "description": "does", 
            "income": {
                "__jsonqualname__": "rafcon.core.state_elements.logical_port.Income"
            }, 
            "input_data_ports": {
                "0": {
                    "__jsonqualname__": "rafcon.core.state_elements.data_port.InputDataPort", 
                    "data_port_id": 0, 
                    "data_type": {
                        "__type__": "__builtin__.float"
                    }, 
                    "default_value": null, 
                    "name": "x"
                }
            }, 
            "name": "a child", 
            "outcomes": {
                "-2": {
                    "__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", 
                    "name": "preempted", 
                    "outcome_id": -2
                }, 
                "-1": {
                    "__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", 
                    "name": "aborted", 
                    "outcome_id": -1
                }, 
                "0": {
                    "__jsonqualname__": "rafcon.core.state_elements.logical_port.Outcome", 
                    "name": "success", 
                    "outcome_id": 0
                }
            }, 
            "output_data_ports": {}, 
            "state_id": "CHILDX"
        }
        a_child_CHILDX/notes.txt
        a_child_CHILDX/script.py
        core_data.json
        meta_data.json
        statemachine.json
        {
            "creation_time": "2017-01-01 01:01:01", 
            "state_machine_version": "1.0", 
            "used_rafcon_version": "2.2.0"
        }
        the root$ROOTID/notes.txt
    "#]]
    .assert_eq(&show_files(dir.path(), &["statemachine.json", "a_child_CHILDX/core_data.json"]));
    let again = loaded(dir.path());
    assert_eq!(again.machine.root, read.machine.root);
    assert_eq!(again.problems, []);
}

#[test]
fn formatting_tells_what_it_changes() {
    let dir = tempfile::tempdir().unwrap();
    put(&machine(EVERY_KIND), dir.path(), None);
    let before = fingerprint(dir.path());
    assert_eq!(
        format(dir.path(), Naming::default(), false).unwrap().changed,
        Vec::<std::path::PathBuf>::new()
    );
    assert_eq!(fingerprint(dir.path()), before);
    fs::rename(dir.path().join("last__LASTXX"), dir.path().join("odd")).unwrap();
    let core = fs::read_to_string(dir.path().join("core_data.json")).unwrap();
    fs::write(dir.path().join("core_data.json"), core.replace('\n', "")).unwrap();
    let dry = format(dir.path(), Naming::default(), true).unwrap();
    assert!(dir.path().join("odd").exists());
    expect![[r#"["core_data.json", "last__LASTXX"]"#]].assert_eq(&format!("{:?}", dry.changed));
    assert_eq!(format(&dir.path().join("core_data.json"), Naming::default(), false).unwrap(), dry);
    assert_eq!(fingerprint(dir.path()), before);
}

#[test]
fn permissions_of_a_file_stay() {
    let dir = tempfile::tempdir().unwrap();
    let machine = machine(EVERY_KIND);
    let saved = put(&machine, dir.path(), None);
    let script = dir.path().join("who_is_first_FIRSTX/slow_CCCCCC/script.py");
    fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
    put(&notation::parse(&EVERY_KIND.replace("c = 1", "c = 2")).unwrap(), dir.path(), Some(&saved));
    assert_eq!(fs::metadata(&script).unwrap().permissions().mode() & 0o777, 0o755);
    assert_eq!(fs::read_to_string(&script).unwrap(), "c = 2\n");
}

#[test]
fn a_copy_leaves_the_original_alone_and_replaces_what_is_there() {
    let dir = tempfile::tempdir().unwrap();
    let (a, b) = (dir.path().join("a"), dir.path().join("b"));
    let saved = put(&machine(EVERY_KIND), &a, None);
    put(&machine("hierarchy OTHERX \"o\"\n  execution INNERX \"i\""), &b, None);
    let before = files(&a);
    put(&machine(EVERY_KIND), &b, Some(&saved));
    assert_eq!(files(&a), before);
    assert_eq!(fingerprint(&b), fingerprint(&a));
}

#[test]
fn ids_that_are_no_file_names_stay_inside_the_machine() {
    let dir = tempfile::tempdir().unwrap();
    let odd = machine(
        "hierarchy ROOTID \"r\"\n  execution \"../../../evil\" \"a\"\n  execution \"../evil\" \"..\"\n  execution \"..\" \"a\"",
    );
    put(&odd, &dir.path().join("m"), None);
    expect![[r"
        m/_evil/core_data.json
        m/a__/core_data.json
        m/a_evil/core_data.json
        m/core_data.json
        m/statemachine.json
    "]]
    .assert_eq(&show_files(dir.path(), &[]));
    assert_eq!(loaded(&dir.path().join("m")).machine.root, odd.root);
}

/// A hierarchy in a hierarchy, and so on.
fn nested(levels: usize) -> Machine {
    let hierarchy = |level: usize| {
        let inside = Kind::Hierarchy(rafcon_model::Container::default());
        State::new(format!("L{level}").as_str().into(), "x", inside)
    };
    let mut state = hierarchy(0);
    for level in 1..levels {
        let mut outer = hierarchy(level);
        outer.container_mut().unwrap().states.insert(state.id.clone(), Arc::new(state));
        state = outer;
    }
    Machine { header: rafcon_model::Header::default(), root: Arc::new(state) }
}

#[test]
fn deep_machines_are_written_or_refused() {
    let dir = tempfile::tempdir().unwrap();
    let short = Naming { with_name: false, max_name_length: None };
    let deep = nested(500);
    let saved = save(&deep, dir.path(), None, short).unwrap();
    assert_eq!(loaded(dir.path()).machine.root, deep.root);
    let before = fingerprint(dir.path());
    let error = save(&nested(1000), dir.path(), Some(&saved), short).unwrap_err();
    let cause = std::error::Error::source(&error).map(ToString::to_string);
    assert_eq!(cause.as_deref(), Some("File name too long (os error 36)"));
    assert!(fingerprint(dir.path()) == before);
}

#[test]
fn a_faulty_port_of_an_older_library_state_is_kept() {
    let older = r#"{"__jsonqualname__": "rafcon.statemachine.states.library_state.LibraryState",
        "library_path": "p", "library_name": "n", "version": "0.1", "name": "N", "state_id": "ASKASK", "outcomes": {},
        "input_data_ports": {"0": {"data_port_id": 0, "data_type": {"__type__": "str"}, "default_value": "x"}}}"#;
    let written = |text: &str| core_data(&state_from_core_data(text, "N_ASKASK").unwrap().0);
    let once = written(older);
    assert!(once.contains("default_value"), "{once}");
    assert_eq!(written(&once), once);
}

#[test]
fn of_two_keys_for_one_id_the_plain_one_counts_also_after_a_save() {
    let outcome = |name: &str| format!(r#"{{"name": "{name}", "outcome_id": 2}}"#);
    let (first, second, third) = (outcome("a"), outcome("b"), outcome("c"));
    let text = format!(
        r#"{{"__jsonqualname__": "x.ExecutionState", "name": "N", "state_id": "AAAAAA", "description": null,
        "input_data_ports": {{}}, "output_data_ports": {{}},
        "outcomes": {{"2 ": {first}, " 2": {second}, "2": {third}}}}}"#
    );
    let read = |text: &str| state_from_core_data(text, "N_AAAAAA").unwrap().0;
    let state = read(&text);
    assert_eq!(state.outcomes.get(OutcomeId(2)).unwrap().name, "c");
    assert_eq!(read(&core_data(&state)).outcomes, state.outcomes);
}
