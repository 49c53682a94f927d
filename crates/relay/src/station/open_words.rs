//! What viewers gave for the robot, and whose fate is open.

use super::viewers::GivenWord;
use crate::ids;
use crate::words::StationWord;
use rafcon_link::{CommandId, StreamId};
use rafcon_protocol::{CommandStage, OpenCommand};
use std::collections::BTreeMap;

/// The words whose fate is open.
#[derive(Debug, Default)]
pub(super) struct OpenWords {
    open: BTreeMap<CommandId, OpenWord>,
}

#[derive(Debug)]
struct OpenWord {
    stream: StreamId,
    command: OpenCommand,
    /// Whether it is a command, and not a wish about control or a sign of life: those are not shown.
    is_command: bool,
}

impl OpenWords {
    /// A word for this run was sent at `sent_ms`; it arrives after `there_ms` if the link is whole. One that is open stays as it is.
    pub(super) fn add(
        &mut self,
        stream: StreamId,
        given: &GivenWord,
        (sent_ms, there_ms): (u64, Option<u64>),
    ) {
        let arrives_ms = there_ms.map(|there_ms| sent_ms + there_ms);
        let (id, stage) = (given.id.clone(), CommandStage::Sent);
        let not_before_ms = given.not_before;
        let command = OpenCommand { id, stage, sent_ms, arrives_ms, not_before_ms };
        let is_command = matches!(given.word, StationWord::Command(..));
        let word = OpenWord { stream, command, is_command };
        self.open.entry(ids::command(&given.id)).or_insert(word);
    }

    /// A word is this far.
    pub(super) fn set_stage(&mut self, id: CommandId, stage: CommandStage) {
        if let Some(word) = self.open.get_mut(&id) {
            word.command.stage = stage;
        }
    }

    /// Closes a word; answers its run and its name.
    pub(super) fn close(&mut self, id: CommandId) -> Option<(StreamId, String)> {
        self.open.remove(&id).map(|word| (word.stream, word.command.id))
    }

    /// The ids of all.
    pub(super) fn ids(&self) -> Vec<CommandId> {
        self.open.keys().copied().collect()
    }

    /// The commands among them, of this run or of all.
    pub(super) fn commands(&self, stream: Option<StreamId>) -> Vec<OpenCommand> {
        let is_wanted = |word: &&OpenWord| stream.is_none_or(|stream| word.stream == stream);
        let words = self.open.values().filter(|word| word.is_command).filter(is_wanted);
        words.map(|word| word.command.clone()).collect()
    }
}
