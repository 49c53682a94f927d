//! An empty hierarchy with one outcome. Knows the model only.

use super::{Template, TemplateRequest};
use rafcon_model::{Container, Kind, Outcome, OutcomeId, State, StateId};

pub(super) const TEMPLATE: Template = Template {
    name: "empty",
    about: "a hierarchy without states",
    sized: false,
    libraries: &[],
    build: |wish| Ok(root(wish)),
};

/// The root alone. It has no start state, so a run of it waits.
pub(super) fn root(wish: &TemplateRequest) -> State {
    let kind = Kind::Hierarchy(Container::default());
    let mut root = State::new(StateId::new("ROOTED"), &wish.name, kind);
    root.outcomes.insert(Outcome::new(OutcomeId(0), "success"));
    root
}
