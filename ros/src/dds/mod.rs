//! The middleware: DDS by RustDDS, used with bytes only, so that a type need not be known when this program is compiled.
//!
//! Knows the names, qualities and services that ROS makes of DDS; knows nothing of what messages hold.

pub(crate) mod endpoints;
pub(crate) mod graph;
pub(crate) mod liveness;
pub(crate) mod names;
pub(crate) mod participant;
pub(crate) mod payload;
pub(crate) mod qos;
