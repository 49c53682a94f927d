//! The link between a robot and its ground station: datagrams that may be late, lost, doubled or out of order.
//!
//! Knows bytes and numbers. Knows nothing of sockets, clocks, files or HTTP: whatever it needs of them is an argument. The format
//! and its reasons are in `docs/link.md`.

mod assembly;
mod bytes;
mod coding;
mod deflate;
mod endpoint;
mod frame;
mod heard;
#[cfg(test)]
mod hostile;
mod loss_rate;
#[cfg(test)]
mod many_runs;
mod path_size;
mod payload_writer;
mod profile;
mod range_set;
mod replay_window;
mod robot;
mod seal;
mod send_rate;
mod session_time;
mod station;
mod traffic;
#[cfg(test)]
mod value_tests;

pub use assembly::LENGTH_MAX;
pub use bytes::{BrokenFrame, FrameReader, write_number};
pub use deflate::{deflate, inflate};
pub use endpoint::{Identity, Unusable};
pub use frame::{
    BriefId, COMMAND_LENGTH_MAX, CommandId, CommandState, EventHash, NoValue, StreamId, ValueId,
    ValueName,
};
pub use heard::ClockBounds;
pub use profile::{CARRIER_OVERHEAD, Compression, Profile};
pub use rafcon_events::{EventBlock, EventBlockRef};
pub use range_set::RangeSet;
pub use robot::{
    NewestValue, Rank, ReceivedCommand, RobotSession, RunSource, VALUE_BYTES_MAX, WatchSubscription,
};
pub use seal::{
    Direction, For, Generation, Horizon, KeyId, OVERHEAD, Opened, Opener, PairingKey, Rejected,
    Salt, SealError, Sealer, SenderStart,
};
pub use session_time::SessionTime;
pub use station::{
    COMMANDS_MAX, CommandProgress, FetchProgress, FromRobot, NewCommand, NotSent, NotWatched,
    RobotTimes, StationSession, StreamProgress, TimedCommand,
};
pub use traffic::Traffic;
