//! Entries of a journal: numbered events, and definitions of the places and values that they name. Frequent events have a few
//! bytes. The others are events of the protocol as JSON.
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

/// Number of a place where a state can run. It is constant in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PlaceNumber(pub u32);

/// Number of a value that is stored once, however often it is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ValueNumber(pub u64);

/// One entry of a journal.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// An event with its time since the start of the run, in ns.
    Record(u64, Record),
    /// Meaning of a number from here on.
    Definition(Definition),
}

/// One event of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// A state was entered.
    Entered {
        /// Place of the state.
        place: PlaceNumber,
        /// One value for each input port, in the order of the place's definition. Empty if values are not recorded.
        inputs: Vec<Kept>,
        /// The entry that is undone, if the state was entered backwards.
        undoes: Option<NonZeroU64>,
    },
    /// A state was left.
    Left {
        /// Place of the state.
        place: PlaceNumber,
        /// Id of the outcome.
        outcome: i64,
        /// One value for each output port, in the order of the place's definition. Empty if values are not recorded.
        outputs: Vec<Kept>,
        /// Error of the state, if it has one.
        error: Option<Kept>,
        /// The entry that is undone, if the state was left backwards.
        undoes: Option<NonZeroU64>,
    },
    /// A scoped variable received a value.
    Scoped {
        /// Place of the container.
        place: PlaceNumber,
        /// Id of the variable.
        port: u64,
        /// Value of the variable.
        value: Kept,
    },
    /// A global variable received a value or was deleted.
    Global {
        /// Name of the variable.
        name: SmolStr,
        /// Value of the variable. `None` if it was deleted.
        value: Option<Kept>,
    },
    /// The persistent data of a state changed.
    Persistent {
        /// Place of the state.
        place: PlaceNumber,
        /// The whole persistent data.
        value: Kept,
    },
    /// A log line of a script or of the engine.
    Log {
        /// Place of the state that wrote it, if one did.
        place: Option<PlaceNumber>,
        /// Severity of the line.
        level: LogLevel,
        /// Source of the line.
        stream: Stream,
        /// Text of the line.
        message: String,
    },
    /// The run returns to an entry of its history, with the data of that moment. It takes effect at the next entry of the root.
    WentBack {
        /// Sequence number of the entry.
        sequence: u64,
        /// Moment before the entry ([`crate::journal::Moment::to_bytes`]).
        moment: Vec<u8>,
    },
    /// Any other event of the protocol.
    Told(Box<Event>),
}

/// A value in an event.
#[derive(Debug, Clone, PartialEq)]
pub enum Kept {
    /// No value: the script left the port out.
    Absent,
    /// Python's value `None`, unlike an absent one.
    None,
    /// A Python `bool`, stored in the event.
    Bool(bool),
    /// A Python `int` of 64 bits.
    Int(i64),
    /// A Python `float`, stored in the event.
    Float(f64),
    /// A Python `str` of at most [`TEXT_MAX`] bytes.
    Text(SmolStr),
    /// Any other value, by the number of its definition.
    Value(ValueNumber),
}

/// Maximum length of a text inside an event, in bytes.
pub const TEXT_MAX: usize = 64;

/// Meaning of a number.
#[derive(Debug, Clone, PartialEq)]
pub enum Definition {
    /// Definition of a place.
    Place(PlaceNumber, Place),
    /// Definition of a value.
    Value(ValueNumber, Stored),
}

/// A place and its state. It is redefined when the state's ports change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Path of the state: ids from the root, joined by `/`.
    pub path: String,
    /// Names of the states on the path, joined by `/`.
    pub names: String,
    /// True for a library state, which does not count as a state run.
    pub is_library: bool,
    /// True if the state runs a script, which a crash can interrupt.
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

/// A stored value, which remains after its run.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// View for readers without Python: JSON encoded as in `docs/protocol.md`, limited in size.
    pub view: serde_json::Value,
    /// Name of the value's type.
    pub type_name: SmolStr,
    /// Source from which the value can be restored.
    pub content: Content,
}

/// Source from which a value can be restored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// The view is complete: plain JSON of Python's built-in types.
    View,
    /// A pickle in these bytes.
    Pickle(Vec<u8>),
    /// A large pickle in the file `values/<hash>` of the run's folder, named by its BLAKE3 hash in hex.
    File {
        /// Name of the file.
        hash: String,
        /// Size of the file in bytes.
        size: u64,
    },
    /// No source, with the reason why the value cannot be stored. Scripts never receive such a value.
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
    /// Encodes the value for the database.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        BinaryWriter::new(&mut bytes).stored(self);
        bytes
    }

    /// Decodes the bytes of [`Stored::to_bytes`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Broken> {
        BinaryReader::new(bytes).stored()
    }
}

impl Item {
    /// Appends the item to `out`. `before` is the time of the previous record, and is set to the time of this one.
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

/// Reads items from bytes, up to the end or the first invalid one.
#[derive(Debug)]
pub struct Items<'b> {
    reader: BinaryReader<'b>,
    t_ns: u64,
}

impl<'b> Items<'b> {
    /// Reads the items in `bytes`. `t_ns` is the time of the record before them.
    pub fn new(bytes: &'b [u8], t_ns: u64) -> Self {
        Self { reader: BinaryReader::new(bytes), t_ns }
    }

    /// Makes the next record count its time from 0.
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
