//! The data flows of a container, found by id, by source and by target.

use crate::ids;
use crate::sorted::{MANY, Sorted};
use crate::{DataFlow, DataFlowId, PortId, StateId};
use imbl::OrdSet;
use std::sync::Arc;

/// The data flows of one container. Cloning shares everything.
#[derive(Debug, Clone, Default)]
pub struct DataFlows {
    by_id: Sorted<DataFlowId, DataFlow>,
    /// Indexes, only for many data flows.
    index: Option<Arc<DataFlowIndex>>,
}

type DataFlowEnd = (StateId, PortId);

#[derive(Debug, Clone, Default)]
struct DataFlowIndex {
    by_link: OrdSet<(DataFlowEnd, DataFlowEnd, DataFlowId)>,
    by_target: OrdSet<(DataFlowEnd, DataFlowId)>,
}

impl PartialEq for DataFlows {
    fn eq(&self, other: &Self) -> bool {
        self.by_id == other.by_id
    }
}

impl DataFlows {
    /// All, sorted by id.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &DataFlow> {
        self.by_id.values()
    }

    /// The number of data flows.
    pub fn len(&self) -> usize {
        self.by_id.len()
    }

    /// True if there are no data flows.
    pub fn is_empty(&self) -> bool {
        self.by_id.is_empty()
    }

    /// The data flow with this id.
    pub fn get(&self, id: DataFlowId) -> Option<&DataFlow> {
        self.by_id.get(&id)
    }

    /// The ids of data flows that differ in `newer`, or exist in only one of both.
    pub fn differing(&self, newer: &Self) -> Vec<DataFlowId> {
        self.by_id.differing(&newer.by_id)
    }

    /// Those that end at this port, sorted by id.
    pub fn into_port<'s>(
        &'s self,
        state: &StateId,
        port: PortId,
    ) -> impl Iterator<Item = &'s DataFlow> + use<'s> {
        let end = (state.clone(), port);
        let wanted = end.clone();
        let few = self.few().filter(move |flow| target_of(flow) == wanted);
        few.chain(self.by_target(end.clone(), end))
    }

    /// Those that begin at this port.
    pub fn out_of_port<'s>(
        &'s self,
        state: &StateId,
        port: PortId,
    ) -> impl Iterator<Item = &'s DataFlow> + use<'s> {
        let end = (state.clone(), port);
        let wanted = end.clone();
        let few = self.few().filter(move |flow| source_of(flow) == wanted);
        few.chain(self.links_from(end.clone(), move |source| *source == end))
    }

    /// Those from one port to another: at most one in a valid container.
    pub fn between(&self, from: DataFlowEnd, to: DataFlowEnd) -> impl Iterator<Item = &DataFlow> {
        let wanted = (from.clone(), to.clone());
        let few = self.few().filter(move |f| (source_of(f), target_of(f)) == wanted);
        few.chain(self.links_between(from, to))
    }

    /// Those that end at any port of `state`.
    pub fn into_state<'s>(
        &'s self,
        state: &StateId,
    ) -> impl Iterator<Item = &'s DataFlow> + use<'s> {
        let wanted = state.clone();
        let few = self.few().filter(move |flow| flow.to_state == wanted);
        few.chain(self.by_target(lowest(state), highest(state)))
    }

    /// Those that begin at any port of `state`.
    pub fn out_of_state<'s>(
        &'s self,
        state: &StateId,
    ) -> impl Iterator<Item = &'s DataFlow> + use<'s> {
        let wanted = state.clone();
        let few = self.few().filter(move |flow| flow.from_state == wanted);
        let wanted = state.clone();
        few.chain(self.links_from(lowest(state), move |(state, _)| *state == wanted))
    }

    /// All, while they are too few for an index.
    fn few(&self) -> impl Iterator<Item = &DataFlow> {
        let all = self.index.is_none().then(|| self.by_id.values());
        all.into_iter().flatten()
    }

    fn by_target(&self, low: DataFlowEnd, high: DataFlowEnd) -> impl Iterator<Item = &DataFlow> {
        let range = (low, DataFlowId(i64::MIN))..=(high, DataFlowId(i64::MAX));
        let keys = self.index.as_deref().map(|index| index.by_target.range(range));
        keys.into_iter().flatten().filter_map(|(_, id)| self.by_id.get(id))
    }

    fn links_between(&self, from: DataFlowEnd, to: DataFlowEnd) -> impl Iterator<Item = &DataFlow> {
        let low = (from.clone(), to.clone(), DataFlowId(i64::MIN));
        let high = (from, to, DataFlowId(i64::MAX));
        let keys = self.index.as_deref().map(|index| index.by_link.range(low..=high));
        keys.into_iter().flatten().filter_map(|(_, _, id)| self.by_id.get(id))
    }

    /// Those from `low` on, as long as their source matches.
    fn links_from(
        &self,
        low: DataFlowEnd,
        wanted: impl Fn(&DataFlowEnd) -> bool,
    ) -> impl Iterator<Item = &DataFlow> {
        let low = (low, lowest(&StateId::new("")), DataFlowId(i64::MIN));
        let keys = self.index.as_deref().map(|index| index.by_link.range(low..));
        let keys = keys.into_iter().flatten().take_while(move |(source, _, _)| wanted(source));
        keys.filter_map(|(_, _, id)| self.by_id.get(id))
    }

    /// Inserts a data flow, and returns the one that had its id.
    pub fn insert(&mut self, flow: DataFlow) -> Option<DataFlow> {
        let id = flow.id;
        let ends = (source_of(&flow), target_of(&flow));
        let earlier = self.by_id.insert(id, flow);
        if let Some(index) = self.index.as_mut().map(Arc::make_mut) {
            if let Some(earlier) = &earlier {
                index.remove(earlier);
            }
            index.by_target.insert((ends.1.clone(), id));
            index.by_link.insert((ends.0, ends.1, id));
        } else if self.by_id.len() >= MANY {
            self.index = Some(Arc::new(DataFlowIndex::of(self.by_id.values())));
        }
        earlier
    }

    /// Removes the data flow with this id.
    pub fn remove(&mut self, id: DataFlowId) -> Option<DataFlow> {
        let flow = self.by_id.remove(&id)?;
        if self.by_id.len() < MANY / 2 {
            self.index = None;
        } else if let Some(index) = self.index.as_mut().map(Arc::make_mut) {
            index.remove(&flow);
        }
        Some(flow)
    }

    /// The next free id: above all used ids, 1 at first.
    pub fn next_id(&self) -> DataFlowId {
        self.free_ids().next().unwrap_or(DataFlowId(0))
    }

    /// The next free ids.
    pub fn free_ids(&self) -> impl Iterator<Item = DataFlowId> {
        let last = self.by_id.last().map(|(id, _)| id.0);
        ids::free_ids(last, |id| self.by_id.contains_key(&DataFlowId(id))).map(DataFlowId)
    }
}

