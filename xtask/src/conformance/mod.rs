//! Conformance: runs machines in both engines, and compares everything that a user can see.
//!
//! The reference runs live. For the machines that it ships, there are also recorded runs. A difference is a defect unless
//! `tests/conformance/expectations.json` names the heading of `docs/differences.md` that explains it.

mod case;
mod compare;
mod expectations;
mod observed;
mod ours;
mod stepping;
mod table;

use std::num::NonZeroUsize;
use std::thread;

use anyhow::{Result, bail};

use crate::process;
use crate::product::{Product, Profile};
use crate::reference::Reference;

use case::Case;
use compare::Difference;
use expectations::Expectations;
use observed::Observed;
use table::Row;

/// Options of `cargo xtask conformance`.
#[derive(clap::Args, Default)]
pub(crate) struct ConformanceOptions {
    /// Only the machines whose name contains this text.
    #[arg(long)]
    machine: Option<String>,
    /// Run only the reference, and print its results as one JSON object a line.
    #[arg(long)]
    reference_only: bool,
    /// Use an earlier build.
    #[arg(long)]
    no_build: bool,
}

impl ConformanceOptions {
    /// All machines, with an earlier build.
    pub(crate) fn without_build() -> Self {
        Self { no_build: true, ..Self::default() }
    }
}

/// Runs the machines and prints the table; fails on a difference without an explanation.
pub(crate) fn run(options: &ConformanceOptions) -> Result<()> {
    let reference = Reference::installed()?;
    case::check_generated()?;
    let expectations = Expectations::read()?;
    let cases = case::all(&reference, &expectations)?;
    let wanted = |case: &&Case| {
        options.machine.as_ref().is_none_or(|part| case.name.contains(part.as_str()))
    };
    let cases = cases.iter().filter(wanted);
    if options.reference_only {
        for case in cases {
            println!("{}", observed::reference(&reference, case)?);
        }
        return Ok(());
    }
    let product = if options.no_build {
        Product::built(Profile::Debug)?
    } else {
        Product::build(Profile::Debug)?
    };
    let cases = cases.collect::<Vec<_>>();
    let at_once = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let mut rows = process::side_by_side(&cases, at_once, |case| row(&reference, &product, case));
    rows.extend(stepping::rows(&reference, &product, options.machine.as_deref()));
    println!("{}", table::render(&rows));
    let unexplained = rows.iter().filter(|row| row.is_failure()).count();
    if unexplained > 0 {
        bail!(
            "{unexplained} of {} machines differ from the reference without an explanation",
            rows.len()
        );
    }
    Ok(())
}

/// Runs one machine in both engines. An error on the way counts as a difference.
fn row(reference: &Reference, product: &Product, case: &Case) -> Row {
    if let Some(reason) = &case.expected.skip {
        return Row::skipped(&case.name, reason);
    }
    match differences(reference, product, case) {
        Ok(differences) => Row::compared(&case.name, &differences, &case.expected),
        Err(reason) => Row::failed(&case.name, &reason),
    }
}

fn differences(reference: &Reference, product: &Product, case: &Case) -> Result<Vec<Difference>> {
    let theirs = Observed::of_reference(&observed::reference(reference, case)?)?;
    let ours = ours::run(product, reference, case)?;
    let mut differences = compare::all(&theirs, &ours, &case.expected);
    if let Some(recorded) = observed::recorded(&case.name)? {
        differences.extend(compare::recorded(&recorded, &ours, &theirs));
    }
    Ok(differences)
}
