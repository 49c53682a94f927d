//! Logins by a password or the owner's link, with their expiry. Stored on disk, so that they outlast a restart of the server.
//! Only digests of their secrets are stored.

use super::private::{self, PrivateError};
use super::secret::{Digest, Secret};
use crate::log;
use rafcon_locks::Mutex;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

/// Lifetime of a login after its last use.
const LENGTH_MS: u64 = 12 * 3_600_000;
/// Minimum shift of a login's expiry that is worth a write.
const GRAIN_MS: u64 = 600_000;
/// Maximum number of logins per user. Beyond it, the one that expires first is removed.
const MAX_OF_ONE: usize = 20;

/// A login of a user.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Login {
    pub(super) user: String,
    /// Time at which the user's password was set. Another password ends the login.
    pub(super) since_ms: u64,
    pub(super) expires_ms: u64,
}

/// All logins, by the digest of their secret.
#[derive(Debug)]
pub(super) struct Sessions {
    file: PathBuf,
    logins: Mutex<BTreeMap<String, Login>>,
}

impl Sessions {
    /// Loads the logins of earlier servers. An invalid file counts as empty.
    pub(super) fn open(file: PathBuf) -> Result<Self, PrivateError> {
        let text = private::read(&file)?.unwrap_or_default();
        let logins = serde_json::from_str(&text).unwrap_or_default();
        Ok(Self { file, logins: Mutex::new(logins) })
    }

    /// Makes a login and its secret. A login that cannot be written lasts only as long as this server.
    pub(super) fn begin(
        &self,
        user: &str,
        since_ms: u64,
        now_ms: u64,
    ) -> Result<(Secret, Login), PrivateError> {
        let secret = Secret::new();
        let secret = secret.map_err(|source| PrivateError::new("make", &self.file, source))?;
        let login = Login { user: user.to_owned(), since_ms, expires_ms: now_ms + LENGTH_MS };
        let mut logins = self.logins.lock();
        logins.retain(|_, login| login.expires_ms > now_ms);
        make_room(&mut logins, user);
        logins.insert(secret.digest().text(), login.clone());
        if let Err(error) = self.keep(&logins) {
            log::say(&format!("{error}: the login of {user} ends with this server"));
        }
        Ok((secret, login))
    }

    /// The login with this secret. Extends its lifetime.
    pub(super) fn used(&self, secret: &str, now_ms: u64) -> Option<(String, Login)> {
        let digest = Digest::of(secret).text();
        let mut logins = self.logins.lock();
        let login = logins.get_mut(&digest).filter(|login| login.expires_ms > now_ms)?;
        let moved = (now_ms + LENGTH_MS).saturating_sub(login.expires_ms);
        if moved < GRAIN_MS {
            return Some((digest, login.clone()));
        }
        login.expires_ms += moved;
        let login = login.clone();
        // A failed write only makes the login expire earlier.
        self.keep(&logins).unwrap_or_default();
        Some((digest, login))
    }

    /// The login with this digest, if it has not expired.
    pub(super) fn with(&self, digest: &str, now_ms: u64) -> Option<Login> {
        self.logins.lock().get(digest).filter(|login| login.expires_ms > now_ms).cloned()
    }

    /// Ends a login. If the remaining logins cannot be written, it removes the file, so that all logins end with the server.
    pub(super) fn end(&self, digest: &str) -> Result<(), PrivateError> {
        let mut logins = self.logins.lock();
        logins.remove(digest);
        self.keep(&logins).or_else(|error| {
            fs::remove_file(&self.file)
                .map_err(|source| PrivateError::new("remove", &self.file, source))?;
            log::say(&format!("{error}: all logins end with this server"));
            Ok(())
        })
    }

    /// Keeps a login valid after a change of its user's password.
    pub(super) fn renew(&self, digest: &str, since_ms: u64) -> Result<(), PrivateError> {
        let mut logins = self.logins.lock();
        if let Some(login) = logins.get_mut(digest) {
            login.since_ms = since_ms;
        }
        self.keep(&logins)
    }

