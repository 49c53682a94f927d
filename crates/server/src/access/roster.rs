//! Users and tokens as a value: names, roles and hashes of secrets. Pure: a change returns a new roster or a refusal.

use super::secret::Digest;
use super::{OWNER, ROS};
use rafcon_protocol::api::{Role, TokenAbout, User};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The maximum length of a name.
const NAME_MAX: usize = 64;
/// Maximum number of tokens per user.
const TOKENS_MAX: usize = 100;

/// All users and tokens except the owner's.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Roster {
    users: BTreeMap<String, Entry>,
    tokens: BTreeMap<String, Token>,
}

/// Stored data of a user.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Entry {
    pub(super) role: Role,
    /// Hash of the password.
    pub(super) password: String,
    /// Time at which the password was set: ms since 1970, UTC. Earlier logins are invalid.
    pub(super) since_ms: u64,
}

/// Stored data of a token.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Token {
    pub(super) user: String,
    pub(super) name: String,
    pub(super) role: Role,
    pub(super) made_ms: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) expires_ms: Option<u64>,
    /// The digest of its secret.
    pub(super) digest: String,
}

/// Reason why a change of the roster is refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RosterError {
    /// The name is not valid.
    #[error(
        "`{0}` cannot be a user's name: use 1 to {NAME_MAX} of the letters a to z and A to Z, digits, `.`, `-` and `_`, and neither `{OWNER}` nor `{ROS}`"
    )]
    BadName(String),
    /// The name is taken.
    #[error("there is a user {0} already: choose another name, or change that user")]
    Taken(String),
    /// No user has this name.
    #[error("there is no user {0}: `rafcon user list` names them")]
    NoUser(String),
    /// The user is the last admin.
    #[error("{0} is the only admin: make somebody else one first")]
    LastAdmin(String),
    /// No token has this id.
    #[error("there is no such token: the list of tokens names them")]
    NoToken,
    /// The token has more rights than its user.
    #[error("a token may do no more than its user: ask for a lesser role")]
    TooMuch,
    /// The user has too many tokens.
    #[error("{0} has {TOKENS_MAX} tokens: delete some first")]
    TooMany(String),
}

impl Roster {
    /// Stored data of a user.
    pub(super) fn user(&self, name: &str) -> Option<&Entry> {
        self.users.get(name)
    }

    /// The role of a user. The owner is an admin.
    pub(super) fn role_of(&self, name: &str) -> Option<Role> {
        if name == OWNER {
            return Some(Role::Admin);
        }
        self.users.get(name).map(|user| user.role)
    }

    /// All users, sorted by name.
    pub fn users(&self) -> Vec<User> {
        let user = |(name, entry): (&String, &Entry)| User { name: name.clone(), role: entry.role };
        self.users.iter().map(user).collect()
    }

    /// The token with this id.
    pub(super) fn token(&self, id: &str) -> Option<&Token> {
        self.tokens.get(id)
    }

    /// The token with this secret.
    pub(super) fn token_of(&self, digest: Digest) -> Option<(&str, &Token)> {
        let is_it = |token: &Token| Digest::read(&token.digest) == Some(digest);
        let mut tokens = self.tokens.iter();
        tokens.find(|(_, token)| is_it(token)).map(|(id, token)| (id.as_str(), token))
    }

    /// Tokens of a user, or of all users.
    pub(super) fn tokens(&self, user: Option<&str>) -> Vec<TokenAbout> {
        let wanted = |token: &Token| user.is_none_or(|user| user == token.user);
        let tokens = self.tokens.iter().filter(|(_, token)| wanted(token));
        tokens.map(|(id, token)| token.about(id)).collect()
    }

    pub(super) fn add(&mut self, name: &str, entry: Entry) -> Result<(), RosterError> {
        if !is_name(name) {
            return Err(RosterError::BadName(name.to_owned()));
        }
        if self.users.contains_key(name) {
            return Err(RosterError::Taken(name.to_owned()));
        }
        self.users.insert(name.to_owned(), entry);
        Ok(())
    }

    pub(super) fn set_role(&mut self, name: &str, role: Role) -> Result<(), RosterError> {
        if role != Role::Admin {
            self.check_not_last(name)?;
        }
        self.entry(name)?.role = role;
        Ok(())
    }

    /// Sets a password and ends the user's logins. Tokens stay valid: they are separate secrets.
    pub(super) fn set_password(
        &mut self,
        name: &str,
        hash: String,
        now_ms: u64,
    ) -> Result<(), RosterError> {
        let entry = self.entry(name)?;
        entry.password = hash;
        entry.since_ms = now_ms.max(entry.since_ms + 1);
        Ok(())
    }

