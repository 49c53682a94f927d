//! Lifetimes of requests to a robot: until their own expiry, or the default over the link, counted from the next contact.

use super::viewers::PendingRequest;
use rafcon_protocol::{ContactPlan, Expiry, wait_for_contact};
use std::time::Duration;

/// Lifetime of a stop: it is sent until the robot has it.
const STOP_LIFETIME: Duration = Duration::from_hours(24);

/// Lifetime of a request that is given at `now_ms`; `usual` is the default over this link. The error is the reason for a refusal: the
/// request would expire before it can be sent.
pub(super) fn lifetime(
    given: &PendingRequest,
    plan: &ContactPlan,
    now_ms: u64,
    usual: Duration,
) -> Result<Duration, String> {
    let until = |ms: u64| Duration::from_millis(ms.saturating_sub(now_ms));
    let begin_ms = plan.next_begin(now_ms).filter(|_| given.is_for_contact());
    let until_contact = begin_ms.map_or(0, |begin_ms| wait_for_contact(now_ms, begin_ms));
    let until_contact = Duration::from_millis(until_contact);
    match given.expiry {
        Some(Expiry(expiry_ms)) => {
            if begin_ms.is_some() {
                plan.check_expiry(now_ms, expiry_ms)?;
            }
            Ok(until(expiry_ms))
        }
        None if given.is_lasting => Ok(until_contact + STOP_LIFETIME),
        None => {
            // The clocks drift until its time, too.
            let wait = given.not_before.map_or(0, |at_ms| wait_for_contact(now_ms, at_ms));
            Ok(until_contact.max(Duration::from_millis(wait)) + usual)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::lifetime;
    use crate::station::viewers::PendingRequest;
    use crate::words::StationRequest;
    use expect_test::{Expect, expect};
    use rafcon_protocol::{Command, ContactPlan, Expiry};
    use std::time::Duration;

    /// A contact from 100 s to 200 s.
    const PLAN: &str =
        r#"[{"begin": "1970-01-01T00:01:40Z", "end": "1970-01-01T00:03:20Z", "profile": "deep"}]"#;

    /// Lifetimes of requests that are given before, in and after the contact, with 20 s as the usual one.
    fn check(change: impl Fn(PendingRequest) -> PendingRequest, expect: &Expect) {
        let plan = ContactPlan::of_text(PLAN).unwrap();
        let said = [40, 150, 250].map(|now_s| {
            let word = StationRequest::Command(String::new(), String::new(), None, Command::Pause);
            let given = change(PendingRequest::soon("ana/1".to_owned(), word));
            match lifetime(&given, &plan, now_s * 1_000, Duration::from_secs(20)) {
                Ok(valid) => format!("at {now_s} s: {} s\n", valid.as_secs()),
                Err(reason) => format!("at {now_s} s: {reason}\n"),
            }
        });
        expect.assert_eq(&said.concat());
    }

    #[test]
    fn a_lifetime_counts_from_the_next_contact() {
        check(
            |given| given,
            &expect![[r"
                at 40 s: 80 s
                at 150 s: 20 s
                at 250 s: 20 s
            "]],
        );
        check(
            |given| PendingRequest { not_before: Some(120_000), ..given },
            &expect![[r"
                at 40 s: 100 s
                at 150 s: 20 s
                at 250 s: 20 s
            "]],
        );
        check(
            |given| PendingRequest { is_lasting: true, ..given },
            &expect![[r"
                at 40 s: 86460 s
                at 150 s: 86400 s
                at 250 s: 86400 s
            "]],
        );
    }

    /// A year passes until the contact. The link shortens the lifetime by the drift, and the robot's clock is fast.
    #[test]
    fn a_command_does_not_expire_while_the_clocks_drift_until_the_contact() {
        let plan = ContactPlan::of_text(PLAN.replace("1970", "1971").as_str()).unwrap();
        let wait = Duration::from_millis(plan.next_begin(0).unwrap());
        let word = StationRequest::Command(String::new(), String::new(), None, Command::Pause);
        let given = PendingRequest::soon("ana/1".to_owned(), word);
        let usual = Duration::from_secs(20);
        let valid = lifetime(&given, &plan, 0, usual).unwrap();
        let drift = |time: Duration| time / 5_000;
        let lost = drift(valid) + drift(wait);
        assert!(valid + Duration::from_secs(3) > wait + usual + lost, "{valid:?}");
    }

    /// The link adds the drift to the wait and takes it from the lifetime.
    #[test]
    fn a_command_for_later_does_not_expire_before_its_time_however_long_it_waits() {
        let plan = ContactPlan::default();
        let word = StationRequest::Command(String::new(), String::new(), None, Command::Pause);
        let soon = PendingRequest::soon("ana/1".to_owned(), word);
        let wait = Duration::from_hours(24 * 30);
        let not_before = u64::try_from(wait.as_millis()).ok();
        let given = PendingRequest { not_before, ..soon };
        let usual = Duration::from_secs(20);
        let valid = lifetime(&given, &plan, 0, usual).unwrap();
        let drift = |time: Duration| time / 5_000;
        let lost = drift(valid) + drift(wait);
        assert!(valid + Duration::from_secs(1) > wait + usual + lost, "{valid:?}");
    }

    #[test]
    fn an_expiry_of_the_user_counts_unless_it_is_before_the_next_contact() {
        check(
            |given| PendingRequest { expiry: Some(Expiry(260_000)), ..given },
            &expect![[r"
                at 40 s: 220 s
                at 150 s: 110 s
                at 250 s: 10 s
            "]],
        );
        check(
            |given| PendingRequest { expiry: Some(Expiry(90_000)), ..given },
            &expect![[r"
                at 40 s: the command would expire at 1970-01-01T00:01:30Z, and the next contact begins at 1970-01-01T00:01:40Z: let it expire later than that, or change the contacts
                at 150 s: 0 s
                at 250 s: 0 s
            "]],
        );
    }

    #[test]
    fn a_note_that_a_user_is_there_does_not_wait_for_a_contact() {
        check(
            |given| PendingRequest { word: StationRequest::Present("ana".to_owned()), ..given },
            &expect![[r"
                at 40 s: 20 s
                at 150 s: 20 s
                at 250 s: 20 s
            "]],
        );
    }
}
