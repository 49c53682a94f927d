//! Two users edit one machine concurrently over their sockets, each on the basis of the revisions already received. In the end both
//! users, the server and the files have equal machines.

use crate::harness::{TestServer, name};
use crate::machines::{get, open, post};
use crate::socket_client::Client;
use rafcon_model::{BuiltinTypes, problems};
use rafcon_protocol::api::Role;
use rafcon_protocol::document::{Document, Mirror, leave};
use rafcon_protocol::edit::Edit;
use rafcon_protocol::socket::ToClient;
use rafcon_storage::{Libraries, load};
use rafcon_testkit::edits::{Dice, edit};
use serde_json::{Value, json};
use std::thread;

const START: &str = "
    hierarchy ROOT
      outcome success
      in a: int
      var v: int
      start -> AAAAAA
      AAAAAA.success -> BBBBBB ; BBBBBB.success -> .success
      flow .a -> AAAAAA.x
      execution AAAAAA
        outcome success
        in x: int
      barrier BBBBBB
        outcome success
        execution DDDDDD
          outcome success
        decider unique_decider_state_id
          outcome success
";

/// Number of edits, undos and redos per user.
const DEEDS: usize = 5_000;
/// Beyond this size, states are removed from the machine.
const STATES_MAX: usize = 40;

/// A user with their copy of the machine.
struct Person<'h> {
    role: Role,
    machine: &'h str,
    client: Client,
    mirror: Mirror,
    next: u64,
    /// Names of the user's steps, for undo and redo.
    done: Vec<String>,
    undone: Vec<String>,
    refused: usize,
}

impl<'h> Person<'h> {
    fn new(server: &TestServer, role: Role, machine: &'h str) -> Self {
        let now = get(server, &format!("/{machine}/document"));
        let document: Document = serde_json::from_value(now["document"].clone()).unwrap();
        let next = now["revision"].as_u64().unwrap() + 1;
        let mut client = Client::connect(server, role);
        client
            .subscribe(1, &json!({ "topic": "machine_history", "machine": machine, "from": next }));
        let (mirror, done, undone) = (Mirror::new(document), Vec::new(), Vec::new());
        Self { role, machine, client, mirror, next, done, undone, refused: 0 }
    }

    fn hear(&mut self) -> ToClient {
        let frame: ToClient = serde_json::from_value(self.client.hear()).unwrap();
        if let ToClient::Revisions { revisions, .. } = &frame {
            for revision in revisions {
                assert_eq!(revision.revision, self.next);
                self.next += 1;
                revision.changes.iter().cloned().for_each(|change| self.mirror.apply(change));
                if revision.author == name(self.role) {
                    self.mine(&revision.id, &revision.name);
                }
            }
        }
        frame
    }

    /// Handles a step of this user: an undo must revert the user's own last step.
    fn mine(&mut self, id: &str, name: &str) {
        let step = match id.split('-').next() {
            Some("undo") => self.done.pop().inspect(|step| self.undone.push(step.clone())),
            Some("redo") => self.undone.pop().inspect(|step| self.done.push(step.clone())),
            _ => {
                self.undone.clear();
                self.done.push(name.to_owned());
                Some(name.to_owned())
            }
        };
        assert_eq!(step.as_deref(), Some(name));
    }

    fn work(&mut self, seed: u64) {
        let mut dice = Dice::new(numbers(seed));
        for number in 0..DEEDS {
            let frame = self.deed(number, &mut dice);
            self.client.say(&frame);
            while !self.take_answer() {}
        }
    }

    fn take_answer(&mut self) -> bool {
        match self.hear() {
            ToClient::Edited { .. } => true,
            ToClient::Refused { refusal, .. } => {
                assert!(!refusal.message.is_empty());
                let known = ["edit_refused", "built_upon", "nothing_to_do", "bad_edit"];
                assert!(known.contains(&refusal.code.as_str()), "{refusal:?}");
                self.refused += 1;
                true
            }
            _ => false,
        }
    }

    fn deed(&self, number: usize, dice: &mut Dice) -> Value {
        let machine = self.machine;
        match dice.roll(6) {
            0 => {
                json!({ "frame": "undo", "machine": machine, "undo": { "id": format!("undo-{number}") } })
            }
            1 => {
                json!({ "frame": "redo", "machine": machine, "redo": { "id": format!("redo-{number}") } })
            }
            _ => {
                let edit = self.edit(dice);
                let step = format!("{} {number}", name(self.role));
                let edit = json!({ "id": format!("edit-{number}"), "name": step, "edit": edit });
                json!({ "frame": "edit", "machine": machine, "edit": edit })
            }
        }
    }

    fn edit(&self, dice: &mut Dice) -> Value {
        let states: Vec<_> = self.mirror.states().collect();
        let inner = states.iter().filter(|state| state.path.contains('/'));
        let inner: Vec<_> = inner.filter(|state| !state.path.ends_with("_id")).collect();
        if states.len() > STATES_MAX {
            let (path, state) = inner[dice.roll(inner.len())].path.rsplit_once('/').unwrap();
            return json!({ "edit": "remove_state", "path": path, "state": state });
        }
        let machine = self.mirror.document().read(&mut leave).unwrap();
        serde_json::to_value(Edit::of(&edit(&machine, dice))).unwrap()
    }

    fn catch_up(&mut self, revision: u64) {
        while self.next <= revision {
            self.hear();
        }
    }
}

/// Pseudo-random numbers, determined by the seed.
fn numbers(seed: u64) -> Vec<u16> {
    let mut state = seed;
    let next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        u16::try_from(state >> 48).unwrap()
    };
    std::iter::repeat_with(next).take(DEEDS * 40).collect()
}

#[test]
fn two_people_edit_one_machine_and_end_with_the_same() {
    let server = TestServer::new();
    crate::machines::write(&server, "one", START);
    let id = open(&server, "one");
    let mut ann = Person::new(&server, Role::Engineer, &id);
    let mut bob = Person::new(&server, Role::Admin, &id);
    thread::scope(|scope| {
        scope.spawn(|| ann.work(1));
        scope.spawn(|| bob.work(2));
    });
    let now = get(&server, &format!("/{id}/document"));
    let revision = now["revision"].as_u64().unwrap();
    let document: Document = serde_json::from_value(now["document"].clone()).unwrap();
    for person in [&mut ann, &mut bob] {
        person.catch_up(revision);
        assert_eq!(person.mirror.document(), document);
        assert!(person.refused > 0 && person.done.len() > DEEDS / 100);
    }
    assert_eq!(post(&server, Role::Engineer, &format!("/{id}/save"), &json!({})).status, 200);
    let saved = load(&server.project().join("one"), &Libraries::default()).unwrap();
    assert_eq!(Document::of(&saved.machine).states, document.states);
    let faults = problems(&saved.machine, &BuiltinTypes);
    // A machine may lack a start or states during editing.
    assert!(faults.iter().all(|fault| !fault.rule.refuses_edits()), "{faults:?}");
}
