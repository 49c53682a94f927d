//! Routes for logins, tokens and users. Knows requests and responses; rights and the roster decide what is allowed.

use super::connection_slots::Peer;
use super::limiter::network;
use super::outer_address::OuterAddress;
use super::people::OWNER;
use super::who::{Credential, Who};
use crate::extract::{Body, Path, Small};
use crate::gate::blocking;
use crate::{Failure, Reason, ServerState};
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::{self, HeaderName};
use rafcon_protocol::api::{
    ChangePassword, ChangeUser, Login, NewToken, NewUser, Refusal, Right, Role, Session,
    TokenAbout, TokenMade, User,
};
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new()
        .routes(routes!(log_in, session, log_out))
        .routes(routes!(change_password))
        .routes(routes!(tokens, make_token))
        .routes(routes!(delete_token))
        .routes(routes!(users, add_user))
        .routes(routes!(change_user, remove_user))
}

/// Logs in with a password.
///
/// The response sets a cookie, which browsers then send. For programs, tokens are better.
#[utoipa::path(post, path = "/api/v1/session", tag = "people", request_body = Login, responses(
    (status = 200, description = "Logged in", body = Session),
    (status = 400, description = "The body does not fit", body = Refusal),
    (status = 401, description = "No such user, or another password", body = Refusal),
    (status = 413, description = "The body is too large", body = Refusal),
    (status = 429, description = "Too many attempts: wait for the time in `Retry-After`", body = Refusal),
))]
async fn log_in(
    State(server): State<Arc<ServerState>>,
    outer: OuterAddress,
    Small(login): Small<Login>,
) -> Result<([(HeaderName, String); 1], Json<Session>), Failure> {
    let from = outer.peer.ip;
    let checked = server.people().check(&login.user, &login.password, from).await;
    if let Err(failure) = checked {
        if failure.reason() == Reason::Unauthorized {
            let (of, about) = (network(from).to_string(), format!("from {from}"));
            server.audit().note_often(&of, &login.user, "wrong_login", &about);
        }
        return Err(failure);
    }
    let (secret, who) = server.people().begin(&login.user)?;
    server.audit().note_often(&who.user, &who.user, "login", &format!("from {from}"));
    Ok(([(header::SET_COOKIE, server.set_cookie(secret.text(), &outer))], Json(about(who))))
}

/// Returns the user of this request, with role and rights.
#[utoipa::path(get, path = "/api/v1/session", tag = "people", responses(
    (status = 200, description = "You", body = Session),
))]
async fn session(who: Who) -> Json<Session> {
    Json(about(who))
}

/// Ends the login of this request.
#[utoipa::path(delete, path = "/api/v1/session", tag = "people", responses(
    (status = 204, description = "Logged out"),
    (status = 409, description = "The request uses a token instead of a login", body = Refusal),
))]
async fn log_out(State(server): State<Arc<ServerState>>, who: Who) -> Result<StatusCode, Failure> {
    server.people().end(&who)?;
    server.audit().note_often(&who.user, &who.user, "logout", "");
    Ok(StatusCode::NO_CONTENT)
}

/// Changes the user's own password.
///
/// The user's other logins end. Tokens stay valid.
#[utoipa::path(put, path = "/api/v1/session/password", tag = "people", request_body = ChangePassword, responses(
    (status = 204, description = "Changed"),
    (status = 400, description = "The body does not fit, or the new password is too short", body = Refusal),
    (status = 401, description = "The current password is wrong", body = Refusal),
    (status = 409, description = "The request uses a token instead of a login", body = Refusal),
    (status = 413, description = "The body is too large", body = Refusal),
    (status = 429, description = "Too many attempts: wait for the time in `Retry-After`", body = Refusal),
))]
async fn change_password(
    State(server): State<Arc<ServerState>>,
    peer: Peer,
    who: Who,
    Small(change): Small<ChangePassword>,
) -> Result<StatusCode, Failure> {
    if who.user == OWNER || !matches!(who.by, Credential::Session(_)) {
        let message = "only who has logged in with a password can change it: log in first";
        return Err(Failure::conflict("not_a_login", message));
    }
    server.people().check(&who.user, &change.password, peer.ip).await?;
    let (users, user) = (Arc::clone(server.people().users()), who.user.clone());
    blocking(move || Ok(users.change(&user, None, Some(&change.new_password))?)).await?;
    server.people().renew(&who)?;
    server.audit().note(&who.user, "password", "own");
    Ok(StatusCode::NO_CONTENT)
}

/// Lists the user's own tokens, or all tokens for an admin.
#[utoipa::path(get, path = "/api/v1/tokens", tag = "people", responses(
    (status = 200, description = "Without their secrets", body = [TokenAbout]),
))]
async fn tokens(State(server): State<Arc<ServerState>>, who: Who) -> Json<Vec<TokenAbout>> {
    Json(server.people().users().roster().tokens(of(&who)))
}

