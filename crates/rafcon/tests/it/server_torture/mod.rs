//! Servers and runners killed at moments that no one chose, while a run is started, while it is resumed, and while two clients
//! follow and command: the run is started once, each client has the history that the journal has, no command ran twice or too
//! late, and the run comes to the end that it would have come to.

mod client;
mod site;

use crate::harness::Place;
use crate::torture::{Dice, MACHINE, Repeat, TREMBLES, first_seed, number};
use client::{Client, Kill, Seen};
use rafcon_protocol::api::HistoryEntry;
use rafcon_protocol::{Answer, Event};
use rafcon_storage::journal::{Entry, Reader};
use rafcon_storage::{Naming, save};
use rafcon_testkit::notation;
pub(crate) use site::now_ms;
use site::{Early, Site, Victim};
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;

/// How often something is killed, where a few times are not enough.
const KILLS: &str = "RAFCON_TEST_KILLS";
/// Events between two kills, at most.
const EVENTS: u64 = 300;
/// A script that begins within this time after its command's expiry was decided on before.
const SLACK_MS: u64 = 50;

#[test]
fn killed_servers_and_runners_lose_nothing_and_repeat_nothing() {
    let (kills, first) = (number(KILLS).unwrap_or(9), first_seed());
    let (mut tally, mut seed) = (Tally::default(), first);
    while tally.killed < kills {
        one_run(seed, kills - tally.killed, &mut tally);
        seed += 1;
    }
    writeln!(std::io::stdout(), "{} runs passed: {tally:?}", seed - first).unwrap();
}

/// What was tried.
#[derive(Debug, Default)]
struct Tally {
    killed: u64,
    /// So many of them before the run had begun.
    starting: u64,
    /// So many of them before the run was resumed.
    resuming: u64,
    lives: u64,
    commands: usize,
    applied: usize,
    expired: usize,
    refused: usize,
}

impl Tally {
    fn add(&mut self, journal: &Journal, clients: &[&Seen]) {
        let is_life =
            |(entry, _): &&(HistoryEntry, _)| matches!(entry.event, Event::Resumed { .. });
        self.lives += 1 + journal.events.iter().filter(is_life).count() as u64;
        for seen in clients {
            self.killed += seen.killed;
            self.commands += seen.sent.len();
            for answer in seen.answers.values() {
                match answer {
                    Answer::Applied => self.applied += 1,
                    Answer::Expired | Answer::Unknown { .. } => self.expired += 1,
                    Answer::Refused { .. } => self.refused += 1,
                }
            }
        }
    }
}

/// A run with at most so many kills.
fn one_run(seed: u64, kills: u64, tally: &mut Tally) {
    let _repeat = Repeat { seed, options: "--server " };
    let mut dice = Dice(seed);
    let place = Place::empty();
    let machine = notation::parse(&MACHINE.replace("wait(0.001)", "wait(0.003)")).unwrap();
    save(&machine, &place.path("project/machine"), None, Naming::default()).unwrap();
    let policy = if dice.roll(2) == 0 { "abort" } else { "restart" };
    let early = (0..kills.min(1 + dice.roll(2))).map(|_| victim(&mut dice)).collect::<Vec<_>>();
    let kills = kills - early.len() as u64;
    let site = Site::new(&place, policy, &early, &mut dice);
    let plan = (0..kills.min(dice.roll(3))).map(|number| plan(&mut dice, number == 0)).collect();
    let one = Client::new(&site, "one", true, Dice(dice.roll(u64::MAX))).with_kills(plan);
    let two = Client::new(&site, "two", false, Dice(dice.roll(u64::MAX)));
    let (one, two) = std::thread::scope(|scope| {
        let two = scope.spawn(|| two.follow());
        (one.follow(), two.join().unwrap())
    });
    let journal = Journal::read(&site.folder());
    assert_eq!(one.told, journal.entries(true), "the first client's history");
    assert_eq!(two.told, journal.entries(false), "the second client's history");
    assert_once(&journal, &[&one, &two]);
    assert_in_time(&journal, &site.deaths());
    assert_end(&journal);
    tally.add(&journal, &[&one, &two]);
    let Early { starting, resuming, late } = site.early();
    tally.killed += starting + resuming + late;
    tally.starting += starting;
    tally.resuming += resuming;
}

