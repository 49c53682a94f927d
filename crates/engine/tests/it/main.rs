//! Random machines, random results, random orders; pauses and stops at random moments.

#[path = "../../examples/simulate/machine.rs"]
mod machine;
#[path = "../../examples/simulate/random.rs"]
mod random;
#[path = "../../examples/simulate/world.rs"]
mod world;

use proptest::prelude::{ProptestConfig, any, prop_assert_eq, proptest};
use world::simulate;

#[test]
fn every_run_ends_and_keeps_its_promises() {
    for seed in 0..500 {
        simulate(seed).unwrap_or_else(|broken| panic!("{broken}"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_same_inputs_give_the_same_events(seed in any::<u64>()) {
        let first = simulate(seed);
        prop_assert_eq!(first.as_ref().err(), None);
        prop_assert_eq!(first, simulate(seed));
    }
}
