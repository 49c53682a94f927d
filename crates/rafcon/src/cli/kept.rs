//! The commands that read recorded runs.

use super::{KeptRemote, Remote, Runs};
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use rafcon_storage::journal::KINDS;
use std::path::PathBuf;
use std::time::Duration;

/// One recorded run.
#[derive(Debug, Args)]
pub(crate) struct KeptRun {
    /// The run: its id or the start of the id, its folder, or `last`
    pub(crate) run: String,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) remote: KeptRemote,
}

/// List the runs, the newest last; or delete old ones.
#[derive(Debug, Args)]
pub(crate) struct ListRuns {
    #[command(flatten)]
    pub(crate) runs: Runs,
    /// One JSON object per line
    #[arg(long)]
    pub(crate) json: bool,
    /// Delete old runs, but never an active run or one of the 10 newest
    #[arg(long)]
    pub(crate) prune: bool,
    /// Keep this number of runs
    #[arg(long, value_name = "NUMBER", requires = "prune")]
    pub(crate) keep: Option<usize>,
    /// Keep the runs up to this age, such as `12h` or `30d`
    #[arg(long, value_name = "AGE", requires = "prune", value_parser = age)]
    pub(crate) max_age: Option<Duration>,
    /// Keep this size in total, such as `500M` or `20G`
    #[arg(long, value_name = "SIZE", requires = "prune", value_parser = size)]
    pub(crate) max_size: Option<u64>,
    #[command(flatten)]
    pub(crate) remote: Remote,
}

/// Print what happened in a run, event by event.
#[derive(Debug, Args)]
pub(crate) struct History {
    #[command(flatten)]
    pub(crate) run: KeptRun,
    /// Only states with this text in their path of names or ids; `*` matches any text, `?` any character
    #[arg(long, value_name = "STATE")]
    pub(crate) state: Option<String>,
    /// Only ends with this outcome, by name or id
    #[arg(long, allow_hyphen_values = true)]
    pub(crate) outcome: Option<String>,
    /// Only events that contain this text
    #[arg(long)]
    pub(crate) text: Option<String>,
    /// Only events from this time on: seconds since the start, or H:MM:SS
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) from: Option<Duration>,
    /// Only events up to this time
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) to: Option<Duration>,
    /// Only events of this kind (repeat for more)
    #[arg(long = "kind", value_parser = PossibleValuesParser::new(KINDS), hide_possible_values = true)]
    pub(crate) kinds: Vec<String>,
    /// Also print the inputs and outputs of states
    #[arg(long)]
    pub(crate) values: bool,
    /// Only this number of last lines
    #[arg(long, value_name = "NUMBER")]
    pub(crate) last: Option<usize>,
    /// One JSON object per line
    #[arg(long)]
    pub(crate) json: bool,
}

/// Print the log of a run.
#[derive(Debug, Args)]
pub(crate) struct Log {
    #[command(flatten)]
    pub(crate) run: KeptRun,
    /// Only lines of at least this level
    #[arg(long, value_enum, default_value_t = LogLevel::Verbose)]
    pub(crate) level: LogLevel,
    /// Only lines of states with this text in their path of names or ids; `*` matches any text, `?` any character
    #[arg(long, value_name = "STATE")]
    pub(crate) state: Option<String>,
    /// Only this number of last lines
    #[arg(long, value_name = "NUMBER")]
    pub(crate) last: Option<usize>,
    /// One JSON object per line
    #[arg(long)]
    pub(crate) json: bool,
}

/// Level of a log line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogLevel {
    /// Everything
    Verbose,
    /// Details for finding a fault
    Debug,
    /// What happens
    Info,
    /// Possible problems
    Warning,
    /// Errors
    Error,
}

