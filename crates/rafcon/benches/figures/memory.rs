//! Memory that a loaded machine takes: resident memory of a process of its own after loading, less what it had before.
//! The allocator is the system's, as in the `rafcon` binary.

use crate::{machines, median, print};
use anyhow::{Context as _, Result, ensure};
use rafcon_storage::{Libraries, load};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The argument by which the bench starts itself again.
const CHILD: &str = "--memory-of";

/// The machine that this process was started for, if it is the child.
pub(crate) fn asked_for() -> Option<PathBuf> {
    std::env::args_os().skip_while(|argument| argument != CHILD).nth(1).map(PathBuf::from)
}

/// MB that the machine takes in this process.
pub(crate) fn taken_by(path: &Path) -> Result<f64> {
    let before = resident_mb()?;
    let loaded = load(path, &Libraries::default())?;
    let after = resident_mb()?;
    ensure!(loaded.machine.count() > 1, "the machine is empty");
    Ok(after - before)
}

/// Measures in child processes.
pub(crate) fn measure(folder: &Path) -> Result<()> {
    let machine = machines::mission(folder, 10_000)?;
    let program = std::env::current_exe()?;
    let taken = median(|| {
        let printed = Command::new(&program).arg(CHILD).arg(&machine).output()?;
        let text = String::from_utf8_lossy(&printed.stdout).into_owned();
        text.trim().parse::<f64>().with_context(|| format!("the child printed {text:?}"))
    })?;
    print("memory_10000_mb", taken, "MB");
    Ok(())
}

/// Pages in memory, from the kernel's own count.
fn resident_mb() -> Result<f64> {
    let text = std::fs::read_to_string("/proc/self/smaps_rollup")?;
    let line = text.lines().find(|line| line.starts_with("Rss:")).context("no Rss line")?;
    let kilobytes: f64 = line.split_whitespace().nth(1).context("no number")?.parse()?;
    Ok(kilobytes / 1e3)
}
