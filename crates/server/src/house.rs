//! Everything that requests share.

use crate::Settings;
use std::sync::Arc;

/// The server's parts, one of each.
#[derive(Debug)]
pub struct House {
    /// How it is set up.
    pub(crate) settings: Settings,
}

impl House {
    /// Prepares everything; nothing listens yet.
    pub fn new(settings: Settings) -> Arc<Self> {
        Arc::new(Self { settings })
    }

    /// How it is set up.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}
