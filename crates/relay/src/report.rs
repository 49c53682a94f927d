//! Serves the state of a link over a socket in the folder of its side.

use crate::error::RelayError;
use parking_lot::Mutex;
use rafcon_protocol::LinkReport;
use rafcon_storage::journal::folder::{SOCKET_FILE, bind_socket};
use rafcon_supervisor::connect;
use std::fs;
use std::io::{self, Read as _, Write as _};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Interval of reports and of updates for viewers.
pub(crate) const REPORT_EVERY: Duration = Duration::from_secs(1);
/// Write timeout of an answer.
const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// Socket that serves reports of a side's links until this is dropped.
#[derive(Debug)]
pub(crate) struct Reporter {
    path: PathBuf,
    reports: Arc<Mutex<Vec<LinkReport>>>,
    is_closed: Arc<AtomicBool>,
}

impl Reporter {
    /// Opens the socket in this folder.
    pub(crate) fn open(folder: &Path) -> Result<Self, RelayError> {
        let failed = |source| RelayError::Folder { path: folder.to_owned(), source };
        fs::create_dir_all(folder).map_err(failed)?;
        let listener = bind_socket(folder).map_err(failed)?;
        let (reports, is_closed) = (Arc::default(), Arc::default());
        let reporter = Self { path: folder.join(SOCKET_FILE), reports, is_closed };
        let (reports, is_closed) = (Arc::clone(&reporter.reports), Arc::clone(&reporter.is_closed));
        let answer = move || answer(&listener, &reports, &is_closed);
        thread::Builder::new().name("reports".to_owned()).spawn(answer).map_err(failed)?;
        Ok(reporter)
    }

    /// This is how the links are.
    pub(crate) fn set(&self, reports: Vec<LinkReport>) {
        *self.reports.lock() = reports;
    }
}

impl Drop for Reporter {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Release);
        // Wakes the thread, which then sees that it is to end.
        drop(UnixStream::connect(&self.path));
        drop(fs::remove_file(&self.path));
    }
}

fn answer(listener: &UnixListener, reports: &Mutex<Vec<LinkReport>>, is_closed: &AtomicBool) {
    for stream in listener.incoming() {
        if is_closed.load(Ordering::Acquire) {
            return;
        }
        let text = serde_json::to_vec(&*reports.lock());
        if let (Ok(mut stream), Ok(text)) = (stream, text) {
            drop(stream.set_write_timeout(Some(WRITE_TIMEOUT)));
            // A client that did not read the answer can ask again.
            drop(stream.write_all(&text));
        }
    }
}

/// Reports of the links of the side in this folder. `None` if its program does not run.
pub fn read_reports(folder: &Path) -> io::Result<Option<Vec<LinkReport>>> {
    let Ok(mut stream) = connect(folder) else { return Ok(None) };
    let mut text = String::new();
    stream.read_to_string(&mut text)?;
    Ok(Some(serde_json::from_str(&text)?))
}
