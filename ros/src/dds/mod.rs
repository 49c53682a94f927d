//! The middleware: DDS by RustDDS. It transfers only bytes, so that types can be loaded at run time.
//!
//! Knows the names, qualities and services of ROS in DDS; knows nothing of the content of messages.

pub(crate) mod endpoints;
pub(crate) mod graph;
pub(crate) mod liveness;
pub(crate) mod names;
pub(crate) mod participant;
pub(crate) mod payload;
pub(crate) mod qos;