    fn keep(&self, logins: &BTreeMap<String, Login>) -> Result<(), PrivateError> {
        let text = serde_json::to_vec(logins).map_err(std::io::Error::from);
        let text = text.map_err(|source| PrivateError::new("write", &self.file, source))?;
        private::write_soon(&self.file, &text)
    }
}

/// Removes the oldest logins of a user to make room for one more.
fn make_room(logins: &mut BTreeMap<String, Login>, user: &str) {
    let own = logins.iter().filter(|(_, login)| login.user == user);
    let mut own = own.map(|(digest, login)| (login.expires_ms, digest.clone())).collect::<Vec<_>>();
    own.sort();
    let left_over = (own.len() + 1).saturating_sub(MAX_OF_ONE);
    for (_, digest) in own.into_iter().take(left_over) {
        logins.remove(&digest);
    }
}

#[cfg(test)]
mod tests {
    use super::{LENGTH_MS, MAX_OF_ONE, Sessions};

    #[test]
    fn a_login_lasts_while_it_is_used_and_outlives_the_server() {
        let place = tempfile::tempdir().unwrap();
        let open = || Sessions::open(place.path().join("sessions.json")).unwrap();
        let (secret, login) = open().begin("anna", 1, 0).unwrap();
        assert_eq!(login.expires_ms, LENGTH_MS);
        let sessions = open();
        let late = LENGTH_MS - 1;
        let (digest, login) = sessions.used(secret.text(), late).unwrap();
        assert_eq!(login.expires_ms, late + LENGTH_MS);
        assert_eq!(open().with(&digest, LENGTH_MS), Some(login));
        assert_eq!(sessions.used(secret.text(), late + LENGTH_MS), None);
        assert_eq!(sessions.used(&digest, late), None);
    }

    #[test]
    fn many_logins_end_the_oldest_of_the_same_user_only() {
        let place = tempfile::tempdir().unwrap();
        let sessions = Sessions::open(place.path().join("sessions.json")).unwrap();
        let begin = |user: &str, now_ms| sessions.begin(user, 1, now_ms).unwrap().0;
        let (ben, first, second) = (begin("ben", 0), begin("anna", 1), begin("anna", 2));
        for now_ms in 3..=1 + MAX_OF_ONE as u64 {
            begin("anna", now_ms);
        }
        let is_known = |secret: &super::Secret| sessions.used(secret.text(), 99).is_some();
        assert_eq!([&ben, &first, &second].map(is_known), [true, false, true]);
    }

    #[test]
    fn a_clock_that_goes_back_ends_no_login() {
        let place = tempfile::tempdir().unwrap();
        let sessions = Sessions::open(place.path().join("sessions.json")).unwrap();
        let (secret, login) = sessions.begin("anna", 1, 1000).unwrap();
        assert_eq!(sessions.used(secret.text(), 0).unwrap().1, login);
    }

    #[test]
    fn a_login_on_a_full_disk_is_valid_and_an_ended_one_is_not_valid_later() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("sessions.json");
        let sessions = Sessions::open(file.clone()).unwrap();
        let (before, _) = sessions.begin("anna", 1, 0).unwrap();
        // A folder with the name of the temporary file makes the write fail.
        let staged = file.with_extension(format!("new-{}", std::process::id()));
        std::fs::create_dir(staged).unwrap();
        let (secret, _) = sessions.begin("anna", 1, 0).unwrap();
        assert!(sessions.used(secret.text(), 1).is_some());
        let (digest, _) = sessions.used(before.text(), 1).unwrap();
        sessions.end(&digest).unwrap();
        assert!(sessions.used(secret.text(), 1).is_some());
        assert_eq!(Sessions::open(file).unwrap().used(before.text(), 1), None);
    }

    #[test]
    fn an_ended_login_is_known_no_more() {
        let place = tempfile::tempdir().unwrap();
        let sessions = Sessions::open(place.path().join("sessions.json")).unwrap();
        let (secret, _) = sessions.begin("anna", 1, 0).unwrap();
        let (digest, _) = sessions.used(secret.text(), 1).unwrap();
        sessions.end(&digest).unwrap();
        assert_eq!(sessions.used(secret.text(), 1), None);
    }
}
