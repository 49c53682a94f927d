//! Authentication: the owner of this computer's account, users with passwords, and programs with tokens.

use super::familiar::Familiar;
use super::limiter::{Limiter, Try, network};
use super::passwords::{self, BYTES_MAX, HashMemory};
use super::private::{self, PrivateError};
use super::roster::{Roster, Token};
use super::secret::{Digest, Secret};
use super::sessions::{Login, Sessions};
use super::users::Users;
use super::who::{Credential, Who};
use crate::gate::Gate;
use crate::{Failure, Settings, log};
use rafcon_locks::Mutex;
use rafcon_protocol::api::Role;
use rafcon_supervisor::clock::since_1970_ms;
use std::net::IpAddr;
use std::path::Path;
use std::sync::Arc;
use tokio::sync::watch;
use tokio::time::Instant;

/// The name of the user with the owner's token.
pub const OWNER: &str = "owner";
/// The name of the user for the bridge to ROS 2.
pub const ROS: &str = "ros";

/// Parallel password checks from unfamiliar addresses. Each takes memory and a processor.
const STRANGERS_MAX: usize = 2;
/// Parallel password checks of users at familiar addresses.
const FAMILIAR_MAX: usize = 1;

/// Credential in a request, not yet verified.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum CredentialClaim {
    /// A token: the owner's or a program's.
    Token(String),
    /// The cookie of a login.
    Cookie(String),
}

/// All users, tokens and logins.
#[derive(Debug)]
pub struct People {
    owner: Secret,
    /// Token of the bridge to ROS 2. It is never stored.
    ros: Secret,
    users: Arc<Users>,
    sessions: Sessions,
    familiar: Familiar,
    limiter: Mutex<Limiter>,
    strangers: Gate,
    /// For users at familiar addresses, so that attempts of others do not delay them.
    familiar_ones: Gate,
    memory: Arc<HashMemory>,
    /// Reference time of the limiter.
    begun: Instant,
}

impl People {
    /// Reads users and tokens, and makes the owner's token.
    pub(crate) fn open(settings: &Settings) -> Result<Self, PrivateError> {
        let state = &settings.state;
        Ok(Self {
            owner: owners_token(state, settings.access.keep_token, settings.tell)?,
            ros: Secret::new()
                .map_err(|source| PrivateError::new("make a token for", state, source))?,
            users: Arc::new(Users::open(state, settings.access.cost)?),
            sessions: Sessions::open(state.join("sessions.json"))?,
            familiar: Familiar::open(state.join("familiar.json"))?,
            limiter: Mutex::default(),
            strangers: Gate::of(STRANGERS_MAX),
            familiar_ones: Gate::of(FAMILIAR_MAX),
            memory: Arc::default(),
            begun: Instant::now(),
        })
    }

    /// Token of the computer account's owner.
    pub(crate) fn owner(&self) -> &Secret {
        &self.owner
    }

    /// The token of the bridge to ROS 2, passed to the process that this server's program starts. It grants the role of operator.
    pub(crate) fn ros(&self) -> &Secret {
        &self.ros
    }

    /// The store of users and tokens.
    pub(crate) fn users(&self) -> &Arc<Users> {
        &self.users
    }

    /// The user with this credential. The owner's token is valid on this computer only.
    pub(crate) fn known(&self, claim: &CredentialClaim, is_near: bool) -> Option<Who> {
        let now_ms = since_1970_ms();
        let roster = self.users.roster();
        let who = match claim {
            CredentialClaim::Token(text) => {
                let digest = Digest::of(text);
                if digest == self.owner.digest() {
                    return is_near.then(owner);
                }
                if digest == self.ros.digest() {
                    return is_near.then(ros);
                }
                let (id, token) = roster.token_of(digest)?;
                of_token(&roster, id, token, now_ms)
            }
            CredentialClaim::Cookie(text) => {
                let (digest, login) = self.sessions.used(text, now_ms)?;
                of_login(&roster, &digest, &login)
            }
        };
        who.filter(|who| is_near || who.user != OWNER)
    }

    /// The current rights of an authenticated user. `None` once the login, token or user no longer exists. A connection that
    /// lasts (a WebSocket) calls it at each new [`People::revision`] and before each action that needs a right.
    pub fn still(&self, who: &Who) -> Option<Who> {
        let now_ms = since_1970_ms();
        let roster = self.users.roster();
        match &who.by {
            Credential::Owner | Credential::Ros => Some(who.clone()),
            Credential::Session(digest) => {
                of_login(&roster, digest, &self.sessions.with(digest, now_ms)?)
            }
            Credential::Token(id) => of_token(&roster, id, roster.token(id)?, now_ms),
        }
    }

    /// Changes when the rights of a user may have changed.
    pub fn revision(&self) -> watch::Receiver<u64> {
        self.users.register().revision().subscribe()
    }

    /// Reloads users and tokens if their file has changed.
    pub(crate) fn look(&self) {
        self.users.roster();
    }

