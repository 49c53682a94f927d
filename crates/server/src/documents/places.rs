//! Places that a step changed, and conflicts with later steps of others. Pure: knows only the inverse steps of the model's edits.

use rafcon_model::edit::{Edit, Field, Set, Step};
use rafcon_model::{DataFlowId, OutcomeId, PortId, PortKind, StateId, StatePath, TransitionId};
use std::fmt;

/// One place in a machine.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct MachinePlace {
    path: StatePath,
    part: StatePart,
}

/// A part of the state at the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum StatePart {
    /// The state with everything inside it.
    Whole,
    /// The contents that depend on its kind: children, script, connections inside.
    Inside,
    Id,
    Name,
    Description,
    SemanticData,
    Script,
    Layout,
    Extra,
    Outcome(OutcomeId),
    Port(PortKind, PortId),
    Transition(TransitionId),
    DataFlow(DataFlowId),
    RuntimeValue(PortKind, PortId),
    /// The machine as a whole.
    Header,
}

impl MachinePlace {
    /// Every place of a machine.
    pub(super) fn everything(root: &StateId) -> [Self; 2] {
        let path = StatePath::root(root.clone());
        [
            Self { path: path.clone(), part: StatePart::Whole },
            Self { path, part: StatePart::Header },
        ]
    }

    fn of(step: &Step) -> Self {
        let here = |part| Self { path: step.at.clone(), part };
        here(match &step.set {
            Set::Child(id, _) => {
                return Self { path: step.at.child(id.clone()), part: StatePart::Whole };
            }
            Set::Id(_) => StatePart::Id,
            Set::Kind(_) => StatePart::Inside,
            Set::Field(Field::Name(_)) => StatePart::Name,
            Set::Field(Field::Description(_)) => StatePart::Description,
            Set::Field(Field::SemanticData(_)) => StatePart::SemanticData,
            Set::Field(Field::Script(_)) => StatePart::Script,
            Set::Field(Field::Layout(_)) => StatePart::Layout,
            Set::Field(Field::Extra(_)) => StatePart::Extra,
            Set::Outcome(id, _) => StatePart::Outcome(*id),
            Set::Port(kind, id, _) => StatePart::Port(*kind, *id),
            Set::Transition(id, _) => StatePart::Transition(*id),
            Set::DataFlow(id, _) => StatePart::DataFlow(*id),
            Set::RuntimeValue(kind, id, _) => StatePart::RuntimeValue(*kind, *id),
            Set::Header(_) => StatePart::Header,
        })
    }

    /// True if both places are the layout of one state.
    pub(super) fn is_layout(&self, other: &Self) -> bool {
        self.part == StatePart::Layout && self == other
    }

    /// True if reverting this place would undo the change of a later step at `later`. Children of a state whose id changed move back
    /// with it.
    pub(super) fn is_built_upon(&self, later: &Self) -> bool {
        if self.part == StatePart::Header || later.part == StatePart::Header {
            return self.part == later.part;
        }
        let same = self.path == later.path;
        let (is_around, is_below) =
            (self.path.0.starts_with(&later.path.0), later.path.0.starts_with(&self.path.0));
        match (self.part, later.part) {
            (_, StatePart::Whole | StatePart::Id) if is_around => true,
            (StatePart::Whole, _) if is_below => true,
            (mine, StatePart::Inside) if is_around => !same || mine.is_inside(),
            (StatePart::Inside, other) if is_below => !same || other.is_inside(),
            (mine, other) => same && mine == other,
        }
    }
}

impl StatePart {
    /// True if a change of the state's kind removes this part.
    fn is_inside(self) -> bool {
        match self {
            Self::Whole
            | Self::Inside
            | Self::Script
            | Self::Layout
            | Self::Transition(_)
            | Self::DataFlow(_)
            | Self::RuntimeValue(..)
            | Self::Port(PortKind::ScopedVariable, _) => true,
            Self::Id
            | Self::Name
            | Self::Description
            | Self::SemanticData
            | Self::Extra
            | Self::Outcome(_)
            | Self::Port(PortKind::Input | PortKind::Output, _)
            | Self::Header => false,
        }
    }
}

