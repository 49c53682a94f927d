//! A request to a robot as its station stores it until its fate is known: one file each, with a hash of its content.

use crate::ids;
use rafcon_link::{COMMANDS_MAX, CommandId, Generation, RobotTimes, TimedCommand};
use rafcon_storage::journal::folder::replace_file;
use rafcon_storage::journal::{JournalError, make_folder};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Ending of the name of a file.
const FILE: &str = "command";
/// Ending of a damaged file.
const DAMAGED_FILE: &str = "damaged";
/// Capacity of the folder: the session sends no more commands at a time.
pub(super) const STORED_MAX: usize = COMMANDS_MAX;

/// A request with its times.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct StoredCommand {
    pub(super) about: AboutCommand,
    /// The request as it is sent.
    pub(super) body: Vec<u8>,
}

/// The times of a stored request.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct AboutCommand {
    /// Id of the request.
    pub(super) id: String,
    /// Tag of the pairing: the robot's clock is that of a start under it.
    pub(super) pairing: String,
    /// Id of its run; empty if the station does not show the run.
    pub(super) run: String,
    /// Epoch of authority.
    pub(super) epoch: u64,
    /// Time of acceptance: ms since 1970, UTC.
    pub(super) sent_ms: u64,
    /// Expiry and earliest effect by the station's calendar, as they are shown.
    pub(super) expires_ms: Option<u64>,
    pub(super) not_before_ms: Option<u64>,
    /// Time to send all of it.
    pub(super) transfer_ms: u64,
    /// Start of the robot, and the times of its clock that bind the robot.
    pub(super) robot_start: u32,
    pub(super) robot_not_before_ms: u64,
    pub(super) robot_not_after_ms: u64,
}

/// Content of the folder.
#[derive(Debug, Default)]
pub(super) struct StoredCommands {
    /// The oldest first.
    pub(super) commands: Vec<StoredCommand>,
    /// Commands that are lost, with the reasons.
    pub(super) problems: Vec<String>,
}

impl StoredCommand {
    pub(super) fn id(&self) -> CommandId {
        ids::command(&self.about.id)
    }

    /// The request for the session of a later start.
    pub(super) fn restored(&self) -> TimedCommand {
        let about = &self.about;
        let times = RobotTimes {
            start: Generation(about.robot_start),
            not_before: about.robot_not_before_ms,
            not_after: about.robot_not_after_ms,
        };
        let (id, epoch, body) = (self.id(), about.epoch, self.body.clone());
        TimedCommand { id, times, epoch, body, is_restored: true }
    }

    /// Stores the request. It is durable when this returns.
    pub(super) fn write(&self, folder: &Path) -> Result<(), JournalError> {
        make_folder(folder)?;
        let mut content = serde_json::to_vec(&self.about).unwrap_or_default();
        content.push(b'\n');
        content.extend(&self.body);
        let hash = blake3::hash(&content);
        replace_file(&path(folder, self.id()), &[hash.as_bytes(), &*content].concat())
    }

    /// The request in a file; the error names the damage.
    fn read(path: &Path) -> Result<Self, String> {
        let bytes = fs::read(path).map_err(|error| error.to_string())?;
        let (hash, content) = bytes.split_first_chunk().ok_or("it is too short")?;
        if blake3::hash(content) != *hash {
            return Err("its content has another hash".to_owned());
        }
        let end = content.iter().position(|byte| *byte == b'\n').ok_or("it has no body")?;
        let about: AboutCommand =
            serde_json::from_slice(&content[..end]).map_err(|error| error.to_string())?;
        Ok(Self { about, body: content[end + 1..].to_vec() })
    }
}

impl StoredCommands {
    /// Removes the commands of other pairings. A robot that was paired anew counts its starts anew, so their times are void.
    pub(super) fn retain_paired(&mut self, folder: &Path, tags: &[String]) {
        let is_other = |command: &mut StoredCommand| !tags.contains(&command.about.pairing);
        for command in self.commands.extract_if(.., is_other) {
            // A file that stays is reported again.
            drop(remove(folder, command.id()));
            self.problems.push(format!(
                "command {} of run {} is not sent again, because the robot was paired anew: check the run, and give it again",
                command.about.id, command.about.run
            ));
        }
    }