/// Print a moment of a run: the active states and their data after one event.
#[derive(Debug, Args)]
pub(crate) struct Replay {
    #[command(flatten)]
    pub(crate) run: KeptRun,
    /// After this event; the default is the last one
    #[arg(long, value_name = "SEQUENCE")]
    pub(crate) at: Option<u64>,
    /// At this time: seconds since the start, or H:MM:SS
    #[arg(long, value_name = "TIME", conflicts_with = "at", value_parser = time)]
    pub(crate) time: Option<Duration>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Print where two runs diverge, which data differed before, and how their times differ.
///
/// Parallel branches are compared one by one. The exit code is 1 if the runs diverge.
#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// One run: its id or the start of the id, its folder, or `last`
    pub(crate) one: String,
    /// The other run
    pub(crate) other: String,
    #[command(flatten)]
    pub(crate) runs: Runs,
    #[command(flatten)]
    pub(crate) remote: KeptRemote,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Export a run in the format of another program.
#[derive(Debug, Args)]
pub(crate) struct Export {
    #[command(flatten)]
    pub(crate) run: KeptRun,
    /// Output format
    #[arg(long, value_enum)]
    pub(crate) format: ExportFormat,
    /// File to write; the default is the standard output
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

/// The format of another program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExportFormat {
    /// One JSON object per event and line
    Jsonl,
    /// A table for spreadsheets
    Csv,
    /// A recording for Foxglove and Lichtblick
    Mcap,
}

/// `12.5`, `2:05` or `1:02:05`.
fn time(text: &str) -> Result<Duration, String> {
    let refused = || format!("`{text}` is not a time: write seconds, such as 12.5, or H:MM:SS");
    let part = |part: &str| part.parse::<f64>().ok().filter(|part| *part >= 0.0);
    let add = |sum: f64, next: &str| Some(sum * 60.0 + part(next)?);
    let seconds = text.split(':').try_fold(0.0, add).ok_or_else(refused)?;
    Duration::try_from_secs_f64(seconds).map_err(|_too_long| refused())
}

/// `90s`, `45m`, `12h` or `30d`.
fn age(text: &str) -> Result<Duration, String> {
    let refused =
        || format!("`{text}` is not an age: write a number and s, m, h or d, such as 30d");
    let units = [('s', 1), ('m', 60), ('h', 3600), ('d', 86_400)];
    scaled(text, &units).map(Duration::from_secs).ok_or_else(refused)
}

/// `500M` or `20G`; without a letter, bytes.
fn size(text: &str) -> Result<u64, String> {
    let refused =
        || format!("`{text}` is not a size: write a number and K, M, G or T, such as 20G");
    let plain = || text.parse().ok();
    let units = [('K', 1 << 10), ('M', 1 << 20), ('G', 1 << 30), ('T', 1 << 40)];
    scaled(text, &units).or_else(plain).ok_or_else(refused)
}

fn scaled(text: &str, units: &[(char, u64)]) -> Option<u64> {
    let unit = text.chars().next_back()?;
    let (_, factor) = units.iter().find(|(letter, _)| letter.eq_ignore_ascii_case(&unit))?;
    text[..text.len() - unit.len_utf8()].parse::<u64>().ok()?.checked_mul(*factor)
}

#[cfg(test)]
mod tests {
    use super::{age, size, time};
    use expect_test::{Expect, expect};
    use std::fmt::Debug;

    fn check(answers: &[Result<impl Debug, String>], expect: &Expect) {
        let line = |answer: &Result<_, String>| match answer {
            Ok(value) => format!("{value:?}\n"),
            Err(reason) => format!("{reason}\n"),
        };
        expect.assert_eq(&answers.iter().map(line).collect::<String>());
    }

    #[test]
    fn times_ages_and_sizes() {
        check(
            &["12.5", "2:05", "1:02:05.5", "-1", "x", ""].map(time),
            &expect![[r"
            12.5s
            125s
            3725.5s
            `-1` is not a time: write seconds, such as 12.5, or H:MM:SS
            `x` is not a time: write seconds, such as 12.5, or H:MM:SS
            `` is not a time: write seconds, such as 12.5, or H:MM:SS
        "]],
        );
        check(
            &["90s", "45m", "12h", "30d", "7", "d", "99999999999999999999d"].map(age),
            &expect![[r"
                90s
                2700s
                43200s
                2592000s
                `7` is not an age: write a number and s, m, h or d, such as 30d
                `d` is not an age: write a number and s, m, h or d, such as 30d
                `99999999999999999999d` is not an age: write a number and s, m, h or d, such as 30d
            "]],
        );
        check(
            &["500M", "20g", "4096", "1.5G", "T", "99999999999T"].map(size),
            &expect![[r"
            524288000
            21474836480
            4096
            `1.5G` is not a size: write a number and K, M, G or T, such as 20G
            `T` is not a size: write a number and K, M, G or T, such as 20G
            `99999999999T` is not a size: write a number and K, M, G or T, such as 20G
        "]],
        );
    }
}
