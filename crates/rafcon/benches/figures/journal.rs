//! Reading the journal of a long run, with a warm file cache.

use crate::{clock, median, print};
use anyhow::{Context as _, Result, ensure};
use rafcon_storage::journal::{
    About, Definition, Item, Journal, Kept, Left, Options, PlaceNumber, Reader,
};
use rafcon_testkit::journal_notation;
use std::path::Path;

/// Events of the run.
const EVENTS: u64 = 1_000_000;
/// Events between two commits.
const GROUP: u64 = 5_000;

/// Two states in a loop that hand a number on, in a root that keeps it.
const MACHINE: &str = r#"
    place R "Root" scoped n outcome done
    place R/A "Root/Ping" script in n out n outcome ok
    place R/B "Root/Pong" script in n out n outcome ok
"#;

/// Measures below `folder`.
pub(crate) fn measure(folder: &Path) -> Result<()> {
    let folder = folder.join("long_run");
    write(&folder)?;
    let page = median(|| open_page(&folder))?;
    print("open_1m_page_ms", page, "ms");
    print("open_1m_moment_ms", median(|| slowest_moment(&folder))?, "ms");
    Ok(())
}

fn open_page(folder: &Path) -> Result<f64> {
    let (seconds, page) = clock::seconds(|| -> Result<usize> {
        let mut reader = Reader::open(folder)?;
        let page = reader.page(1, 200)?;
        page.iter().try_for_each(|entry| reader.event(entry, true).map(drop))?;
        Ok(page.len())
    });
    ensure!(page? == 200, "the page is not full");
    Ok(seconds * 1e3)
}

/// The slowest of many: how far the moment lies from the last that was kept decides.
fn slowest_moment(folder: &Path) -> Result<f64> {
    let moments = (1..=40).map(|part| open_moment(folder, part * EVENTS / 40 - part * 137));
    moments.reduce(|one, other| Ok(one?.max(other?))).context("no moments")?
}

fn open_moment(folder: &Path, at: u64) -> Result<f64> {
    let (seconds, active) = clock::seconds(|| -> Result<usize> {
        let mut reader = Reader::open(folder)?;
        let moment = reader.moment(at)?;
        Ok(reader.picture(&moment)?.active.len())
    });
    ensure!(active? > 0, "nothing is active");
    Ok(seconds * 1e3)
}

fn write(folder: &Path) -> Result<()> {
    let journal = Journal::create(folder, &About::default(), &Options::default())?;
    let mut batch = journal_notation::batch(&format!("{MACHINE}\nenter R"), 0)?;
    let places: Vec<PlaceNumber> = journal_notation::parse(MACHINE)?
        .iter()
        .filter_map(|item| match item {
            Item::Definition(Definition::Place(number, _)) => Some(*number),
            _ => None,
        })
        .collect();
    let [root, ping, pong] = places.try_into().ok().context("three places")?;
    let (mut written, mut t_ns) = (1, 1_000_000);
    while written < EVENTS {
        for place in [ping, pong] {
            t_ns += 5_000;
            let value = Kept::Int(i64::try_from(written)?);
            batch.entered(t_ns, place, [&value], None);
            let outputs = [&value];
            batch
                .left(t_ns + 2_000, Left { place, outcome: 0, outputs, error: None, undoes: None });
            batch.scoped(t_ns + 2_000, root, 0, &value);
            written += 3;
        }
        if written % GROUP < 6 {
            journal.append(&batch)?;
            batch.clear();
            journal.commit()?;
        }
    }
    journal.append(&batch)?;
    journal.close()?;
    Ok(())
}
