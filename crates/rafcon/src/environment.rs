//! Inputs from the environment, read once at the start and passed on as a value.

use rafcon_supervisor::ProgramEnvironment;
use std::env;
use std::fmt;
use std::path::PathBuf;

/// Environment variables of this program, and its location.
#[derive(Debug, Clone, Default)]
pub(crate) struct Environment {
    /// Locations of runners and of the folders of runs.
    pub(crate) locations: ProgramEnvironment,
    /// The folder of the programs' configuration: `XDG_CONFIG_HOME` or its default.
    pub(crate) config_home: Option<PathBuf>,
    /// `RAFCON_TOKEN`: a token for a server.
    pub(crate) token: Option<Secret>,
    /// Options from the environment: `RAFCON_PYTHON` and `RAFCON_RUNS`.
    pub(crate) options: [Option<PathBuf>; 2],
    /// `USER`, or the number of the user: the author of commands.
    pub(crate) user: String,
    /// True if `NO_COLOR` is set and not empty.
    pub(crate) no_color: bool,
    /// True if `TERM` names a terminal that supports only lines.
    pub(crate) dumb_terminal: bool,
    /// True if the locale's encoding is UTF-8.
    pub(crate) unicode: bool,
}

/// A secret text that is never shown.
#[derive(Clone)]
pub(crate) struct Secret(pub(crate) String);

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret")
    }
}

/// Value of a variable, for variables in files.
pub(crate) fn variable(name: &str) -> Option<String> {
    env::var_os(name)?.into_string().ok()
}

impl Environment {
    pub(crate) fn read() -> Self {
        let set = |name: &str| env::var_os(name).filter(|value| !value.is_empty());
        Self {
            locations: ProgramEnvironment {
                virtual_env: set("VIRTUAL_ENV").map(PathBuf::from),
                extension: set("RAFCON_EXTENSION").map(PathBuf::from),
                program: env::current_exe().ok().map(|file| file.canonicalize().unwrap_or(file)),
                home: set("HOME").map(PathBuf::from),
                state_home: set("XDG_STATE_HOME").map(PathBuf::from),
            },
            config_home: set("XDG_CONFIG_HOME")
                .map(PathBuf::from)
                .or_else(|| Some(PathBuf::from(set("HOME")?).join(".config"))),
            token: variable("RAFCON_TOKEN").filter(|text| !text.is_empty()).map(Secret),
            options: ["RAFCON_PYTHON", "RAFCON_RUNS"].map(|name| set(name).map(PathBuf::from)),
            user: variable("USER")
                .filter(|name| !name.is_empty())
                .unwrap_or_else(|| format!("uid {}", rustix::process::getuid().as_raw())),
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
