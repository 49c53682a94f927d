//! Random machines with random results, commands and edits, in random orders.

use proptest::prelude::{ProptestConfig, any, prop_assert_eq, proptest};
use rafcon_testkit::simulation::{Counts, Width, simulate};

/// Number of runs in one test.
const SEEDS: u64 = 300;
/// Number of runs in which every kind of event occurs more than `RARE / 100` times.
const SEEDS_OF_ALL_KINDS: u64 = 1000;
/// Argument of [`Counts::rare`]: a kind of event is rare if it occurs at most `RARE / 100` times.
const RARE: u64 = 300;
/// Environment variable with the first seed of the day's new runs.
const FROM: &str = "RAFCON_SEEDS_FROM";

#[test]
fn every_run_ends_and_keeps_its_promises() {
    let mut counts = Counts::default();
    for seed in 0..SEEDS_OF_ALL_KINDS {
        let report = simulate(seed, Width::Wide).unwrap_or_else(|broken| panic!("{broken}"));
        counts.add(&report.counts);
    }
    assert_eq!(counts.rare(RARE), Vec::<&str>::new(), "\n{counts}");
}

/// Seeds change each day, so that the tests cover new machines. A failure prints how to repeat it.
#[test]
fn seeds_of_the_day_keep_their_promises() {
    let from = first_seed().unwrap_or_else(|| today() * 1_000_000);
    for seed in from..from + SEEDS {
        simulate(seed, Width::Wide).unwrap_or_else(|broken| {
            panic!("{broken}\nto repeat: cargo xtask simulate --seeds 1 --from {seed}, or this test with {FROM}={seed}")
        });
    }
}

#[expect(clippy::disallowed_methods, reason = "a failure of the day is repeated by its seed")]
fn first_seed() -> Option<u64> {
    std::env::var(FROM).ok()?.parse().ok()
}

/// The date as a number, such as 20261231.
#[expect(clippy::disallowed_methods, clippy::disallowed_types, reason = "only chooses seeds")]
fn today() -> u64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    date(since.map_or(0, |since| since.as_secs() / 86_400))
}

/// The date this many days after 1970-01-01 (the algorithm for civil days by Howard Hinnant).
fn date(days: u64) -> u64 {
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    (era * 400 + year + next) * 10_000 + month * 100 + day
}

#[test]
fn days_have_dates() {
    let dates = [0, 58, 59, 11_016, 20_453, 20_779].map(date);
    assert_eq!(dates, [19_700_101, 19_700_228, 19_700_301, 20_000_229, 20_251_231, 20_261_122]);
}

/// Seeds that once broke a promise, in the first version of the simulation.
const BROKEN_ONCE: [u64; 11] = [
    11_386,
    15_733,
    35_552,
    38_432,
    40_260,
    52_743,
    80_404,
    8_123_403_619,
    8_123_421_613,
    8_123_431_539,
    8_123_457_698,
];

#[test]
fn seeds_that_failed_once_pass() {
    for seed in BROKEN_ONCE {
        simulate(seed, Width::First).unwrap_or_else(|broken| panic!("{broken}"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_same_inputs_give_the_same_events(seed in any::<u64>()) {
        let first = simulate(seed, Width::Wide);
        prop_assert_eq!(first.as_ref().err(), None);
        prop_assert_eq!(first, simulate(seed, Width::Wide));
    }
}
