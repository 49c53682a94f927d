//! How much of a state is kept: what the run asks for, less what the state's semantic data gives up.

use rafcon_model::State;
use rafcon_protocol::Keeping;

/// The entry of the semantic data that says it.
const KEY: &str = "journal";

/// How much of `state` is kept, if that much is kept of the state around it (of the root: of the run).
///
/// A state cannot ask for more than the one around it. [`Keeping::Off`] leaves out its values and log lines; that it came and
/// went is kept all the same, for without it a run could not be taken up.
pub(crate) fn of(state: &State, around: Keeping) -> Keeping {
    around.min(asked(state).unwrap_or_default())
}

fn asked(state: &State) -> Option<Keeping> {
    match state.semantic_data.as_ref()?.get(KEY)?.as_str()? {
        "off" => Some(Keeping::Off),
        "status" => Some(Keeping::Status),
        "full" => Some(Keeping::Full),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::of;
    use expect_test::{Expect, expect};
    use rafcon_model::{Json, Kind, Script, State, StateId};
    use rafcon_protocol::Keeping;
    use std::sync::Arc;

    fn check(asked: &str, around: Keeping, expect: &Expect) {
        let mut state = State::new(StateId::new("A"), "a", Kind::Execution(Script::default()));
        let members = vec![("journal".into(), Json::Str(asked.into()))];
        state.semantic_data = Some(Arc::new(Json::Object(members)));
        expect.assert_eq(&format!("{:?}", of(&state, around)));
    }

    #[test]
    fn a_state_keeps_what_it_asks_for_but_not_more_than_the_one_around_it() {
        check("status", Keeping::Full, &expect!["Status"]);
        check("off", Keeping::Full, &expect!["Off"]);
        check("full", Keeping::Status, &expect!["Status"]);
        check("everything", Keeping::Full, &expect!["Full"]);
    }
}
