//! Git data of a folder: its commits, and its files at a commit. Knows git's commands, but not the meaning of the files.
//!
//! A repository is untrusted: no program in its configuration may run. Therefore it uses neither checkout nor archive, which
//! run filters, and no configuration of the user or the system. It never fetches missing objects.

use crate::child::{ChildError, ChildLimits, ChildOutput, ask};
use crate::{Failure, failure::reason};
use rafcon_protocol::api::{MachineVersion, MachineVersions};
use std::path::Path;
use std::time::Duration;
use tokio::process::Command;

/// Capacity of the list of commits.
const COMMITS_MAX: usize = 200;
/// Limit on the total bytes of a commit's files.
const BYTES_MAX: u64 = 128 << 20;
/// Limit on the number of files in a commit below the folder.
const FILES_MAX: usize = 200_000;
const GIT_TIMEOUT: Duration = Duration::from_secs(20);

/// A file of a commit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CommittedFile {
    /// Path below the folder, joined by `/`, without `.` or `..`.
    pub(super) path: String,
    object: String,
    bytes: u64,
}

/// The folder of a machine, for git.
#[derive(Debug, Clone, Copy)]
pub(super) struct GitFolder<'f> {
    pub(super) path: &'f Path,
    /// The project that contains it. Repositories outside are refused.
    pub(super) project: &'f Path,
    /// Search path for programs.
    pub(super) programs: Option<&'f str>,
}

impl GitFolder<'_> {
    fn git(&self, arguments: &[&str]) -> Command {
        let mut git = Command::new("git");
        git.env_clear().envs(self.programs.map(|path| ("PATH", path)));
        git.env("GIT_CEILING_DIRECTORIES", self.project.parent().unwrap_or(self.project));
        git.env("GIT_CONFIG_NOSYSTEM", "1").env("GIT_CONFIG_GLOBAL", "/dev/null");
        git.env("GIT_ALLOW_PROTOCOL", "none").env("GIT_NO_LAZY_FETCH", "1");
        git.env("GIT_OPTIONAL_LOCKS", "0").env("GIT_TERMINAL_PROMPT", "0").env("LC_ALL", "C.UTF-8");
        git.args(["--no-pager", "-c", "core.fsmonitor=false", "-c", "core.hooksPath=/dev/null"]);
        git.args(["-c", "log.showSignature=false"]).arg("-C").arg(self.path).args(arguments);
        git
    }

    async fn ask(
        &self,
        arguments: &[&str],
        input: Vec<u8>,
        output: u64,
    ) -> Result<ChildOutput, ChildError> {
        ask(self.git(arguments), input, ChildLimits { patience: GIT_TIMEOUT, output }).await
    }

    /// True if the repository exists and is completely inside the project. A file `.git`, a link or `commondir` may lead to another one.
    async fn find_repository(&self) -> Result<bool, ChildError> {
        let folders = ["rev-parse", "--path-format=absolute", "--git-dir", "--git-common-dir"];
        let said = self.ask(&folders, Vec::new(), 64 << 10).await?;
        let text = String::from_utf8_lossy(&said.output);
        let (mut folders, mut is_inside) = (0, said.status.success());
        for folder in text.lines().map(Path::new) {
            folders += 1;
            let lends = folder.join("objects/info/alternates").exists();
            let home = folder.canonicalize();
            is_inside &= !lends && home.is_ok_and(|home| home.starts_with(self.project));
        }
        Ok(is_inside && folders == 2)
    }

    /// Commits that changed the folder, newest first.
    pub(super) async fn versions(&self) -> Result<MachineVersions, Failure> {
        match self.find_repository().await {
            Ok(false) | Err(ChildError::NotStarted(_)) => return Ok(MachineVersions::default()),
            found => found.map_err(|error| failed(&error))?,
        };
        let most = format!("--max-count={}", COMMITS_MAX + 1);
        let form = "--format=%H%n%an%n%at%n%s";
        let log = ["log", "-z", "--no-color", "--no-show-signature", "--encoding=UTF-8", &most];
        let log = [&log[..], &[form, "--", "."]].concat();
        let said = self.ask(&log, Vec::new(), 8 << 20).await.map_err(|error| failed(&error))?;
        if !said.status.success() {
            return no_versions(&said);
        }
        let text = String::from_utf8_lossy(&said.output);
        let mut versions: Vec<_> = text.split_terminator('\0').filter_map(version).collect();
        let is_cut = versions.len() > COMMITS_MAX;
        versions.truncate(COMMITS_MAX);
        Ok(MachineVersions { is_git: true, versions, is_cut })
    }

    /// Files below the folder in a commit.
    pub(super) async fn files(&self, commit: &str) -> Result<Vec<CommittedFile>, Failure> {
        check_hash(commit)?;
        if !self.find_repository().await.map_err(|error| failed(&error))? {
            return Err(no_version(commit, "the project has no git repository of its own"));
        }
        let list = ["ls-tree", "-r", "-z", "--long", commit, "--"];
        let said = self.ask(&list, Vec::new(), 64 << 20).await.map_err(|error| failed(&error))?;
        if !said.status.success() {
            return Err(no_version(commit, &said.error));
        }
        let text = String::from_utf8_lossy(&said.output);
        let files: Vec<_> = text.split_terminator('\0').filter_map(file).collect();
        if files.is_empty() {
            return Err(no_version(commit, "the folder is not in it"));
        }
        Ok(files)
    }

    /// Contents of these files, in order.
    pub(super) async fn contents(&self, files: &[CommittedFile]) -> Result<Vec<Vec<u8>>, Failure> {
        let bytes: u64 = files.iter().map(|file| file.bytes).sum();
        if files.len() > FILES_MAX || bytes > BYTES_MAX {
            let message = format!(
                "the machine has {} files with {bytes} bytes in this version, and {FILES_MAX} with {BYTES_MAX} are the most: \
                 look at it with git",
                files.len()
            );
            return Err(Failure::unprocessable("version_too_large", message));
        }
        let wanted: Vec<u8> =
            files.iter().flat_map(|file| format!("{}\n", file.object).into_bytes()).collect();
        let most = bytes + 128 * files.len() as u64;
        let said = self.ask(&["cat-file", "--batch"], wanted, most).await;
        let said = said.map_err(|error| failed(&error))?;
        let mut rest = &*said.output;
        let contents = files.iter().map(|file| content(file, &mut rest)).collect::<Option<_>>();
        contents
            .ok_or_else(|| refused(&format!("not all of its objects are there: {}", said.error)))
    }
}

