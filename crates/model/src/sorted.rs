//! A sorted map that is small for few entries and shares its structure when it has many.
//! Does not know its entries.

use imbl::OrdMap;
use imbl::ordmap::DiffItem;
use std::fmt;
use std::sync::Arc;

/// From this size on, the entries are in a tree instead of one list.
pub(crate) const MANY: usize = 32;
/// Below this size, a list has no spare capacity.
const EXACT: usize = 8;
/// Below this size, the entries move back into a list.
const FEW: usize = 16;

/// A persistent map: cloning it is cheap, and changing a clone does not change the original.
#[derive(Clone)]
pub struct Sorted<K, V>(Form<K, V>);

#[derive(Clone)]
enum Form<K, V> {
    Few(Option<Arc<Vec<(K, V)>>>),
    Many(OrdMap<K, V>),
}

impl<K, V> Default for Sorted<K, V> {
    fn default() -> Self {
        Self(Form::Few(None))
    }
}

impl<K: Ord + Clone, V: Clone> Sorted<K, V> {
    /// A map without entries.
    pub fn new() -> Self {
        Self::default()
    }

    /// The number of entries.
    pub fn len(&self) -> usize {
        match &self.0 {
            Form::Few(_) => self.few().len(),
            Form::Many(map) => map.len(),
        }
    }

    /// True if there are no entries.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn few(&self) -> &[(K, V)] {
        match &self.0 {
            Form::Few(entries) => entries.as_deref().map_or(&[], Vec::as_slice),
            Form::Many(_) => &[],
        }
    }

    fn many(&self) -> Option<&OrdMap<K, V>> {
        match &self.0 {
            Form::Few(_) => None,
            Form::Many(map) => Some(map),
        }
    }

    /// The entries, sorted by key.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (&K, &V)> + Clone {
        let few = self.few().iter().map(|(key, value)| (key, value));
        few.chain(self.many().into_iter().flat_map(OrdMap::iter))
    }

    /// The keys in ascending order.
    pub fn keys(&self) -> impl DoubleEndedIterator<Item = &K> + Clone {
        self.iter().map(|(key, _)| key)
    }

    /// The values, sorted by key.
    pub fn values(&self) -> impl DoubleEndedIterator<Item = &V> + Clone {
        self.iter().map(|(_, value)| value)
    }

    /// The value of a key.
    pub fn get(&self, key: &K) -> Option<&V> {
        match &self.0 {
            Form::Few(_) => {
                let entries = self.few();
                position(entries, key).ok().map(|index| &entries[index].1)
            }
            Form::Many(map) => map.get(key),
        }
    }

    /// True if the key has a value.
    pub fn contains_key(&self, key: &K) -> bool {
        self.get(key).is_some()
    }

    /// The value of a key, mutable.
    pub fn get_mut(&mut self, key: &K) -> Option<&mut V> {
        match &mut self.0 {
            Form::Few(entries) => {
                let entries = entries.as_mut()?;
                let index = position(entries, key).ok()?;
                Some(&mut Arc::make_mut(entries)[index].1)
            }
            Form::Many(map) => map.get_mut(key),
        }
    }

    /// The entry with the greatest key; `None` if there are no entries.
    pub fn last(&self) -> Option<(&K, &V)> {
        self.iter().next_back()
    }

    /// Sets the value of a key, and returns the earlier one.
    pub fn insert(&mut self, key: K, value: V) -> Option<V> {
        match &mut self.0 {
            Form::Few(entries) => {
                let entries = Arc::make_mut(entries.get_or_insert_default());
                match position(entries, &key) {
                    Ok(index) => return Some(std::mem::replace(&mut entries[index].1, value)),
                    Err(index) => {
                        if entries.len() < EXACT {
                            entries.reserve_exact(1);
                        }
                        entries.insert(index, (key, value));
                    }
                }
                if entries.len() >= MANY {
                    self.0 = Form::Many(std::mem::take(entries).into_iter().collect());
                }
                None
            }
            Form::Many(map) => map.insert(key, value),
        }
    }

    /// Removes the value of a key.
    pub fn remove(&mut self, key: &K) -> Option<V> {
        match &mut self.0 {
            Form::Few(entries) => {
                let list = entries.as_mut()?;
                let index = position(list, key).ok()?;
                let removed = Arc::make_mut(list).remove(index).1;
                if list.is_empty() {
                    *entries = None;
                }
                Some(removed)
            }
            Form::Many(map) => {
                let removed = map.remove(key)?;
                if map.len() < FEW {
                    let entries = map.iter().map(|(key, value)| (key.clone(), value.clone()));
                    self.0 = Form::Few(Some(Arc::new(entries.collect())));
                }
                Some(removed)
            }
        }
    }

    /// True if both share their memory, and are therefore equal.
    pub fn ptr_eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Form::Few(None), Form::Few(None)) => true,
            (Form::Few(Some(a)), Form::Few(Some(b))) => Arc::ptr_eq(a, b),
            (Form::Many(a), Form::Many(b)) => a.ptr_eq(b),
            _ => false,
        }
    }
}

