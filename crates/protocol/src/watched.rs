//! Watched values of a remote run: the requests, and the newest values that the robot sent ahead of the events.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Maximum number of watched targets of a run, over all viewers.
pub const WATCHED_MAX: usize = 256;

/// Maximum lengths of a path and a name that can be watched, in bytes.
const PATH_MAX: usize = 640;
const NAME_MAX: usize = 128;

/// A value, or all values of a state, to watch.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct WatchTarget {
    /// Kind of the watched value or values.
    pub kind: WatchKind,
    /// Path of the state: ids from the root, joined by `/`. Empty for global variables.
    #[serde(default)]
    pub path: String,
    /// Name of the port or variable. Empty for `state`.
    #[serde(default)]
    pub name: String,
    /// Priority if the rate does not allow all values. 0 is the highest.
    #[serde(default)]
    pub priority: u8,
}

/// Kind of watched value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum WatchKind {
    /// All values of the state and its descendants.
    State,
    /// An input of the state.
    Input,
    /// An output, from the state's last end.
    Output,
    /// A scoped variable of the state.
    ScopedVariable,
    /// A global variable of the run.
    Global,
}

/// The newest value of a port or variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct WatchedValue {
    /// Kind of value, never `state`.
    pub kind: WatchKind,
    /// Path of the state. Empty for global variables.
    pub path: String,
    /// Name of the port or variable.
    pub name: String,
    /// Event that carries the value. It may not have arrived yet.
    pub sequence: u64,
    /// The time of that event since the start of the run, in ns.
    pub t_ns: u64,
    /// The value, if it is short.
    pub value: Option<Value>,
    /// Description of the value, if it is long.
    pub large: Option<LongValue>,
}

/// A value that is too long to be sent ahead of its event.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct LongValue {
    /// Name of the Python type. Empty if it is not known.
    pub type_name: String,
    /// Size of the value in bytes.
    pub bytes: u64,
    /// BLAKE3 hash of the value's bytes in hex, if they are kept beside the events.
    pub hash: Option<String>,
}

/// Acknowledgement of the watched targets by the robot.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Watching {
    /// True if the robot has acknowledged the targets. Until then it sends the previous ones.
    pub is_confirmed: bool,
    /// Time of the request: ms since 1970, UTC, by the station's clock.
    pub asked_ms: u64,
    /// Number of targets that were not requested because of the limits.
    pub left_out: u32,
}

impl WatchTarget {
    /// Returns true if this target includes the value.
    pub fn fits(&self, kind: WatchKind, path: &str, name: &str) -> bool {
        match self.kind {
            WatchKind::State => {
                let rest = path.strip_prefix(self.path.as_str());
                kind != WatchKind::Global
                    && rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
            }
            own => (own, self.path.as_str(), self.name.as_str()) == (kind, path, name),
        }
    }

    /// Merges the targets of several viewers and sorts them by priority. Duplicates keep their highest priority. Also returns the
    /// number of targets dropped because of the limits.
    pub fn union<'t>(all: impl IntoIterator<Item = &'t Self>) -> (Vec<Self>, usize) {
        let mut union: Vec<Self> = all.into_iter().cloned().collect();
        let wanted = union.len();
        union.retain(|target| target.path.len() <= PATH_MAX && target.name.len() <= NAME_MAX);
        let too_long = wanted - union.len();
        let place = |target: &Self| (target.kind, target.path.clone(), target.name.clone());
        union.sort_by_cached_key(|target| (place(target), target.priority));
        union.dedup_by_key(|target| place(target));
        union.sort_by_key(|target| target.priority);
        let left_out = too_long + union.len().saturating_sub(WATCHED_MAX);
        union.truncate(WATCHED_MAX);
        (union, left_out)
    }
}

#[cfg(test)]
mod tests {
    use super::{NAME_MAX, PATH_MAX, WATCHED_MAX, WatchKind, WatchTarget};

    fn target(kind: WatchKind, path: &str, name: &str, priority: u8) -> WatchTarget {
        WatchTarget { kind, path: path.to_owned(), name: name.to_owned(), priority }
    }

    #[test]
    fn a_state_is_watched_with_all_that_is_in_it() {
        let arm = target(WatchKind::State, "R/ARM", "", 0);
        let fits = |path| arm.fits(WatchKind::Input, path, "x");
        assert_eq!(
            ["R/ARM", "R/ARM/A", "R/ARMS", "R", ""].map(fits),
            [true, true, false, false, false]
        );
        assert!(!arm.fits(WatchKind::Global, "", "x"));
        let port = target(WatchKind::Input, "R", "x", 0);
        assert!(port.fits(WatchKind::Input, "R", "x") && !port.fits(WatchKind::Output, "R", "x"));
    }

    #[test]
    fn what_two_watch_is_asked_for_once_by_the_first_priority() {
        let ana = [target(WatchKind::Input, "R/A", "x", 3), target(WatchKind::State, "R/B", "", 1)];
        let ben = [target(WatchKind::Input, "R/A", "x", 0)];
        let (union, left_out) = WatchTarget::union(ana.iter().chain(&ben));
        assert_eq!(union, [ben[0].clone(), ana[1].clone()]);
        assert_eq!(left_out, 0);
    }

    #[test]
    fn of_ten_thousand_the_first_are_asked_for() {
        let many: Vec<_> = (0..10_000_u32)
            .map(|nth| {
                target(WatchKind::Output, &format!("R/{nth}"), "x", u8::try_from(nth % 50).unwrap())
            })
            .collect();
        let (union, left_out) = WatchTarget::union(&many);
        assert_eq!((union.len(), left_out), (WATCHED_MAX, 10_000 - WATCHED_MAX));
        assert!(union.iter().all(|target| target.priority <= 5));
    }

    #[test]
    fn what_has_too_long_a_path_or_name_is_left_out_and_counted() {
        let watched = |path: usize, name: usize| {
            let (path, name) = ("p".repeat(path), "n".repeat(name));
            let (union, left_out) = WatchTarget::union(&[
                target(WatchKind::Output, &path, &name, 0),
                target(WatchKind::Output, "R", "x", 1),
            ]);
            (union.len(), left_out)
        };
        assert_eq!(watched(PATH_MAX, NAME_MAX), (2, 0));
        assert_eq!(watched(PATH_MAX + 1, NAME_MAX), (1, 1));
        assert_eq!(watched(PATH_MAX, NAME_MAX + 1), (1, 1));
    }
}
