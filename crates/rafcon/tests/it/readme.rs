//! The first machine of the README: typed as it stands there, the terminal answers as it stands there.

use crate::harness::Place;
use std::path::Path;
use std::process::Command;

const README: &str = include_str!("../../../../README.md");

#[test]
fn the_first_machine_runs_as_shown() {
    let place = Place::empty();
    let mut checked = 0;
    for step in console(README).split("$ ").skip(1) {
        let (command, answer) = step.split_once('\n').unwrap();
        assert_eq!(without_times(&type_in(command, &place)), without_times(answer));
        checked += 1;
    }
    assert_eq!(checked, 4, "the README shows four commands");
}

/// The text of the first console block.
fn console(markdown: &str) -> &str {
    let (_, after) = markdown.split_once("```console\n").unwrap();
    after.split_once("```").unwrap().0
}

fn type_in(command: &str, place: &Place) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_rafcon"));
    let programs = program.parent().unwrap().display();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = format!("{programs}:{}", path.to_string_lossy());
    let mut shell = Command::new("sh");
    shell.args(["-c", command]).current_dir(place.path("")).env("PATH", path);
    shell.env("HOME", place.path("")).env_remove("RAFCON_RUNS").env_remove("XDG_STATE_HOME");
    let answer = place.answer(&shell.output().unwrap());
    answer.stdout + &answer.stderr
}

/// Times differ from run to run: numbers with a fraction become a sign.
fn without_times(text: &str) -> String {
    let mut words = Vec::new();
    for line in text.lines() {
        let time = |word: &str| word.contains('.') && word.parse::<f64>().is_ok();
        let words_of = line.split(' ').map(|word| if time(word) { "TIME" } else { word });
        words.push(words_of.collect::<Vec<_>>().join(" "));
    }
    words.join("\n")
}
