//! Carries the runs of a robot over the link to its stations: on the robot from journals and runners to datagrams, at a station
//! from datagrams to ordinary run folders, each with a stand-in for its runner that a server joins like any other.
//!
//! Knows sockets of every kind, threads and folders. Knows nothing of requests, terminals or what a datagram looks like inside (`rafcon-link`).

mod about;
mod carrier;
mod clock;
mod command_list_file;
mod command_lists;
#[cfg(test)]
mod command_matrix;
mod contacts;
mod error;
mod ids;
mod inbox;
mod machine_lists;
mod meter;
mod pairing;
mod parcels;
mod report;
mod request_words;
mod requests;
mod rights;
mod robot;
mod sent_snapshot;
#[cfg(test)]
mod short_journal;
mod start;
mod station;
mod value_fetch_broker;
mod watch_words;
mod words;

pub use carrier::{ByteStream, Dial, Secure, StationAddress};
pub use command_list_file::{CommandListFile, CommandListFileError, StoredList};
pub use command_lists::{CommandListError, CommandListStore};
pub use contacts::{ContactFile, ContactFileError, ContactStore, ContactsNotSet, KnownContacts};
pub use error::RelayError;
pub use inbox::Stopper;
pub use machine_lists::{MachineLists, MachinesUnknown, read_machine_list};
pub use pairing::{BadPairing, Paired, Pairing};
pub use report::read_reports;
pub use requests::{Answered, NotTaken, RequestBroker};
pub use rights::{BadRights, PairingRights};
pub use robot::{Authority, ProjectFolder, Projects, RobotSettings, relay_robot};
pub use station::{PairingList, StationSettings, relay_station};
pub use value_fetch_broker::{ValueCost, ValueFetchBroker};
