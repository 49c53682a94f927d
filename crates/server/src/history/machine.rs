//! `GET …/machine`: a machine as stored in a run. Loaded once, then cached in memory.
//!
//! Knows machines by their hash. Does not know their meaning.

use super::events::LOOK;
use super::{History, Json, folder};
use crate::document_text::document_text;
use crate::extract::{Path, Query};
use crate::failure::reason;
use crate::{Failure, ServerState};
use axum::body::Bytes;
use axum::extract::State;
use rafcon_locks::Mutex;
use rafcon_protocol::api::{KeptMachineQuery, Refusal};
use rafcon_protocol::document::Document;
use rafcon_protocol::{Event, Keeping};
use rafcon_storage::journal::{Filter, Found, Hash, Packed, Reader, Search};
use rafcon_storage::{Libraries, load_packed};
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{Instant, sleep};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Capacity of the cache, in machines.
const COUNT_MAX: usize = 64;
/// Capacity of the cache, in bytes. The last machine stays even if it is larger.
const BYTES_MAX: usize = 64 << 20;
/// Timeout and interval of the wait for the machine of a run that has just begun.
const MACHINE_TIMEOUT: Duration = Duration::from_secs(10);
const RETRY_INTERVAL: Duration = Duration::from_millis(50);

/// The run has not stored a machine.
const NO_MACHINE: &str = "no_such_machine";

/// Machines of runs as JSON.
#[derive(Debug, Default)]
pub(super) struct Machines {
    /// Held during a load, so that a concurrent request for the machine finds the result.
    reading: Mutex<()>,
    /// Least recently requested machine first.
    kept: Mutex<VecDeque<CachedDocument>>,
}

#[derive(Debug)]
struct CachedDocument {
    which: Which,
    document: Bytes,
}

/// Identifies a machine of a run, or a library in it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Which {
    folder: PathBuf,
    hash: Hash,
    library: Option<String>,
}

/// The routes of this file.
pub(super) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new().routes(routes!(machine))
}

/// A machine or a library of it, as a run stored it.
#[utoipa::path(get, path = "/api/v1/runs/{run}/machine", tag = "history",
    params(("run" = String, Path, description = "The run's id"), KeptMachineQuery),
    responses(
        (status = 200, description = "The machine or library, as the run stored it", body = Document),
        (status = 400, description = "This is no hash", body = Refusal),
        (status = 404, description = "There is no such run, or it has kept no such machine or library", body = Refusal),
        (status = 422, description = "The journal is damaged, or of a newer version", body = Refusal),
        (status = 503, description = "The journal cannot be read now, or there is no room to unpack", body = Refusal),
    )
)]
async fn machine(
    State(server): State<Arc<ServerState>>,
    Path(run): Path<String>,
    Query(query): Query<KeptMachineQuery>,
) -> Result<Json, Failure> {
    let wanted = query.root.as_deref().map(parse).transpose()?;
    let folder = folder(&server, &run).await?;
    let hash = match wanted {
        Some(hash) => hash,
        None => began_with(&server, &run, &folder).await?,
    };
    let run = server.runs.get(&run).await?;
    let which = Which { folder, hash, library: query.library };
    let patience = Instant::now() + MACHINE_TIMEOUT;
    loop {
        // Checked before the load: once the replica is complete, it is no longer live.
        let is_coming = run.is_replica() && run.is_live();
        match kept(&server, which.clone()).await {
            Err(failure) if is_coming && failure.refusal().code == NO_MACHINE => {
                if Instant::now() >= patience {
                    let message = "the machine of this run is on its way from the robot: ask again in a while";
                    return Err(Failure::unavailable("machine_on_its_way", message));
                }
                sleep(RETRY_INTERVAL).await;
            }
            answer => return answer,
        }
    }
}

async fn kept(server: &ServerState, which: Which) -> Result<Json, Failure> {
    let History { readers, machines, .. } = &server.history;
    let machines = Arc::clone(machines);
    readers
        .read_slowly(which.folder.clone(), move |_reader| machines.document(&which).map(Json))
        .await
}

/// The hash of a run's first machine. Waits if the run has just begun.
async fn began_with(server: &ServerState, run: &str, folder: &FilePath) -> Result<Hash, Failure> {
    let run = server.runs.get(run).await?;
    let patience = Instant::now() + MACHINE_TIMEOUT;
    loop {
        // Checked before the read: a run that has ended adds no events.
        let is_kept = run.is_live() && run.summary().keeping != Keeping::Off;
        let may_come = is_kept && Instant::now() < patience;
        let found = server.history.readers.read(folder.to_owned(), first).await?;
        match found {
            Some(hash) => return Ok(hash),
            None if may_come => sleep(RETRY_INTERVAL).await,
            None => {
                let message =
                    "the run has not kept its machine: ask for a run that keeps its history";
                return Err(Failure::not_found(NO_MACHINE, message));
            }
        }
    }
}

fn parse(text: &str) -> Result<Hash, Failure> {
    Hash::parse(text).ok_or_else(|| {
        let message =
            format!("`{text}` is no hash of a machine: take one from a `root` event or a moment");
        Failure::bad("bad_hash", message)
    })
}

