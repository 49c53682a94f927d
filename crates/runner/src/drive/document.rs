//! The current machine of a run, and its changes. An edit reaches the engine between two steps, or not at all. This
//! module knows roots, but not who changes them.

use crate::drive::core::Core;
use crate::drive::error::ChangeError;
use crate::drive::prepare::Source;
use crate::{Driver, Scripts};
use rafcon_engine::{Change, Input, PathId, Program, Refusal};
use rafcon_locks::{Condvar, Mutex, RwLock};
use rafcon_model::edit::{Edit, StateEdit, apply};
use rafcon_model::{BuiltinTypes, Machine, StatePath};
use rafcon_protocol::Event;
use std::sync::Arc;

/// The result of an accepted change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edited {
    /// The run uses the changed machine.
    Applied,
    /// The change waits until the states that it affects have ended.
    Waits,
}

/// The machine of a run.
#[derive(Debug)]
pub(crate) struct Document<D> {
    current: RwLock<Root<D>>,
    /// Roots passed to the engine that it does not use yet: one that waits, and one that is being passed.
    coming: Mutex<Vec<Root<D>>>,
    /// The newest root, waiting or not. Taken by the thread that creates the next one.
    newest: Mutex<Option<Root<D>>>,
    returned: Condvar,
    /// The source from which the machine can be loaded again.
    source: Option<Source>,
}

/// One version of the machine.
#[derive(Debug)]
pub(crate) struct Root<D> {
    pub(crate) machine: Arc<Machine>,
    pub(crate) program: Arc<Program<D>>,
    /// A description of the changes since the current root.
    what: String,
}

impl<D> Clone for Root<D> {
    fn clone(&self) -> Self {
        let (machine, program) = (Arc::clone(&self.machine), Arc::clone(&self.program));
        Self { machine, program, what: self.what.clone() }
    }
}

impl<D> Document<D> {
    /// A machine without changes.
    pub(crate) fn new(machine: Machine, program: Arc<Program<D>>, source: Option<Source>) -> Self {
        let root = Root { machine: Arc::new(machine), program, what: String::new() };
        Self {
            current: RwLock::new(root.clone()),
            coming: Mutex::default(),
            newest: Mutex::new(Some(root)),
            returned: Condvar::new(),
            source,
        }
    }

    /// The program of the current machine.
    pub(crate) fn program(&self) -> Arc<Program<D>> {
        Arc::clone(&self.current.read().program)
    }

    /// The machine that currently runs.
    pub(crate) fn machine(&self) -> Arc<Machine> {
        Arc::clone(&self.current.read().machine)
    }

    fn take(&self) -> Root<D> {
        let mut newest = self.newest.lock();
        loop {
            if let Some(root) = newest.take() {
                return root;
            }
            self.returned.wait(&mut newest);
        }
    }

    fn give_back(&self, root: Root<D>) {
        *self.newest.lock() = Some(root);
        self.returned.notify_one();
    }

    fn is_run(&self, root: &Root<D>) -> bool {
        Arc::ptr_eq(&self.current.read().program, &root.program)
    }

    /// Makes the root of this program the current one, and returns it if it was coming.
    fn adopt(&self, program: &Arc<Program<D>>) -> Option<Root<D>> {
        let mut coming = self.coming.lock();
        let at = coming.iter().position(|root| Arc::ptr_eq(&root.program, program))?;
        let root = coming.swap_remove(at);
        *self.current.write() = root.clone();
        Some(root)
    }

    /// The description of the newest coming root.
    fn last_coming(&self) -> String {
        self.coming.lock().last().map(|root| root.what.clone()).unwrap_or_default()
    }
}

/// The newest root while a thread changes it. Drop returns the root to the document.
struct Taken<'d, D> {
    document: &'d Document<D>,
    root: Option<Root<D>>,
}

impl<D> Drop for Taken<'_, D> {
    fn drop(&mut self) {
        if let Some(root) = self.root.take() {
            self.document.give_back(root);
        }
    }
}

impl<S: Scripts> Driver<S> {
    /// Changes the machine of the run: all edits or none. `what` describes the change for people. A change that affects
    /// an active state is refused, or waits until that state is left.
    ///
    /// The new structure applies when this returns [`Edited::Applied`], also if the caller is a script of the run.
    pub fn edit(
        self: &Arc<Self>,
        edits: &[Edit],
        what: &str,
        wait: bool,
    ) -> Result<Edited, ChangeError> {
        self.change(what, wait, |machine| {
            let mut machine = machine.clone();
            for edit in edits {
                apply(&mut machine, edit.clone(), &BuiltinTypes)
                    .map_err(|why| ChangeError::Edit(Box::new(why)))?;
            }
            Ok(machine)
        })
    }

