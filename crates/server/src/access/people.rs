//! Who is let in: the owner of this computer's account, users with passwords, and programs with tokens.

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
/// The name of the user as whom the bridge to ROS 2 acts.
pub const ROS: &str = "ros";

/// How many passwords of strangers are hashed at a time: each takes memory and a processor.
const STRANGERS_MAX: usize = 2;
/// How many of users who have logged in from the same address before.
const FAMILIAR_MAX: usize = 1;

/// What someone shows to be let in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum CredentialClaim {
    /// A token: the owner's or a program's.
    Token(String),
    /// The cookie of a login.
    Cookie(String),
}

/// Everyone who may come in.
#[derive(Debug)]
pub struct People {
    owner: Secret,
    /// The bridge's; it stands in no file.
    ros: Secret,
    users: Arc<Users>,
    sessions: Sessions,
    familiar: Familiar,
    limiter: Mutex<Limiter>,
    strangers: Gate,
    /// For users who have logged in from the same address before: however many strangers try, these do not wait for them.
    familiar_ones: Gate,
    memory: Arc<HashMemory>,
    /// The time from which attempts are counted.
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

    /// The owner's token.
    pub(crate) fn owner(&self) -> &Secret {
        &self.owner
    }

    /// The token of the bridge to ROS 2, for the process that this server's program starts: it admits an operator.
    pub(crate) fn ros(&self) -> &Secret {
        &self.ros
    }

    /// Users and tokens.
    pub(crate) fn users(&self) -> &Arc<Users> {
        &self.users
    }

    /// The user with this credential. The owner's token counts on this computer only.
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

    /// Who that is now; no one, once the login, the token or the user is gone. Whoever was let in once and stays (a WebSocket)
    /// is asked for again with every new [`People::revision`] and before everything that needs a right.
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

    /// Is another number whenever someone's rights may be others.
    pub fn revision(&self) -> watch::Receiver<u64> {
        self.users.register().revision().subscribe()
    }

    /// Reads users and tokens again if they have changed.
    pub(crate) fn look(&self) {
        self.users.roster();
    }

    /// Whether this is the user's password. A few attempts are free, later ones have to wait.
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

    /// The work of comparing; a password hashed at another cost is hashed again.
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
                // A full disk keeps no one from a robot.
                log::say(&format!("the password of {user} keeps its old hash: {error}"));
            }
            Ok(is_right)
        }
    }

    /// Begins a login of someone who was checked.
    pub(crate) fn begin(&self, user: &str) -> Result<(Secret, Who), Failure> {
        let roster = self.users.roster();
        let since_ms = since(&roster, user).ok_or_else(wrong)?;
        let (secret, login) = self.sessions.begin(user, since_ms, since_1970_ms())?;
        let who = of_login(&roster, &secret.digest().text(), &login).ok_or_else(wrong)?;
        Ok((secret, who))
    }

    /// Ends a login.
    pub(crate) fn end(&self, who: &Who) -> Result<(), Failure> {
        let Credential::Session(digest) = &who.by else {
            let message = "this is no login: a token ends by being deleted, at /api/v1/tokens";
            return Err(Failure::conflict("not_a_login", message));
        };
        self.sessions.end(digest)?;
        self.changed();
        Ok(())
    }

    /// Lets a login continue although its user has chosen another password with it.
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

/// When someone's password was set; the owner has none.
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

/// The token in the folder if `keep` is set, else a new one. A token that cannot be written is valid, so that the owner can stop a
/// robot with a full disk.
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