/// Makes a token for a program.
///
/// Requires a login or the owner's token: a stolen token must not make others.
#[utoipa::path(post, path = "/api/v1/tokens", tag = "people", request_body = NewToken, responses(
    (status = 201, description = "The token with its secret, which is shown only once", body = TokenMade),
    (status = 400, description = "The body does not fit", body = Refusal),
    (status = 403, description = "A role beyond one's own", body = Refusal),
    (status = 409, description = "The request uses a token instead of a login, or the user has too many tokens", body = Refusal),
    (status = 413, description = "The body is too large", body = Refusal),
))]
async fn make_token(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Body(wanted): Body<NewToken>,
) -> Result<(StatusCode, Json<TokenMade>), Failure> {
    if let Credential::Token(_) | Credential::Ros = who.by {
        let message = "a token cannot make tokens: log in first";
        return Err(Failure::conflict("not_a_login", message));
    }
    let (users, user, role) = (Arc::clone(server.people().users()), who.user.clone(), who.role);
    let made = blocking(move || Ok(users.make_token(&user, role, &wanted)?)).await?;
    server.audit().note(&who.user, "token_made", &made.id);
    Ok((StatusCode::CREATED, Json(made)))
}

/// Deletes a token of the user, or for an admin any token.
#[utoipa::path(delete, path = "/api/v1/tokens/{token}", tag = "people",
    params(("token" = String, Path, description = "The token's id")),
    responses(
        (status = 204, description = "It lets nobody in any more"),
        (status = 404, description = "There is no such token of yours", body = Refusal),
    )
)]
async fn delete_token(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(id): Path<String>,
) -> Result<StatusCode, Failure> {
    let (users, asker, token) = (Arc::clone(server.people().users()), who.clone(), id.clone());
    blocking(move || Ok(users.remove_token(&token, of(&asker))?)).await?;
    server.audit().note(&who.user, "token_deleted", &id);
    Ok(StatusCode::NO_CONTENT)
}

/// Lists the users, sorted by name.
#[utoipa::path(get, path = "/api/v1/users", tag = "people", responses(
    (status = 200, description = "By name", body = [User]),
))]
async fn users(State(server): State<Arc<ServerState>>) -> Json<Vec<User>> {
    Json(server.people().users().roster().users())
}

/// Adds a user with role and password.
#[utoipa::path(post, path = "/api/v1/users", tag = "people", request_body = NewUser, responses(
    (status = 201, description = "Added", body = User),
    (status = 400, description = "The body, the name or the password does not fit", body = Refusal),
    (status = 409, description = "The name is taken", body = Refusal),
    (status = 413, description = "The body is too large", body = Refusal),
))]
async fn add_user(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Body(new): Body<NewUser>,
) -> Result<(StatusCode, Json<User>), Failure> {
    let users = Arc::clone(server.people().users());
    let user = User { name: new.name.clone(), role: new.role };
    blocking(move || Ok(users.add(&new.name, new.role, &new.password)?)).await?;
    server.audit().note(&who.user, "user_added", &format!("{}: {:?}", user.name, user.role));
    Ok((StatusCode::CREATED, Json(user)))
}

/// Changes a user's role or password.
///
/// The change takes effect at once, also for open connections. A new password ends the user's logins.
#[utoipa::path(patch, path = "/api/v1/users/{user}", tag = "people", request_body = ChangeUser,
    params(("user" = String, Path, description = "The user's name")),
    responses(
        (status = 204, description = "Changed"),
        (status = 400, description = "The body or the password does not fit", body = Refusal),
        (status = 404, description = "There is no such user", body = Refusal),
        (status = 409, description = "This is the last admin", body = Refusal),
        (status = 413, description = "The body is too large", body = Refusal),
    )
)]
async fn change_user(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(user): Path<String>,
    Body(change): Body<ChangeUser>,
) -> Result<StatusCode, Failure> {
    let about = changed(&user, &change);
    let users = Arc::clone(server.people().users());
    let change = move || Ok(users.change(&user, change.role, change.password.as_deref())?);
    blocking(change).await?;
    server.audit().note(&who.user, "user_changed", &about);
    Ok(StatusCode::NO_CONTENT)
}

/// Removes a user, and all their tokens.
#[utoipa::path(delete, path = "/api/v1/users/{user}", tag = "people",
    params(("user" = String, Path, description = "The user's name")),
    responses(
        (status = 204, description = "Removed"),
        (status = 404, description = "There is no such user", body = Refusal),
        (status = 409, description = "This is the last admin", body = Refusal),
    )
)]
async fn remove_user(
    State(server): State<Arc<ServerState>>,
    who: Who,
    Path(user): Path<String>,
) -> Result<StatusCode, Failure> {
    let (users, name) = (Arc::clone(server.people().users()), user.clone());
    blocking(move || Ok(users.remove(&name)?)).await?;
    server.audit().note(&who.user, "user_removed", &user);
    Ok(StatusCode::NO_CONTENT)
}

/// The session of a user, as it is sent to clients.
pub(crate) fn about(who: Who) -> Session {
    let rights = [Right::Observe, Right::Command, Right::Start, Right::Edit, Right::Administer];
    let Who { user, role, expires_ms, by: _ } = who;
    let rights = rights.into_iter().filter(|right| role.grants(*right)).collect();
    Session { user, role, rights, version: env!("CARGO_PKG_VERSION").to_owned(), expires_ms }
}

/// Owner of the tokens that the user may see and delete. `None` for an admin: all tokens.
fn of(who: &Who) -> Option<&str> {
    (who.role != Role::Admin).then_some(&who.user)
}

fn changed(user: &str, change: &ChangeUser) -> String {
    let role = change.role.map(|role| format!(", role {role:?}")).unwrap_or_default();
    let password = if change.password.is_some() { ", password" } else { "" };
    format!("{user}{role}{password}")
}