impl DataFlowIndex {
    fn of<'f>(flows: impl Iterator<Item = &'f DataFlow> + Clone) -> Self {
        Self {
            by_link: flows.clone().map(|f| (source_of(f), target_of(f), f.id)).collect(),
            by_target: flows.map(|f| (target_of(f), f.id)).collect(),
        }
    }

    fn remove(&mut self, flow: &DataFlow) {
        self.by_link.remove(&(source_of(flow), target_of(flow), flow.id));
        self.by_target.remove(&(target_of(flow), flow.id));
    }
}

fn source_of(flow: &DataFlow) -> DataFlowEnd {
    (flow.from_state.clone(), flow.from_port)
}

fn target_of(flow: &DataFlow) -> DataFlowEnd {
    (flow.to_state.clone(), flow.to_port)
}

fn lowest(state: &StateId) -> DataFlowEnd {
    (state.clone(), PortId(i64::MIN))
}

fn highest(state: &StateId) -> DataFlowEnd {
    (state.clone(), PortId(i64::MAX))
}

impl FromIterator<DataFlow> for DataFlows {
    fn from_iter<I: IntoIterator<Item = DataFlow>>(items: I) -> Self {
        let mut flows = Self::default();
        for flow in items {
            flows.insert(flow);
        }
        flows
    }
}

#[cfg(test)]
mod tests {
    use super::DataFlows;
    use crate::{DataFlow, DataFlowId, PortId, StateId};
    use proptest::prelude::*;

    fn end(number: u8) -> (StateId, PortId) {
        (StateId::new(format!("S{}", number % 3)), PortId(i64::from(number / 3)))
    }

    proptest! {
        /// The lists by source and target equal those of a scan of all data flows, with an index and without.
        #[test]
        fn every_list_is_complete(steps in proptest::collection::vec((1..80i64, 0..9u8, 0..9u8, 0..3u8), 0..160)) {
            let mut flows = DataFlows::default();
            for (id, from, to, step) in steps {
                if step == 0 {
                    flows.remove(DataFlowId(id));
                } else {
                    flows.insert(DataFlow::new(DataFlowId(id), end(from), end(to)));
                }
            }
            let ids = |found: Vec<&DataFlow>| {
                let mut ids: Vec<_> = found.iter().map(|f| f.id).collect();
                ids.sort();
                ids
            };
            let each = |test: &dyn Fn(&DataFlow) -> bool| ids(flows.iter().filter(|f| test(f)).collect());
            for (number, other) in (0..9).zip([4, 2, 7, 1, 8, 0, 3, 5, 6]) {
                let (state, port) = end(number);
                let from = |f: &DataFlow| (f.from_state.clone(), f.from_port) == end(number);
                let to = |f: &DataFlow, n| (f.to_state.clone(), f.to_port) == end(n);
                prop_assert_eq!(ids(flows.into_port(&state, port).collect()), each(&|f| to(f, number)));
                prop_assert_eq!(ids(flows.out_of_port(&state, port).collect()), each(&from));
                prop_assert_eq!(ids(flows.into_state(&state).collect()), each(&|f| f.to_state == state));
                prop_assert_eq!(ids(flows.out_of_state(&state).collect()), each(&|f| f.from_state == state));
                prop_assert_eq!(
                    ids(flows.between(end(number), end(other)).collect()),
                    each(&|f| from(f) && to(f, other))
                );
            }
        }
    }
}