/// `may_again`: the next runner is killed while it resumes the run. A run that dies too often is left alone.
fn plan(dice: &mut Dice, may_again: bool) -> Kill {
    let victim = victim(dice);
    let again = (may_again && victim != Victim::Server).then(|| dice.roll(TREMBLES));
    Kill { after: dice.roll(EVENTS), with_command: dice.roll(2) == 0, victim, again }
}

fn victim(dice: &mut Dice) -> Victim {
    let victim = [Victim::Server, Victim::Server, Victim::Runner, Victim::Runner, Victim::Both];
    victim[usize::try_from(dice.roll(5)).unwrap()]
}

/// What the run's journal says.
pub(crate) struct Journal {
    started_ms: u64,
    events: Vec<(HistoryEntry, HistoryEntry)>,
}

impl Journal {
    pub(crate) fn read(folder: &Path) -> Self {
        let mut reader = Reader::open(folder).unwrap();
        let entries = reader.page(1, usize::MAX).unwrap();
        let entry = |entry: &Entry, values| HistoryEntry {
            sequence: entry.sequence,
            t_ns: entry.t_ns,
            event: reader.event(entry, values).unwrap(),
        };
        let events = entries.iter().map(|read| (entry(read, true), entry(read, false))).collect();
        Self { started_ms: reader.about().started_ms, events }
    }

    /// As a follower with or without values is told them.
    fn entries(&self, values: bool) -> Vec<HistoryEntry> {
        let about_values = |event: &Event| {
            matches!(event, Event::Scoped { .. } | Event::Global { .. } | Event::Persistent { .. })
        };
        let told = self.events.iter().filter(|(_, bare)| values || !about_values(&bare.event));
        told.map(|(whole, bare)| if values { whole } else { bare }.clone()).collect()
    }

    /// How often each command was carried out.
    pub(crate) fn applied(&self) -> BTreeMap<&str, usize> {
        let mut applied = BTreeMap::new();
        for (entry, _) in &self.events {
            if let Event::Commanded { envelope, answer: Answer::Applied } = &entry.event {
                let id = envelope.id.as_str();
                // Everyone here is the same user.
                *applied.entry(id.strip_prefix("owner/").unwrap_or(id)).or_default() += 1;
            }
        }
        applied
    }
}

/// What was answered is what the journal says, and nothing was carried out twice.
fn assert_once(journal: &Journal, clients: &[&Seen]) {
    let applied = journal.applied();
    for (id, times) in &applied {
        assert_eq!(*times, 1, "{id} was carried out {times} times");
        let is_known =
            id.starts_with("control-") || clients.iter().any(|seen| seen.sent.contains_key(*id));
        assert!(is_known, "{id} was never asked for");
    }
    for (id, answer) in clients.iter().flat_map(|seen| &seen.answers) {
        let is_applied = applied.contains_key(id.as_str());
        assert_eq!(*answer == Answer::Applied, is_applied, "{id} was answered by {answer:?}");
    }
}

/// Nothing was carried out after its expiry. Times of a later life count from its runner's beginning, which was not before the
/// death of the runner before it.
pub(crate) fn assert_in_time(journal: &Journal, deaths: &[u64]) {
    let (mut born_ms, mut life) = (journal.started_ms, 0);
    let mut born_ns = 0;
    for (entry, _) in &journal.events {
        if matches!(entry.event, Event::Resumed { .. }) {
            born_ms = deaths.get(life).copied().unwrap_or(born_ms);
            (life, born_ns) = (life + 1, entry.t_ns);
        }
        let Event::Commanded { envelope, answer: Answer::Applied } = &entry.event else { continue };
        let at_ms = born_ms + entry.t_ns.saturating_sub(born_ns) / 1_000_000;
        let expiry = envelope.expiry.map_or(u64::MAX, |expiry| expiry.0);
        assert!(at_ms <= expiry.saturating_add(SLACK_MS), "{at_ms} ms is too late: {envelope:?}");
    }
}

/// The run has ended as one that no one disturbs.
fn assert_end(journal: &Journal) {
    let last = journal.events.last().map(|(entry, _)| &entry.event);
    let Some(Event::Finished { outcome, outputs, .. }) = last else { panic!("ends by {last:?}") };
    let total = outputs.get("total").and_then(serde_json::Value::as_i64);
    assert_eq!((outcome.name.as_str(), total), ("success", Some(40)));
}
