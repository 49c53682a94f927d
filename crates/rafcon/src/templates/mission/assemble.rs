//! Assembly at the base, with both arms in parallel. Knows when it is complete.

use super::draft::{Draft, Parts};
use super::scripts;
use rafcon_model::Value;

/// Puts the battery into the mug, and retries if it is crooked.
pub(super) fn assemble() -> Draft {
    let no = || Value::Bool(false);
    let realign = Draft::script("Realign", scripts::REALIGN).output("realigned", no());
    let test = Draft::script("Test it", scripts::TEST_ASSEMBLY).output("assembled", no());
    let parts = Parts::default()
        .variable("realigned", no())
        .child(both_arms())
        .child(realign)
        .child(test)
        .go("Both arms", "assembled", "Test it")
        .go("Both arms", "askew", "Realign")
        .go("Realign", "success", "Both arms")
        .end("Test it", "success", "assembled")
        .give("realigned", &["Both arms"])
        .take("Realign", "realigned")
        .take("Test it", "assembled");
    Draft::hierarchy("Assemble", parts).output("assembled", no()).outcomes(["assembled"])
}

fn both_arms() -> Draft {
    let (no, askew) = (|| Value::Bool(false), || Value::Float(90.0));
    let insert = Draft::script("Insert the battery", scripts::INSERT_BATTERY)
        .input("realigned", no())
        .output("askew_deg", askew());
    let decider = Draft::decider(scripts::DECIDE_ASSEMBLY)
        .input("askew_deg", askew())
        .outcomes(["assembled", "askew"]);
    let parts = Parts::default()
        .child(Draft::script("Hold the mug", scripts::HOLD_MUG))
        .child(insert)
        .child(decider)
        .give("realigned", &["Insert the battery"])
        .pass("askew_deg", "Insert the battery", "Decider")
        .end("Decider", "assembled", "assembled")
        .end("Decider", "askew", "askew");
    Draft::barrier("Both arms", parts)
        .about("The left arm holds, the right arm inserts.")
        .input("realigned", no())
        .outcomes(["assembled", "askew"])
}