/// The hash of a run's first machine. A large machine is stored a little later.
fn first(reader: &mut Reader) -> Result<Option<Hash>, Failure> {
    let filter = Filter { kinds: vec!["root".to_owned()], ..Filter::default() };
    let search = Search { filter: &filter, from: 1, look: LOOK, values: true };
    let mut first = None;
    reader.search(&search, |found: Found| -> Result<_, Failure> {
        if let Event::Root { hash, .. } = &found.event {
            first = Hash::parse(hash);
        }
        Ok(ControlFlow::Break(()))
    })?;
    Ok(first)
}

impl Machines {
    /// Drops the cached machines of a run.
    pub(super) fn forget(&self, folder: &FilePath) {
        self.kept.lock().retain(|kept| kept.which.folder != folder);
    }

    /// A machine as JSON, cached.
    fn document(&self, which: &Which) -> Result<Bytes, Failure> {
        if let Some(document) = self.known(which) {
            return Ok(document);
        }
        let _alone = self.reading.lock();
        if let Some(document) = self.known(which) {
            return Ok(document);
        }
        let document = read(which)?;
        self.keep(CachedDocument { which: which.clone(), document: document.clone() });
        Ok(document)
    }

    fn known(&self, which: &Which) -> Option<Bytes> {
        let mut kept = self.kept.lock();
        let index = kept.iter().position(|it| it.which == *which)?;
        let found = kept.remove(index)?;
        let document = found.document.clone();
        kept.push_back(found);
        Some(document)
    }

    fn keep(&self, fresh: CachedDocument) {
        let mut kept = self.kept.lock();
        kept.push_back(fresh);
        let bytes = |kept: &VecDeque<CachedDocument>| {
            kept.iter().map(|it| it.document.len()).sum::<usize>()
        };
        while kept.len() > COUNT_MAX || (kept.len() > 1 && bytes(&kept) > BYTES_MAX) {
            kept.pop_front();
        }
    }
}

fn read(which: &Which) -> Result<Bytes, Failure> {
    let packed = Arc::new(Packed::read(&which.folder, which.hash)?);
    let folder = match &which.library {
        None => Packed::MACHINE.to_owned(),
        Some(library) => library_folder(&packed, library)?,
    };
    let unreadable = |error: &dyn std::error::Error| {
        let message = format!("what the run has kept cannot be read: {}", reason(error));
        Failure::unprocessable("machine_unreadable", message)
    };
    let libraries = Libraries::default().packed(Arc::clone(&packed));
    let loaded = load_packed(&packed, &folder, FilePath::new(&folder), &libraries);
    let text = document_text(&loaded.map_err(|error| unreadable(&error))?.machine);
    Ok(text.map_err(|error| unreadable(&error))?.into())
}

/// The folder of a library with this path and name.
fn library_folder(packed: &Packed, library: &str) -> Result<String, Failure> {
    let folder =
        library.rsplit_once('/').and_then(|(path, name)| packed.library_folder(path, name));
    folder.ok_or_else(|| {
        let message = format!(
            "the run has kept no library `{library}`: take path and name from a library state"
        );
        Failure::not_found("no_such_library", message)
    })
}

#[cfg(test)]
mod tests {
    use super::{BYTES_MAX, Bytes, COUNT_MAX, CachedDocument, Hash, Machines, Which};
    use std::path::PathBuf;

    fn which(nth: usize) -> Which {
        let folder = PathBuf::from(format!("/runs/{nth}"));
        Which { folder, hash: Hash([0; 32]), library: None }
    }

    /// Caches documents of these sizes in order. Returns the indices of those that remain.
    fn stay(sizes: &[usize]) -> Vec<usize> {
        let machines = Machines::default();
        for (nth, size) in sizes.iter().enumerate() {
            let document = Bytes::from(vec![b' '; *size]);
            machines.keep(CachedDocument { which: which(nth), document });
        }
        let last = sizes.len() - 1;
        assert_eq!(machines.known(&which(last)).map(|it| it.len()), Some(sizes[last]));
        (0..sizes.len()).filter(|nth| machines.known(&which(*nth)).is_some()).collect()
    }

    #[test]
    fn machines_of_runs_in_memory_are_bounded_and_the_last_one_stays() {
        assert_eq!(stay(&[1; COUNT_MAX]).len(), COUNT_MAX);
        assert_eq!(stay(&[1; COUNT_MAX + 2]), (2..COUNT_MAX + 2).collect::<Vec<_>>());
        assert_eq!(stay(&[BYTES_MAX / 2, BYTES_MAX / 2]), [0, 1]);
        assert_eq!(stay(&[BYTES_MAX / 2, BYTES_MAX / 2, 1]), [1, 2]);
        assert_eq!(stay(&[1, BYTES_MAX + 1]), [1]);
    }

    #[test]
    fn a_machine_that_is_asked_for_again_stays_longest() {
        let machines = Machines::default();
        for nth in 0..=COUNT_MAX {
            machines.keep(CachedDocument { which: which(nth), document: Bytes::new() });
            assert!(machines.known(&which(0)).is_some());
        }
        assert!(machines.known(&which(1)).is_none());
    }
}
