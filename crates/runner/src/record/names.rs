//! What the numbers of places stand for, at each moment of the run. Written by whoever records, read by all.

use rafcon_engine::{Datum, Engine, Node, NodeId, PathId};
use rafcon_locks::RwLock;
use rafcon_model::{KindName, Port, PortId};
use rafcon_storage::journal::stream::{EventBlock, PlaceHistory, write_place};
use rafcon_storage::journal::{Place, PlaceNumber};
use smol_str::SmolStr;
use std::collections::BTreeMap;
use std::sync::Arc;

/// All places that were recorded.
#[derive(Debug, Default)]
pub(crate) struct Names {
    places: RwLock<PlaceHistory>,
}

impl Names {
    /// From record `from` on, the number stands for `place`.
    pub(crate) fn define(&self, from: u64, number: PlaceNumber, place: Arc<Place>) {
        self.places.write().define(from, number, place);
    }

    /// What the number stands for now, if it was recorded.
    pub(crate) fn latest(&self, number: PlaceNumber) -> Option<Arc<Place>> {
        self.places.read().at(number, u64::MAX).cloned()
    }

    /// All definitions so far, as blocks of a stream: for who has not seen what was sent before.
    pub(crate) fn write(&self, out: &mut Vec<u8>) {
        let mut items = Vec::new();
        for (number, from, place) in self.places.read().all() {
            items.clear();
            write_place(number, place, &mut items);
            EventBlock { first: from, t_before: 0, items: &items }.write(out);
        }
    }

    /// Numbers for further places, after those that have one.
    pub(crate) fn numbering(&self) -> Numbering {
        let places = self.places.read();
        let latest = places.latest();
        let next = u32::try_from(latest.len()).unwrap_or(u32::MAX);
        let named = latest.filter_map(|(number, place)| Some((place?.path.clone(), number)));
        Numbering { kept: named.collect(), next }
    }
}

/// Which number a place gets: the one that it has in the journal already, or the next.
#[derive(Debug, Default)]
pub(crate) struct Numbering {
    kept: BTreeMap<String, PlaceNumber>,
    next: u32,
}

impl Numbering {
    /// The number of the place with these ids, which asks once.
    pub(crate) fn number(&mut self, path: &str) -> PlaceNumber {
        self.kept.remove(path).unwrap_or_else(|| {
            let number = PlaceNumber(self.next);
            self.next += 1;
            number
        })
    }
}

/// The place at `path` as a journal defines it.
pub(crate) fn definition<D: Datum>(engine: &Engine<D>, path: PathId, node: NodeId) -> Place {
    let node = engine.program().node(node);
    let container = node.state().container();
    Place {
        path: engine.path_text(path).to_string(),
        names: names(engine, path),
        is_library: node.state().kind.name() == KindName::Library,
        is_script: node.is_script(),
        inputs: ports(node.inputs().iter()),
        outputs: ports(node.outputs().iter()),
        scoped: container.map(|inside| ports(inside.scoped_variables.iter())).unwrap_or_default(),
        outcomes: outcomes(node),
    }
}

fn names<D: Datum>(engine: &Engine<D>, path: PathId) -> String {
    let around = std::iter::successors(Some(path), |path| engine.path_parent(*path));
    let name = |path| Some(engine.program().node(engine.path_node(path)?).name().as_str());
    let mut names: Vec<&str> = around.filter_map(name).collect();
    names.reverse();
    names.join("/")
}

fn ports<'p>(ports: impl Iterator<Item = &'p Port>) -> Vec<(u64, SmolStr)> {
    ports.map(|port| (port_number(port.id), port.name.clone())).collect()
}

/// The id of a port as a journal writes it.
pub(crate) fn port_number(port: PortId) -> u64 {
    port.0.cast_unsigned()
}

fn outcomes<D>(node: &Node<D>) -> Vec<(i64, SmolStr)> {
    node.outcomes().iter().map(|outcome| (outcome.id.0, outcome.name.clone())).collect()
}
