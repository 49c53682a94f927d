//! Everything that requests share.

use crate::Settings;
use crate::news::News;
use crate::projects::Projects;
use std::sync::Arc;

/// The server's parts, one of each.
#[derive(Debug)]
pub struct House {
    /// How it is set up.
    pub(crate) settings: Settings,
    /// What wakes whoever follows the house.
    pub(crate) news: News,
    /// The folders with machines, and the libraries.
    pub(crate) projects: Projects,
}

impl House {
    /// Prepares everything; nothing listens yet.
    pub fn new(settings: Settings) -> Arc<Self> {
        Arc::new(Self { news: News::default(), projects: Projects::new(&settings), settings })
    }

    /// How it is set up.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}
