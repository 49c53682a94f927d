//! Users, roles, rights and tokens.

use serde::{Deserialize, Serialize};

/// Right that a request needs. [`Role`]s grant rights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Right {
    /// Log in and check that the server is running. Needs no account.
    Anyone,
    /// See projects, machines and runs.
    Observe,
    /// Command a run in progress, and answer its questions.
    Command,
    /// Start or resume a run.
    Start,
    /// Change machines and scripts, and so the Python code that runs.
    Edit,
    /// Manage users and delete runs.
    Administer,
}

/// Role of a user.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Sees projects, machines and runs.
    Viewer,
    /// Also starts and commands runs.
    Operator,
    /// Also changes machines and their scripts.
    Engineer,
    /// Also manages users and deletes runs.
    Admin,
}

impl Role {
    /// All roles, the one with the fewest rights first.
    pub const ALL: [Self; 4] = [Self::Viewer, Self::Operator, Self::Engineer, Self::Admin];

    /// Returns true if the role grants the right.
    pub fn grants(self, right: Right) -> bool {
        self >= match right {
            Right::Anyone | Right::Observe => Self::Viewer,
            Right::Command | Right::Start => Self::Operator,
            Right::Edit => Self::Engineer,
            Right::Administer => Self::Admin,
        }
    }
}

/// Session of a user or program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Session {
    /// Name of the user.
    pub user: String,
    /// Role of the user.
    pub role: Role,
    /// All rights of the role.
    pub rights: Vec<Right>,
    /// Version of the server.
    pub version: String,
    /// End of the session: ms since 1970, UTC. Empty if it lasts until the server stops.
    pub expires_ms: Option<u64>,
}

/// Request to log in.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Login {
    /// Name of the user.
    pub user: String,
    /// Password of the user.
    #[cfg_attr(feature = "schema", schema(max_length = 1024))]
    pub password: String,
}

/// Request of a user to change the own password.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct ChangePassword {
    /// Current password, as proof of identity.
    #[cfg_attr(feature = "schema", schema(max_length = 1024))]
    pub password: String,
    /// The new password, of at least 10 characters.
    #[cfg_attr(feature = "schema", schema(min_length = 10, max_length = 1024))]
    pub new_password: String,
}

/// A user of the server.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct User {
    /// Name of the user.
    pub name: String,
    /// Role of the user.
    pub role: Role,
}

/// Request to add a user.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct NewUser {
    /// Name of the user: letters, digits, `.`, `-`, `_`; at most 64.
    #[cfg_attr(feature = "schema", schema(pattern = "^[A-Za-z0-9._-]{1,64}$"))]
    pub name: String,
    /// Role of the user.
    pub role: Role,
    /// The password, of at least 10 characters.
    #[cfg_attr(feature = "schema", schema(min_length = 10, max_length = 1024))]
    pub password: String,
}

/// Request to change a user. Empty fields are not changed.
#[derive(Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(default)]
pub struct ChangeUser {
    /// New role of the user.
    pub role: Option<Role>,
    /// New password of the user.
    #[cfg_attr(feature = "schema", schema(min_length = 10, max_length = 1024))]
    pub password: Option<String>,
}

/// Request for an access token, which represents the requesting user.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct NewToken {
    /// Purpose of the token, for people.
    #[cfg_attr(feature = "schema", schema(min_length = 1, max_length = 100))]
    pub name: String,
    /// Lifetime in seconds. Empty for a token without expiry.
    #[serde(default)]
    pub lifetime_s: Option<u64>,
    /// Role of the token, if lower than the user's.
    #[serde(default)]
    pub role: Option<Role>,
}

/// A new token. Its secret is shown only once.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct TokenMade {
    /// Id of the token, for the list of tokens.
    pub id: String,
    /// Secret text of the token.
    pub token: String,
}

/// Public data of a token.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct TokenAbout {
    /// Id of the token.
    pub id: String,
    /// User whom the token represents.
    pub user: String,
    /// Purpose of the token.
    pub name: String,
    /// Role of the token.
    pub role: Role,
    /// Creation time: ms since 1970, UTC.
    pub made_ms: u64,
    /// Expiry: ms since 1970, UTC. Empty for a token without expiry.
    pub expires_ms: Option<u64>,
}

/// Implements `Debug` without the secret fields, to keep them out of logs.
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
