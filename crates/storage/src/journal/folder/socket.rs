//! Socket in the folder of a run, for programs that join it.

use super::SOCKET_FILE;
use std::fs::{self, File, Permissions};
use std::io;
use std::os::fd::AsRawFd as _;
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::net::UnixListener;
use std::path::Path;

/// Binds the socket in this folder, for this user only. Removes a socket left by an earlier program.
pub fn bind_socket(folder: &Path) -> io::Result<UnixListener> {
    let path = folder.join(SOCKET_FILE);
    match fs::remove_file(&path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        Ok(()) | Err(_) => {}
    }
    let listener = bind(folder, &path)?;
    fs::set_permissions(&path, Permissions::from_mode(0o600))?;
    Ok(listener)
}

/// Binds through the folder's descriptor, because the path of a socket is limited to about a hundred bytes.
#[cfg(target_os = "linux")]
fn bind(folder: &Path, _path: &Path) -> io::Result<UnixListener> {
    let folder = File::open(folder)?;
    UnixListener::bind(format!("/proc/self/fd/{}/{SOCKET_FILE}", folder.as_raw_fd()))
}

#[cfg(not(target_os = "linux"))]
fn bind(_folder: &Path, path: &Path) -> io::Result<UnixListener> {
    UnixListener::bind(path)
}
