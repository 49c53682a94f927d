//! The definitions of place numbers at each moment of the run. Written by the recorder, read by all.

use rafcon_engine::{Datum, Engine, Node, NodeId, PathId};
use rafcon_locks::RwLock;
use rafcon_model::{KindName, Port, PortId};
use rafcon_storage::journal::stream::{PlaceHistory, StreamBlock, write_place};
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
    /// Defines the number of `place` from record `from` on.
    pub(crate) fn define(&self, from: u64, number: PlaceNumber, place: Arc<Place>) {
        self.places.write().define(from, number, place);
    }

    /// The current definition of the number, if it was recorded.
    pub(crate) fn latest(&self, number: PlaceNumber) -> Option<Arc<Place>> {
        self.places.read().at(number, u64::MAX).cloned()
    }

    /// Writes all definitions as blocks of a stream, for a reader without the earlier ones.
    pub(crate) fn write(&self, out: &mut Vec<u8>) {
        let mut items = Vec::new();
        for (number, from, place) in self.places.read().all() {
            items.clear();
            write_place(number, place, &mut items);
            StreamBlock { first: from, t_before: 0, items: &items }.write(out);
        }
    }

    /// Numbers for further places, after the assigned ones.
    pub(crate) fn numbering(&self) -> Numbering {
        let places = self.places.read();
        let latest = places.latest();
        let next = u32::try_from(latest.len()).unwrap_or(u32::MAX);
        let named = latest.filter_map(|(number, place)| Some((place?.path.clone(), number)));
        Numbering { kept: named.collect(), next }
    }
}

/// Assigns numbers to places: the number that a place has in the journal, or the next free one.
#[derive(Debug, Default)]
pub(crate) struct Numbering {
    kept: BTreeMap<String, PlaceNumber>,
    next: u32,
}

impl Numbering {
    /// The number of the place with this path. Each place asks once.
    pub(crate) fn number(&mut self, path: &str) -> PlaceNumber {
        self.kept.remove(path).unwrap_or_else(|| {
            let number = PlaceNumber(self.next);
            self.next += 1;
            number
        })
    }
}

/// The journal's definition of the place at `path`.
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

/// The id of a port in the journal's form.
pub(crate) fn port_number(port: PortId) -> u64 {
    port.0.cast_unsigned()
}

fn outcomes<D>(node: &Node<D>) -> Vec<(i64, SmolStr)> {
    node.outcomes().iter().map(|outcome| (outcome.id.0, outcome.name.clone())).collect()
}
