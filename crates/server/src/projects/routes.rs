//! Routes for projects and libraries. Knows requests and responses. The work runs on other threads than those of the connections.

use super::library::Content;
use super::tree::{self, BOUNDS};
use crate::extract::{Path, Query};
use crate::{Failure, ServerState};
use axum::Json;
use axum::extract::State;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, ETAG, IF_NONE_MATCH};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse as _, Response};
use rafcon_protocol::api::{
    FileNode, LibraryRoot, LibraryUsages, MachineFile, Project, Refusal, TreeFrom, UsagesOf,
};
use rafcon_protocol::document::Document;
use std::path::Path as FilePath;
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub(crate) fn routes() -> OpenApiRouter<Arc<ServerState>> {
    OpenApiRouter::new()
        .routes(routes!(projects))
        .routes(routes!(project_tree))
        .routes(routes!(libraries))
        .routes(routes!(library))
        .routes(routes!(library_usages))
}

/// The projects of the server.
#[utoipa::path(get, path = "/api/v1/projects", tag = "files", responses(
    (status = 200, description = "In the order in which the server was given them", body = [Project])
))]
async fn projects(State(server): State<Arc<ServerState>>) -> Json<Vec<Project>> {
    Json(server.projects.all().to_vec())
}

/// Folders and machines of a project.
///
/// A large tree is cut. Request a node that is marked as cut by its path.
#[utoipa::path(get, path = "/api/v1/projects/{project}/tree", tag = "files",
    params(("project" = String, Path, description = "The project's id"), TreeFrom),
    responses(
        (status = 200, description = "The folder that was asked for, with what is in it", body = FileNode),
        (status = 400, description = "The path is none", body = Refusal),
        (status = 403, description = "The path leads out of the project", body = Refusal),
        (status = 404, description = "There is no such project or folder", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn project_tree(
    State(server): State<Arc<ServerState>>,
    Path(project): Path<String>,
    Query(from): Query<TreeFrom>,
) -> Result<Json<FileNode>, Failure> {
    let file = MachineFile { project, path: from.path };
    let at = Arc::clone(&server);
    let look = move || {
        let folder = server.projects.resolve(&file)?;
        if !folder.is_dir() {
            let message =
                format!("there is no folder `{}` in the project {}", file.path, file.project);
            return Err(Failure::not_found("no_such_folder", message));
        }
        let hidden: [&FilePath; 2] = [&server.settings.runs, &server.settings.state];
        let path = server.projects.canonical(&file, &folder).path;
        Ok(Json(tree::tree(&folder, &path, &hidden, BOUNDS)))
    };
    at.projects.looks().work(look).await
}

/// The library roots with the libraries below them.
#[utoipa::path(get, path = "/api/v1/libraries", tag = "files", responses(
    (status = 200, description = "In the order in which they count", body = [LibraryRoot]),
    (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
))]
async fn libraries(
    State(server): State<Arc<ServerState>>,
) -> Result<Json<Vec<LibraryRoot>>, Failure> {
    let at = Arc::clone(&server);
    at.projects.looks().work(move || Ok(Json(server.projects.shelf().roots()))).await
}

/// Finds the usages of a library: in open machines, and in the files of all projects and library roots.
#[utoipa::path(get, path = "/api/v1/libraries/usages", tag = "files", params(UsagesOf), responses(
    (status = 200, description = "The states that run it", body = LibraryUsages),
    (status = 400, description = "The query does not fit", body = Refusal),
    (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
))]
async fn library_usages(
    State(server): State<Arc<ServerState>>,
    Query(of): Query<UsagesOf>,
) -> Result<Json<LibraryUsages>, Failure> {
    let at = Arc::clone(&server);
    at.projects.searches().work(move || Ok(Json(server.documents.usages(&server, &of)))).await
}

/// The machine of a library, as it is on disk.
#[utoipa::path(get, path = "/api/v1/libraries/{root}/{*path}", tag = "files",
    params(
        ("root" = String, Path, description = "The name of a library root"),
        ("path" = String, Path, description = "From the root's folder on, joined by `/`"),
    ),
    responses(
        (status = 200, description = "The machine; `ETag` is another one when it has changed", body = Document),
        (status = 304, description = "It is still the one that `If-None-Match` names"),
        (status = 400, description = "The path is none", body = Refusal),
        (status = 403, description = "The path, or a link in the library, leads out", body = Refusal),
        (status = 404, description = "There is no such library", body = Refusal),
        (status = 422, description = "The folder holds no machine that can be read", body = Refusal),
        (status = 429, description = "Too many ask for the like at the moment", body = Refusal),
    )
)]
async fn library(
    State(server): State<Arc<ServerState>>,
    Path((root, path)): Path<(String, String)>,
    headers: HeaderMap,
) -> Result<Response, Failure> {
    let at = Arc::clone(&server);
    let read = move || server.projects.shelf().document(&root, &path);
    let Content { document, tag } = at.projects.looks().work(read).await?;
    if headers.get(IF_NONE_MATCH).is_some_and(|known| names(known, &tag)) {
        return Ok((StatusCode::NOT_MODIFIED, [(ETAG, tag)]).into_response());
    }
    let head = [(CONTENT_TYPE, "application/json"), (CACHE_CONTROL, "no-cache"), (ETAG, &tag)];
    Ok((head, document).into_response())
}

/// True if the header contains this tag. A proxy that recompresses a response marks its tag as weak.
fn names(known: &HeaderValue, tag: &str) -> bool {
    let mut tags = known.to_str().unwrap_or_default().split(',').map(str::trim);
    tags.any(|known| known.strip_prefix("W/").unwrap_or(known) == tag)
}
