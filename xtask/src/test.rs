//! All tests: Rust, documentation, the Python package with every interpreter found, the server's interface, the page
//! without and with a browser, and conformance with the reference.

use std::collections::VecDeque;
use std::io::{BufRead as _, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::thread;

use anyhow::{Context as _, Result, bail};
use clap::ValueEnum as _;

use crate::bench::library;
use crate::conformance;
use crate::product::{Product, Profile};
use crate::reference::Reference;
use crate::{bench_web, process, python, types, web, workspace};

/// Packages for the Python tests, in addition to the extension.
const CONTENTS: python::Contents =
    python::Contents { bare: &[], full: &["numpy", "mypy>=1.11,<2"] };

/// The default engine of plans.
const ENGINE: python::Contents = python::Contents { bare: &["kairos-planner==1.0.6"], full: &[] };

/// A plugin of the reference that generates machines with this package, and its examples.
const PLANNER: (&str, &str) = ("rafcon-task-planner-plugin", "1.5.2");

/// Packages for the tests of the server's interface: a WebSocket client, and a tool that checks the description.
const INTERFACE: python::Contents =
    python::Contents { bare: &[], full: &["websockets==17.4", "schemathesis==4.32.5"] };

/// Options of `cargo xtask test`.
#[derive(clap::Args, Default)]
pub(crate) struct TestOptions {
    /// Run only this part.
    #[arg(long, value_enum)]
    only: Option<Part>,
    /// Use an earlier build.
    #[arg(long)]
    no_build: bool,
}

/// Parts of the tests, in execution order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    /// Tests and documentation tests of all crates.
    Rust,
    /// Tests of the Python package, with every interpreter found.
    Python,
    /// The server's interface: its document, its description, the types made of it.
    Api,
    /// The page, without a browser.
    Web,
    /// The page in a browser, against the real server.
    E2e,
    /// Comparison of machines in both engines.
    Conformance,
}

/// Parts that run in parallel, the longest first: each often waits for interpreters, browsers and disks.
const SIDE_BY_SIDE: [Part; 5] = [Part::E2e, Part::Python, Part::Api, Part::Conformance, Part::Web];
/// Maximum number of parallel parts.
const AT_ONCE: usize = 2;
/// Number of last lines to repeat of a failed part.
const LAST_LINES: usize = 60;

/// Runs all parts, or the selected one, and sets up their dependencies.
pub(crate) fn run(options: &TestOptions) -> Result<()> {
    let build = if options.no_build { Product::built } else { Product::build };
    let product = build(Profile::Debug)?;
    if let Some(part) = options.only {
        return run_part(part, &product);
    }
    // Rust's tests need the processor, while the dependencies of later parts come over the network.
    thread::scope(|scope| {
        let needed = scope.spawn(install);
        rust()?;
        needed.join().unwrap_or_else(|_| bail!("the installation panicked"))
    })?;
    run_side_by_side()
}

/// Installs the dependencies of the parts beforehand. Each part checks them again, but parallel installations would disturb
/// each other.
fn install() -> Result<()> {
    Reference::installed()?;
    web::install()?;
    planner()?;
    engine_environment()?;
    interface_environment()?;
    python::all().iter().try_for_each(|interpreter| python_environment(interpreter).map(drop))
}

fn run_part(part: Part, product: &Product) -> Result<()> {
    match part {
        Part::Rust => rust(),
        Part::Python => python_side(product),
        Part::Api => {
            types::check_by_built()?;
            interface(product)
        }
        Part::Web => web::test(),
        Part::E2e => browser(product),
        Part::Conformance => conformance::run(&conformance::ConformanceOptions::without_build()),
    }
}

/// Runs each part in its own process, with its name before each line. All parts run to their end, even if others fail. The
/// last lines of failed parts are repeated without interleaving.
fn run_side_by_side() -> Result<()> {
    let results = process::side_by_side(&SIDE_BY_SIDE, AT_ONCE, |part| run_beside(*part));
    let failed = results.into_iter().filter_map(Result::err);
    let failed: Vec<_> = failed.map(|error| format!("{error:#}")).collect();
    if !failed.is_empty() {
        bail!("{}", failed.join("\n\n"));
    }
    Ok(())
}