    /// Stores the unchanged password, hashed at another cost. Logins stay valid.
    pub(super) fn keep_again(&mut self, name: &str, old: &str, hash: String) {
        let entry = self.users.get_mut(name).filter(|entry| entry.password == old);
        if let Some(entry) = entry {
            entry.password = hash;
        }
    }

    /// Removes the user and all their tokens.
    pub(super) fn remove(&mut self, name: &str) -> Result<(), RosterError> {
        self.check_not_last(name)?;
        self.users.remove(name).ok_or_else(|| RosterError::NoUser(name.to_owned()))?;
        self.tokens.retain(|_, token| token.user != name);
        Ok(())
    }

    pub(super) fn add_token(&mut self, id: String, token: Token) -> Result<(), RosterError> {
        let user = token.user.clone();
        let role = self.role_of(&user).ok_or_else(|| RosterError::NoUser(user.clone()))?;
        if token.role > role {
            return Err(RosterError::TooMuch);
        }
        self.tokens.retain(|_, old| old.expires_ms.is_none_or(|end| end > token.made_ms));
        if self.tokens.values().filter(|token| token.user == user).count() >= TOKENS_MAX {
            return Err(RosterError::TooMany(user));
        }
        self.tokens.insert(id, token);
        Ok(())
    }

    /// Removes a token. With a user, only if the token belongs to them.
    pub(super) fn remove_token(&mut self, id: &str, user: Option<&str>) -> Result<(), RosterError> {
        let is_theirs = |token: &&Token| user.is_none_or(|user| user == token.user);
        self.tokens.get(id).filter(is_theirs).ok_or(RosterError::NoToken)?;
        self.tokens.remove(id);
        Ok(())
    }

    fn entry(&mut self, name: &str) -> Result<&mut Entry, RosterError> {
        self.users.get_mut(name).ok_or_else(|| RosterError::NoUser(name.to_owned()))
    }

    fn check_not_last(&self, name: &str) -> Result<(), RosterError> {
        let is_admin = |entry: &Entry| entry.role == Role::Admin;
        let others = self.users.iter().any(|(other, entry)| other != name && is_admin(entry));
        if !others && self.users.get(name).is_some_and(is_admin) {
            return Err(RosterError::LastAdmin(name.to_owned()));
        }
        Ok(())
    }
}

impl Token {
    /// True if the token has expired.
    pub(super) fn is_over(&self, now_ms: u64) -> bool {
        self.expires_ms.is_some_and(|end| end <= now_ms)
    }

    fn about(&self, id: &str) -> TokenAbout {
        TokenAbout {
            id: id.to_owned(),
            user: self.user.clone(),
            name: self.name.clone(),
            role: self.role,
            made_ms: self.made_ms,
            expires_ms: self.expires_ms,
        }
    }
}

fn is_name(name: &str) -> bool {
    let fits = |byte: u8| byte.is_ascii_alphanumeric() || b".-_".contains(&byte);
    (1..=NAME_MAX).contains(&name.len()) && name.bytes().all(fits) && ![OWNER, ROS].contains(&name)
}

#[cfg(test)]
mod tests {
    use super::{Entry, NAME_MAX, Roster, RosterError, TOKENS_MAX, Token};
    use crate::access::secret::Secret;
    use expect_test::{Expect, expect};
    use rafcon_protocol::api::Role;

    fn entry(role: Role) -> Entry {
        Entry { role, password: "hash".to_owned(), since_ms: 1 }
    }

    fn token(user: &str, role: Role, expires_ms: Option<u64>) -> Token {
        let digest = Secret::new().unwrap().digest().text();
        let (user, name) = (user.to_owned(), "ci".to_owned());
        Token { user, name, role, made_ms: 1, expires_ms, digest }
    }

    /// Applies one change per line, and prints the results.
    fn check(script: &str, expected: &Expect) {
        let mut roster = Roster::default();
        let role = |word: &str| serde_json::from_str(&format!("\"{word}\"")).unwrap();
        let mut said = Vec::new();
        for line in script.lines().map(str::trim).filter(|line| !line.is_empty()) {
            let words = line.split(' ').collect::<Vec<_>>();
            let came = match words.as_slice() {
                ["add", name, word] => roster.add(name, entry(role(word))),
                ["role", name, word] => roster.set_role(name, role(word)),
                ["remove", name] => roster.remove(name),
                ["token", id, name, word] => {
                    roster.add_token((*id).to_owned(), token(name, role(word), None))
                }
                ["untoken", id, name] => roster.remove_token(id, Some(name)),
                _ => panic!("{line}"),
            };
            let came = came.err().map_or("done".to_owned(), |error| error.to_string());
            said.push(format!("{line}: {came}\n"));
        }
        let users = roster.users().into_iter().map(|user| format!("{} ", user.name));
        let tokens = roster.tokens(None).into_iter().map(|token| format!("{} ", token.id));
        said.extend(users.chain(tokens));
        expected.assert_eq(&said.concat());
    }

