//! Text in, typed config out.

use super::{Config, clean_path, find, parse};
use expect_test::{Expect, expect};
use std::path::Path;

fn environment(name: &str) -> Option<String> {
    match name {
        "HOME" => Some("/home/me".to_owned()),
        "LIBS" => Some("/opt/libs".to_owned()),
        _ => None,
    }
}

fn check(text: &str, expect: &Expect) {
    expect.assert_eq(&format!("{:#?}", parse(text, Path::new("/etc/rafcon"), &environment)));
}

#[test]
fn a_config_of_the_reference_is_read() {
    check(
        r#"
# a comment
TYPE: SM_CONFIG
LIBRARY_PATHS: {
    "own": "${LIBS}/own",
    near: ./near/../here,
    home: ~/libs,
    beside: "$RELATIVE_PATH{x}"
}
LIBRARY_RECOVERY_MODE: False
STORAGE_PATH_WITH_STATE_NAME: no
MAX_LENGTH_FOR_STATE_NAME_IN_STORAGE_PATH: 20
EXECUTION_LOG_PATH: "%RAFCON_TEMP_PATH_BASE/execution_logs"
SCRIPT_RECOMPILATION_ON_STATE_EXECUTION: "False"
"#,
        &expect![[r#"
            Config {
                library_paths: [
                    (
                        "own",
                        "/opt/libs/own",
                    ),
                    (
                        "near",
                        "/etc/rafcon/here",
                    ),
                    (
                        "home",
                        "/home/me/libs",
                    ),
                    (
                        "beside",
                        "/etc/rafcon/x",
                    ),
                ],
                naming: Naming {
                    with_name: false,
                    max_name_length: Some(
                        20,
                    ),
                },
                in_memory_history: true,
                file_history: false,
                execution_log_path: None,
                recompile_scripts: false,
                notes: [],
            }"#]],
    );
}

/// Roots and notes only; everything else has its default.
fn check_faulty(text: &str, expect: &Expect) {
    let config = parse(text, Path::new("/etc/rafcon"), &environment);
    expect.assert_eq(&format!("{:?}\n{:?}", config.library_paths, config.notes));
    assert_eq!(
        Config { library_paths: Vec::new(), notes: Vec::new(), ..config },
        Config::default()
    );
}

#[test]
fn what_cannot_be_read_is_a_note_and_the_default_counts() {
    check_faulty(
        "LIBRARY_PATHS: {a: 1, b: /b}\nMAX_LENGTH_FOR_STATE_NAME_IN_STORAGE_PATH: None\nEXECUTION_LOG_PATH: 3\nIN_MEMORY_EXECUTION_HISTORY_ENABLE: 7",
        &expect![[r#"
            [("b", "/b")]
            [WrongType { key: "LIBRARY_PATHS.a", expected: "a name and a folder" }, WrongType { key: "IN_MEMORY_EXECUTION_HISTORY_ENABLE", expected: "true or false" }, WrongType { key: "EXECUTION_LOG_PATH", expected: "a path" }]"#]],
    );
    check_faulty(
        "LIBRARY_PATHS: [1, 2",
        &expect![[r#"
        []
        [Malformed("while parsing a flow sequence, expected ',' or ']' at byte 20 line 2 column 1")]"#]],
    );
    check_faulty(
        "",
        &expect![[r"
        []
        []"]],
    );
    check_faulty(
        "just text",
        &expect![[r"
        []
        []"]],
    );
}

#[test]
fn paths_are_expanded() {
    let clean =
        |text| clean_path(text, Path::new("/base"), &environment).to_string_lossy().into_owned();
    assert_eq!(clean("a/./b/../c"), "/base/a/c");
    assert_eq!(clean("'~/x'"), "/home/me/x");
    assert_eq!(clean("~"), "/home/me");
    assert_eq!(clean("~other/x"), "/base/~other/x");
    assert_eq!(clean("$LIBS/${LIBS}x"), "/opt/libs/opt/libsx");
    assert_eq!(clean("${NONE}/a"), "/base/${NONE}/a");
    assert_eq!(clean("/a$"), "/a$");
    assert_eq!(clean("/../.."), "/../..");
}

#[test]
fn a_config_is_found_and_never_written() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("config.yaml");
    let text = "STORAGE_PATH_WITH_STATE_NAME: false\n";
    assert!(find(Some(dir.path()), &environment).is_err());
    assert_eq!(find(None, &|_: &str| None).unwrap().1, None);
    std::fs::write(&file, text).unwrap();
    for given in [dir.path(), &file] {
        let (config, found) = find(Some(given), &environment).unwrap();
        assert_eq!((config.naming.with_name, found.as_deref()), (false, Some(file.as_path())));
    }
    let home = dir.path().join("home");
    let usual = |name: &str| (name == "HOME").then(|| home.to_string_lossy().into_owned());
    assert_eq!(find(None, &usual).unwrap().1, None);
    assert!(!home.exists());
    assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
}
