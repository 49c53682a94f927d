//! Long forms of the tests, for a night instead of for continuous integration: hundreds of thousands of random runs of the
//! engine, damaged files of runs, thousands of killed saves, runners and servers, and runs with many branches or many
//! clients.

use std::process::Command;

use anyhow::Result;

use crate::process;
use crate::product::{Product, Profile};

/// Options of `cargo xtask simulate`.
#[derive(clap::Args)]
pub(crate) struct SimulateOptions {
    /// Number of random machines; each runs twice.
    #[arg(long, default_value_t = 100_000)]
    seeds: u64,
    /// Seed of the first machine.
    #[arg(long, default_value_t = 0)]
    from: u64,
}

/// Prints the coverage, or the first seed with a broken guarantee.
pub(crate) fn simulate(options: &SimulateOptions) -> Result<()> {
    seeds(options.from, options.seeds)
}

/// Runs this number of seeds in a release build.
fn seeds(from: u64, count: u64) -> Result<()> {
    let simulate = ["run", "--release", "-p", "rafcon-engine", "--example", "simulate", "--"];
    let (from, count) = (from.to_string(), count.to_string());
    process::run(process::cargo().args(simulate).args(["--seeds", &count, "--from", &from]))
}

/// Options of `cargo xtask soak`.
#[derive(clap::Args)]
pub(crate) struct SoakOptions {
    /// Number of random machines.
    #[arg(long, default_value_t = 100_000)]
    seeds: u64,
    /// Number of saving processes to kill.
    #[arg(long, default_value_t = 1000)]
    kills: u32,
    /// Number of runs with 64 branches whose viewers come and go.
    #[arg(long, default_value_t = 20)]
    wide: u32,
    /// Instead of these: a server with many clients, one of which is slow and one never reads.
    #[arg(long)]
    server: bool,
    /// Instead of these: months of use of one server, a day at a time; three months take about two hours.
    #[arg(long, conflicts_with = "server", value_name = "MONTHS")]
    months: Option<u32>,
    /// Runs of each of these days.
    #[arg(long, default_value_t = 60)]
    runs: u32,
    /// Number of clients of the server.
    #[arg(long, default_value_t = 200)]
    clients: u32,
    /// Duration of the run that they follow, in seconds.
    #[arg(long, default_value_t = 60)]
    seconds: u32,
    /// Instead of these: this many short runs of one robot, which its station receives one after the other.
    #[arg(long, conflicts_with_all = ["server", "months"], value_name = "RUNS")]
    station: Option<u32>,
}

/// Runs the selected tests. The first failure ends them and names its seed.
pub(crate) fn soak(options: &SoakOptions) -> Result<()> {
    if options.server {
        return served(options);
    }
    if let Some(months) = options.months {
        return used(months, options.runs);
    }
    if let Some(runs) = options.station {
        return process::run(&mut short_runs(runs));
    }
    seeds(0, options.seeds)?;
    let kill = ["test", "--release", "-p", "rafcon-storage", "--test", "it"];
    let one = ["kill::a_killed_process_leaves_one_of_its_machines", "--", "--exact"];
    let mut kill_often = process::cargo();
    kill_often.args(kill).args(one).env("RAFCON_TEST_KILLS", options.kills.to_string());
    process::run(&mut kill_often)?;
    Product::build(Profile::Release)?;
    let mut wide = long_form("wide::a_wide_run_ends_while_viewers_come_and_go");
    process::run(wide.env("RAFCON_TEST_WIDE", options.wide.to_string()))
}

/// The test of a station that receives this number of short runs. It prints figures as lines of JSON with `name`, `value`
/// and `unit`.
pub(crate) fn short_runs(runs: u32) -> Command {
    let mut cargo = process::cargo();
    cargo.args(["test", "--release", "-q", "-p", "rafcon-relay", "--test", "short_runs"]);
    cargo.args(["--", "--nocapture"]).env("RAFCON_TEST_SHORT_RUNS", runs.to_string());
    cargo
}

fn served(options: &SoakOptions) -> Result<()> {
    Product::build(Profile::Release)?;
    let test = "server_soak::many_clients_lose_nothing_and_cost_a_bounded_amount_of_memory";
    let mut soak = long_form(test);
    soak.env("RAFCON_TEST_CLIENTS", options.clients.to_string());
    process::run(soak.env("RAFCON_TEST_SECONDS", options.seconds.to_string()))
}

/// Days of a simulated month.
const DAYS: u32 = 30;

/// Simulates months of use; fails if memory, descriptors, threads or disk usage grow.
fn used(months: u32, runs: u32) -> Result<()> {
    Product::build(Profile::Release)?;
    let mut soak = long_form("months::months_of_use_leave_memory_descriptors_and_disk_flat");
    soak.env("RAFCON_TEST_DAYS", (DAYS * months).to_string());
    process::run(soak.env("RAFCON_TEST_RUNS", runs.to_string()))
}

/// Options of `cargo xtask corrupt`.
#[derive(clap::Args)]
pub(crate) struct CorruptOptions {
    /// Number of runs to damage, for the readers and for the commands each.
    #[arg(long, default_value_t = 1000)]
    runs: u32,
    /// The first seed; repeat a failed one with it. The default is the date.
    #[arg(long)]
    from: Option<u64>,
}

/// Damages files and reads them. The first failure ends the test and names its seed.
pub(crate) fn corrupt(options: &CorruptOptions) -> Result<()> {
    Product::build(Profile::Release)?;
    let mut readers = process::cargo();
    readers.args(["test", "--release", "-q", "-p", "rafcon-storage", "--test", "it"]);
    readers.arg("corrupt::what_is_read_of_a_corrupted_journal_is_true");
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

/// Options of `cargo xtask torture`.
#[derive(clap::Args)]
pub(crate) struct TortureOptions {
    /// Number of processes to kill.
    #[arg(long, default_value_t = 1000)]
    kills: u32,
    /// Kill the server as well as the runner, while two clients follow and command.
    #[arg(long)]
    server: bool,
    /// Kill robots' servers, stations and runners, while commands are in flight over a bad link.
    #[arg(long, conflicts_with = "server")]
    link: bool,
    /// The first seed; repeat a failed one with it. The default differs each day.
    #[arg(long)]
    from: Option<u64>,
}

/// Kills and resumes; the last line has the number of successes. The first failure ends the test and names its seed.
pub(crate) fn torture(options: &TortureOptions) -> Result<()> {
    Product::build(Profile::Release)?;
    let test = if options.server {
        "server_torture::killed_servers_and_runners_lose_nothing_and_repeat_nothing"
    } else if options.link {
        "link_torture::killed_robots_and_stations_carry_out_each_command_once_or_never"
    } else {
        "torture::a_killed_runner_loses_nothing_that_was_told"
    };
    let mut kill = long_form(test);
    kill.env("RAFCON_TEST_KILLS", options.kills.to_string());
    if let Some(from) = options.from {
        kill.env("RAFCON_TEST_SEED", from.to_string());
    }
    process::run(&mut kill)?;
    // A failure has ended the test before, with its seed.
    println!("{kills} of {kills} kills passed", kills = options.kills);
    Ok(())
}

/// A test of whole processes in a release build; environment variables set its length.
pub(crate) fn long_form(test: &str) -> Command {
    let mut cargo = process::cargo();
    cargo.args(["test", "--release", "-q", "-p", "rafcon", "--test", "it", test]);
    cargo.args(["--", "--exact", "--nocapture"]);
    cargo
}
