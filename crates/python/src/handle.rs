//! Values in the engine: Python objects that can be passed on, type-checked and dropped without the interpreter.

use crate::class::{self, Class};
use crate::graveyard;
use crate::value_serializer::ValueSerializer;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PySet, PyString, PyTuple};
use rafcon_engine::Datum;
use rafcon_model::{Answer, DataType};
use rafcon_runner::{Keep, KeptValue};
use rafcon_storage::journal::record::{Content, TEXT_MAX};
use rafcon_storage::journal::{Kept, Stored};
use serde_json::json;
use smol_str::SmolStr;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// Type name of the placeholder for a lost value. No class has a name with spaces.
const LOST: &str = "a value that was lost";

/// A Python object, or `None`. Cloning increments our own reference count, never Python's.
#[derive(Clone, Default)]
pub(crate) struct Handle(Option<Arc<Object>>);

struct Object {
    /// Present until it is dropped.
    python: Option<Py<PyAny>>,
    kind: Kind,
    saved: Saved,
}

/// Form in which a value is kept.
enum Saved {
    /// Kept in the events that name it.
    Plain(Kept),
    /// Kept by number; copies of one value share it.
    Stored(Arc<KeptValue>),
    /// Not kept. The placeholder is made when an event names the value.
    Not(OnceLock<Box<KeptValue>>),
}

/// Exact type of an object; subclasses are `Other`.
#[derive(Debug, Clone)]
pub(crate) enum Kind {
    Bool,
    Int,
    Float,
    Str,
    List,
    Tuple,
    Dict,
    Set,
    Other(Arc<Class>),
    /// Any other type whose class cannot be read.
    Strange,
}

impl Handle {
    /// A new handle for `object`. Keeps only values that fit in an event.
    pub(crate) fn new(object: Bound<'_, PyAny>) -> Self {
        Self::make(object, |object, kind| {
            plain(object, kind).map_or_else(|| Saved::Not(OnceLock::new()), Saved::Plain)
        })
    }

    /// A handle whose value is kept. May run user code: never called with the engine locked.
    pub(crate) fn kept(object: Bound<'_, PyAny>, keeper: &ValueSerializer) -> Self {
        Self::make(object, |object, kind| match plain(object, kind) {
            Some(kept) => Saved::Plain(kept),
            None if keeper.keeps() => stored(keeper.stored(object, kind.type_name())),
            None => Saved::Not(OnceLock::new()),
        })
    }

    /// A handle whose value is shown as `object`, and kept as the pickle of `carrier`, which contains it.
    pub(crate) fn carried(
        object: Bound<'_, PyAny>,
        carrier: &Bound<'_, PyAny>,
        keeper: &ValueSerializer,
    ) -> Self {
        let type_name = Kind::of(&object).type_name();
        let kept = keeper.stored_as(&object, type_name, carrier);
        Self::restored(object, kept)
    }

    /// A handle for a value restored from `kept`.
    pub(crate) fn restored(object: Bound<'_, PyAny>, kept: Stored) -> Self {
        Self::make(object, |_, _| stored(kept))
    }

    /// A handle with a placeholder for a value that cannot be restored.
    pub(crate) fn lost(py: Python<'_>, why: &str) -> Self {
        let error = PyRuntimeError::new_err(why.to_owned()).into_value(py);
        let kept = Stored {
            view: json!({ "__exc__": "RuntimeError", "msg": why }),
            type_name: LOST.into(),
            content: Content::Nothing(why.to_owned()),
        };
        Self::restored(error.into_bound(py).into_any(), kept)
    }

    /// The reason why the value was lost, if this is a placeholder.
    pub(crate) fn why_lost(&self) -> Option<String> {
        let Keep::Stored(kept) = self.keep() else { return None };
        match &kept.stored().content {
            Content::Nothing(why) if kept.stored().type_name == LOST => Some(why.clone()),
            _ => None,
        }
    }

    /// A handle for a copy of this value. Shares the stored value, if it has one.
    pub(crate) fn like(&self, object: Bound<'_, PyAny>) -> Self {
        match self.0.as_ref().map(|own| &own.saved) {
            Some(Saved::Stored(kept)) => Self::make(object, |_, _| Saved::Stored(Arc::clone(kept))),
            _ => Self::new(object),
        }
    }

    fn make(
        object: Bound<'_, PyAny>,
        save: impl FnOnce(&Bound<'_, PyAny>, &Kind) -> Saved,
    ) -> Self {
        if object.is_none() {
            return Self(None);
        }
        let kind = Kind::of(&object);
        let saved = save(&object, &kind);
        Self(Some(Arc::new(Object { python: Some(object.unbind()), kind, saved })))
    }

    /// The value as the journal keeps it; runs no user code.
    pub(crate) fn keep(&self) -> Keep<'_> {
        match self.0.as_ref().map(|own| (own, &own.saved)) {
            None => Keep::Plain(Kept::None),
            Some((_, Saved::Plain(kept))) => Keep::Plain(kept.clone()),
            Some((_, Saved::Stored(kept))) => Keep::Stored(kept),
            Some((own, Saved::Not(placeholder))) => {
                Keep::Stored(placeholder.get_or_init(|| Box::new(not_kept(&own.kind))))
            }
        }
    }

