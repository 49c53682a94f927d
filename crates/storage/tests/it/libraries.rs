//! Libraries on disk and references to them in, content and reasons out.

use crate::folders::show_problems;
use expect_test::{Expect, expect};
use rafcon_model::notation::{Shown, print_with};
use rafcon_model::{Kind, LibraryContent, StatePath};
use rafcon_storage::libraries::{EntryKind, LibraryEntry};
use rafcon_storage::{Config, Libraries, Naming, Root, load, roots, save};
use rafcon_testkit::files::make_files;
use rafcon_testkit::machines::machine;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn put(dir: &Path, text: &str) {
    save(&machine(text), dir, None, Naming::default()).unwrap();
}

fn libraries(dir: &Path) -> Libraries {
    Libraries::new(vec![Root { name: "lib".into(), dir: dir.join("libs") }])
}

/// Saves libraries (name, text) and a machine, loads the machine, and shows it with its problems.
fn check(library: &[(&str, &str)], text: &str, expect: &Expect) {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in library {
        put(&dir.path().join("libs").join(name), text);
    }
    put(&dir.path().join("m"), text);
    let read = load(&dir.path().join("m"), &libraries(dir.path())).unwrap();
    let shown = Shown { layout: false, scripts: false, contents: true };
    let shown = print_with(&read.machine, shown) + &show_problems(&read);
    expect.assert_eq(&shown.replace(&*dir.path().to_string_lossy(), "DIR"));
}

const LEAF: &str = r#"
machine
  version "2"
execution LEAFXX "leaf"
  outcome done
  in 0 x: int = 1
  out 1 y: str
"#;

