//! Building, checking, measuring and packing this repository: one module per command.
//!
//! Knows the repository's layout and its programs. Never links one of the crates: it uses them from outside, through cargo,
//! the `rafcon` binary and files.
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a developer's tool prints to the terminal"
)]

mod bench;
mod bench_web;
mod ci;
mod conformance;
mod demo;
mod dist;
mod limits;
mod link;
mod link_demo;
mod long_tests;
mod planner;
mod process;
mod product;
mod python;
mod reference;
mod ros;
mod ros_helper;
mod test;
mod tidy;
mod types;
mod web;
mod workspace;
mod zenoh;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Developer's commands of the RAFCON repository.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Run all checks of continuous integration: `lint`, then `test`.
    Ci,
    /// Check format, lints, layers, house rules and documentation.
    Lint,
    /// Run all tests, setting up what they need.
    Test(test::TestOptions),
    /// Run machines in the reference and here, and compare the results.
    Conformance(conformance::ConformanceOptions),
    /// Measure speed and memory, and compare them with our bars and with the reference.
    Bench(bench::BenchOptions),
    /// Measure the speed of the page in a browser, and compare it with our bars.
    BenchWeb(bench_web::BenchWebOptions),
    /// Watch a long run in the page: memory stays constant, every event arrives once, and frames keep their rate.
    SoakWeb(bench_web::Watch),
    /// Take the pictures of the page in `docs/pictures`.
    Pictures,
    /// Build everything and show a generated mission, in the page or live in this terminal.
    Demo(demo::DemoOptions),
    /// Pack an archive and a wheel.
    Dist,
    /// Run random machines with random inputs, and check the guarantees of the engine.
    Simulate(long_tests::SimulateOptions),
    /// Run robots and stations over a bad link, in virtual time or in real time, and print the gate's table.
    Spacebotcamp(link::SpacebotcampOptions),
    /// Simulate a bad network between a robot and a station.
    LinkProxy(link::LinkProxyOptions),
    /// Measure the duration of planning, and compare it with our bars.
    Planner(planner::PlannerOptions),
    /// Carry events over a bad link by the link, Zenoh, QUIC and plain datagrams, and compare the results.
    LinkCompare(zenoh::LinkCompareOptions),
    /// Build and test `rafcon-zenoh`, which has a workspace of its own.
    Zenoh,
    /// Test and measure `rafcon.ros` against foreign nodes of two distributions of ROS 2.
    Ros(ros::RosOptions),
    /// Build, lint and test `rafcon-ros`, which has a workspace of its own.
    RosHelper,
    /// Test the limits: 100,000 short runs at a station, edits between kills, strangers, signals, values; print the
    /// figures.
    Limits(limits::LimitsOptions),
    /// Run long versions of the tests: random runs of the engine, killed saves, clients of a server.
    Soak(long_tests::SoakOptions),
    /// Damage files of runs, and check that all data read from them is correct or reported as damaged.
    Corrupt(long_tests::CorruptOptions),
    /// Kill runners and servers in the middle of a run, and resume the runs.
    Torture(long_tests::TortureOptions),
    /// Build the page, which `rafcon serve` serves and a release build contains; or check its sources.
    Web(web::WebOptions),
    /// Write the files generated from the server's types: `OpenAPI` and TypeScript.
    Types(types::TypesOptions),
    /// Check rules beyond compiler and lints: module docs, sizes, named tests, links, generated files.
    Tidy(tidy::TidyOptions),
}

fn main() -> ExitCode {
    match run(Arguments::parse().task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: Task) -> anyhow::Result<()> {
    match task {
        Task::Ci => ci::run(),
        Task::Lint => ci::lint(),
        Task::Test(options) => test::run(&options),
        Task::Conformance(options) => conformance::run(&options),
        Task::Bench(options) => bench::run(&options),
        Task::BenchWeb(options) => bench_web::run(&options),
        Task::SoakWeb(options) => bench_web::soak(&options),
        Task::Pictures => bench_web::pictures(),
        Task::Demo(options) => demo::run(&options),
        Task::Dist => dist::run(),
        Task::Simulate(options) => long_tests::simulate(&options),
        Task::Spacebotcamp(options) => link::spacebotcamp(&options),
        Task::LinkProxy(options) => link::link_proxy(&options),
        Task::Planner(options) => planner::run(options),
        Task::LinkCompare(options) => zenoh::compare(&options),
        Task::Zenoh => zenoh::test(),
        Task::Ros(options) => ros::run(&options),
        Task::RosHelper => ros_helper::test(),
        Task::Limits(options) => limits::run(&options),
        Task::Soak(options) => long_tests::soak(&options),
        Task::Corrupt(options) => long_tests::corrupt(&options),
        Task::Torture(options) => long_tests::torture(&options),
        Task::Web(options) => web::run(options),
        Task::Types(options) => types::run(options),
        Task::Tidy(options) => tidy::run(&options),
    }
}
