//! The events of a mission, encoded as in a journal: 800 states, eight deep, three branches, ten events a second.

use super::plan::Window;
use crate::random::Random;
use rafcon_storage::journal::record::Content;
use rafcon_storage::journal::{
    Definition, Item, Kept, Moment, Place, PlaceNumber, Places, Record, Stored, ValueNumber,
};
use std::time::Duration;

const BRANCHES: usize = 3;
const DEPTH: usize = 8;
const STATES: usize = 800;
/// Average duration of a state on each branch.
const STATE_MS: usize = 850;

/// A random mission, recorded in advance as a list of events.
#[derive(Debug)]
pub(super) struct Mission {
    events: Vec<MissionEvent>,
    items: Vec<u8>,
    /// The paths of its branches.
    pub(super) branches: Vec<String>,
}

#[derive(Debug, Clone, Copy)]
struct MissionEvent {
    t_ns: u64,
    /// End of its items.
    end: usize,
}

impl Mission {
    /// A mission of this length without events in the quiet time.
    pub(super) fn new(random: Random, length: Duration, quiet: Window) -> Self {
        let mut writer = MissionWriter::new(random);
        writer.run(length, quiet);
        let branches = writer.places[1..=BRANCHES].iter().map(|place| place.path.clone()).collect();
        Self { branches, ..writer.mission }
    }

    /// Time of the event with this number.
    pub(super) fn time(&self, sequence: u64) -> Option<Duration> {
        let event = self.events.get(usize::try_from(sequence.checked_sub(1)?).ok()?)?;
        Some(Duration::from_nanos(event.t_ns))
    }

    /// The number of the last event up to this time.
    pub(super) fn head(&self, time: Duration) -> u64 {
        let time = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        self.events.partition_point(|event| event.t_ns <= time) as u64
    }

    /// The time before the events of these numbers, and their items.
    pub(super) fn items(&self, first: u64, last: u64) -> (u64, &[u8]) {
        let [before, last] = [first - 1, last].map(|sequence| {
            let place = usize::try_from(sequence).unwrap_or_default();
            place
                .checked_sub(1)
                .map_or(MissionEvent { t_ns: 0, end: 0 }, |place| self.events[place])
        });
        (before.t_ns, &self.items[before.end..last.end])
    }
}

#[derive(Debug)]
struct MissionWriter {
    random: Random,
    mission: Mission,
    t_ns: u64,
    places: Vec<Place>,
    /// Parent of each place.
    parents: Vec<usize>,
    known: Vec<bool>,
    values: u64,
    /// The active state of each branch, after the containers around it.
    active: [Vec<usize>; BRANCHES],
}

impl MissionWriter {
    fn new(random: Random) -> Self {
        let mut writer = Self {
            random,
            mission: Mission { events: Vec::new(), items: Vec::new(), branches: Vec::new() },
            t_ns: 0,
            places: vec![place("MISSION", "Mission", false)],
            parents: vec![0],
            known: vec![false; STATES],
            values: 0,
            active: [const { Vec::new() }; BRANCHES],
        };
        let mut inner = Vec::new();
        for number in 1..STATES {
            let parent = writer.random.pick(&inner).filter(|_| number > BRANCHES).unwrap_or(0);
            let id: String = (0..6).map(|_| writer.letter()).collect();
            let around = &writer.places[parent];
            let path = format!("{}/{id}", around.path);
            let names = format!("{}/Waypoint {number}", around.names);
            let depth = path.matches('/').count();
            let is_script = number > BRANCHES && (depth >= DEPTH || writer.random.percent(75));
            writer.places.push(place(&path, &names, is_script));
            writer.parents.push(parent);
            if !is_script {
                inner.push(number);
            }
        }
        writer
    }

    fn letter(&mut self) -> char {
        ('A'..='Z').nth(self.random.below(26)).unwrap_or('A')
    }

