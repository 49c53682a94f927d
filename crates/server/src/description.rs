//! The shared parts of the `OpenAPI` description: security, refusals before the handler, WebSocket messages and examples. Knows
//! the table of rights, but not the handlers.

use crate::access;
use axum::http::Method;
use rafcon_protocol::api::{LibraryNodeKind, NodeKind, Refusal, Right};
use rafcon_protocol::document::Change;
use rafcon_protocol::edit::{Edit, Element, Goal, OutcomeOf, PortList, PortOf};
use rafcon_protocol::socket::{ToClient, ToServer};
use serde_json::{Value, json};
use utoipa::OpenApi as _;
use utoipa::openapi::path::{Operation, PathItem};
use utoipa::openapi::response::Response;
use utoipa::openapi::schema::{Components, Schema};
use utoipa::openapi::security::{
    ApiKey, ApiKeyValue, HttpAuthScheme, HttpBuilder, SecurityRequirement, SecurityScheme,
};
use utoipa::openapi::{Content, OpenApi, Ref, RefOr};

/// General information in the description, and additional schemas.
#[derive(Debug, utoipa::OpenApi)]
#[openapi(
    info(
        title = "RAFCON",
        description = "Projects, open machines, runs and people. docs/api.md says what the words mean and how to use the \
                       WebSocket, whose frames are the schemas ToServer and ToClient."
    ),
    // The last schemas belong to types that have explicit names. The generator does not find their parts by itself.
    components(schemas(
        Refusal, ToServer, ToClient, Edit, Change, NodeKind, LibraryNodeKind, Element, Goal, OutcomeOf, PortList, PortOf,
    )),
    tags(
        (name = "server", description = "The server itself"),
        (name = "people", description = "Users, roles, logins and tokens"),
        (name = "files", description = "Projects and libraries as they lie on disk"),
        (name = "machines", description = "Open machines, which several people edit at once"),
        (name = "plans", description = "Plans of engines, as machines"),
        (name = "runs", description = "Active runs: start, state, commands, control"),
        (name = "history", description = "Recorded runs: events, moments, machines, values"),
    )
)]
struct Head;

/// The description without routes.
pub(crate) fn head() -> OpenApi {
    Head::openapi()
}

/// Completes the description: adds to each route its rights, its refusals and its security.
pub(crate) fn complete(mut api: OpenApi) -> OpenApi {
    let described = std::mem::take(&mut api.paths.paths);
    for (path, mut item) in described {
        for (method, operation) in operations(&mut item) {
            complete_operation(operation, &method, &path);
        }
        api.paths.paths.insert(path.replace("{*", "{"), item);
    }
    let components = api.components.get_or_insert_default();
    add_keys(components);
    add_examples(components);
    api
}

fn operations(item: &mut PathItem) -> impl Iterator<Item = (Method, &mut Operation)> {
    let all = [
        (Method::GET, &mut item.get),
        (Method::PUT, &mut item.put),
        (Method::POST, &mut item.post),
        (Method::DELETE, &mut item.delete),
        (Method::PATCH, &mut item.patch),
    ];
    all.into_iter().filter_map(|(method, operation)| Some((method, operation.as_mut()?)))
}

fn complete_operation(operation: &mut Operation, method: &Method, path: &str) {
    let right = access::of_route(method, path).unwrap_or(Right::Administer);
    for (status, meaning) in refusals(operation, right) {
        let responses = &mut operation.responses.responses;
        responses.entry(status.to_owned()).or_insert_with(|| RefOr::T(refusal(meaning)));
    }
    if right == Right::Anyone {
        return;
    }
    let key = |name: &str| SecurityRequirement::new(name, [""; 0]);
    operation.security = Some(vec![key("token"), key("login")]);
    let needs = format!("Needs the right to {}.", format!("{right:?}").to_lowercase());
    let said = operation.description.take().filter(|text| !text.is_empty());
    operation.description = Some(said.map_or(needs.clone(), |said| format!("{said}\n\n{needs}")));
}

/// Responses sent before the handler runs, by status.
fn refusals(operation: &Operation, right: Right) -> Vec<(&'static str, &'static str)> {
    let mut refusals = vec![("421", "The server is not called by this name")];
    if right != Right::Anyone {
        refusals.push(("401", "Nobody is logged in, or the token or login is not known here"));
        refusals.push(("403", "The user's role does not grant it, or a stranger's page asks"));
    }
    let has_body = operation.request_body.is_some();
    if has_body {
        refusals.push(("413", "The body is too large"));
    }
    if has_body || operation.parameters.as_ref().is_some_and(|list| !list.is_empty()) {
        refusals.push(("400", "The request cannot be understood"));
    }
    refusals
}

fn refusal(meaning: &str) -> Response {
    let body = Content::new(Some(Ref::from_schema_name("Refusal")));
    let mut response = Response::new(meaning);
    response.content.insert("application/json".to_owned(), RefOr::T(body));
    response
}

/// Adds the ways to authenticate: a token or a login's cookie.
fn add_keys(components: &mut Components) {
    let token = HttpBuilder::new()
        .scheme(HttpAuthScheme::Bearer)
        .description(Some("The token of the start link, or one that was made for a program"))
        .build();
    let login = ApiKeyValue::with_description(
        "rafcon_4747",
        "Session cookie of a login; its name ends with the server's port",
    );
    let schemes = &mut components.security_schemes;
    schemes.insert("token".to_owned(), RefOr::T(SecurityScheme::Http(token)));
    let login = SecurityScheme::ApiKey(ApiKey::Cookie(login));
    schemes.insert("login".to_owned(), RefOr::T(login));
}

fn add_examples(components: &mut Components) {
    for (name, example) in examples() {
        if let Some(RefOr::T(schema)) = components.schemas.get_mut(name) {
            add_example(schema, example);
        }
    }
}

fn add_example(schema: &mut Schema, example: Value) {
    match schema {
        Schema::Object(object) => object.examples = vec![example],
        Schema::OneOf(choice) => choice.examples = vec![example],
        Schema::AllOf(parts) => parts.examples = vec![example],
        _other => {}
    }
}

/// Examples of the main requests, by schema.
fn examples() -> [(&'static str, Value); 10] {
    let machine = json!({"project": "examples", "path": "hierarchy_and_data"});
    [
        ("Login", json!({"user": "anna", "password": "correct horse battery"})),
        (
            "NewToken",
            json!({"name": "night shift script", "lifetime_s": 86400, "role": "operator"}),
        ),
        ("MachineAt", json!({"file": machine})),
        (
            "NewMachine",
            json!({"file": {"project": "examples", "path": "new/machine"}, "name": "Mission"}),
        ),
        (
            "EditMachine",
            json!({
                "id": "anna-17",
                "base": 4,
                "name": "Rename state",
                "edit": {"edit": "set_name", "path": "ROOT", "name": "Mission"}
            }),
        ),
        ("Undo", json!({"id": "anna-18"})),
        ("StartRun", json!({"id": "anna-19", "machine": machine, "hold": true, "inputs": {}})),
        ("Envelope", json!({"id": "anna-20", "command": {"type": "step_into"}, "decided_on": 12})),
        ("ControlMove", json!({"move": "hand_over", "to": "ben"})),
        ("Retention", json!({"count": 50})),
    ]
}

#[cfg(test)]
mod tests;
