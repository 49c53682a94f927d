//! What the program takes from its environment, read once where it starts and passed on as a value.

use std::env;
use std::path::PathBuf;

/// The variables that mean something here, and where this program stands.
#[derive(Debug, Clone, Default)]
pub(crate) struct Environment {
    /// `VIRTUAL_ENV`: the active virtual environment.
    pub(crate) virtual_env: Option<PathBuf>,
    /// `RAFCON_EXTENSION`: the extension's file, for unusual installations.
    pub(crate) extension: Option<PathBuf>,
    /// This program's file, links followed.
    pub(crate) program: Option<PathBuf>,
    /// `USER`: who gives commands.
    pub(crate) user: String,
    /// `HOME`: the user's folder.
    pub(crate) home: Option<PathBuf>,
    /// `XDG_STATE_HOME`: where programs keep what they remember.
    pub(crate) state_home: Option<PathBuf>,
    /// `NO_COLOR` is set and not empty.
    pub(crate) no_color: bool,
    /// `TERM` says that the terminal can do nothing but lines.
    pub(crate) dumb_terminal: bool,
    /// The locale's text is UTF-8.
    pub(crate) unicode: bool,
}

/// A variable's text, for whoever expands variables in files.
pub(crate) fn variable(name: &str) -> Option<String> {
    env::var_os(name)?.into_string().ok()
}

impl Environment {
    /// Reads it.
    pub(crate) fn read() -> Self {
        let set = |name: &str| env::var_os(name).filter(|value| !value.is_empty());
        Self {
            virtual_env: set("VIRTUAL_ENV").map(PathBuf::from),
            extension: set("RAFCON_EXTENSION").map(PathBuf::from),
            program: env::current_exe().ok().map(|file| file.canonicalize().unwrap_or(file)),
            user: variable("USER").unwrap_or_default(),
            home: set("HOME").map(PathBuf::from),
            state_home: set("XDG_STATE_HOME").map(PathBuf::from),
            no_color: set("NO_COLOR").is_some(),
            dumb_terminal: set("TERM").is_none_or(|term| term == "dumb"),
            unicode: ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(set).is_some_and(
                |locale| {
                    let locale = locale.to_string_lossy().to_ascii_lowercase();
                    locale.contains("utf-8") || locale.contains("utf8")
                },
            ),
        }
    }
}