    fn run(&mut self, length: Duration, quiet: Window) {
        self.enter(0);
        for branch in 1..=BRANCHES {
            self.enter(branch);
        }
        let mut due = [0_u64; BRANCHES].map(|_| self.pause());
        loop {
            let branch = (0..BRANCHES).min_by_key(|branch| due[*branch]).unwrap_or_default();
            let at = Duration::from_nanos(due[branch]);
            if at >= length {
                break;
            }
            if quiet.has(at) {
                due[branch] = u64::try_from(quiet.to.as_nanos()).unwrap_or(u64::MAX) + self.pause();
                continue;
            }
            self.t_ns = self.t_ns.max(due[branch]);
            self.advance(branch);
            due[branch] += self.pause();
        }
    }

    fn pause(&mut self) -> u64 {
        self.random.below(2 * STATE_MS) as u64 * 1_000_000
    }

    /// Leaves the state of the branch and enters another: mostly a sibling, else any state of the branch.
    fn advance(&mut self, branch: usize) {
        let before = std::mem::take(&mut self.active[branch]);
        let scripts = (0..STATES).filter(|place| self.places[*place].is_script);
        let around = before.last().map(|place| self.parents[*place]);
        let around = around.filter(|_| self.random.percent(70));
        let below: Vec<usize> = scripts
            .filter(|&place| match around {
                Some(around) => self.parents[place] == around,
                None => self.way(place).first() == Some(&(branch + 1)),
            })
            .collect();
        let Some(next) = self.random.pick(&below) else { return };
        let way = self.way(next)[1..].to_vec();
        let common = before.iter().zip(&way).take_while(|(one, other)| one == other).count();
        let common = common.min(way.len() - 1);
        for place in before.iter().skip(common).rev() {
            self.leave(*place);
        }
        for place in &way[common..] {
            self.enter(*place);
        }
        self.active[branch] = way;
    }

    /// The places from below the root to this one.
    fn way(&self, place: usize) -> Vec<usize> {
        let mut way = vec![place];
        while self.parents[way[0]] != 0 {
            way.insert(0, self.parents[way[0]]);
        }
        way
    }

    fn enter(&mut self, place: usize) {
        let inputs = self.values();
        self.record(place, Record::Entered { place: number(place), inputs, undoes: None });
    }

    fn leave(&mut self, place: usize) {
        let outputs = self.values();
        let left =
            Record::Left { place: number(place), outcome: 0, outputs, error: None, undoes: None };
        self.record(place, left);
    }

    fn record(&mut self, place: usize, record: Record) {
        if !std::mem::replace(&mut self.known[place], true) {
            self.define(Definition::Place(number(place), self.places[place].clone()));
        }
        let before = self.mission.events.last().map_or(0, |event| event.t_ns);
        self.t_ns += 300_000;
        Item::Record(self.t_ns, record).write(&mut { before }, &mut self.mission.items);
        let end = self.mission.items.len();
        self.mission.events.push(MissionEvent { t_ns: self.t_ns, end });
    }

    fn define(&mut self, definition: Definition) {
        Item::Definition(definition).write(&mut 0, &mut self.mission.items);
    }

    /// Values whose average number and length match the mission of `rafcon new --template mission`.
    fn values(&mut self) -> Vec<Kept> {
        let count = [0, 0, 1, 1, 2][self.random.below(5)];
        (0..count).map(|_| self.value()).collect()
    }

    fn measured(&mut self) -> f64 {
        f64::from(u16::try_from(self.random.below(10_000)).unwrap_or_default()) / 10.0
    }

    fn value(&mut self) -> Kept {
        let kind = self.random.below(100);
        if kind < 45 {
            return Kept::Int(self.random.small(500));
        } else if kind < 80 {
            return Kept::Float(self.measured());
        }
        self.values += 1;
        let number = ValueNumber(self.values);
        let view = serde_json::json!([self.measured(), self.measured()]);
        let stored = Stored { view, type_name: "tuple".into(), content: Content::View };
        self.define(Definition::Value(number, stored));
        Kept::Value(number)
    }
}

fn number(place: usize) -> PlaceNumber {
    PlaceNumber(u32::try_from(place).unwrap_or(u32::MAX))
}