/// The content of the next object in a batch.
fn content(file: &CommittedFile, rest: &mut &[u8]) -> Option<Vec<u8>> {
    let head = format!("{} blob {}\n", file.object, file.bytes);
    let body = rest.strip_prefix(head.as_bytes())?;
    let (content, behind) = body.split_at_checked(usize::try_from(file.bytes).ok()?)?;
    *rest = behind.strip_prefix(b"\n")?;
    Some(content.to_vec())
}

fn version(text: &str) -> Option<MachineVersion> {
    let mut lines = text.splitn(4, '\n').map(str::to_owned);
    let (commit, author, at) = (lines.next()?, lines.next()?, lines.next()?);
    let at_ms = at.parse::<u64>().unwrap_or_default().saturating_mul(1000);
    Some(MachineVersion { commit, author, at_ms, subject: lines.next().unwrap_or_default() })
}

/// Parses a line of the list. `None` unless it is a regular file with a path below the folder.
fn file(line: &str) -> Option<CommittedFile> {
    let (about, path) = line.split_once('\t')?;
    let mut about = about.split_ascii_whitespace();
    let (mode, kind, object) = (about.next()?, about.next()?, about.next()?);
    let bytes = about.next()?.parse().ok()?;
    let is_file = kind == "blob" && matches!(mode, "100644" | "100755");
    let is_below = path.split('/').all(|name| !matches!(name, "" | "." | ".."));
    let (path, object) = (path.to_owned(), object.to_owned());
    (is_file && is_below).then_some(CommittedFile { path, object, bytes })
}

