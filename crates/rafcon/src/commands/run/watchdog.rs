//! Last resort of `--timeout`: a thread that ends this program if its loop is blocked, for example by a reader that does
//! not read.

use crate::clock::Clock;
use crate::failure::complain;
use crate::follow::{EXIT_TIMEOUT, GRACE};
use anyhow::{Context as _, Result};
use rafcon_supervisor::Group;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Additional time for the loop.
const MARGIN: Duration = Duration::from_secs(2);
/// Exit code of a killed run.
const KILLED: i32 = 8;

/// Watches one runner, until dropped.
#[derive(Debug)]
pub(super) struct Watchdog(Arc<AtomicBool>);

impl Watchdog {
    /// Ends runner and program some seconds after `timeout`, if there is one.
    pub(super) fn start(timeout: Option<Duration>, clock: Clock, group: Group) -> Result<Self> {
        let is_over = Arc::new(AtomicBool::new(false));
        let Some(timeout) = timeout else { return Ok(Self(is_over)) };
        let at = timeout.saturating_add(GRACE + EXIT_TIMEOUT + MARGIN);
        let watched = Arc::clone(&is_over);
        let watch = move || {
            while clock.now() < at {
                thread::park_timeout(at.saturating_sub(clock.now()));
            }
            if !watched.load(Ordering::SeqCst) {
                group.kill();
                complain(
                    "error: the time limit of --timeout expired and nobody reads the output; killed",
                );
                signal_hook::low_level::exit(KILLED);
            }
        };
        let thread = thread::Builder::new().name("watchdog".to_owned()).spawn(watch);
        thread.context("cannot start a thread for the time limit")?;
        Ok(Self(is_over))
    }
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}
