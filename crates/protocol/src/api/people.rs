//! Who may do what.

use serde::{Deserialize, Serialize};

/// What a request needs. Rights are granted by [`Role`]s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Right {
    /// Whoever reaches the server: only to log in and to ask whether it is there.
    Anyone,
    /// See projects, machines and runs.
    Observe,
    /// Command a run in progress, and answer its questions.
    Command,
    /// Start a run, and take one up again.
    Start,
    /// Change machines and scripts: what decides which Python text runs.
    Edit,
    /// Manage users and delete runs.
    Administer,
}

/// What someone is allowed to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Looks on.
    Viewer,
    /// Starts and commands runs.
    Operator,
    /// Also changes machines.
    Engineer,
    /// Also manages users and deletes runs.
    Admin,
}

impl Role {
    /// All roles, the least first.
    pub const ALL: [Self; 4] = [Self::Viewer, Self::Operator, Self::Engineer, Self::Admin];

    /// Whether it grants a right.
    pub fn grants(self, right: Right) -> bool {
        self >= match right {
            Right::Anyone | Right::Observe => Self::Viewer,
            Right::Command | Right::Start => Self::Operator,
            Right::Edit => Self::Engineer,
            Right::Administer => Self::Admin,
        }
    }
}

/// Who someone is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Session {
    /// The user's name.
    pub user: String,
    /// What the user may do.
    pub role: Role,
    /// The same in detail.
    pub rights: Vec<Right>,
    /// The server's version.
    pub version: String,
    /// When the session ends: ms since 1970, UTC; none if it lasts as long as the server.
    pub expires_ms: Option<u64>,
}

/// A login.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Login {
    /// The user's name.
    pub user: String,
    /// The password.
    #[cfg_attr(feature = "schema", schema(max_length = 1024))]
    pub password: String,
}

/// Another password for oneself.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ChangePassword {
    /// The password so far.
    #[cfg_attr(feature = "schema", schema(max_length = 1024))]
    pub password: String,
    /// The new one, of at least 10 characters.
    #[cfg_attr(feature = "schema", schema(min_length = 10, max_length = 1024))]
    pub new_password: String,
}

/// One who may log in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct User {
    /// The name.
    pub name: String,
    /// What the user may do.
    pub role: Role,
}

/// A user to be added.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct NewUser {
    /// The name: letters, digits, `.`, `-`, `_`; at most 64.
    #[cfg_attr(feature = "schema", schema(pattern = "^[A-Za-z0-9._-]{1,64}$"))]
    pub name: String,
    /// What the user may do.
    pub role: Role,
    /// The password, of at least 10 characters.
    #[cfg_attr(feature = "schema", schema(min_length = 10, max_length = 1024))]
    pub password: String,
}

/// A change of a user; what is left out stays.
#[derive(Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(default)]
pub struct ChangeUser {
    /// Another role.
    pub role: Option<Role>,
    /// Another password.
    #[cfg_attr(feature = "schema", schema(min_length = 10, max_length = 1024))]
    pub password: Option<String>,
}

/// A token for a program, asked for by the user whom it stands for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct NewToken {
    /// What it is for, for people.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 100))]
    pub name: String,
    /// For how many seconds it is good; none: until it is deleted.
    #[serde(default)]
    pub lifetime_s: Option<u64>,
    /// A lesser role than the user's.
    #[serde(default)]
    pub role: Option<Role>,
}

/// A token that was made. Its text is told this once only.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct TokenMade {
    /// Names it in the list of tokens.
    pub id: String,
    /// The secret.
    pub token: String,
}

/// What may be told about a token.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct TokenAbout {
    /// Its id.
    pub id: String,
    /// Whom it stands for.
    pub user: String,
    /// What it is for.
    pub name: String,
    /// What it allows.
    pub role: Role,
    /// When it was made: ms since 1970, UTC.
    pub made_ms: u64,
    /// When it ends: ms since 1970, UTC.
    pub expires_ms: Option<u64>,
}

/// Secrets stay out of logs.
macro_rules! told_without_secrets {
    ($($name:ident: $shown:ident),*) => {$(
        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.debug_struct(stringify!($name)).field(stringify!($shown), &self.$shown).finish_non_exhaustive()
            }
        }
    )*};
}

told_without_secrets!(Login: user, NewUser: name, ChangeUser: role, TokenMade: id);

impl std::fmt::Debug for ChangePassword {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("ChangePassword")
    }
}