/// Requires a complete hash, which cannot be an option, a branch or a path.
fn check_hash(commit: &str) -> Result<(), Failure> {
    let is_hex = commit.bytes().all(|byte| byte.is_ascii_hexdigit());
    if is_hex && matches!(commit.len(), 40 | 64) {
        return Ok(());
    }
    let message = "a commit is named by its whole hash, 40 or 64 hexadecimal digits";
    Err(Failure::bad("bad_commit", message))
}

/// The response if the repository has no commit, or if git refuses.
fn no_versions(said: &ChildOutput) -> Result<MachineVersions, Failure> {
    if said.error.contains("does not have any commits yet") {
        return Ok(MachineVersions { is_git: true, ..MachineVersions::default() });
    }
    Err(refused(&said.error))
}

fn no_version(commit: &str, why: &str) -> Failure {
    let message = format!(
        "there is no version {commit} of this machine ({why}): its `versions` lists those that there are"
    );
    Failure::not_found("no_such_version", message)
}

fn refused(why: &str) -> Failure {
    // The remedy that git suggests is in the user's configuration, which is ignored here.
    let message = if why.contains("dubious ownership") {
        "the repository belongs to another user than the server: start the server as that user"
            .to_owned()
    } else {
        format!("git cannot read the history: {why}")
    };
    Failure::unprocessable("git_refused", message)
}

fn failed(error: &ChildError) -> Failure {
    let message = format!("git cannot be asked: {}", reason(error));
    Failure::unprocessable("git_refused", message)
}

#[cfg(test)]
mod tests {
    use super::{BYTES_MAX, CommittedFile, FILES_MAX, GitFolder, check_hash, file, refused};
    use std::path::Path;

    #[test]
    fn only_regular_files_below_the_folder_count() {
        let path = |line: &str| file(line).map(|file| file.path);
        assert_eq!(
            path("100644 blob abc      12\tA/core_data.json"),
            Some("A/core_data.json".into())
        );
        for line in [
            "120000 blob abc 12\tlink",
            "160000 commit abc -\tmodule",
            "100644 blob abc 12\t../out",
            "100644 blob abc 12\tA/../../out",
            "100644 blob abc 12\t/etc/passwd",
            "100644 blob abc",
        ] {
            assert_eq!(path(line), None, "{line}");
        }
    }

    #[test]
    fn a_way_out_that_leads_nowhere_is_not_told() {
        let git = "fatal: detected dubious ownership in repository at '/p'\nTo add an exception for this directory, \
                   call:\n\n\tgit config --global --add safe.directory /p";
        let message = refused(git).refusal().message;
        assert!(
            message.contains("start the server as that user")
                && !message.contains("safe.directory")
        );
    }

    #[test]
    fn a_commit_is_a_whole_hash() {
        check_hash(&"0a".repeat(20)).unwrap();
        for text in ["", "HEAD", "--output=x", "0a0a", &"0g".repeat(20), "HEAD~1"] {
            check_hash(text).unwrap_err();
        }
    }

    #[tokio::test]
    async fn a_version_that_is_too_large_is_refused_and_git_is_not_asked() {
        let nowhere = Path::new("/nowhere");
        let folder = GitFolder { path: nowhere, project: nowhere, programs: Some("/nowhere") };
        let read = async |count: usize, bytes: u64| {
            let file = |nth: usize| CommittedFile {
                path: String::new(),
                object: String::new(),
                bytes: if nth == 0 { bytes } else { 0 },
            };
            let files: Vec<_> = (0..count).map(file).collect();
            folder.contents(&files).await.unwrap_err().refusal().code
        };
        assert_eq!(read(FILES_MAX + 1, 0).await, "version_too_large");
        assert_eq!(read(2, BYTES_MAX + 1).await, "version_too_large");
        // At the limit git is started, but `programs` has none.
        assert_eq!(read(FILES_MAX, BYTES_MAX).await, "git_refused");
    }
}
