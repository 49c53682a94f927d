//! Values as the engine holds them: Python objects that can be passed on, asked for their type and dropped without the
//! interpreter.

use crate::class::{self, Class};
use crate::graveyard;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PySet, PyString, PyTuple};
use rafcon_engine::Datum;
use rafcon_model::{Answer, DataType};
use smol_str::SmolStr;
use std::fmt;
use std::sync::Arc;

/// A Python object, or `None`. Cloning counts a reference of our own, never Python's.
#[derive(Clone, Default)]
pub(crate) struct Handle(Option<Arc<Object>>);

struct Object {
    object: Option<Py<PyAny>>,
    kind: Kind,
}

/// The type of an object, known once and for all.
#[derive(Debug, Clone)]
pub(crate) enum Kind {
    /// Exactly `bool`.
    Bool,
    /// Exactly `int`.
    Int,
    /// Exactly `float`.
    Float,
    /// Exactly `str`.
    Str,
    /// Exactly `list`.
    List,
    /// Exactly `tuple`.
    Tuple,
    /// Exactly `dict`.
    Dict,
    /// Exactly `set`.
    Set,
    /// Any other type.
    Other(Arc<Class>),
    /// Any other type that does not say what it is.
    Strange,
}

impl Handle {
    /// A handle of its own for `object`.
    pub(crate) fn new(object: Bound<'_, PyAny>) -> Self {
        if object.is_none() {
            return Self(None);
        }
        let kind = Kind::of(&object);
        Self(Some(Arc::new(Object { object: Some(object.unbind()), kind })))
    }

    /// The object itself.
    pub(crate) fn bind<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let object = self.0.as_ref().and_then(|object| object.object.as_ref());
        object.map_or_else(|| py.None().into_bound(py), |object| object.bind(py).clone())
    }

    /// Whether it is this very object.
    pub(crate) fn is(&self, object: &Bound<'_, PyAny>) -> bool {
        match self.0.as_ref().and_then(|own| own.object.as_ref()) {
            Some(own) => own.is(object),
            None => object.is_none(),
        }
    }

    /// Its type; nothing for `None`.
    pub(crate) fn kind(&self) -> Option<&Kind> {
        self.0.as_ref().map(|object| &object.kind)
    }
}

impl Drop for Object {
    fn drop(&mut self) {
        if let Some(object) = self.object.take() {
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
        match self.kind() {
            None => "NoneType".into(),
            Some(Kind::Other(class)) => class.name.clone(),
            Some(Kind::Strange) => "object".into(),
            Some(kind) => kind.builtin().map(|own| own.short_name()).unwrap_or_default(),
        }
    }
}
