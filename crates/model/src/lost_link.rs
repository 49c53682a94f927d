//! The policy of a state for a lost link, from its semantic data (`docs/semantics.md`, Lost link).
//! Knows how that is written; knows nothing of a clock.

use crate::{Json, State};

/// A year is as good as for ever, and fits every clock.
const SECONDS_MAX: f64 = 365.0 * 86_400.0;

/// The silence that the policy measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Loss {
    /// The time since the last contact with the ground.
    Link,
    /// The time since someone gave a command.
    Command,
}

impl Loss {
    /// Both kinds, the link first.
    pub const ALL: [Self; 2] = [Self::Link, Self::Command];

    /// The entry of the semantic data with the policy.
    pub fn key(self) -> &'static str {
        match self {
            Self::Link => "lost_link",
            Self::Command => "lost_command",
        }
    }
}

/// Actions on a state and its descendants, with their delays in ms. Without any of them the state continues, whatever the policy of
/// the state around it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LossPolicy {
    /// The state ends, then its branch is paused.
    pub finish_ms: Option<u64>,
    /// No state in it begins: each branch is paused before the next one.
    pub hold_ms: Option<u64>,
    /// The state is preempted: its outcome *preempted* leads to what recovers.
    pub recover_ms: Option<u64>,
}

impl LossPolicy {
    /// The policy that a state has of its own; those of other states count for it otherwise. One that is not understood is none.
    pub fn of(state: &State, loss: Loss) -> Option<Self> {
        Self::read(entry(state, loss)?)
    }

    /// True if a state has an invalid policy.
    pub(crate) fn is_unclear(state: &State, loss: Loss) -> bool {
        entry(state, loss).is_some_and(|json| Self::read(json).is_none())
    }

    fn read(json: &Json) -> Option<Self> {
        if json.as_str().is_some_and(|text| text.trim() == "continue") {
            return Some(Self::default());
        }
        let entries = json.as_object().filter(|entries| !entries.is_empty())?;
        let mut policy = Self::default();
        for (key, value) in entries {
            let time = match key.as_str() {
                "finish_s" => &mut policy.finish_ms,
                "hold_s" => &mut policy.hold_ms,
                "recover_s" => &mut policy.recover_ms,
                _ => return None,
            };
            *time = Some(seconds_as_ms(value)?);
        }
        Some(policy)
    }

    /// The times after which something happens, in ms.
    pub fn times(self) -> impl Iterator<Item = u64> {
        [self.finish_ms, self.hold_ms, self.recover_ms].into_iter().flatten()
    }
}

fn entry(state: &State, loss: Loss) -> Option<&Json> {
    state.semantic_data.as_ref()?.get(loss.key())
}

/// Seconds of semantic data as ms: a number between 0 and a year, or a text that is one, as the reference's editor writes it.
pub fn seconds_as_ms(json: &Json) -> Option<u64> {
    let number = match json {
        Json::Str(text) => text.trim().parse().ok()?,
        other => other.as_number()?,
    };
    let sensible = (0.0..=SECONDS_MAX).contains(&number);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it is between nothing and a year"
    )]
    sensible.then_some((number * 1000.0).round() as u64)
}

#[cfg(test)]
mod tests {
    use super::LossPolicy;
    use crate::json;
    use expect_test::{Expect, expect};

    fn check(policy: &str, expect: &Expect) {
        let read = LossPolicy::read(&json::parse(policy).unwrap());
        let said = read.map(|policy| {
            let LossPolicy { finish_ms, hold_ms, recover_ms } = policy;
            format!("finish {finish_ms:?} hold {hold_ms:?} recover {recover_ms:?}")
        });
        expect.assert_eq(&said.unwrap_or_else(|| "not understood".to_owned()));
    }

    #[test]
    fn a_policy_says_what_happens_after_how_many_seconds() {
        check(r#""continue""#, &expect!["finish None hold None recover None"]);
        check(r#"{"hold_s": 30}"#, &expect!["finish None hold Some(30000) recover None"]);
        check(
            r#"{"finish_s": "0.5", "hold_s": 600, "recover_s": 3600.0}"#,
            &expect!["finish Some(500) hold Some(600000) recover Some(3600000)"],
        );
        check(
            r#"{"hold_s": 31536000}"#,
            &expect!["finish None hold Some(31536000000) recover None"],
        );
    }

    #[test]
    fn what_is_no_policy_is_not_half_understood() {
        for nonsense in [
            r"{}",
            r"30",
            r"null",
            r#""hold""#,
            r#"{"hold_s": "soon"}"#,
            r#"{"hold_s": -1}"#,
            r#"{"hold_s": 31536001}"#,
            r#"{"hold_s": 1e300}"#,
            r#"{"hold_s": 30, "wait_s": 30}"#,
        ] {
            check(nonsense, &expect!["not understood"]);
        }
    }
}