#[test]
fn outcomes_and_ports_are_those_of_the_library() {
    check(
        &[("leaf", LEAF)],
        r#"
        hierarchy ROOTID "root"
          library AAAAAA "a" from "lib/leaf" version "2"
            interface
            outcome old
            set in 0 = 5
            missing "no"
        "#,
        &expect![[r#"
            machine
              writer "2.2.0"
            hierarchy ROOTID "root"
              library AAAAAA "a" from "lib/leaf" version "2"
                set in x = 5
                content
                  execution LEAFXX "leaf"
                    outcome done
                    in x: int = 1
                    out y: str
        "#]],
    );
}

#[test]
fn another_version_is_a_note() {
    check(
        &[("leaf", LEAF)],
        r#"library AAAAAA "a" from "lib/leaf" version "1""#,
        &expect![[r#"
            machine
              writer "2.2.0"
            library AAAAAA "a" from "lib/leaf" version "1"
              content
                execution LEAFXX "leaf"
                  outcome done
                  in x: int = 1
                  out y: str
            AAAAAA (core_data.json): made with version 1 of library lib/leaf, found version 2; check the instance against the library, then save it
        "#]],
    );
}

#[test]
fn values_for_ports_that_are_gone_are_kept_and_reported() {
    check(
        &[("leaf", LEAF)],
        r#"
        library AAAAAA "a" from "lib/leaf" version "2"
          interface
          set in 7 = 5
          missing "no"
        "#,
        &expect![[r#"
            machine
              writer "2.2.0"
            library AAAAAA "a" from "lib/leaf" version "2"
              set in 7 = 5
              content
                execution LEAFXX "leaf"
                  outcome done
                  in x: int = 1
                  out y: str
            AAAAAA (core_data.json): has a runtime value for input port 7, which library lib/leaf does not have; remove the value; until then it is kept and has no effect
        "#]],
    );
}

#[test]
fn a_missing_library_keeps_what_the_machine_knows() {
    check(
        &[],
        r#"
        hierarchy ROOTID "root"
          library AAAAAA "a" from "lib/gone" version "3"
            interface
            outcome done
            in 4 x: int
            set in 5 = "five"
            out 6 y: int
            missing "no"
          library BBBBBB "b" from "other/leaf"
            missing "no"
          execution CCCCCC "c"
            in 1 v: int
            out 2 w: int
          AAAAAA.done -> CCCCCC
          flow CCCCCC.w -> AAAAAA.x
          flow AAAAAA.y -> CCCCCC.v
        "#,
        &expect![[r#"
            machine
              writer "2.2.0"
            hierarchy ROOTID "root"
              AAAAAA.done -> CCCCCC
              flow CCCCCC.w -> AAAAAA.input_4
              flow AAAAAA.output_6 -> CCCCCC.v
              library AAAAAA "a" from "lib/gone" version "3"
                outcome done
                in 4 input_4: object
                in 5 input_5: object = "five"
                out 6 output_6: object
                set in input_5 = "five"
                missing "DIR/libs/gone: No such file or directory (os error 2)"
              library BBBBBB "b" from "other/leaf"
                missing "no library root is named `other`"
              execution CCCCCC "c"
                in 1 v: int
                out 2 w: int
            ROOTID/AAAAAA (a_AAAAAA/core_data.json): library lib/gone is missing: DIR/libs/gone: No such file or directory (os error 2); add the library's root to LIBRARY_PATHS, RAFCON_LIBRARY_PATH or --library-path; the reference is kept
            ROOTID/BBBBBB (b_BBBBBB/core_data.json): library other/leaf is missing: no library root is named `other`; add the library's root to LIBRARY_PATHS, RAFCON_LIBRARY_PATH or --library-path; the reference is kept
        "#]],
    );
}

#[test]
fn a_cycle_of_libraries_is_a_missing_library() {
    check(
        &[("a", r#"library AAAAAA "a" from "lib/b""#), ("b", r#"library BBBBBB "b" from "lib/a""#)],
        r#"library ROOTID "root" from "lib/a""#,
        &expect![[r#"
            machine
              writer "2.2.0"
            library ROOTID "root" from "lib/a"
              content
                library AAAAAA "a" from "lib/b"
                  content
                    library BBBBBB "b" from "lib/a"
                      missing "DIR/libs/a contains itself"
            ROOTID (core_data.json): library lib/a has problems of its own (1), the first: AAAAAA (core_data.json): library lib/b has problems of its own (1), the first: BBBBBB (core_data.json): library lib/a is missing: DIR/libs/a contains itself; add the library's root to LIBRARY_PATHS, RAFCON_LIBRARY_PATH or --library-path; the reference is kept; open the library and correct it there; open the library and correct it there
        "#]],
    );
}

#[test]
fn a_library_that_cannot_be_read_is_missing_and_one_with_faults_is_reported() {
    let dir = tempfile::tempdir().unwrap();
    make_files(&dir.path().join("libs"), "== empty/statemachine.json\n{}\n== odd/a.txt\n");
    put(&dir.path().join("libs/faulty"), LEAF);
    std::fs::write(dir.path().join("libs/faulty/meta_data.json"), "{").unwrap();
    put(
        &dir.path().join("m"),
        r#"
        hierarchy ROOTID "root"
          library AAAAAA "a" from "lib/empty"
          library BBBBBB "b" from "lib/odd"
          library CCCCCC "c" from "lib/faulty" version "2"
          library DDDDDD "d" from "lib/faulty" version "2"
          library EEEEEE "e" from "lib//x"
        "#,
    );
    let read = load(&dir.path().join("m"), &libraries(dir.path())).unwrap();
    expect![[r"
        ROOTID/AAAAAA (a_AAAAAA/core_data.json): library lib/empty is missing: DIR/libs/empty has no root state: a folder with core_data.json is missing; add the library's root to LIBRARY_PATHS, RAFCON_LIBRARY_PATH or --library-path; the reference is kept
        ROOTID/BBBBBB (b_BBBBBB/core_data.json): library lib/odd is missing: DIR/libs/odd has no statemachine.json; add the library's root to LIBRARY_PATHS, RAFCON_LIBRARY_PATH or --library-path; the reference is kept
        ROOTID/CCCCCC (c_CCCCCC/core_data.json): library lib/faulty has problems of its own (1), the first: LEAFXX (meta_data.json): is not JSON: line 1, column 2: expected a key in quotes; correct the file by hand or restore it; it stays as it is until this part of the state is changed; open the library and correct it there
        ROOTID/EEEEEE (e_EEEEEE/core_data.json): library lib//x is missing: `lib/` is not a library path such as `root/folder`; add the library's root to LIBRARY_PATHS, RAFCON_LIBRARY_PATH or --library-path; the reference is kept
    "]].assert_eq(&show_problems(&read).replace(&*dir.path().to_string_lossy(), "DIR"));
}

#[test]
fn libraries_are_read_once_and_shared() {
    let dir = tempfile::tempdir().unwrap();
    put(&dir.path().join("libs/leaf"), LEAF);
    put(
        &dir.path().join("libs/outer"),
        r#"hierarchy OUTERX "o"
  library LLLLLL "l" from "lib/leaf" version "2""#,
    );
    put(
        &dir.path().join("m"),
        r#"
        hierarchy ROOTID "root"
          library AAAAAA "a" from "lib/leaf" version "2"
          library BBBBBB "b" from "lib/leaf" version "2"
          library CCCCCC "c" from "lib/outer"
        "#,
    );
    let libraries = libraries(dir.path());
    let machine = load(&dir.path().join("m"), &libraries).unwrap().machine;
    let content = |path: &str| match &machine.state(&StatePath::parse(path)).unwrap().kind {
        Kind::Library(library) => match &library.content {
            LibraryContent::Found(root) => Arc::clone(root),
            LibraryContent::Missing { reason } => panic!("{reason}"),
        },
        _ => panic!("not a library"),
    };
    let first = content("ROOTID/AAAAAA");
    assert!(Arc::ptr_eq(&first, &content("ROOTID/BBBBBB")));
    assert!(Arc::ptr_eq(&first, &content("ROOTID/CCCCCC/OUTERX/LLLLLL")));
    put(&dir.path().join("libs/leaf"), &LEAF.replace("\"leaf\"", "\"changed\""));
    libraries.refresh();
    let again = load(&dir.path().join("m"), &libraries).unwrap().machine;
    let path = StatePath::parse("ROOTID/AAAAAA/LEAFXX");
    assert_eq!(again.state(&path).unwrap().name, "changed");
}

#[test]
fn a_missing_library_is_saved_as_what_it_was() {
    let dir = tempfile::tempdir().unwrap();
    put(&dir.path().join("libs/leaf"), LEAF);
    let text = r#"
        hierarchy ROOTID "root"
          library AAAAAA "a" from "lib/leaf" version "2"
            set in 0 = 5
        "#;
    put(&dir.path().join("m"), text);
    let known = load(&dir.path().join("m"), &libraries(dir.path())).unwrap();
    let missing = load(&dir.path().join("m"), &Libraries::default()).unwrap();
    let copy = dir.path().join("copy");
    save(&missing.machine, &copy, None, Naming::default()).unwrap();
    let again = load(&copy, &libraries(dir.path())).unwrap();
    assert_eq!(again.machine, known.machine);
    assert_eq!(again.problems, []);
}

#[test]
fn roots_are_found_by_whole_folder_names() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["lib/x", "lib_other/x", "lib/sub/y"] {
        put(&dir.path().join(name), LEAF);
    }
    let root = |name: &str| Root { name: name.into(), dir: dir.path().join(name) };
    let libraries = Libraries::new(vec![root("lib"), root("lib_other")]);
    let reference = |path: &str| {
        let found = libraries.reference(&dir.path().join(path));
        found.map(|(path, name)| format!("{path} + {name}"))
    };
    assert_eq!(reference("lib_other/x").as_deref(), Some("lib_other + x"));
    assert_eq!(reference("lib/sub/y").as_deref(), Some("lib/sub + y"));
    assert_eq!(reference("nowhere"), None);
    let folder = |path: &str| {
        libraries.folder(path, "y").map(|found| found.strip_prefix(dir.path()).unwrap().to_owned())
    };
    assert_eq!(folder("lib/sub"), Ok("lib/sub/y".into()));
    assert_eq!(folder("lib_other"), Ok("lib_other/y".into()));
    assert_eq!(folder("li"), Err("no library root is named `li`".into()));
    for path in ["", "/lib", "lib/", "lib//sub"] {
        assert!(folder(path).is_err(), "{path}");
    }
}

#[test]
fn roots_come_in_a_defined_order_and_later_ones_replace_earlier() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| -> PathBuf { dir.path().join(name) };
    for name in ["c/one", "e/two", "e/one", "g/three"] {
        std::fs::create_dir_all(at(name)).unwrap();
    }
    let config = Config {
        library_paths: vec![("one".into(), at("c/one")), ("gone".into(), at("gone"))],
        ..Config::default()
    };
    let search = format!("{}::{}", at("e/two").display(), at("e/one").display());
    let environment = |name: &str| (name == "RAFCON_LIBRARY_PATH").then(|| search.clone());
    let (roots, notes) = roots(&config, &environment, &[("two".to_owned(), at("g/three"))]);
    let mut shown = String::new();
    for root in roots {
        shown.push_str(&(root.name.to_string() + " " + &root.dir.to_string_lossy() + "\n"));
    }
    for note in notes {
        shown.push_str(&(note.to_string() + "\n"));
    }
    expect![[r"
        one DIR/e/one
        two DIR/g/three
        library root gone: DIR/gone does not exist; correct the path or remove it
        library root one is now DIR/e/one, not DIR/c/one; rename one to use both
        library root two is now DIR/g/three, not DIR/e/two; rename one to use both
    "]]
    .assert_eq(&shown.replace(&*dir.path().to_string_lossy(), "DIR"));
}

#[test]
fn without_configured_roots_the_usual_ones_count() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(dir.path().join("libraries/generic")).unwrap();
    std::fs::create_dir_all(dir.path().join("examples/tutorials")).unwrap();
    let base = dir.path().join("libraries").to_string_lossy().into_owned();
    let environment = |name: &str| (name == "RAFCON_LIB_PATH").then(|| base.clone());
    let (found, notes) = roots(&Config::default(), &environment, &[]);
    let names: Vec<_> = found.iter().map(|root| root.name.as_str()).collect();
    assert_eq!(names, ["generic", "tutorials"]);
    assert_eq!(notes, []);
}

#[test]
fn the_tree_shows_folders_and_libraries() {
    let dir = tempfile::tempdir().unwrap();
    put(&dir.path().join("libs/b/leaf"), LEAF);
    put(&dir.path().join("libs/a"), LEAF);
    std::fs::create_dir_all(dir.path().join("libs/.hidden")).unwrap();
    std::os::unix::fs::symlink("..", dir.path().join("libs/b/up")).unwrap();
    std::fs::remove_file(dir.path().join("libs/b/up")).unwrap();
    let mut shown = String::new();
    show(&libraries(dir.path()).tree(), 0, &mut shown);
    expect![[r"
        lib
          lib/a (library)
          lib/b
            lib/b/leaf (library)
    "]]
    .assert_eq(&shown);
}

fn show(entries: &[LibraryEntry], depth: usize, out: &mut String) {
    for entry in entries {
        out.push_str(&"  ".repeat(depth));
        match &entry.kind {
            EntryKind::Library => out.push_str(&(entry.path.to_string() + " (library)\n")),
            EntryKind::Folder(inside) => {
                out.push_str(&(entry.path.to_string() + "\n"));
                show(inside, depth + 1, out);
            }
        }
    }
}

#[test]
fn libraries_nest_up_to_the_bound() {
    let dir = tempfile::tempdir().unwrap();
    let library = |number: usize| format!(r#"library AAAAAA "a" from "lib/l{number}" version "2""#);
    put(&dir.path().join("libs/l0"), LEAF);
    for number in 1..=100 {
        put(&dir.path().join(format!("libs/l{number}")), &library(number - 1));
    }
    for (number, problem) in [(99, None), (100, Some("libraries nest deeper than 100 levels"))] {
        let machine = dir.path().join("m");
        put(&machine, &library(number));
        let read = load(&machine, &libraries(dir.path())).unwrap();
        let content =
            print_with(&read.machine, Shown { layout: false, scripts: false, contents: true });
        let refused = problem.map_or(0, |problem| content.matches(problem).count());
        assert_eq!(
            (refused, content.contains("LEAFXX")),
            (usize::from(problem.is_some()), problem.is_none())
        );
    }
}

#[test]
fn the_tree_ends_at_the_bound_and_in_a_loop_of_links() {
    let dir = tempfile::tempdir().unwrap();
    let mut folder = dir.path().join("libs");
    for _ in 1..32 {
        folder.push("d");
    }
    put(&folder.join("last"), LEAF);
    put(&folder.join("d/beyond"), LEAF);
    std::os::unix::fs::symlink(dir.path().join("libs"), dir.path().join("libs/loop")).unwrap();
    let mut found = Vec::new();
    library_paths(&libraries(dir.path()).tree(), &mut found);
    assert_eq!(found, [format!("lib{}/last", "/d".repeat(31))]);
}

fn library_paths(entries: &[LibraryEntry], out: &mut Vec<String>) {
    for entry in entries {
        match &entry.kind {
            EntryKind::Folder(entries) => library_paths(entries, out),
            EntryKind::Library => out.push(entry.path.to_string()),
        }
    }
}
