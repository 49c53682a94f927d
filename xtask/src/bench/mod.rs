//! Figures of speed and memory, compared with our bars and with the reference in one run.

mod figures;
mod journal;
pub(crate) mod library;
mod link;
mod whole_process;

use anyhow::{Context as _, Result, bail};
use serde_json::json;

use figures::{ALL, Bar, Figure};

/// Options of `cargo xtask bench`.
#[derive(clap::Args)]
pub(crate) struct BenchOptions {
    /// Print one JSON object a line instead of a table.
    #[arg(long)]
    json: bool,
    /// Measure only this part.
    #[arg(long, value_enum)]
    only: Option<BenchPart>,
}

/// Place of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum BenchPart {
    /// `rafcon run` and the reference
    WholeProcess,
    /// Inside one program, by `cargo bench`
    Library,
    /// Clients of `rafcon serve`
    Server,
}

/// A measured value with the name of its figure.
type Measured = (String, f64);

/// Measures and prints. Fails if a figure with a bar could not be measured, not if it misses its bar.
pub(crate) fn run(options: &BenchOptions) -> Result<()> {
    let mut measured = Vec::new();
    let wanted = |part| options.only.is_none_or(|only| only == part);
    if wanted(BenchPart::Library) {
        measured.extend(library::measure()?);
    }
    if wanted(BenchPart::Server) {
        measured.extend(library::measure_server()?);
    }
    if wanted(BenchPart::WholeProcess) {
        measured.extend(whole_process::measure()?);
    }
    for figure in ALL {
        match measured.iter().find(|(name, _)| name == figure.name) {
            Some((_, value)) if options.json => println!("{}", line(&figure, *value)),
            Some((_, value)) => println!("{}", row(&figure, *value)),
            None if options.only.is_none() => bail!("nothing measured {}", figure.name),
            None => {}
        }
    }
    Ok(())
}

fn line(figure: &Figure, value: f64) -> serde_json::Value {
    json!({ "name": figure.name, "value": value, "unit": figure.unit })
}

fn row(figure: &Figure, value: f64) -> String {
    let (sign, bar) = match figure.bar {
        Bar::AtLeast(bar) => ('≥', bar),
        Bar::AtMost(bar) => ('≤', bar),
    };
    let verdict = if figure.bar.is_kept(value) { "pass" } else { "MISS" };
    let (value, bar) = (number(value), number(bar));
    format!(
        "{verdict}  {:26}  {value:>10}  {sign} {bar:>9} {:9} {}",
        figure.name, figure.unit, figure.meaning
    )
}

/// Rounds for display, with fewer decimals for larger values.
fn number(value: f64) -> String {
    if value >= 1000.0 {
        format!("{value:.0}")
    } else if value >= 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.3}")
    }
}

/// The median, with the name of the figure.
fn middle(name: &str, values: Vec<f64>) -> Result<Measured> {
    let value = figures::median(values).with_context(|| format!("no values for {name}"))?;
    Ok((name.to_owned(), value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_whether_the_promise_is_kept() {
        let figure = ALL.iter().find(|figure| figure.name == "preempt_ms").unwrap();
        assert!(row(figure, 0.25).starts_with("pass  preempt_ms "));
        assert!(row(figure, 2.5).starts_with("MISS  preempt_ms "));
    }
}
