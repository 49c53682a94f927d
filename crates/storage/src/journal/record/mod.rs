//! The entries of a journal: numbered events, and definitions of the places and values that they name. Frequent events take
//! a few bytes; the others are events of the protocol as JSON.
//!
//! A sequence of items is self-contained: a definition comes before its first use. Only records are numbered.

mod batch;
pub(in crate::journal) mod binary;
pub(in crate::journal) mod frame;
mod places;
pub(in crate::journal) mod protocol;

pub use batch::{Batch, Left};
pub use binary::Broken;
pub use places::Places;
pub use protocol::{DAMAGED, Glossary, float, int, tell};

use binary::{BinaryReader, BinaryWriter};
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
    /// The meaning of a number from here on.
    Definition(Definition),
}

/// One thing that happened.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// Adds a state.
    Entered {
        /// Its place.
        place: PlaceNumber,
        /// One for each input port, in the order of the place's definition; empty if values are not kept.
        inputs: Vec<Kept>,
        /// The entry that is undone, if it was entered backwards.
        undoes: Option<NonZeroU64>,
    },
    /// Removes a state.
    Left {
        /// Its place.
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
    /// The persistent value of a state changed.
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
    /// The run returns to an entry of its history, with the data of that moment. Applies at the next entry of the root.
    WentBack {
        /// The entry.
        sequence: u64,
        /// The moment before the entry ([`crate::journal::Moment::to_bytes`]).
        moment: Vec<u8>,
    },
    /// Any other event of the protocol.
    Told(Box<Event>),
}

/// A value in an event.
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

/// The maximum length of a text inside the event, in bytes.
pub const TEXT_MAX: usize = 64;

/// The meaning of a number.
#[derive(Debug, Clone, PartialEq)]
pub enum Definition {
    /// A place.
    Place(PlaceNumber, Place),
    /// A value.
    Value(ValueNumber, Stored),
}

/// A place and its state. It is defined again when the state's ports change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Ids from the root, joined by `/`.
    pub path: String,
    /// Names from the root, joined by `/`.
    pub names: String,
    /// Whether it is a library state, which does not count as a state run.
    pub is_library: bool,
    /// Whether the state runs a script, which a crash can interrupt.
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

/// A value that outlives its run.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// The value for readers without Python: JSON as `docs/protocol.md` encodes values, bounded.
    pub view: serde_json::Value,
    /// The name of its type.
    pub type_name: SmolStr,
    /// The source from which the value can be restored.
    pub content: Content,
}

/// The source from which a value can be restored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// The view, which is complete: plain JSON of Python's built-in types.
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
    /// Nothing, with the reason why the value cannot be kept. A script never gets such a value back.
    Nothing(String),
}

impl Record {
    /// Removes the values and the log text.
    pub(in crate::journal) fn forget_values(&mut self) {
        match self {
            Self::Entered { inputs, .. } => inputs.clear(),
            Self::Left { outputs, error, .. } => {
                outputs.clear();
                *error = None;
            }
            Self::Scoped { value, .. } | Self::Persistent { value, .. } => *value = Kept::Absent,
            Self::Global { value, .. } => {
                if let Some(value) = value {
                    *value = Kept::Absent;
                }
            }
            Self::Log { message, .. } => message.clear(),
            Self::Told(_) | Self::WentBack { .. } => {}
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
    /// Appends the item to `out`; `before` is the time of the previous record, and becomes the time of this one.
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

/// Reads items from bytes, up to the end or the first broken one.
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
    pub(in crate::journal) fn count_from_zero(&mut self) {
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
