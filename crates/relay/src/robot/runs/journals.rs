//! The journals of a robot's runs: reading for the link, and the hashes of their events.

use super::RobotRuns;
use rafcon_link::{EventHash, RobotSession};
use rafcon_storage::journal::EventSource;

/// Up to this many new events are sent before the backlog. The journal has the others.
pub(super) const AHEAD_MAX: u64 = 64;
/// Bytes of events hashed in one step.
const HASH_BYTES: usize = 256 << 10;
/// Number of ended runs whose events are hashed in one step.
pub(super) const HASHED_AT_ONCE: usize = 16;
/// Limit of open journals of ended runs. Each takes some 300 KB of memory.
pub(super) const OPEN_MAX: usize = 32;

impl RobotRuns {
    /// Continues the hashes of all runs, those that run first.
    pub(super) fn hash(&mut self, session: &mut RobotSession) {
        let due = |is_live: bool| {
            let runs = self.all.iter().filter(move |(_, run)| run.runner.is_some() == is_live);
            runs.filter(|(_, run)| !run.is_hashed()).map(|(id, _)| id.clone())
        };
        let due: Vec<_> = due(true).chain(due(false)).collect();
        let (mut left, mut ended_left) = (HASH_BYTES, HASHED_AT_ONCE);
        for id in due {
            // A journal that cannot be read now holds up no other.
            if self.open(&id).is_none() {
                continue;
            }
            let Some(run) = self.all.get_mut(&id) else { continue };
            let (Some(chain), Some(source)) = (&mut run.chain, &mut run.source) else { continue };
            // An incomplete journal has no hash.
            let Ok(hashed) = chain.advance(source.reader(), run.head, left) else {
                run.chain = None;
                continue;
            };
            left = left.saturating_sub(hashed);
            if chain.last() == run.head {
                let (last, hash) = (chain.last(), chain.hash());
                session.set_chain(run.events, EventHash { last, hash });
            }
            ended_left -= usize::from(run.runner.is_none());
            if left == 0 || ended_left == 0 {
                break;
            }
        }
    }

    /// The journal of a run. Of ended runs, those that were opened last stay open.
    pub(super) fn open(&mut self, id: &str) -> Option<&mut EventSource> {
        let run = self.all.get(id)?;
        if run.source.is_none() && run.runner.is_none() {
            self.note_opened(id);
        }
        self.all.get_mut(id)?.open()
    }

    pub(super) fn note_opened(&mut self, id: &str) {
        self.opened.retain(|opened| opened != id);
        self.opened.push_back(id.to_owned());
        while self.opened.len() > OPEN_MAX
            && let Some(oldest) = self.opened.pop_front()
        {
            let ended = self.all.get_mut(&oldest).filter(|run| run.runner.is_none());
            if let Some(ended) = ended {
                ended.source = None;
            }
        }
    }

    /// Sends what is new in the journal of a run.
    pub(in crate::robot) fn happened(&mut self, id: &str, session: &mut RobotSession) {
        let Some(Ok(last)) = self.open(id).map(|source| source.last()) else { return };
        let Some(run) = self.all.get_mut(id) else { return };
        if last > run.head + AHEAD_MAX {
            session.advance(run.events, last);
            run.head = last;
        }
        while run.head < last {
            let next = run.head + 1;
            let read = run.open().map(|source| source.read(next, last, 0));
            let Some(Ok(Some(read))) = read else { return };
            session.append(run.events, read.view());
            run.head = read.last_sequence();
        }
    }
}
