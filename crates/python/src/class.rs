//! Cache of facts about Python types, so that type checks need no interpreter.

use parking_lot::{Mutex, RwLock};
use pyo3::prelude::*;
use pyo3::types::PyType;
use rafcon_model::{Answer, DataType};
use smol_str::{SmolStr, format_smolstr};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Capacity of the cache; a program that creates types without limit must not fill the memory.
const CLASSES_MAX: usize = 4096;

/// A type other than the common built-in ones.
#[derive(Debug)]
pub(crate) struct Class {
    /// Its own name, for messages.
    pub(crate) name: SmolStr,
    /// Its dotted name and those of all its bases.
    names: Box<[SmolStr]>,
    /// True if objects of exactly this type can never change.
    pub(crate) immutable: bool,
    /// Keeps the type alive, so that its address is not reused.
    _type: Py<PyType>,
}

/// Types by their addresses.
static CLASSES: Mutex<BTreeMap<usize, Arc<Class>>> = Mutex::new(BTreeMap::new());
/// Real name of each declared type; `None` if only Python can check its objects.
static DECLARED: RwLock<BTreeMap<SmolStr, Option<SmolStr>>> = RwLock::new(BTreeMap::new());

/// Names in `builtins` and elsewhere whose objects never change.
const IMMUTABLE: [&str; 9] = [
    "builtins.bytes",
    "builtins.complex",
    "builtins.type",
    "builtins.function",
    "builtins.builtin_function_or_method",
    "builtins.module",
    "builtins.range",
    "builtins.ellipsis",
    "decimal.Decimal",
];

impl Class {
    /// Facts about a type, from the cache if possible.
    pub(crate) fn of(found: &Bound<'_, PyType>) -> PyResult<Arc<Self>> {
        let address = found.as_ptr() as usize;
        if let Some(class) = CLASSES.lock().get(&address) {
            return Ok(Arc::clone(class));
        }
        let class = Arc::new(Self::read(found)?);
        let forgotten = {
            let mut classes = CLASSES.lock();
            let full = classes.len() >= CLASSES_MAX;
            let forgotten = if full { std::mem::take(&mut *classes) } else { BTreeMap::new() };
            classes.insert(address, Arc::clone(&class));
            forgotten
        };
        drop(forgotten);
        Ok(class)
    }

    fn read(found: &Bound<'_, PyType>) -> PyResult<Self> {
        let names: Vec<SmolStr> = found.mro().iter().map(|base| dotted(&base)).collect();
        let immutable = names.first().is_some_and(|name| IMMUTABLE.contains(&name.as_str()))
            || found.is_subclass_of::<PyType>()?;
        Ok(Self {
            name: SmolStr::new(found.name()?.to_string_lossy()),
            names: names.into(),
            immutable,
            _type: found.clone().unbind(),
        })
    }

    /// Reports if a port of type `declared` accepts objects of this type.
    pub(crate) fn fits(&self, declared: &DataType) -> Answer {
        let is = |name: &str| self.names.iter().any(|own| own == name);
        let answer = |yes: bool| if yes { Answer::Yes } else { Answer::No };
        match declared {
            DataType::None | DataType::Object => Answer::Yes,
            DataType::Int | DataType::Float => answer(is("builtins.int") || is("builtins.float")),
            DataType::Named(name) => is_declared_as(&self.names, name),
            builtin => answer(is(&builtin.python_name())),
        }
    }
}

/// Reports if a type is the one that a port declares as `declared`. `names` are those of the type and its bases.
pub(crate) fn is_declared_as(names: &[SmolStr], declared: &SmolStr) -> Answer {
    if names.contains(declared) {
        return Answer::Yes;
    }
    match DECLARED.read().get(declared) {
        Some(Some(real)) if names.contains(real) => Answer::Yes,
        Some(Some(_)) => Answer::No,
        Some(None) | None => Answer::Unknown,
    }
}

/// Stores the real name of a declared type, if the name is new. `resolve` returns `None` if only Python can check objects
/// of the type (abstract classes).
pub(crate) fn declare(name: &SmolStr, resolve: impl FnOnce() -> Option<SmolStr>) {
    if DECLARED.read().contains_key(name) {
        return;
    }
    let real = resolve();
    DECLARED.write().insert(name.clone(), real);
}

/// Module and qualified name of a type.
pub(crate) fn dotted(found: &Bound<'_, PyAny>) -> SmolStr {
    let text = |name: &str| {
        let value = found.getattr(name).ok()?;
        value.extract::<String>().ok()
    };
    let module = text("__module__").unwrap_or_else(|| "builtins".to_owned());
    format_smolstr!("{module}.{}", text("__qualname__").unwrap_or_default())
}
