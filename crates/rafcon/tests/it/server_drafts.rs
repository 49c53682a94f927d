//! A server that is killed in the middle of editing: what it had answered is there when the next one opens the machine, and
//! what is asked for again is not made twice. With the real server and nothing in between.

use crate::harness::Place;
use crate::served::{Line, Served};
use rafcon_storage::{Libraries, Naming, load, save};
use rafcon_testkit::notation;
use serde_json::{Value, json};

const MACHINE: &str = "
    hierarchy ROOT
      outcome success
      execution AAAAAA
        outcome success
";
/// So often the server is killed.
const KILLS: usize = 6;
/// So many edits are under way when it is.
const EDITS: usize = 60;

/// A machine, and a server that has it open.
struct Site {
    place: Place,
    served: Served,
    machine: String,
}

impl Site {
    fn new() -> Self {
        let place = Place::empty();
        let machine = notation::parse(MACHINE).unwrap();
        save(&machine, &place.path("project/machine"), None, Naming::default()).unwrap();
        let (served, machine) = serve(&place);
        Self { place, served, machine }
    }

    /// Kills the server, and starts another one that opens the machine.
    fn take_over(&mut self) {
        self.served.kill();
        (self.served, self.machine) = serve(&self.place);
    }

    fn ask(&self, method: &str, what: &str, body: Option<&Value>) -> Value {
        let path = format!("/api/v1/machines/{}{what}", self.machine);
        self.served.door().ask(method, &path, body).unwrap()
    }

    fn say(&self, line: &mut Line, number: usize) {
        let edit = json!({
            "edit": "add_outcome", "path": "ROOT/AAAAAA", "outcome": number, "name": format!("o{number}")
        });
        let edit = json!({ "id": format!("edit {number}"), "name": "Add outcome", "edit": edit });
        let frame = json!({ "frame": "edit", "machine": self.machine, "edit": edit });
        line.say(&serde_json::from_value(frame).unwrap()).unwrap();
    }

    /// The outcomes from 1 on that the machine has now.
    fn outcomes(&self) -> Vec<usize> {
        let document = self.ask("GET", "/document", None);
        let outcomes = document["document"]["states"][1]["outcomes"].as_array().unwrap().clone();
        let number = |outcome: &Value| usize::try_from(outcome["id"].as_i64()?).ok();
        outcomes.iter().filter_map(number).filter(|number| *number > 0).collect()
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

/// The number of the edit that was answered; nothing once the server is dead.
fn answered(line: &mut Line) -> Option<usize> {
    let frame: Value = serde_json::from_str(&line.hear_text().ok()?).unwrap();
    assert_eq!(frame["frame"], "edited", "{frame}");
    frame["id"].as_str().unwrap().strip_prefix("edit ")?.parse().ok()
}

#[test]
fn a_killed_server_loses_no_edit_that_was_answered_and_makes_none_twice() {
    let mut site = Site::new();
    for kill in 0..KILLS {
        let numbers = (1 + kill * EDITS..=(kill + 1) * EDITS).collect::<Vec<_>>();
        let mut line = site.served.door().line().unwrap();
        for number in &numbers {
            site.say(&mut line, *number);
        }
        let mut known = Vec::new();
        while known.len() < 1 + kill * EDITS / KILLS {
            known.push(answered(&mut line).unwrap());
        }
        site.served.kill();
        known.extend(std::iter::from_fn(|| answered(&mut line)));
        site.take_over();
        let outcomes = site.outcomes();
        assert!(known.iter().all(|number| outcomes.contains(number)), "{known:?} {outcomes:?}");
        let mut line = site.served.door().line().unwrap();
        for number in &numbers {
            site.say(&mut line, *number);
            assert_eq!(answered(&mut line), Some(*number));
        }
        assert_eq!(site.outcomes(), (1..=(kill + 1) * EDITS).collect::<Vec<_>>());
    }
    site.ask("POST", "/save", Some(&json!({})));
    let saved = load(&site.place.path("project/machine"), &Libraries::default()).unwrap();
    assert!(notation::print(&saved.machine).contains(&format!("o{}", KILLS * EDITS)));
}