fn run_beside(part: Part) -> Result<()> {
    let name = part.to_possible_value().context("a part without a name")?.get_name().to_owned();
    // Start a current build: the tests of all crates may have replaced this program.
    let mut command = process::cargo();
    command.args(["xtask", "test", "--no-build", "--only", &name]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let (output, errors) = (child.stdout.take(), child.stderr.take());
    let tail = Mutex::new(VecDeque::with_capacity(LAST_LINES));
    thread::scope(|scope| {
        scope.spawn(|| output.map(|output| show_lines(&name, output, &tail)));
        scope.spawn(|| errors.map(|errors| show_lines(&name, errors, &tail)));
    });
    let status = child.wait()?;
    println!("{name} | ended: {status}");
    if !status.success() {
        let tail = Vec::from(tail.into_inner().unwrap_or_default()).join("\n");
        bail!("`cargo xtask test --only {name}` failed: {status}. Its last lines:\n{tail}");
    }
    Ok(())
}

fn show_lines(name: &str, output: impl Read, tail: &Mutex<VecDeque<String>>) {
    for line in BufReader::new(output).split(b'\n').map_while(Result::ok) {
        let line = format!("{name} | {}", String::from_utf8_lossy(&line));
        println!("{line}");
        if let Ok(mut tail) = tail.lock() {
            if tail.len() == LAST_LINES {
                tail.pop_front();
            }
            tail.push_back(line);
        }
    }
}

fn rust() -> Result<()> {
    let tests: &[&str] =
        if has_nextest() { &["nextest", "run", "--workspace"] } else { &["test", "--workspace"] };
    process::run(process::cargo().args(tests))?;
    if has_nextest() {
        process::run(process::cargo().args(["test", "--doc", "--workspace", "--quiet"]))?;
    }
    library::check_server_bench()
}

fn has_nextest() -> bool {
    let asked = process::cargo()
        .args(["nextest", "--version"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    asked.is_ok_and(|status| status.success())
}

/// Tests for interpreters between the oldest and the newest: the extension, scripts and values.
const BETWEEN: &str = "test_[esv][cxa]*.py";

/// `crates/python/tests/test_*.py`: all with the oldest and the newest interpreter, the basic ones with the others.
fn python_side(product: &Product) -> Result<()> {
    let reference = Reference::installed()?;
    let planner = planner()?;
    let engine = engine_environment()?;
    let interpreters = python::all();
    let last = interpreters.len().saturating_sub(1);
    for (at, interpreter) in interpreters.into_iter().enumerate() {
        let python = python_environment(&interpreter)?;
        let mut command = discover(&python, "crates/python/tests", product);
        command.env("RAFCON_REFERENCE_PYTHON", &reference.python);
        command.env("RAFCON_TASK_PLANNER", &planner);
        command.env("RAFCON_KAIROS_PYTHON", &engine);
        if at != 0 && at != last {
            command.args(["--pattern", BETWEEN]);
        }
        process::run(&mut command).with_context(|| format!("Python {}", interpreter.version))?;
    }
    Ok(())
}

/// The unpacked sources of the planner plugin.
pub(crate) fn planner() -> Result<PathBuf> {
    let (name, version) = PLANNER;
    python::sources(&python::default()?, &workspace::target()?.join("plugins"), name, version)
}

/// A Python with the default engine next to it.
pub(crate) fn engine_environment() -> Result<PathBuf> {
    let folder = workspace::target()?.join("engine-venv");
    python::environment(&python::default()?, &folder, ENGINE)
}

fn python_environment(interpreter: &python::Interpreter) -> Result<PathBuf> {
    let folder = workspace::target()?.join("python-venvs").join(&interpreter.version);
    python::environment(interpreter, &folder, CONTENTS)
}

/// `crates/server/tests/api/test_*.py`, against the real server.
fn interface(product: &Product) -> Result<()> {
    process::run(&mut discover(&interface_environment()?, "crates/server/tests/api", product))
}

fn interface_environment() -> Result<PathBuf> {
    let folder = workspace::target()?.join("interface-venv");
    python::environment(&python::default()?, &folder, INTERFACE)
}

/// `web/e2e`: a browser, the built page, the real server and the reference's core. Also a short watch of a run.
fn browser(product: &Product) -> Result<()> {
    web::build()?;
    let reference = Reference::installed()?;
    let engine = engine_environment()?;
    let mut journeys = web::program("vitest")?;
    journeys.args(["run", "--config", "e2e/vitest.config.ts"]);
    journeys.env("RAFCON_BINARY", &product.binary).env("RAFCON_EXTENSION", &product.extension);
    journeys.env("RAFCON_KAIROS", engine.with_file_name("kairos"));
    journeys.env("RAFCON_REFERENCE_PYTHON", &reference.python);
    process::run(journeys.env("RAFCON_REFERENCE_SHARE", &reference.share))?;
    bench_web::soak_briefly(product)
}

/// Runs all tests in a folder.
fn discover(python: &Path, folder: &str, product: &Product) -> Command {
    let mut command = python::command(python);
    command
        .args(["-m", "unittest", "discover", "--start-directory", folder])
        .env("RAFCON_EXTENSION", &product.extension)
        .env("RAFCON_BINARY", &product.binary);
    command
}
