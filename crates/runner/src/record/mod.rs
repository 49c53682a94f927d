//! What happened in a run, as bytes: in the journal, in memory, and what of it is safe. Must never know threads or viewers.

pub(crate) mod archive;
pub(crate) mod blocks;
pub(crate) mod keep;
pub(crate) mod names;
pub(crate) mod record_encoder;
pub(crate) mod recorder;
pub(crate) mod safety;
pub(crate) mod tell;
