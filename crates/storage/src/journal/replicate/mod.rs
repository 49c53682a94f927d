//! Replication of a run: from its journal to self-contained items, and from those to an ordinary journal. Handles journals and
//! items, not the transport or its timing.

mod ahead;
mod chain;
mod content;
mod incoming;
mod replica;
mod source;

pub use chain::Chain;
pub use content::ValueContent;
pub use incoming::IncomingContent;
pub use replica::{Replica, ReplicaError};
pub use source::EventSource;
