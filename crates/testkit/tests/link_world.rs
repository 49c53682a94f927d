//! A few worlds with a bad link; many more with `cargo xtask spacebotcamp`.

use rafcon_testkit::link_world::{Scenario, run};
use std::time::{SystemTime, UNIX_EPOCH};

/// Other worlds every day.
#[expect(clippy::disallowed_methods, reason = "the day's date is the seed")]
fn first_seed() -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).expect("a clock after 1970");
    now.as_secs() / 86_400 * 1_000
}

#[test]
fn nothing_is_lost_late_or_done_twice_while_servers_die() {
    for seed in [9].into_iter().chain(first_seed()..first_seed() + 3) {
        let measures = run(seed, Scenario::Kills).expect("all promises are kept");
        assert!(measures.kills > 20 && measures.commands > 50, "seed {seed} was too quiet");
    }
}

#[test]
fn an_hour_over_a_bad_link_is_complete_on_the_ground() {
    let measures = run(first_seed(), Scenario::SpaceBotCamp).expect("all promises are kept");
    assert!(measures.events > 5_000 && measures.commands > 20, "the hour was too quiet");
}

#[test]
fn a_seed_has_one_world() {
    assert_eq!(run(9, Scenario::Kills), run(9, Scenario::Kills));
}
