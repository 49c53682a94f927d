//! Qualities of service in ROS, and their equivalents in RustDDS.

use rustdds::policy::{
    Deadline, Durability, History, Lifespan, Liveliness, Reliability, ResourceLimits,
};
use rustdds::{Duration, QosPolicies, QosPolicyBuilder};

/// Maximum time that a reliable writer blocks.
const BLOCKING: Duration = Duration::from_millis(100);
/// Number of messages kept for readers, also if a smaller depth is requested, so that a burst loses nothing.
const BURST: i32 = 4096;
/// Number of messages kept for types with large arrays.
const BURST_LARGE: i32 = 32;

/// The quality of service of a publisher or subscription.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Qos {
    pub(crate) reliable: bool,
    /// True if late subscribers receive earlier messages.
    pub(crate) latched: bool,
    /// Number of messages kept; 0 for all.
    pub(crate) depth: u32,
}

impl Qos {
    /// The quality of service of services.
    pub(crate) const SERVICE: Self = Self { reliable: true, latched: false, depth: 0 };

    /// The policies for RustDDS. `large` is true for types whose messages can have megabytes.
    pub(crate) fn policies(self, large: bool) -> QosPolicies {
        let reliability = match self.reliable {
            true => Reliability::Reliable { max_blocking_time: BLOCKING },
            false => Reliability::BestEffort,
        };
        let durability =
            if self.latched { Durability::TransientLocal } else { Durability::Volatile };
        let depth = i32::try_from(self.depth).unwrap_or(i32::MAX);
        let history = if depth == 0 { History::KeepAll } else { History::KeepLast { depth } };
        let most = depth.max(if large { BURST_LARGE } else { BURST });
        let limits =
            ResourceLimits { max_samples: most, max_instances: 1, max_samples_per_instance: most };
        QosPolicyBuilder::new()
            .reliability(reliability)
            .durability(durability)
            .history(history)
            .resource_limits(limits)
            .deadline(Deadline(Duration::INFINITE))
            .lifespan(Lifespan { duration: Duration::INFINITE })
            .liveliness(Liveliness::Automatic { lease_duration: Duration::INFINITE })
            .build()
    }

    /// The quality of service of a remote reader or writer.
    pub(crate) fn of(
        reliability: Option<Reliability>,
        durability: Option<Durability>,
        reader: bool,
    ) -> Self {
        // Default of DDS: readers are best effort, writers are reliable.
        let reliable = match reliability {
            Some(Reliability::Reliable { .. }) => true,
            Some(Reliability::BestEffort) => false,
            None => !reader,
        };
        let latched = durability.is_some_and(|durability| durability != Durability::Volatile);
        Self { reliable, latched, depth: 0 }
    }
}
