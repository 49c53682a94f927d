//! Describes errors of the file system: cause and remedy. Uses the kind of error, not the operation that failed.

use std::io::{self, ErrorKind};

/// System error numbers without an [`ErrorKind`].
const TOO_MANY_FILES: [i32; 2] = [23, 24];
const BROKEN_DISK: i32 = 5;

/// Returns the cause, if it is known, and the remedy of an error that occurred while writing files.
pub fn remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::StorageFull => "the disk is full: make room on it, or use another folder",
        ErrorKind::QuotaExceeded => {
            "the disk quota is used up: make room, raise the quota, or use another folder"
        }
        ErrorKind::ReadOnlyFilesystem => {
            "the file system is read-only: make it writable, or use another folder"
        }
        ErrorKind::PermissionDenied => {
            "there is no permission: let the user that runs this program write there, or use another folder"
        }
        ErrorKind::NotFound => "the folder is missing: create it again, or use another one",
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists | ErrorKind::IsADirectory => {
            "something else is in its place: remove it, or use another folder"
        }
        ErrorKind::InvalidFilename => "a name is too long for the file system: shorten it",
        ErrorKind::FileTooLarge => "a file is too large for the file system: use another folder",
        _ => match error.raw_os_error() {
            Some(number) if TOO_MANY_FILES.contains(&number) => {
                "too many files are open: raise the limit (`ulimit -n`), and try again"
            }
            Some(BROKEN_DISK) => "the disk fails: check it, and use another one",
            _ => "check the disk and the permissions, or use another folder",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::remedy;
    use rustix::io::Errno;
    use std::io;

    #[test]
    fn each_cause_has_its_own_way_out() {
        let causes = [
            (Errno::NOSPC, "full"),
            (Errno::DQUOT, "quota"),
            (Errno::ROFS, "read-only"),
            (Errno::ACCESS, "permission"),
            (Errno::PERM, "permission"),
            (Errno::NOENT, "missing"),
            (Errno::NOTDIR, "in its place"),
            (Errno::NAMETOOLONG, "too long"),
            (Errno::FBIG, "too large"),
            (Errno::MFILE, "ulimit"),
            (Errno::NFILE, "ulimit"),
            (Errno::IO, "disk fails"),
            (Errno::STALE, "check the disk"),
        ];
        for (error, word) in causes {
            let words = remedy(&io::Error::from(error));
            assert!(words.contains(word), "{error}: {words}");
        }
    }
}
