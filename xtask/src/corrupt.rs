//! Files of runs, damaged by the thousand: what is read of them is true, or it is said that it cannot be read
//! (`crates/storage/src/journal/tests/corrupt.rs` and `crates/rafcon/tests/it/corrupt.rs`, in the long form).

use crate::process;
use crate::product::{Product, Profile};
use crate::torture::long_form;
use anyhow::Result;

/// What `cargo xtask corrupt` can be asked for.
#[derive(clap::Args)]
pub(crate) struct CorruptOptions {
    /// How many runs are damaged, for the readers as such and for the commands each.
    #[arg(long, default_value_t = 1000)]
    runs: u32,
    /// The first seed; one that failed, to repeat it. Else the day's date.
    #[arg(long)]
    from: Option<u64>,
}

/// Damages and reads; the first failure ends it and names its seed.
pub(crate) fn run(options: &CorruptOptions) -> Result<()> {
    Product::build(Profile::Release)?;
    let mut readers = process::cargo();
    readers.args(["test", "--release", "-q", "-p", "rafcon-storage", "--lib"]);
    readers.arg("journal::tests::corrupt::what_is_read_of_a_corrupted_journal_is_true");
    readers.args(["--", "--exact", "--nocapture"]);
    let commands = long_form("corrupt::what_is_told_of_a_damaged_run_is_true");
    for mut test in [readers, commands] {
        test.env("RAFCON_TEST_CORRUPTIONS", options.runs.to_string());
        if let Some(from) = options.from {
            test.env("RAFCON_TEST_SEED", from.to_string());
        }
        process::run(&mut test)?;
    }
    println!("{runs} of {runs} damaged runs passed, twice", runs = options.runs);
    Ok(())
}
