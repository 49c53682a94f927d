//! Names of things inside a machine: state ids, element ids, paths.

use smol_str::SmolStr;
use std::fmt;

/// The id of a barrier's decider, fixed by the file format.
pub const DECIDER_ID: &str = "unique_decider_state_id";

/// The id of a state: unique among its siblings and different from its parent's. A new id has six upper-case letters.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StateId(pub SmolStr);

impl StateId {
    /// An id with this text.
    pub fn new(text: impl AsRef<str>) -> Self {
        Self(SmolStr::new(text))
    }

    /// The text of the id.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// True for the decider of a barrier.
    pub fn is_decider(&self) -> bool {
        self.0 == DECIDER_ID
    }
}

impl From<&str> for StateId {
    fn from(text: &str) -> Self {
        Self::new(text)
    }
}

impl fmt::Display for StateId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The smallest free number from 0 on.
pub(crate) fn smallest_free(taken: impl Fn(i64) -> bool) -> i64 {
    (0..i64::MAX).find(|id| !taken(*id)).unwrap_or_default()
}

/// The id after `last`, 1 at first; `None` after the largest id.
pub(crate) fn id_after(last: Option<i64>) -> Option<i64> {
    const END: i64 = i64::MAX - (1 << 32);
    let next = last.map_or(1, |last| last.saturating_add(1).max(1));
    (next < END).then_some(next)
}

/// Free ids: those after `last`, or the gaps from 1 on if there are none after it.
pub(crate) fn free_ids(
    last: Option<i64>,
    taken: impl Fn(i64) -> bool,
) -> impl Iterator<Item = i64> {
    (id_after(last).unwrap_or(1)..i64::MAX).filter(move |id| !taken(*id))
}

macro_rules! number_id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub i64);

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

number_id! {
    /// The id of an outcome of a state; 0 and up for the user's, -1 aborted, -2 preempted.
    OutcomeId
}
number_id! {
    /// The id of a data port or scoped variable: unique over inputs, outputs and scoped variables of its state.
    PortId
}
number_id! {
    /// The id of a transition in its container.
    TransitionId
}
number_id! {
    /// The id of a data flow in its container.
    DataFlowId
}

impl OutcomeId {
    /// Every state has this outcome: an error ended it.
    pub const ABORTED: Self = Self(-1);
    /// Every state has this outcome: it was preempted.
    pub const PREEMPTED: Self = Self(-2);

    /// True for *aborted* and *preempted*, which every state has.
    pub fn is_mandatory(self) -> bool {
        self == Self::ABORTED || self == Self::PREEMPTED
    }
}

/// Makes state ids of six upper-case letters. Equal seeds give equal ids, so that the caller controls randomness.
#[derive(Debug, Clone)]
pub struct Fresh(u64);

impl Fresh {
    /// A generator whose ids depend on `seed` only.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next id for which `taken` is false.
    pub fn id(&mut self, taken: impl Fn(&StateId) -> bool) -> StateId {
        loop {
            let id = self.letters();
            if !taken(&id) {
                return id;
            }
        }
    }

    fn letters(&mut self) -> StateId {
        let mut number = self.number();
        let mut letter = || {
            let letter = char::from(b'A' + u8::try_from(number % 26).unwrap_or(0));
            number /= 26;
            letter
        };
        StateId((0..6).map(|_| letter()).collect())
    }

    /// The next number of the generator known as `SplitMix64`.
    fn number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }
}

/// The path of a state: ids from the root down. Inside a library, the library state's id is followed by the id of the
/// library's root state.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct StatePath(pub Vec<StateId>);

impl StatePath {
    /// The path of a root state.
    pub fn root(id: StateId) -> Self {
        Self(vec![id])
    }

    /// This path with one more id.
    #[must_use]
    pub fn child(&self, id: StateId) -> Self {
        let mut ids = Vec::with_capacity(self.0.len() + 1);
        ids.extend_from_slice(&self.0);
        ids.push(id);
        Self(ids)
    }

    /// The path without its last id; `None` for a root (or empty) path.
    pub fn parent(&self) -> Option<Self> {
        match self.0.len() {
            0 | 1 => None,
            n => Some(Self(self.0[..n - 1].to_vec())),
        }
    }

    /// The id of the state itself.
    pub fn last(&self) -> Option<&StateId> {
        self.0.last()
    }

    /// Reads `A/B/C`. Empty parts are dropped.
    pub fn parse(text: &str) -> Self {
        Self(text.split('/').filter(|part| !part.is_empty()).map(StateId::new).collect())
    }
}

impl fmt::Display for StatePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, id) in self.0.iter().enumerate() {
            if index > 0 {
                f.write_str("/")?;
            }
            f.write_str(id.as_str())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Fresh;

    #[test]
    fn fresh_ids_follow_the_seed_and_skip_what_is_taken() {
        let (mut one, mut two) = (Fresh::new(1), Fresh::new(1));
        let first = one.id(|_| false);
        assert_eq!(first.as_str().len(), 6);
        assert!(first.as_str().bytes().all(|b| b.is_ascii_uppercase()));
        assert_ne!(two.id(|id| *id == first), first);
        assert_ne!(Fresh::new(2).id(|_| false), first);
    }
}
