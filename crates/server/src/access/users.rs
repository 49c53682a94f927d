//! Changes of users and tokens, by the server and the command line: validates requests, makes and hashes secrets, and writes the
//! roster. Slow: call changes only from blocking threads.

use super::passwords::{self, BYTES_MAX, HashError, LENGTH_MIN};
use super::private::{self, PrivateError};
use super::register::Register;
use super::roster::{Entry, Roster, RosterError, Token};
use super::secret::{Secret, hex, random};
use crate::settings::HashCost;
use rafcon_protocol::api::{NewToken, Right, Role, TokenMade};
use rafcon_supervisor::clock::since_1970_ms;
use std::path::Path;
use std::sync::Arc;

/// The maximum length of a token's name.
const TOKEN_NAME_MAX: usize = 100;

/// The users and tokens of a server's folder.
#[derive(Debug)]
pub struct Users {
    register: Register,
    cost: HashCost,
}

/// Reason why a change of users or tokens fails.
#[derive(Debug, thiserror::Error)]
pub enum UsersError {
    /// The change is not valid.
    #[error(transparent)]
    Roster(#[from] RosterError),
    /// A file cannot be read or written.
    #[error(transparent)]
    Private(#[from] PrivateError),
    /// The password cannot be hashed.
    #[error(transparent)]
    Hash(#[from] HashError),
    /// The password is too short, or much too long.
    #[error(
        "a password has {LENGTH_MIN} characters at least and {BYTES_MAX} bytes at most: choose another"
    )]
    BadPassword,
    /// The token's name is not valid.
    #[error("a token needs a name of 1 to {TOKEN_NAME_MAX} characters that describes its purpose")]
    BadTokenName,
}

impl Users {
    /// Opens those in a server's folder. Makes the folder if it does not exist.
    pub fn open(state: &Path, cost: HashCost) -> Result<Self, PrivateError> {
        private::folder(state)?;
        Ok(Self { register: Register::open(state)?, cost })
    }

    /// The current users and tokens.
    pub fn roster(&self) -> Arc<Roster> {
        self.register.now()
    }

    /// True if the user with this name currently has the right.
    pub(crate) fn may(&self, name: &str, right: Right) -> bool {
        self.roster().role_of(name).is_some_and(|role| role.grants(right))
    }

    pub(super) fn register(&self) -> &Register {
        &self.register
    }

    pub(super) fn cost(&self) -> HashCost {
        self.cost
    }

    /// Adds a user with role and password.
    pub fn add(&self, name: &str, role: Role, password: &str) -> Result<(), UsersError> {
        let password = self.hash(password)?;
        let entry = Entry { role, password, since_ms: since_1970_ms() };
        self.register.change(|roster| roster.add(name, entry))
    }

    /// Removes a user and all their tokens.
    pub fn remove(&self, name: &str) -> Result<(), UsersError> {
        self.register.change(|roster| roster.remove(name))
    }

    /// Sets a role, a password (which ends the user's logins), or both. If one fails, neither is set.
    pub fn change(
        &self,
        name: &str,
        role: Option<Role>,
        password: Option<&str>,
    ) -> Result<(), UsersError> {
        let hash = password.map(|password| self.hash(password)).transpose()?;
        let now_ms = since_1970_ms();
        self.register.change(|roster| {
            role.map_or(Ok(()), |role| roster.set_role(name, role))?;
            hash.map_or(Ok(()), |hash| roster.set_password(name, hash, now_ms))
        })
    }

    /// Stores the unchanged password, hashed at the current cost.
    pub(super) fn keep_again(
        &self,
        name: &str,
        old: &str,
        password: &str,
    ) -> Result<(), UsersError> {
        let hash = passwords::hash(password, self.cost)?;
        self.register.change(|roster| {
            roster.keep_again(name, old, hash);
            Ok(())
        })
    }

    /// Makes a token for a user whose current role is `most`.
    pub fn make_token(
        &self,
        user: &str,
        most: Role,
        wanted: &NewToken,
    ) -> Result<TokenMade, UsersError> {
        if !(1..=TOKEN_NAME_MAX).contains(&wanted.name.chars().count()) {
            return Err(UsersError::BadTokenName);
        }
        let (id, secret) = made()?;
        let made_ms = since_1970_ms();
        let lifetime = |seconds: u64| made_ms.saturating_add(seconds.saturating_mul(1000));
        let token = Token {
            user: user.to_owned(),
            name: wanted.name.clone(),
            role: wanted.role.unwrap_or(most),
            made_ms,
            expires_ms: wanted.lifetime_s.map(lifetime),
            digest: secret.digest().text(),
        };
        self.register.change(|roster| roster.add_token(id.clone(), token))?;
        Ok(TokenMade { id, token: secret.text().to_owned() })
    }

    /// Removes a token. With a user, only if the token belongs to them.
    pub fn remove_token(&self, id: &str, user: Option<&str>) -> Result<(), UsersError> {
        self.register.change(|roster| roster.remove_token(id, user))
    }

    fn hash(&self, password: &str) -> Result<String, UsersError> {
        if password.chars().count() < LENGTH_MIN || password.len() > BYTES_MAX {
            return Err(UsersError::BadPassword);
        }
        Ok(passwords::hash(password, self.cost)?)
    }
}

/// A new token's id and secret.
fn made() -> Result<(String, Secret), UsersError> {
    let failed = |error: std::io::Error| HashError::new(&error);
    let id = hex(&random::<8>().map_err(failed)?);
    Ok((id, Secret::new().map_err(failed)?))
}

#[cfg(test)]
mod tests {
    use super::{BYTES_MAX, TOKEN_NAME_MAX, Users, UsersError};
    use crate::settings::HashCost;
    use rafcon_protocol::api::{NewToken, Role};

    #[test]
    fn passwords_and_names_of_tokens_have_bounds() {
        let state = tempfile::tempdir().unwrap();
        let users = Users::open(state.path(), HashCost { memory_kib: 8, passes: 1 }).unwrap();
        let long = "p".repeat(BYTES_MAX);
        let add = |name, password: &str| users.add(name, Role::Viewer, password);
        assert!(matches!(add("anna", &format!("{long}p")), Err(UsersError::BadPassword)));
        // The limit is in bytes, not in characters.
        assert!(matches!(add("anna", &"ä".repeat(BYTES_MAX)), Err(UsersError::BadPassword)));
        add("anna", &long).unwrap();
        let token = |characters: usize| {
            let name = "ä".repeat(characters);
            users.make_token("anna", Role::Viewer, &NewToken { name, lifetime_s: None, role: None })
        };
        assert!(matches!(token(TOKEN_NAME_MAX + 1), Err(UsersError::BadTokenName)));
        assert!(matches!(token(0), Err(UsersError::BadTokenName)));
        token(TOKEN_NAME_MAX).unwrap();
    }
}
