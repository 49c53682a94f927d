//! An engine that cannot be reached, and one that has failed. Both are detected, and neither prevents the end of a run.

use super::players::Run;
use crate::drive::ending::RunEnd;
use crate::drive::pulse::UNREACHED;
use rafcon_engine::{Input, Refusal, Start, Status};
use rafcon_protocol::{Breakpoint, Command, Envelope, Scope, Unattended, When};
use std::sync::Barrier;
use std::thread;

const WAITS: &str = "execution ROOT \"wait\"\n  outcome done\n";
/// Environment variable of the process that ends by itself.
const ENDS: &str = "RAFCON_TEST_ENDS";

/// A run whose script waits.
fn waiting() -> Run {
    let run = Run::new(WAITS, 1, 0);
    run.start();
    run.wait_for(|text| text == "+ROOT");
    run
}

fn command(command: Command) -> Envelope {
    Envelope::new("1", "test", command)
}

#[test]
fn an_engine_that_cannot_be_reached_is_told_from_one_that_has_nothing_to_do() {
    let run = waiting();
    let quiet = run.driver.engine_pulse();
    assert_eq!((quiet.unreached_ms, quiet.scripts), (0, Some(1)));
    let (held, seen) = (Barrier::new(2), Barrier::new(2));
    thread::scope(|scope| {
        scope.spawn(|| {
            run.driver.with_core(|_core| {
                held.wait();
                seen.wait();
            })
        });
        held.wait();
        let stuck = run.driver.engine_pulse();
        assert!(stuck.unreached_ms > 0 && stuck.scripts.is_none(), "{stuck:?}");
        seen.wait();
    });
    let again = run.driver.engine_pulse();
    assert_eq!((again.unreached_ms, again.scripts), (0, Some(1)));
    run.driver.command(Input::Stop).unwrap();
    run.end();
}

#[test]
fn a_stop_that_the_engine_does_not_take_ends_the_process() {
    if std::env::var_os(ENDS).is_some() {
        let run = waiting();
        let (driver, held) = (run.driver, Barrier::new(2));
        thread::scope(|scope| {
            scope.spawn(|| {
                driver.with_core(|_core| {
                    held.wait();
                    // No other thread arrives, so the engine stays locked.
                    held.wait();
                })
            });
            held.wait();
            driver.obey(&command(Command::Stop));
        });
    }
    let test = "tests::pulse::a_stop_that_the_engine_does_not_take_ends_the_process";
    let child = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", test, "--nocapture"])
        .env(ENDS, "yes")
        .output()
        .unwrap();
    assert_eq!(child.status.code(), Some(UNREACHED), "{}", String::from_utf8_lossy(&child.stdout));
}

#[test]
fn an_engine_that_has_failed_takes_nothing_more_and_the_run_ends() {
    let machine = "hierarchy ROOT\n  outcome done\n  start -> A\n  A.ok -> .done\n  \
                   execution A \"go\"\n    outcome ok\n    in x: object = \"$panic\"\n";
    let run = Run::new(machine, 1, 0);
    assert_eq!(run.driver.command(Input::Start(Start::default())), Err(Refusal::Broken));
    assert!(matches!(run.driver.wait(), Some(RunEnd::Broken)));
    assert_eq!(run.driver.command(Input::Pause), Err(Refusal::Broken));
    run.wait_for(|text| text.contains("the engine failed"));
}

#[test]
fn a_breakpoint_is_there_for_the_engine_if_and_only_if_it_is_there_for_viewers() {
    let run = waiting();
    let driver = &run.driver;
    let breakpoint = Breakpoint {
        id: 1,
        path: "ROOT".to_owned(),
        when: When::After,
        condition: None,
        hit_count: 1,
        scope: Scope::Branch,
        unattended: Unattended::Hold,
        lost_link_ms: None,
        enabled: true,
    };
    for _ in 0..500 {
        driver.set_breakpoint(&breakpoint).unwrap();
        thread::scope(|scope| {
            scope.spawn(|| drop(driver.remove_breakpoint(1)));
            scope.spawn(|| driver.set_breakpoint(&breakpoint).unwrap());
        });
        let is_told = !driver.points().all().is_empty();
        assert_eq!(driver.command(Input::Unbreak(1)).is_ok(), is_told);
        drop(driver.remove_breakpoint(1));
        driver.set_breakpoint(&breakpoint).unwrap();
    }
    driver.remove_breakpoint(1).unwrap();
    assert_eq!(driver.with_core(|core| core.engine.status()), Some(Status::Running));
    driver.command(Input::Stop).unwrap();
    run.end();
}
