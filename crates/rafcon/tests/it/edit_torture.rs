//! Servers killed while machines are edited and saved, and while other programs write the same files: no edit that was answered
//! is lost, and the server calls only what others wrote a change by another program. With the real server and nothing between.
//!
//! The short form is a few kills at 750 states. The long form is set up by environment variables, and prints the number of lost
//! edits as a line of JSON.

use crate::harness::Place;
use crate::served::{Line, Served};
use crate::torture::{Dice, first_seed, number};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::{fs, thread};

/// How often the server is killed.
const KILLS: &str = "RAFCON_TEST_KILLS";
/// How many states the machine has.
const STATES: &str = "RAFCON_TEST_STATES";
/// Edits between two kills, at most.
const EDITS: u64 = 24;

#[test]
fn no_answered_edit_is_lost_to_kills_and_other_programs() {
    let (kills, seed) = (number(KILLS).unwrap_or(4), first_seed());
    let mut site = Site::new(number(STATES).unwrap_or(750), Dice(seed));
    for kill in 0..kills {
        site.round(kill);
    }
    let line = json!({ "name": "edits_lost", "value": site.lost, "unit": "edits" });
    writeln!(std::io::stdout(), "{line}").unwrap();
    assert_eq!((site.lost, site.false_alarms), (0, 0), "seed {seed}");
}

/// Who writes the machine's files while a round goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Writer {
    Nobody,
    /// Another program, while the server lives.
    Before,
    /// Another program, between two servers.
    Between,
    /// The server itself: it is killed while it saves.
    Save,
}

/// A machine, the server that has it open, and what the server has confirmed.
struct Site {
    place: Place,
    served: Served,
    machine: String,
    dice: Dice,
    /// Paths of states that are edited.
    states: Vec<String>,
    /// Files that another program writes.
    scripts: Vec<PathBuf>,
    /// The last confirmed name by state.
    names: BTreeMap<String, String>,
    /// Whether another program has written the files since a server wrote or read them.
    is_changed: bool,
    lost: usize,
    false_alarms: usize,
}

impl Site {
    fn new(states: u64, dice: Dice) -> Self {
        let place = Place::empty();
        let made = place.call(&format!("new project/machine --template mission --states {states}"));
        assert_eq!(made.code, Some(0), "{}", made.stderr);
        let (served, machine) = serve(&place);
        let mut site = Self {
            place,
            served,
            machine,
            dice,
            states: Vec::new(),
            scripts: Vec::new(),
            names: BTreeMap::new(),
            is_changed: false,
            lost: 0,
            false_alarms: 0,
        };
        site.states = site.document().into_keys().collect();
        site
    }

    /// Edits, perhaps another program's write or a save, a kill, and a look at what the next server has.
    fn round(&mut self, kill: u64) {
        let mut line = self.served.door().line().unwrap();
        for number in 0..=self.dice.roll(EDITS) {
            self.edit(&mut line, &format!("{kill}.{number}"));
        }
        let writers = [Writer::Nobody, Writer::Before, Writer::Between, Writer::Save];
        let writer = writers[usize::try_from(self.dice.roll(4)).unwrap()];
        match writer {
            Writer::Before => self.write_as_another_program(kill),
            Writer::Save => self.kill_while_it_saves(),
            Writer::Nobody | Writer::Between => {}
        }
        self.served.kill();
        if writer == Writer::Between {
            self.write_as_another_program(kill);
        }
        (self.served, self.machine) = serve(&self.place);
        self.look();
        self.settle(kill);
    }

    fn ask(&self, method: &str, what: &str, body: Option<&Value>) -> Value {
        let path = format!("/api/v1/machines/{}{what}", self.machine);
        self.served.door().ask(method, &path, body).unwrap()
    }

    /// The names of all states.
    fn document(&self) -> BTreeMap<String, String> {
        let whole = self.ask("GET", "/document", None);
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let states = whole["document"]["states"].as_array().unwrap().iter();
        states.map(|state| (text(&state["path"]), text(&state["name"]))).collect()
    }