    #[test]
    fn names_are_plain_and_taken_once() {
        check(
            "add anna operator
             add anna viewer
             add owner viewer
             add ros operator
             add ../anna viewer
             add bo.b-1_ viewer",
            &expect![[r"
                add anna operator: done
                add anna viewer: there is a user anna already: choose another name, or change that user
                add owner viewer: `owner` cannot be a user's name: use 1 to 64 of the letters a to z and A to Z, digits, `.`, `-` and `_`, and neither `owner` nor `ros`
                add ros operator: `ros` cannot be a user's name: use 1 to 64 of the letters a to z and A to Z, digits, `.`, `-` and `_`, and neither `owner` nor `ros`
                add ../anna viewer: `../anna` cannot be a user's name: use 1 to 64 of the letters a to z and A to Z, digits, `.`, `-` and `_`, and neither `owner` nor `ros`
                add bo.b-1_ viewer: done
                anna bo.b-1_ "]],
        );
    }

    #[test]
    fn the_last_admin_stays() {
        check(
            "add anna admin
             remove anna
             role anna viewer
             add bob admin
             role anna viewer
             remove bob
             remove anna
             remove anna",
            &expect![[r"
                add anna admin: done
                remove anna: anna is the only admin: make somebody else one first
                role anna viewer: anna is the only admin: make somebody else one first
                add bob admin: done
                role anna viewer: done
                remove bob: bob is the only admin: make somebody else one first
                remove anna: done
                remove anna: there is no user anna: `rafcon user list` names them
                bob "]],
        );
    }

    #[test]
    fn tokens_belong_to_users_and_go_with_them() {
        check(
            "add anna operator
             add bob viewer
             token a anna engineer
             token a anna operator
             token b bob viewer
             token c owner admin
             token d carl viewer
             untoken b anna
             untoken a anna
             untoken a anna
             remove bob",
            &expect![[r"
                add anna operator: done
                add bob viewer: done
                token a anna engineer: a token may do no more than its user: ask for a lesser role
                token a anna operator: done
                token b bob viewer: done
                token c owner admin: done
                token d carl viewer: there is no user carl: `rafcon user list` names them
                untoken b anna: there is no such token: the list of tokens names them
                untoken a anna: done
                untoken a anna: there is no such token: the list of tokens names them
                remove bob: done
                anna c "]],
        );
    }

    #[test]
    fn a_token_is_found_by_its_secret() {
        let mut roster = Roster::default();
        let (one, other) = (Secret::new().unwrap(), Secret::new().unwrap());
        let token = Token { digest: one.digest().text(), ..token("owner", Role::Viewer, Some(9)) };
        roster.add_token("t".to_owned(), token).unwrap();
        assert_eq!(roster.token_of(one.digest()).unwrap().0, "t");
        assert!(roster.token_of(other.digest()).is_none());
        let token = roster.token("t").unwrap();
        assert_eq!((token.is_over(8), token.is_over(9)), (false, true));
    }

    #[test]
    fn a_name_has_at_most_so_many_bytes() {
        let mut roster = Roster::default();
        let name = "a".repeat(NAME_MAX);
        let long = format!("{name}a");
        assert_eq!(roster.add(&long, entry(Role::Viewer)), Err(RosterError::BadName(long.clone())));
        roster.add(&name, entry(Role::Viewer)).unwrap();
        assert_eq!(roster.users().len(), 1);
    }

    #[test]
    fn a_user_has_at_most_so_many_tokens() {
        let mut roster = Roster::default();
        let add =
            |roster: &mut Roster, id: usize, token: Token| roster.add_token(format!("{id}"), token);
        for id in 0..TOKENS_MAX {
            add(&mut roster, id, token("owner", Role::Viewer, Some(9))).unwrap();
        }
        let refused = add(&mut roster, TOKENS_MAX, token("owner", Role::Viewer, None));
        assert_eq!(refused, Err(RosterError::TooMany("owner".to_owned())));
        // The limit is per user.
        roster.add("anna", entry(Role::Viewer)).unwrap();
        add(&mut roster, TOKENS_MAX, token("anna", Role::Viewer, None)).unwrap();
        roster.remove_token("7", None).unwrap();
        add(&mut roster, 7, token("owner", Role::Viewer, None)).unwrap();
        // Expired tokens are removed to make room.
        let late = Token { made_ms: 9, ..token("owner", Role::Viewer, None) };
        add(&mut roster, TOKENS_MAX + 1, late).unwrap();
        assert_eq!(roster.tokens(Some("owner")).len(), 2);
    }
}
