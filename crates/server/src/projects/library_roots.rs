//! Which library roots the server's machines are loaded with. Knows settings and where the configuration lies.

use crate::Settings;
use rafcon_storage::config::{self, Config};
use rafcon_storage::{Root, roots};

/// The roots of these settings; what is wrong with one is told, and the others count.
pub(super) fn find(settings: &Settings) -> Vec<Root> {
    let config = match config::find(settings.config.as_deref(), &settings.variable) {
        Ok((config, _file)) => config,
        Err(error) => {
            (settings.tell)(&format!(
                "{error}: {}; library roots of it do not count",
                error.source
            ));
            Config::default()
        }
    };
    let (roots, notes) = roots(&config, &settings.variable, &settings.libraries);
    for note in notes {
        (settings.tell)(&note.to_string());
    }
    roots
}