fn position<K: Ord, V>(entries: &[(K, V)], key: &K) -> Result<usize, usize> {
    entries.binary_search_by(|(known, _)| known.cmp(key))
}

impl<K: Ord + Clone, V: Clone + PartialEq> Sorted<K, V> {
    /// The keys whose values differ in `newer`, or that exist in only one of both, sorted. Skips memory that both
    /// share.
    pub fn differing(&self, newer: &Self) -> Vec<K> {
        if let (Form::Many(old), Form::Many(new)) = (&self.0, &newer.0) {
            let key = |item: DiffItem<'_, '_, K, V>| match item {
                DiffItem::Add(key, _)
                | DiffItem::Remove(key, _)
                | DiffItem::Update { new: (key, _), .. } => key.clone(),
            };
            return old.diff(new).map(key).collect();
        }
        if self.ptr_eq(newer) {
            return Vec::new();
        }
        let gone = self.keys().filter(|key| !newer.contains_key(key));
        let other = newer.iter().filter(|(key, value)| self.get(key) != Some(*value));
        let mut keys: Vec<K> = gone.chain(other.map(|(key, _)| key)).cloned().collect();
        keys.sort();
        keys
    }
}

impl<K: Ord + Clone, V: Clone + PartialEq> PartialEq for Sorted<K, V> {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Form::Many(a), Form::Many(b)) => a.len() == b.len() && a.diff(b).next().is_none(),
            _ => self.ptr_eq(other) || (self.len() == other.len() && self.iter().eq(other.iter())),
        }
    }
}

impl<K: Ord + Clone + fmt::Debug, V: Clone + fmt::Debug> fmt::Debug for Sorted<K, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter()).finish()
    }
}

impl<K: Ord + Clone, V: Clone> Extend<(K, V)> for Sorted<K, V> {
    fn extend<I: IntoIterator<Item = (K, V)>>(&mut self, entries: I) {
        for (key, value) in entries {
            self.insert(key, value);
        }
    }
}

impl<K: Ord + Clone, V: Clone> FromIterator<(K, V)> for Sorted<K, V> {
    fn from_iter<I: IntoIterator<Item = (K, V)>>(entries: I) -> Self {
        let mut map = Self::default();
        map.extend(entries);
        if let Form::Few(Some(entries)) = &mut map.0 {
            Arc::make_mut(entries).shrink_to_fit();
        }
        map
    }
}

#[cfg(test)]
mod tests {
    use super::Sorted;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        #[test]
        fn it_does_what_a_plain_map_does(steps in proptest::collection::vec((0..60u8, any::<bool>()), 0..200)) {
            let mut map = Sorted::new();
            let mut plain = BTreeMap::new();
            for (index, (key, insert)) in steps.into_iter().enumerate() {
                let before = map.clone();
                let had: Vec<_> = before.iter().map(|(k, v)| (*k, *v)).collect();
                if insert {
                    prop_assert_eq!(map.insert(key, index), plain.insert(key, index));
                } else {
                    prop_assert_eq!(map.remove(&key), plain.remove(&key));
                }
                prop_assert!(before.iter().map(|(k, v)| (*k, *v)).eq(had));
                prop_assert!(map.iter().eq(plain.iter()));
                prop_assert!(map.iter().rev().eq(plain.iter().rev()));
                prop_assert_eq!(map.len(), plain.len());
                prop_assert_eq!(map.get(&key), plain.get(&key));
                prop_assert_eq!(map.get_mut(&key), plain.get_mut(&key));
                prop_assert_eq!(&map, &plain.clone().into_iter().collect());
                let differs = before.get(&key) != map.get(&key);
                prop_assert_eq!(before.differing(&map), differs.then_some(key).into_iter().collect::<Vec<_>>());
                prop_assert_eq!(map.differing(&plain.clone().into_iter().collect()), Vec::new());
                prop_assert_eq!(Sorted::new().differing(&map), map.keys().copied().collect::<Vec<_>>());
                prop_assert_eq!(before == map, !differs);
            }
        }
    }
}