    /// Verifies a user's password. After a burst of attempts, further ones must wait.
    pub(crate) async fn check(
        &self,
        user: &str,
        password: &str,
        from: IpAddr,
    ) -> Result<(), Failure> {
        let from = network(from);
        let tried = Try { user, from, is_familiar: self.familiar.knows(user, from) };
        self.limiter.lock().attempt(tried, self.age_ms()).map_err(too_often)?;
        if password.len() > BYTES_MAX {
            return Err(wrong());
        }
        let kept = self.users.roster().user(user).map(|entry| entry.password.clone());
        let gate = if tried.is_familiar { &self.familiar_ones } else { &self.strangers };
        let is_right = self.compare(user.to_owned(), password.to_owned(), kept);
        if !gate.work(is_right).await? {
            return Err(wrong());
        }
        self.limiter.lock().succeeded(tried);
        self.familiar.add(user, from);
        Ok(())
    }

    fn age_ms(&self) -> u64 {
        u64::try_from(self.begun.elapsed().as_millis()).unwrap_or(u64::MAX)
    }

    /// The comparison, for a blocking thread. Renews the hash of a password that was hashed at another cost.
    fn compare(
        &self,
        user: String,
        password: String,
        kept: Option<String>,
    ) -> impl FnOnce() -> Result<bool, Failure> + Send + 'static {
        let (users, memory) = (Arc::clone(&self.users), Arc::clone(&self.memory));
        move || {
            let cost = users.cost();
            let is_right = memory.is_right(&password, kept.as_deref(), cost);
            let is_old = |kept: &String| is_right && !passwords::is_of(kept, cost);
            if let Some(kept) = kept.filter(is_old)
                && let Err(error) = users.keep_again(&user, &kept, &password)
            {
                // A full disk must not prevent a login.
                log::say(&format!("the password of {user} keeps its old hash: {error}"));
            }
            Ok(is_right)
        }
    }

    /// Starts a login for a verified user.
    pub(crate) fn begin(&self, user: &str) -> Result<(Secret, Who), Failure> {
        let roster = self.users.roster();
        let since_ms = since(&roster, user).ok_or_else(wrong)?;
        let (secret, login) = self.sessions.begin(user, since_ms, since_1970_ms())?;
        let who = of_login(&roster, &secret.digest().text(), &login).ok_or_else(wrong)?;
        Ok((secret, who))
    }

    /// Ends the user's current login.
    pub(crate) fn end(&self, who: &Who) -> Result<(), Failure> {
        let Credential::Session(digest) = &who.by else {
            let message = "this is no login: a token ends by being deleted, at /api/v1/tokens";
            return Err(Failure::conflict("not_a_login", message));
        };
        self.sessions.end(digest)?;
        self.changed();
        Ok(())
    }

    /// Keeps a login valid after its user has changed the password with it.
    pub(crate) fn renew(&self, who: &Who) -> Result<(), Failure> {
        let since = since(&self.users.roster(), &who.user);
        if let (Credential::Session(digest), Some(since_ms)) = (&who.by, since) {
            self.sessions.renew(digest, since_ms)?;
        }
        self.changed();
        Ok(())
    }

    fn changed(&self) {
        self.users.register().revision().send_modify(|revision| *revision += 1);
    }
}

fn owner() -> Who {
    let user = OWNER.to_owned();
    Who { user, role: Role::Admin, expires_ms: None, by: Credential::Owner }
}

fn ros() -> Who {
    Who { user: ROS.to_owned(), role: Role::Operator, expires_ms: None, by: Credential::Ros }
}

/// Time at which a user's password was set; 0 for the owner, who has none.
fn since(roster: &Roster, user: &str) -> Option<u64> {
    if user == OWNER {
        return Some(0);
    }
    roster.user(user).map(|entry| entry.since_ms)
}

fn of_login(roster: &Roster, digest: &str, login: &Login) -> Option<Who> {
    let role = roster.role_of(&login.user)?;
    let is_good = since(roster, &login.user) == Some(login.since_ms);
    let by = Credential::Session(digest.to_owned());
    let (user, expires_ms) = (login.user.clone(), Some(login.expires_ms));
    is_good.then_some(Who { user, role, expires_ms, by })
}

fn of_token(roster: &Roster, id: &str, token: &Token, now_ms: u64) -> Option<Who> {
    let role = roster.role_of(&token.user)?.min(token.role);
    let by = Credential::Token(id.to_owned());
    let (user, expires_ms) = (token.user.clone(), token.expires_ms);
    (!token.is_over(now_ms)).then_some(Who { user, role, expires_ms, by })
}

fn wrong() -> Failure {
    let message = "this is not a user and their password: try again, or ask an admin for another";
    Failure::unauthorized("wrong_login", message)
}

fn too_often(seconds: u64) -> Failure {
    let message = format!("too many logins were tried: wait {seconds} s");
    let failure = Failure::too_many("too_many_logins", message);
    failure.retry_after(seconds)
}

/// The stored token if `keep` is set, else a new one. A token that cannot be written is still valid, so that the owner can
/// stop a robot with a full disk.
fn owners_token(state: &Path, keep: bool, log: fn(&str)) -> Result<Secret, PrivateError> {
    let file = state.join("token");
    let kept = if keep { private::read(&file)? } else { None };
    if let Some(secret) = kept.as_deref().and_then(Secret::read) {
        return Ok(secret);
    }
    let secret = Secret::new().map_err(|source| PrivateError::new("make", &file, source))?;
    if let Err(error) = private::write_without_room(&file, secret.text().as_bytes()) {
        log(&format!(
            "{error}: the printed address admits you; other programs of this computer need its token in RAFCON_TOKEN"
        ));
    }
    Ok(secret)
}