impl fmt::Display for MachinePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, part } = self;
        match part {
            StatePart::Whole => write!(f, "{path}"),
            StatePart::Inside => write!(f, "the kind of {path}"),
            StatePart::Id => write!(f, "the id of {path}"),
            StatePart::Name => write!(f, "the name of {path}"),
            StatePart::Description => write!(f, "the description of {path}"),
            StatePart::SemanticData => write!(f, "the semantic data of {path}"),
            StatePart::Script => write!(f, "the script of {path}"),
            StatePart::Layout => write!(f, "the layout of {path}"),
            StatePart::Extra => write!(f, "the unknown keys of {path}"),
            StatePart::Outcome(id) => write!(f, "outcome {id} of {path}"),
            StatePart::Port(kind, id) => write!(f, "{kind} {id} of {path}"),
            StatePart::Transition(id) => write!(f, "transition {id} in {path}"),
            StatePart::DataFlow(id) => write!(f, "data flow {id} in {path}"),
            StatePart::RuntimeValue(kind, id) => write!(f, "the value for {kind} {id} of {path}"),
            StatePart::Header => write!(f, "the machine's header"),
        }
    }
}

/// The places that an edit changed, according to its inverse.
pub(super) fn places(back: &Edit) -> Vec<MachinePlace> {
    let Edit::Restore(restore) = back else { return Vec::new() };
    let mut places: Vec<MachinePlace> = restore.steps.iter().map(MachinePlace::of).collect();
    places.sort();
    places.dedup();
    places
}

#[cfg(test)]
mod tests {
    use super::places;
    use expect_test::{Expect, expect};
    use rafcon_model::edit::{ChildrenEdit, Edit, StateEdit, apply};
    use rafcon_model::{BuiltinTypes, KindName, StateId, StatePath};
    use rafcon_testkit::notation;

    const MACHINE: &str = "
        hierarchy ROOT
          outcome success
          start -> A
          A.success -> .success
          hierarchy A
            outcome success
            execution B
        ";

    fn state(path: &str, edit: StateEdit) -> Edit {
        Edit::State(StatePath::parse(path), edit)
    }

    fn remove(path: &str, id: &str) -> Edit {
        Edit::Children(StatePath::parse(path), ChildrenEdit::Remove(StateId::new(id)))
    }

    fn name(path: &str) -> Edit {
        state(path, StateEdit::SetName("New".into()))
    }

    /// Prints the places that the first edit changes, each with the places of the second that build upon it.
    fn check(first: Edit, second: Edit, expect: &Expect) {
        let mut machine = notation::parse(MACHINE).expect("a machine");
        let mut changed =
            |edit| places(&apply(&mut machine, edit, &BuiltinTypes).expect("applied"));
        let (first, second) = (changed(first), changed(second));
        let line = |place: &super::MachinePlace| {
            let upon = second.iter().filter(|later| place.is_built_upon(later));
            let upon: Vec<_> = upon.map(ToString::to_string).collect();
            format!("{place} <- {}\n", upon.join(", "))
        };
        expect.assert_eq(&first.iter().map(line).collect::<String>());
    }

    #[test]
    fn what_changes_the_same_is_built_upon() {
        check(
            name("ROOT/A"),
            name("ROOT/A"),
            &expect![[r"
            the name of ROOT/A <- the name of ROOT/A
        "]],
        );
        check(
            name("ROOT/A"),
            name("ROOT/A/B"),
            &expect![[r"
            the name of ROOT/A <- 
        "]],
        );
        check(
            name("ROOT/A/B"),
            remove("ROOT", "A"),
            &expect![[r"
            the name of ROOT/A/B <- ROOT/A
        "]],
        );
        check(
            name("ROOT/A"),
            state("ROOT/A", StateEdit::SetKind(KindName::Execution)),
            &expect![[r"
            the name of ROOT/A <- 
        "]],
        );
        check(
            name("ROOT/A/B"),
            state("ROOT/A", StateEdit::SetKind(KindName::Execution)),
            &expect![[r"
                the name of ROOT/A/B <- the kind of ROOT/A
            "]],
        );
        check(
            state("ROOT/A", StateEdit::SetKind(KindName::Barrier)),
            name("ROOT/A/B"),
            &expect![[r"
            the kind of ROOT/A <- the name of ROOT/A/B
        "]],
        );
        check(
            name("ROOT/A"),
            state("ROOT/A", StateEdit::SetId("C".into())),
            &expect![[r"
            the name of ROOT/A <- 
        "]],
        );
    }

    #[test]
    fn what_moves_along_is_not() {
        let rename = state("ROOT/A", StateEdit::SetId("C".into()));
        check(
            rename.clone(),
            name("ROOT/C"),
            &expect![[r"
            the id of ROOT/C <- 
        "]],
        );
        check(
            rename,
            remove("ROOT", "C"),
            &expect![[r"
            the id of ROOT/C <- ROOT/C
        "]],
        );
    }
}
