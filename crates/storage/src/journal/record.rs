//! What a journal keeps: numbered events, and definitions of the places and values that they name. Frequent events are
//! a few bytes; the others are the protocol's own events, as JSON.
//!
//! A sequence of items is self-contained: a definition comes before its first use. Only records are numbered.

use super::binary::{BinaryReader, BinaryWriter, Broken};
use super::moment::values_in;
use rafcon_protocol::{Event, LogLevel, Stream};
use smol_str::SmolStr;
use std::num::NonZeroU64;

/// Number of a place where a state can run; the same for the whole run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PlaceNumber(pub u32);

/// Number of a value that is kept once, however often it is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ValueNumber(pub u64);

/// One entry of a journal.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// Something that happened, with its time since the start of the run, in ns.
    Record(u64, Record),
    /// What a number stands for from here on.
    Definition(Definition),
}

/// One thing that happened.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// A state began.
    Entered {
        /// Where it stands.
        place: PlaceNumber,
        /// One for each input port, in the order of the place's definition; empty if values are not kept.
        inputs: Vec<Kept>,
        /// The entry that is undone, if it was entered backwards.
        undoes: Option<NonZeroU64>,
    },
    /// A state ended.
    Left {
        /// Where it stands.
        place: PlaceNumber,
        /// Id of its outcome.
        outcome: i64,
        /// One for each output port, in the order of the place's definition; empty if values are not kept.
        outputs: Vec<Kept>,
        /// Its error, if it left one.
        error: Option<Kept>,
        /// The entry that is undone, if it was left backwards.
        undoes: Option<NonZeroU64>,
    },
    /// A scoped variable got a value.
    Scoped {
        /// The container.
        place: PlaceNumber,
        /// Id of the variable.
        port: u64,
        /// The value.
        value: Kept,
    },
    /// A global variable got a value, or was deleted.
    Global {
        /// Its name.
        name: SmolStr,
        /// The value.
        value: Option<Kept>,
    },
    /// What a state keeps from one run to the next changed: all of it, as one value.
    Persistent {
        /// The state.
        place: PlaceNumber,
        /// The value.
        value: Kept,
    },
    /// A line of a script or of the engine.
    Log {
        /// The state that wrote it, if one did.
        place: Option<PlaceNumber>,
        /// How much it matters.
        level: LogLevel,
        /// Where it came from.
        stream: Stream,
        /// The text.
        message: String,
    },
    /// The run begins again at an entry of its history, with the data of then. It counts from the next entry of the root on.
    WentBack {
        /// The entry.
        sequence: u64,
        /// What was active before it ([`super::Moment::to_bytes`]).
        moment: Vec<u8>,
    },
    /// Anything else, as it is told.
    Told(Box<Event>),
}

/// A value as an event names it.
#[derive(Debug, Clone, PartialEq)]
pub enum Kept {
    /// There is none: the script left the port out.
    Absent,
    /// `None`.
    None,
    /// A `bool`.
    Bool(bool),
    /// An `int` of 64 bits.
    Int(i64),
    /// A `float`.
    Float(f64),
    /// A `str` of at most [`TEXT_MAX`] bytes.
    Text(SmolStr),
    /// Any other value, defined before.
    Value(ValueNumber),
}

/// The longest text that stands in the event itself, in bytes.
pub const TEXT_MAX: usize = 64;

/// What a number stands for.
#[derive(Debug, Clone, PartialEq)]
pub enum Definition {
    /// A place.
    Place(PlaceNumber, Place),
    /// A value.
    Value(ValueNumber, Stored),
}

/// A place and the state that stands there. It is defined again when the state's ports change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Ids from the root, joined by `/`.
    pub path: String,
    /// Names from the root, joined by `/`.
    pub names: String,
    /// Whether it is a library state: these are not counted as states run.
    pub is_library: bool,
    /// Whether its script is run by the engine: what a crash interrupts.
    pub is_script: bool,
    /// Id and name of each input port.
    pub inputs: Vec<(u64, SmolStr)>,
    /// Id and name of each output port.
    pub outputs: Vec<(u64, SmolStr)>,
    /// Id and name of each scoped variable.
    pub scoped: Vec<(u64, SmolStr)>,
    /// Id and name of each outcome.
    pub outcomes: Vec<(i64, SmolStr)>,
}

/// A value that is kept for longer than its run.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// What a reader without Python sees: JSON as `docs/protocol.md` encodes values, bounded.
    pub view: serde_json::Value,
    /// The name of its type.
    pub type_name: SmolStr,
    /// From what it can be made again.
    pub content: Content,
}

/// From what a value can be made again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// The view is all of it: plain JSON of Python's own types.
    View,
    /// These bytes: a pickle.
    Pickle(Vec<u8>),
    /// The file `values/<hash>` in the run's folder: a pickle that is large, named by its BLAKE3 hash in hex.
    File {
        /// The file's name.
        hash: String,
        /// Its size in bytes.
        size: u64,
    },
    /// Nothing: it cannot be kept, and why. A script never gets such a value back.
    Nothing(String),
}

impl Record {
    /// Shows all values that the record names.
    pub fn values(&self, see: &mut dyn FnMut(&Kept)) {
        match self {
            Self::Entered { inputs, .. } => inputs.iter().for_each(see),
            Self::Left { outputs, error, .. } => outputs.iter().chain(error).for_each(see),
            Self::Scoped { value, .. } | Self::Persistent { value, .. } => see(value),
            Self::Global { value, .. } => value.iter().for_each(see),
            // A moment that is broken names none.
            Self::WentBack { moment, .. } => drop(values_in(moment, see)),
            Self::Log { .. } | Self::Told(_) => {}
        }
    }
}

impl Stored {
    /// The value as bytes, as the database keeps it.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        BinaryWriter::new(&mut bytes).stored(self);
        bytes
    }

    /// The value from [`Stored::to_bytes`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Broken> {
        BinaryReader::new(bytes).stored()
    }
}

impl Item {
    /// Appends the item to `out`; `before` is the time of the record before it, and becomes that of this one.
    pub fn write(&self, before: &mut u64, out: &mut Vec<u8>) {
        let mut writer = BinaryWriter::new(out);
        match self {
            Self::Record(t_ns, record) => {
                let delta = t_ns.saturating_sub(*before);
                *before = (*before).max(*t_ns);
                writer.record(delta, record);
            }
            Self::Definition(definition) => writer.definition(definition),
        }
    }
}

/// Reads items one after the other from bytes, up to the end or the first that is broken.
#[derive(Debug)]
pub struct Items<'b> {
    reader: BinaryReader<'b>,
    t_ns: u64,
}

impl<'b> Items<'b> {
    /// The items in `bytes`; `t_ns` is the time of the record before them.
    pub fn new(bytes: &'b [u8], t_ns: u64) -> Self {
        Self { reader: BinaryReader::new(bytes), t_ns }
    }

    /// The next record counts its time from 0.
    pub(super) fn count_from_zero(&mut self) {
        self.t_ns = 0;
    }
}

impl Iterator for Items<'_> {
    type Item = Result<Item, Broken>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.reader.is_at_end() {
            return None;
        }
        let item = self.reader.item(self.t_ns);
        if let Ok(Item::Record(t_ns, _)) = &item {
            self.t_ns = *t_ns;
        }
        if item.is_err() {
            self.reader = BinaryReader::new(&[]);
        }
        Some(item)
    }
}