    /// Reads the folder. A damaged file costs only its command, and is renamed so that it is reported once.
    pub(super) fn read(folder: &Path) -> Self {
        let mut stored = Self::default();
        let files = match files(folder) {
            Ok(files) => files,
            Err(error) => {
                let folder = folder.display();
                stored.problems.push(format!(
                    "the commands in {folder} cannot be read and are not sent again: {error}"
                ));
                return stored;
            }
        };
        for file in files {
            match StoredCommand::read(&file) {
                Ok(command) => stored.commands.push(command),
                Err(why) => {
                    stored.problems.push(format!(
                        "the command in {} is not sent again, because the file is damaged ({why}): check the run, and give it again",
                        file.display()
                    ));
                    // A file that stays is reported again.
                    drop(fs::rename(&file, file.with_extension(DAMAGED_FILE)));
                }
            }
        }
        stored.commands.sort_by_key(|command| command.about.sent_ms);
        let surplus = stored.commands.len().saturating_sub(STORED_MAX);
        for command in stored.commands.drain(..surplus) {
            // A file that stays is reported again.
            drop(remove(folder, command.id()));
            stored.problems.push(format!(
                "command {} of run {} is not sent again: more than {STORED_MAX} are stored",
                command.about.id, command.about.run
            ));
        }
        stored
    }
}

/// Removes a stored request, if there is one.
pub(super) fn remove(folder: &Path, id: CommandId) -> io::Result<()> {
    match fs::remove_file(path(folder, id)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let paths = entries.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    let is_command = |path: &PathBuf| path.extension().is_some_and(|ending| ending == FILE);
    Ok(paths.into_iter().filter(is_command).collect())
}

fn path(folder: &Path, id: CommandId) -> PathBuf {
    let name = u128::from_be_bytes(id.0);
    folder.join(format!("{name:032x}")).with_extension(FILE)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The request number `nth`, which is as old as its number is small.
    pub(in crate::station) fn stored(nth: u64) -> StoredCommand {
        let about = AboutCommand {
            id: format!("ana/{nth}"),
            pairing: "tag".to_owned(),
            run: "drive".to_owned(),
            epoch: 3,
            sent_ms: nth,
            expires_ms: Some(nth + 1_000),
            not_before_ms: None,
            transfer_ms: 0,
            robot_start: 1,
            robot_not_before_ms: 0,
            robot_not_after_ms: 9_000,
        };
        StoredCommand { about, body: b"\x01two\nlines".to_vec() }
    }

    #[test]
    fn requests_are_read_as_they_were_stored_until_they_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("commands");
        assert!(StoredCommands::read(&folder).commands.is_empty());
        for nth in [2, 1] {
            stored(nth).write(&folder).unwrap();
        }
        let read = StoredCommands::read(&folder);
        assert_eq!((read.commands, read.problems), (vec![stored(1), stored(2)], vec![]));
        remove(&folder, stored(1).id()).unwrap();
        remove(&folder, stored(1).id()).unwrap();
        assert_eq!(StoredCommands::read(&folder).commands, [stored(2)]);
    }

    #[test]
    fn a_damaged_file_costs_its_command_and_is_reported_once() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        for nth in 0..4 {
            stored(nth).write(folder).unwrap();
        }
        let file = |nth| path(folder, stored(nth).id());
        let mut flipped = fs::read(file(0)).unwrap();
        *flipped.last_mut().unwrap() ^= 1;
        fs::write(file(0), flipped).unwrap();
        fs::write(file(1), b"short").unwrap();
        fs::write(file(2), []).unwrap();
        fs::write(folder.join("half.new"), b"half").unwrap();
        let read = StoredCommands::read(folder);
        assert_eq!((read.commands, read.problems.len()), (vec![stored(3)], 3));
        assert!(read.problems.iter().all(|problem| problem.contains("is damaged (it")));
        let again = StoredCommands::read(folder);
        assert_eq!((again.commands, again.problems), (vec![stored(3)], vec![]));
    }

    #[test]
    fn a_command_of_another_pairing_is_not_restored_and_is_reported_once() {
        let folder = tempfile::tempdir().unwrap();
        let mut other = stored(1);
        other.about.pairing = "other".to_owned();
        other.write(folder.path()).unwrap();
        stored(2).write(folder.path()).unwrap();
        let mut read = StoredCommands::read(folder.path());
        read.retain_paired(folder.path(), &["tag".to_owned()]);
        assert_eq!((read.commands, read.problems.len()), (vec![stored(2)], 1));
        assert_eq!(StoredCommands::read(folder.path()).commands, [stored(2)]);
    }

    #[test]
    fn of_more_commands_than_the_session_sends_the_newest_are_restored() {
        let folder = tempfile::tempdir().unwrap();
        for nth in 0..=STORED_MAX as u64 {
            stored(nth).write(folder.path()).unwrap();
        }
        let read = StoredCommands::read(folder.path());
        assert_eq!((read.commands.len(), &read.commands[0]), (STORED_MAX, &stored(1)));
        assert!(read.problems[0].starts_with("command ana/0 of run drive is not sent again"));
        assert_eq!(StoredCommands::read(folder.path()).problems.len(), 0);
    }
}