    /// True if all changes are kept, so that a run resumed after a crash uses them.
    pub fn has_kept_changes(&self) -> bool {
        self.roots().are_kept()
    }

    /// Changes the script of a state, in the run only.
    pub(crate) fn edit_script(
        self: &Arc<Self>,
        path: &str,
        script: &str,
    ) -> Result<(), ChangeError> {
        let edit = Edit::State(StatePath::parse(path), StateEdit::SetScript(Some(script.into())));
        self.edit(&[edit], &format!("the script of {path}"), false).map(drop)
    }

    /// Loads the machine from its folder again, and switches to it.
    pub(crate) fn reload(self: &Arc<Self>, wait: bool) -> Result<(), ChangeError> {
        let source = self.document().source.as_ref();
        let source = source.ok_or(ChangeError::NotFromFolder)?;
        let mut saved = None;
        self.change("its folder was read again", wait, |_| {
            let loaded = source.read().map_err(|why| ChangeError::Load(Box::new(why)))?;
            if let Some(damage) = &loaded.machine.root.damage {
                return Err(ChangeError::Damaged(damage.to_string()));
            }
            saved = Some(loaded.saved);
            Ok(loaded.machine)
        })?;
        if let Some(saved) = saved {
            source.went_by(saved);
        }
        Ok(())
    }

    /// Switches to the machine that `make` derives from the newest root.
    pub(crate) fn change(
        self: &Arc<Self>,
        what: &str,
        wait: bool,
        make: impl FnOnce(&Machine) -> Result<Machine, ChangeError>,
    ) -> Result<Edited, ChangeError> {
        let mut taken = self.take_newest()?;
        let Some(old) = &taken.root else { return Ok(Edited::Applied) };
        let machine = make(&old.machine)?;
        if *old.machine == machine {
            return Ok(if self.document().is_run(old) { Edited::Applied } else { Edited::Waits });
        }
        let waits_with_it = !self.document().is_run(old) && !old.what.is_empty();
        let what = if waits_with_it { format!("{}; {what}", old.what) } else { what.to_owned() };
        let program = self.compile(&old.program, &machine)?;
        let root = Root { machine: Arc::new(machine), program, what };
        self.give_to_engine(&root, wait)?;
        let edited = if self.document().is_run(&root) { Edited::Applied } else { Edited::Waits };
        taken.root = Some(root);
        Ok(edited)
    }

    fn take_newest(&self) -> Result<Taken<'_, S::Value>, ChangeError> {
        let mut root = None;
        self.scripts().park(&mut || root = Some(self.document().take()));
        let root = root.ok_or(ChangeError::Unavailable)?;
        Ok(Taken { document: self.document(), root: Some(root) })
    }

    fn compile(
        &self,
        old: &Program<S::Value>,
        machine: &Machine,
    ) -> Result<Arc<Program<S::Value>>, ChangeError> {
        let mut program = None;
        self.scripts().with_literals(&mut |literals| {
            program = Some(Arc::new(old.change(machine, literals)));
        });
        program.ok_or(ChangeError::NoLiterals)
    }

    fn give_to_engine(self: &Arc<Self>, root: &Root<S::Value>, wait: bool) -> Result<(), Refusal> {
        self.document().coming.lock().push(root.clone());
        let change = Change { program: Arc::clone(&root.program), wait };
        let answer = self.command(Input::Change(change));
        let is_new = |other: &Root<S::Value>| Arc::ptr_eq(&other.program, &root.program);
        let mut coming = self.document().coming.lock();
        match &answer {
            // The new change contains one that waited.
            Ok(()) => coming.retain(is_new),
            Err(_refused) => coming.retain(|other| !is_new(other)),
        }
        answer
    }

    /// Follows the engine to another program. Called with the engine locked, before any state of the new program
    /// begins.
    pub(crate) fn adopt(&self, core: &Core<S::Value>) {
        let Some(root) = self.document().adopt(core.engine.program()) else { return };
        self.timers().adopt(&root.program);
        self.look_at_ground_later();
        self.roots().keep(self.record(), &root.machine, &root.what);
        self.scripts().changed(&root.machine, &root.program);
    }

    /// Reports that a change waits until the state at `path` is left.
    pub(crate) fn change_waits(&self, core: &Core<S::Value>, path: PathId) {
        let path = core.engine.path_text(path).to_string();
        self.record().tell(Event::ChangeWaits { path, change: self.document().last_coming() });
    }
}