    fn edit(&mut self, line: &mut Line, name: &str) {
        let at = usize::try_from(self.dice.roll(self.states.len() as u64)).unwrap();
        let path = self.states[at].clone();
        let edit = json!({ "edit": "set_name", "path": path, "name": name });
        let edit = json!({ "id": name, "name": "Rename", "edit": edit });
        let frame = json!({ "frame": "edit", "machine": self.machine, "edit": edit });
        line.say(&serde_json::from_value(frame).unwrap()).unwrap();
        let answer: Value = serde_json::from_str(&line.hear_text().unwrap()).unwrap();
        assert_eq!(answer["frame"], "edited", "{answer}");
        self.names.insert(path, name.to_owned());
    }

    fn write_as_another_program(&mut self, kill: u64) {
        // A save renames the folders of renamed states.
        self.scripts.clear();
        find_scripts(&self.place.path("project/machine"), &mut self.scripts);
        self.scripts.sort();
        let at = usize::try_from(self.dice.roll(self.scripts.len() as u64)).unwrap();
        let mut script = fs::OpenOptions::new().append(true).open(&self.scripts[at]).unwrap();
        writeln!(script, "# written by another program: {kill}").unwrap();
        self.is_changed = true;
    }

    /// The server dies when its staging folder has so many entries, or when it is done.
    fn kill_while_it_saves(&mut self) {
        let entries = usize::try_from(self.dice.roll(12)).unwrap();
        let staging = self.place.path("project/machine/.rafcon-save");
        let path = format!("/api/v1/machines/{}/save", self.machine);
        let (door, body) = (self.served.door().clone(), json!({ "overwrite": self.is_changed }));
        let save = move || drop(door.answer("POST", &path, Some(&body)));
        let save = thread::Builder::new().spawn(save).unwrap();
        while !save.is_finished() && count(&staging) < entries {
            thread::yield_now();
        }
        self.served.kill();
        save.join().unwrap();
    }

    /// What was confirmed is there; a change of the files is called another program's only if it is.
    fn look(&mut self) {
        let now = self.document();
        let lost = self.names.iter().filter(|(path, name)| now.get(*path) != Some(name)).count();
        let status = self.ask("GET", "", None);
        let says_changed = status["summary"]["disk"] == "changed";
        if lost > 0 || (says_changed && !self.is_changed) {
            let mut out = std::io::stdout();
            writeln!(out, "{lost} lost, another program's change: {}", self.is_changed).unwrap();
            writeln!(out, "{status}").unwrap();
        }
        self.lost += lost;
        self.false_alarms += usize::from(says_changed && !self.is_changed);
        self.is_changed = says_changed;
        self.names.retain(|path, name| now.get(path) == Some(name));
    }

    /// Saves or takes what another program wrote from time to time, so that drafts of all ages are tried.
    fn settle(&mut self, kill: u64) {
        match self.dice.roll(6) {
            0 => drop(self.ask("POST", "/save", Some(&json!({ "overwrite": true })))),
            1 => {
                drop(self.ask("POST", "/reload", Some(&json!({ "id": format!("reload {kill}") }))));
            }
            _ => return,
        }
        self.is_changed = false;
        let now = self.document();
        self.names.retain(|path, name| now.get(path) == Some(name));
    }
}

fn serve(place: &Place) -> (Served, String) {
    let words = "serve project --bind 127.0.0.1:0 --state state --runs runs";
    let served = Served::start(place.command(words)).unwrap();
    let file = json!({ "file": { "project": "project", "path": "machine" } });
    let opened = served.door().ask("POST", "/api/v1/machines/open", Some(&file)).unwrap();
    let machine = opened["id"].as_str().unwrap().to_owned();
    (served, machine)
}

fn find_scripts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            find_scripts(&path, found);
        } else if path.file_name().is_some_and(|name| name == "script.py") {
            found.push(path);
        }
    }
}

fn count(folder: &Path) -> usize {
    fs::read_dir(folder).map_or(0, Iterator::count)
}
