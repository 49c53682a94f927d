//! Outcomes and data ports: the interface of a state.

use crate::{DataType, Json, OutcomeId, PortId, Value};
use smol_str::SmolStr;
use std::sync::Arc;

/// Unknown keys of an element; kept and written back. `None` if there are none.
pub type Extra = Option<Box<Json>>;

/// One way in which a state can end.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Unique in the state.
    pub id: OutcomeId,
    /// Unique in the state.
    pub name: SmolStr,
    /// Unknown keys of the file.
    pub extra: Extra,
}

/// An input port, output port or scoped variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Port {
    /// Unique over inputs, outputs and scoped variables of the state.
    pub id: PortId,
    /// Unique in its own kind.
    pub name: SmolStr,
    /// Declared type of its values; [`DataType::None`] if none is declared.
    pub data_type: DataType,
    /// The value in the file. A string for another type is raw text, converted when a run starts; a string that starts
    /// with `$` names a global variable.
    pub default: Value,
    /// Unknown keys of the file.
    pub extra: Extra,
}

impl Outcome {
    /// An outcome without unknown keys.
    pub fn new(id: OutcomeId, name: impl AsRef<str>) -> Self {
        Self { id, name: SmolStr::new(name), extra: None }
    }
}

impl Port {
    /// A port without unknown keys.
    pub fn new(id: PortId, name: impl AsRef<str>, data_type: DataType, default: Value) -> Self {
        Self { id, name: SmolStr::new(name), data_type, default, extra: None }
    }
}

/// An element with its own id in an [`Elements`] list.
pub trait Element: Clone {
    /// The type of its id.
    type Id: Copy + Ord;
    /// Id, unique in its list.
    fn id(&self) -> Self::Id;
    /// Name, for people and scripts.
    fn name(&self) -> &SmolStr;
}

impl Element for Outcome {
    type Id = OutcomeId;
    fn id(&self) -> OutcomeId {
        self.id
    }
    fn name(&self) -> &SmolStr {
        &self.name
    }
}

impl Element for Port {
    type Id = PortId;
    fn id(&self) -> PortId {
        self.id
    }
    fn name(&self) -> &SmolStr {
        &self.name
    }
}

/// A short list of elements, sorted by id, shared until it is changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Elements<T>(Option<Arc<[T]>>);

/// The outcomes of a state.
pub type Outcomes = Elements<Outcome>;
/// The input ports, output ports or scoped variables of a state.
pub type Ports = Elements<Port>;

impl<T> Default for Elements<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T: Element> Elements<T> {
    /// All elements, sorted by id.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.as_slice().iter()
    }

    /// All elements, sorted by id.
    pub fn as_slice(&self) -> &[T] {
        self.0.as_deref().unwrap_or_default()
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        self.as_slice().len()
    }

    /// True if there are no ports.
    pub fn is_empty(&self) -> bool {
        self.0.is_none()
    }

    /// The element with this id.
    pub fn get(&self, id: T::Id) -> Option<&T> {
        self.index(id).ok().map(|index| &self.as_slice()[index])
    }

    /// The first element with this name.
    pub fn by_name(&self, name: &str) -> Option<&T> {
        self.iter().find(|element| element.name() == name)
    }

    /// Inserts an element, and returns the one that had its id.
    pub fn insert(&mut self, element: T) -> Option<T> {
        match self.index(element.id()) {
            Ok(index) => {
                let slot = Arc::make_mut(self.0.as_mut()?).get_mut(index)?;
                Some(std::mem::replace(slot, element))
            }
            Err(index) => {
                let (before, after) = self.as_slice().split_at(index);
                let (before, after) = (before.iter().cloned(), after.iter().cloned());
                self.0 = Some(before.chain([element]).chain(after).collect());
                None
            }
        }
    }

    /// Removes the element with this id.
    pub fn remove(&mut self, id: T::Id) -> Option<T> {
        let index = self.index(id).ok()?;
        let (before, rest) = self.as_slice().split_at(index);
        let (element, after) = rest.split_first()?;
        let element = element.clone();
        let left: Arc<[T]> = before.iter().chain(after).cloned().collect();
        self.0 = Some(left).filter(|left| !left.is_empty());
        Some(element)
    }

    fn index(&self, id: T::Id) -> Result<usize, usize> {
        self.as_slice().binary_search_by_key(&id, Element::id)
    }
}

impl<T: Element> FromIterator<T> for Elements<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        let mut items: Vec<T> = items.into_iter().collect();
        items.sort_by_key(Element::id);
        items.dedup_by_key(|element| element.id());
        Self(if items.is_empty() { None } else { Some(items.into()) })
    }
}

impl<'e, T: Element> IntoIterator for &'e Elements<T> {
    type Item = &'e T;
    type IntoIter = std::slice::Iter<'e, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
