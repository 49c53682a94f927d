//! Active states while a run is read, with their paths and names.

use std::collections::BTreeMap;

/// Active states by path.
#[derive(Debug, Default)]
pub(super) struct States {
    active: BTreeMap<String, ExportedState>,
}

#[derive(Debug, Default)]
struct ExportedState {
    names: String,
    children: usize,
}

impl States {
    /// Adds a state that was entered.
    pub(super) fn entered(&mut self, path: &str, names: &str) {
        let new = ExportedState { names: names.to_owned(), children: 0 };
        if self.active.insert(path.to_owned(), new).is_none()
            && let Some(around) = self.around(path)
        {
            around.children += 1;
        }
    }

    /// Removes a state that was left.
    pub(super) fn left(&mut self, path: &str) {
        if self.active.remove(path).is_some()
            && let Some(around) = self.around(path)
        {
            around.children = around.children.saturating_sub(1);
        }
    }

    /// Returns the names of the innermost active states.
    pub(super) fn innermost(&self) -> Vec<&str> {
        let innermost = self.active.values().filter(|state| state.children == 0);
        innermost.map(|state| state.names.as_str()).collect()
    }

    fn around(&mut self, path: &str) -> Option<&mut ExportedState> {
        self.active.get_mut(path.rsplit_once('/')?.0)
    }
}

#[cfg(test)]
mod tests {
    use super::States;

    #[test]
    fn the_innermost_are_those_in_which_nothing_is_active() {
        let mut states = States::default();
        for path in ["R", "R/A", "R/A/X", "R/B"] {
            states.entered(path, path);
        }
        assert_eq!(states.innermost(), ["R/A/X", "R/B"]);
        states.left("R/A/X");
        states.left("R/B");
        assert_eq!(states.innermost(), ["R/A"]);
        states.left("R/A");
        assert_eq!(states.innermost(), ["R"]);
    }
}
