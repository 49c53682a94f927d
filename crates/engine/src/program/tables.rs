//! Tables that hold the short lists of all nodes in a few long ones, so that lists of neighbours are adjacent in
//! memory.

use super::node::Exit;
use rafcon_model::{DataType, Ports};
use std::collections::BTreeMap;

/// The tables that all nodes of a program share.
#[derive(Debug, Default)]
pub(crate) struct Tables {
    numbers: Vec<u32>,
    exits: Vec<Exit>,
    types: Vec<DataType>,
}

/// The slots that flow into each port, or the slots into which each port flows.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FlowRange {
    /// Index of the first port's list end. The lists follow the ends.
    begin: u32,
    /// Number of ports; 0 if no port has a flow.
    ports: u32,
}

/// The ports whose values are checked against a type.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Checks {
    begin: u32,
    end: u32,
}

/// Index of a node's first exit. Each outcome has one exit.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Exits(u32);

impl FlowRange {
    /// True if no port has a flow.
    pub(crate) fn is_empty(self) -> bool {
        self.ports == 0
    }
}

impl Tables {
    /// The slots of the port with this index.
    pub(crate) fn slots(&self, wires: FlowRange, port: usize) -> &[u32] {
        if port >= wires.ports as usize {
            return &[];
        }
        let ends = &self.numbers[wires.begin as usize..];
        let first = (wires.begin + wires.ports) as usize;
        let begin = if port == 0 { first } else { ends[port - 1] as usize };
        &self.numbers[begin..ends[port] as usize]
    }

    /// The index of each checked port, with its type.
    pub(crate) fn checks(&self, checks: Checks) -> impl Iterator<Item = (usize, &DataType)> {
        let pairs = self.numbers[checks.begin as usize..checks.end as usize].chunks_exact(2);
        pairs.map(|pair| (pair[0] as usize, &self.types[pair[1] as usize]))
    }

    /// The target of the outcome with this index.
    pub(crate) fn exit(&self, exits: Exits, outcome: u32) -> Exit {
        self.exits.get((exits.0 + outcome) as usize).copied().unwrap_or(Exit::Nowhere)
    }
}

/// Builds the tables of a program.
#[derive(Debug, Default)]
pub(super) struct TablesBuilder {
    tables: Tables,
    types: BTreeMap<DataType, u32>,
}

impl TablesBuilder {
    pub(super) fn finish(self) -> Tables {
        self.tables
    }

    fn end(&self) -> u32 {
        super::compile::index(self.tables.numbers.len())
    }

    pub(super) fn wires(&mut self, lists: &[Vec<u32>]) -> FlowRange {
        if lists.iter().all(Vec::is_empty) {
            return FlowRange::default();
        }
        let (begin, ports) = (self.end(), super::compile::index(lists.len()));
        let mut end = begin + ports;
        for list in lists {
            end += super::compile::index(list.len());
            self.tables.numbers.push(end);
        }
        self.tables.numbers.extend(lists.iter().flatten());
        FlowRange { begin, ports }
    }

    pub(super) fn checks(&mut self, ports: &Ports) -> Checks {
        let begin = self.end();
        for (port, declared) in (0..).zip(ports.iter().map(|port| &port.data_type)) {
            if !super::defaults::takes_anything(declared) {
                let number = self.data_type(declared);
                self.tables.numbers.extend([port, number]);
            }
        }
        Checks { begin, end: self.end() }
    }

    fn data_type(&mut self, data_type: &DataType) -> u32 {
        if let Some(&number) = self.types.get(data_type) {
            return number;
        }
        let number = super::compile::index(self.tables.types.len());
        self.tables.types.push(data_type.clone());
        self.types.insert(data_type.clone(), number);
        number
    }

    pub(super) fn exits(&mut self, exits: &[Exit]) -> Exits {
        let begin = super::compile::index(self.tables.exits.len());
        self.tables.exits.extend_from_slice(exits);
        Exits(begin)
    }
}