    /// The Python object; Python's `None` for an empty handle.
    pub(crate) fn bind<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let object = self.0.as_ref().and_then(|object| object.python.as_ref());
        object.map_or_else(|| py.None().into_bound(py), |object| object.bind(py).clone())
    }

    /// True if the handle holds this very object.
    pub(crate) fn is(&self, object: &Bound<'_, PyAny>) -> bool {
        match self.0.as_ref().and_then(|own| own.python.as_ref()) {
            Some(own) => own.is(object),
            None => object.is_none(),
        }
    }

    /// Type of the object; `None` for Python's `None`.
    pub(crate) fn kind(&self) -> Option<&Kind> {
        self.0.as_ref().map(|object| &object.kind)
    }
}

impl Drop for Object {
    fn drop(&mut self) {
        if let Some(object) = self.python.take() {
            graveyard::bury(object);
        }
    }
}

impl fmt::Debug for Handle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Handle").field(&self.type_name()).finish()
    }
}

impl Kind {
    /// The type of an object that is not `None`.
    pub(crate) fn of(object: &Bound<'_, PyAny>) -> Self {
        if object.is_exact_instance_of::<PyInt>() {
            Self::Int
        } else if object.is_exact_instance_of::<PyString>() {
            Self::Str
        } else if object.is_exact_instance_of::<PyBool>() {
            Self::Bool
        } else if object.is_exact_instance_of::<PyFloat>() {
            Self::Float
        } else {
            Self::of_larger(object)
        }
    }

    fn of_larger(object: &Bound<'_, PyAny>) -> Self {
        if object.is_exact_instance_of::<PyList>() {
            Self::List
        } else if object.is_exact_instance_of::<PyDict>() {
            Self::Dict
        } else if object.is_exact_instance_of::<PyTuple>() {
            Self::Tuple
        } else if object.is_exact_instance_of::<PySet>() {
            Self::Set
        } else {
            Class::of(&object.get_type()).map_or(Self::Strange, Self::Other)
        }
    }

    /// The built-in type, if it is one of the common ones.
    fn builtin(&self) -> Option<DataType> {
        Some(match self {
            Self::Bool => DataType::Bool,
            Self::Int => DataType::Int,
            Self::Float => DataType::Float,
            Self::Str => DataType::Str,
            Self::List => DataType::List,
            Self::Tuple => DataType::Tuple,
            Self::Dict => DataType::Dict,
            Self::Set => DataType::Set,
            Self::Other(_) | Self::Strange => return None,
        })
    }

    /// The name of the type, for messages.
    pub(crate) fn type_name(&self) -> SmolStr {
        match self {
            Self::Other(class) => class.name.clone(),
            Self::Strange => "object".into(),
            kind => kind.builtin().map(|own| own.short_name()).unwrap_or_default(),
        }
    }

    fn fits(&self, declared: &DataType) -> Answer {
        match (self, declared) {
            (_, DataType::None | DataType::Object)
            | (Self::Int | Self::Bool, DataType::Int | DataType::Float)
            | (Self::Float, DataType::Int) => Answer::Yes,
            (Self::Other(class), declared) => class.fits(declared),
            (Self::Strange, _) => Answer::Unknown,
            (own, DataType::Named(name)) => {
                let own = own.builtin().map(|own| own.python_name()).unwrap_or_default();
                class::is_declared_as(&[own], name)
            }
            (own, declared) if own.builtin().as_ref() == Some(declared) => Answer::Yes,
            _ => Answer::No,
        }
    }
}

impl Datum for Handle {
    fn none() -> Self {
        Self(None)
    }

    fn is_none(&self) -> bool {
        self.0.is_none()
    }

    fn fits(&self, declared: &DataType) -> Answer {
        self.kind().map_or(Answer::Yes, |kind| kind.fits(declared))
    }

    fn type_name(&self) -> SmolStr {
        self.kind().map_or_else(|| "NoneType".into(), Kind::type_name)
    }
}

fn stored(kept: Stored) -> Saved {
    Saved::Stored(Arc::new(KeptValue::new(kept)))
}

/// The value in the form that fits in an event.
fn plain(object: &Bound<'_, PyAny>, kind: &Kind) -> Option<Kept> {
    match kind {
        Kind::Bool => object.cast::<PyBool>().ok().map(|truth| Kept::Bool(truth.is_true())),
        Kind::Int => object.extract().ok().map(Kept::Int),
        Kind::Float => object.cast::<PyFloat>().ok().map(|number| Kept::Float(number.value())),
        Kind::Str => {
            let text = object.cast::<PyString>().ok()?;
            if text.len().ok()? > TEXT_MAX {
                return None;
            }
            let text = text.to_cow().ok()?;
            (text.len() <= TEXT_MAX).then(|| Kept::Text(SmolStr::new(text)))
        }
        _ => None,
    }
}

/// Placeholder for a value of a state that keeps no values.
fn not_kept(kind: &Kind) -> KeptValue {
    let type_name = kind.type_name();
    KeptValue::new(Stored {
        view: json!({ "__repr__": "(not kept)", "__class__": type_name.as_str() }),
        type_name,
        content: Content::Nothing(
            "the state that made it keeps no values: its semantic data `journal` says so"
                .to_owned(),
        ),
    })
}
