//! The link between a robot and its ground station: datagrams that may be late, lost, doubled or out of order.
//!
//! Knows bytes and numbers. Knows nothing of sockets, clocks, files or HTTP: whatever it needs of them is an argument. The format
//! and its reasons are in `docs/link.md`.

mod replay_window;
mod seal;

pub use seal::{
    Direction, Generation, Horizon, KeyId, OVERHEAD, Opened, Opener, PairingKey, Rejected,
    SealError, Sealer,
};