fn place(path: &str, names: &str, is_script: bool) -> Place {
    Place {
        path: path.to_owned(),
        names: names.to_owned(),
        is_library: false,
        is_script,
        inputs: vec![(0, "goal".into()), (1, "speed".into())],
        outputs: vec![(2, "distance".into())],
        scoped: Vec::new(),
        outcomes: vec![(0, "success".into()), (-1, "aborted".into()), (-2, "preempted".into())],
    }
}

/// One event of a mission, for other carriers.
#[derive(Debug, Clone)]
pub struct SampleEvent {
    /// Time of the event, in ns since the beginning of the mission.
    pub t_ns: u64,
    /// Its items as in a journal, with all definitions that they need and that were not yet sent.
    pub items: Vec<u8>,
    /// The ids of its place.
    pub path: String,
    /// The names of its place.
    pub names: String,
}

/// The events of a mission of this length, and its state in the middle, encoded as for a link.
pub fn sample_events(seed: u64, length: Duration) -> (Vec<SampleEvent>, Vec<u8>) {
    let mission = Mission::new(Random::new(seed), length, Window { from: length, to: length });
    let (mut places, mut events) = (Vec::new(), Vec::new());
    for sequence in 1..=mission.events.len() as u64 {
        let (time_before, items) = mission.items(sequence, sequence);
        let mut sample = SampleEvent {
            t_ns: 0,
            items: items.to_vec(),
            path: String::new(),
            names: String::new(),
        };
        for item in rafcon_storage::journal::record::Items::new(items, time_before).flatten() {
            match item {
                Item::Definition(Definition::Place(number, place)) => places.push((number, place)),
                Item::Record(t_ns, Record::Entered { place, .. } | Record::Left { place, .. }) => {
                    sample.t_ns = t_ns;
                    if let Some((_, place)) = places.iter().find(|(number, _)| *number == place) {
                        sample.path.clone_from(&place.path);
                        sample.names.clone_from(&place.names);
                    }
                }
                _ => {}
            }
        }
        events.push(sample);
    }
    let mut state = MissionState::new();
    state.follow(&mission, events.len() as u64 / 2);
    (events, state.take_bytes())
}

/// The state of a mission, as a robot sends it.
#[derive(Debug)]
pub(super) struct MissionState {
    moment: Moment,
    sequence: u64,
}

impl MissionState {
    pub(super) fn new() -> Self {
        Self { moment: Moment::new(Places::default()), sequence: 0 }
    }

    /// Applies the events up to this one.
    pub(super) fn follow(&mut self, mission: &Mission, head: u64) {
        if self.sequence >= head {
            return;
        }
        let (time_before, items) = mission.items(self.sequence + 1, head);
        for item in rafcon_storage::journal::record::Items::new(items, time_before).flatten() {
            match item {
                Item::Definition(definition) => self.moment.define(&definition),
                Item::Record(t_ns, record) => {
                    self.sequence += 1;
                    self.moment.apply(self.sequence, t_ns, &record);
                }
            }
        }
    }

    /// Active states with inputs: path, event, and the inputs as text.
    pub(super) fn inputs(&self) -> impl Iterator<Item = (String, u64, String)> {
        self.moment.active().into_iter().map(|state| {
            let inputs: Vec<_> = state.inputs.iter().map(|(_, kept)| format!("{kept:?}")).collect();
            (state.place.path.clone(), state.order, inputs.join(" "))
        })
    }

    /// The encoded state, with the parent and the number of each place. With the machine, these identify the place.
    pub(super) fn take_bytes(&mut self) -> Vec<u8> {
        let mut bytes = self.moment.to_bytes_with_steps(0);
        // Continue from the decoded state, because the station's copy has no steps for undoing.
        let places = self.moment.places().clone();
        if let Ok(moment) = Moment::from_bytes(&bytes, places) {
            self.moment = moment;
        }
        let places = self.moment.places();
        for (number, _) in places.iter() {
            let parent = places.parent(number).map_or(0, |parent| parent.0);
            bytes.extend_from_slice(&u16::try_from(parent).unwrap_or_default().to_le_bytes());
            bytes.push(number.0.to_le_bytes()[0]);
        }
        bytes
    }
}
