//! Names of states by path, because the protocol sends ids. Loads the machine independently, in parallel with the runner.

use rafcon_model::{Kind, Machine, State, StatePath};
use rafcon_protocol::Event;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use std::thread::JoinHandle;

/// Names of the loaded machine; ids for all else.
pub(crate) struct Names {
    loading: Option<JoinHandle<Option<Machine>>>,
    /// The current machine and the one before. States that are active during a change may exist only in the older one.
    machines: [Option<Machine>; 2],
    known: BTreeMap<String, Arc<str>>,
    later: Option<LoadChanged>,
}

/// Finds the machine of a run by its hash.
type LoadChanged = Arc<dyn Fn(&str) -> Option<Machine> + Send + Sync>;

impl fmt::Debug for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Names").field("known", &self.known.len()).finish_non_exhaustive()
    }
}

impl Names {
    /// Names from a machine that `load` loads on a separate thread; without a machine, ids are shown.
    pub(crate) fn new(load: impl FnOnce() -> Option<Machine> + Send + 'static) -> Self {
        let loading = std::thread::Builder::new().name("names".to_owned()).spawn(load).ok();
        Self { loading, machines: [None, None], known: BTreeMap::new(), later: None }
    }

    /// Adds the loading of machines by their hash, whenever the run's machine has changed.
    pub(crate) fn following(
        self,
        load: impl Fn(&str) -> Option<Machine> + Send + Sync + 'static,
    ) -> Self {
        Self { later: Some(Arc::new(load)), ..self }
    }

    /// Handles a change of the machine.
    pub(crate) fn hear(&mut self, event: &Event) {
        let Event::Root { hash, change } = event else { return };
        let Some(load) = self.later.clone().filter(|_| !change.is_empty()) else { return };
        self.wait();
        let hash = hash.clone();
        let spawn = std::thread::Builder::new().name("names".to_owned());
        self.loading = spawn.spawn(move || load(&hash)).ok();
    }

    /// The path of ids for the user's text: a path of ids, a path of names, or a unique name.
    pub(crate) fn resolve(&mut self, text: &str) -> Result<String, String> {
        self.wait();
        let [Some(machine), _] = &self.machines else { return Ok(text.to_owned()) };
        if machine.state(&StatePath::parse(text)).is_some() {
            return Ok(text.to_owned());
        }
        let mut found = Vec::new();
        collect(&machine.root, &mut Vec::new(), &mut Vec::new(), text, &mut found);
        match found.as_slice() {
            [one] => Ok(one.clone()),
            [] => Err(format!(
                "no state is named `{text}`: write a path of ids, a path of names, or a name"
            )),
            many => Err(format!("`{text}` could mean {}: write the path", many.join(" or "))),
        }
    }

    /// The machine, once it is loaded.
    pub(crate) fn machine(&mut self) -> Option<&Machine> {
        self.wait();
        self.machines[0].as_ref()
    }

    fn wait(&mut self) {
        let Some(loading) = self.loading.take() else { return };
        if let Some(newer) = loading.join().unwrap_or(None) {
            let [now, before] = &mut self.machines;
            *before = now.replace(newer);
            self.known.clear();
        }
    }

    /// The names along a path, joined by `/`. A library state and the root of its content form one name if their names are
    /// equal.
    pub(crate) fn path(&mut self, path: &str) -> Arc<str> {
        self.wait();
        if let Some(known) = self.known.get(path) {
            return Arc::clone(known);
        }
        let found: Arc<str> = self.find(path).unwrap_or_else(|| path.to_owned()).into();
        self.known.insert(path.to_owned(), Arc::clone(&found));
        found
    }

    fn find(&self, path: &str) -> Option<String> {
        let path = StatePath::parse(path);
        self.machines.iter().flatten().find_map(|machine| names_of(machine, &path))
    }
}

/// Finds the states whose name, or path of names, is `text`.
fn collect(
    state: &Arc<State>,
    ids: &mut Vec<String>,
    names: &mut Vec<String>,
    text: &str,
    found: &mut Vec<String>,
) {
    ids.push(state.id.to_string());
    names.push(state.name.to_string());
    if state.name == text || names.join("/") == text {
        found.push(ids.join("/"));
    }
    for child in state.container().into_iter().flat_map(|container| container.states.values()) {
        collect(child, ids, names, text, found);
    }
    ids.pop();
    names.pop();
}

/// The names along a path, joined by `/`; `None` if the machine does not have the path.
pub(crate) fn names_of(machine: &Machine, path: &StatePath) -> Option<String> {
    let mut names: Vec<&str> = Vec::new();
    let mut content_of = None;
    for end in 1..=path.0.len() {
        let state = machine.state(&StatePath(path.0[..end].to_vec()))?;
        if content_of != Some(&state.name) {
            names.push(&state.name);
        }
        content_of = matches!(state.kind, Kind::Library(_)).then_some(&state.name);
    }
    Some(names.join("/"))
}

#[cfg(test)]
mod tests {
    use super::Names;
    use rafcon_protocol::Event;
    use rafcon_testkit::notation;

    const MACHINE: &str = r#"
hierarchy ROOT "Mission"
  outcome done
  execution WAITED "Wait a bit"
    outcome done
"#;

    fn check(path: &str, expected: &str) {
        let mut names = Names::new(|| notation::parse(MACHINE).ok());
        assert_eq!(&*names.path(path), expected);
    }

    #[test]
    fn a_path_becomes_names() {
        check("ROOT/WAITED", "Mission/Wait a bit");
    }

    #[test]
    fn names_become_a_path() {
        let resolve = |text: &str| Names::new(|| notation::parse(MACHINE).ok()).resolve(text);
        assert_eq!(resolve("Wait a bit").unwrap(), "ROOT/WAITED");
        assert_eq!(resolve("Mission/Wait a bit").unwrap(), "ROOT/WAITED");
        assert_eq!(resolve("ROOT/WAITED").unwrap(), "ROOT/WAITED");
        assert_eq!(
            resolve("Nobody").unwrap_err(),
            "no state is named `Nobody`: write a path of ids, a path of names, or a name"
        );
    }

    #[test]
    fn a_machine_that_changes_is_read_again() {
        let later = MACHINE.replace("WAITED \"Wait a bit\"", "FETCHX \"Fetch\"");
        let mut names = Names::new(|| notation::parse(MACHINE).ok())
            .following(move |hash| notation::parse(&later).ok().filter(|_| hash == "2"));
        let hear = |names: &mut Names, hash: &str, change: &str| {
            names.hear(&Event::Root { hash: hash.to_owned(), change: change.to_owned() });
        };
        hear(&mut names, "1", "");
        assert_eq!(&*names.path("ROOT/FETCHX"), "ROOT/FETCHX");
        hear(&mut names, "2", "state added");
        assert_eq!(&*names.path("ROOT/FETCHX"), "Mission/Fetch");
        assert_eq!(&*names.path("ROOT/WAITED"), "Mission/Wait a bit");
        assert!(names.resolve("Wait a bit").is_err());
        // An unreadable machine changes nothing.
        hear(&mut names, "3", "state removed");
        assert_eq!(&*names.path("ROOT/FETCHX"), "Mission/Fetch");
    }

    #[test]
    fn what_nobody_knows_keeps_its_ids() {
        check("ROOT/NOBODY", "ROOT/NOBODY");
    }

    #[test]
    fn a_machine_that_does_not_load_has_ids() {
        assert_eq!(&*Names::new(|| None).path("A/B"), "A/B");
    }
}
