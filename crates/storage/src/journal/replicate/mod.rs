//! A run that is written a second time, elsewhere: from its journal to items that need no other, and from those to an ordinary
//! journal. Knows journals and items. Does not know how the items travel, nor when.

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
pub use source::{EventItems, EventSource};
