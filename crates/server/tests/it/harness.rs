//! A real server in the test's process, on its own port, with temporary folders. Only this module knows its start and shutdown.

use rafcon_protocol::api::{NewToken, Role};
use rafcon_server::access::Users;
use rafcon_server::settings::HashCost;
use rafcon_server::{Server, Settings};
use serde_json::Value;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use tempfile::TempDir;
use tokio::sync::oneshot;

/// Cost of hashing a password in tests: almost none.
const CHEAP: HashCost = HashCost { memory_kib: 8, passes: 1 };

/// A server, until dropped. Its users are called `viewer`, `operator`, `engineer` and `admin`.
pub(crate) struct TestServer {
    place: TempDir,
    address: SocketAddr,
    url: String,
    owner: String,
    ros: String,
    tokens: [String; 4],
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// Response of a server.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) headers: Vec<(String, String)>,
    pub(crate) text: String,
}

impl TestServer {
    /// A server with one empty project, `project`.
    pub(crate) fn new() -> Self {
        Self::with(|_settings| {})
    }

    /// A server with changed settings.
    pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> Self {
        Self::at(tempfile::tempdir().unwrap(), change)
    }

    /// A server in the folders of an earlier one.
    pub(crate) fn at(place: TempDir, change: impl FnOnce(&mut Settings)) -> Self {
        let settings = settings(place.path(), change);
        let users = Users::open(&settings.state, CHEAP).unwrap();
        let tokens = Role::ALL.map(|role| token(&users, role));
        let (begun, server) = std::sync::mpsc::sync_channel(1);
        let (stop, stopped) = oneshot::channel::<()>();
        let builder = std::thread::Builder::new().name("server".to_owned());
        let run = move || {
            let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
            runtime.block_on(async move {
                let server = Server::bind(settings).await.unwrap();
                let (url, ros) = (server.url().to_owned(), server.ros_token().to_owned());
                begun.send((server.address(), url, server.link(), ros)).unwrap();
                server.run(async { stopped.await.unwrap_or_default() }).await.unwrap();
            });
        };
        let thread = Some(builder.spawn(run).unwrap());
        let (address, url, link, ros) = server.recv().unwrap();
        let owner = link.split_once("token=").unwrap().1.to_owned();
        Self { place, address, url, owner, ros, tokens, stop: Some(stop), thread }
    }

    /// The folder of the project `project`.
    pub(crate) fn project(&self) -> PathBuf {
        self.place.path().join("project")
    }

    /// The folder of runs.
    pub(crate) fn runs(&self) -> PathBuf {
        self.place.path().join("runs")
    }

    /// The server's own folder.
    pub(crate) fn state(&self) -> PathBuf {
        self.place.path().join("state")
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Scheme, name and port of the server.
    pub(crate) fn url(&self) -> &str {
        &self.url
    }

    /// The token of the user with this role.
    pub(crate) fn token(&self, role: Role) -> &str {
        &self.tokens[role as usize]
    }

    /// The token of the start link.
    pub(crate) fn owner(&self) -> &str {
        &self.owner
    }

    /// The token of the bridge to ROS.
    pub(crate) fn ros(&self) -> &str {
        &self.ros
    }

    /// Sends a request as the user with this role, or without a user.
    pub(crate) fn call(
        &self,
        role: Option<Role>,
        method: &str,
        path: &str,
        body: Option<&Value>,
    ) -> Answer {
        let token = role.map(|role| self.token(role));
        self.ask(token, method, path, body)
    }

    /// Sends a request with this token.
    pub(crate) fn ask(
        &self,
        token: Option<&str>,
        method: &str,
        path: &str,
        body: Option<&Value>,
    ) -> Answer {
        let bearer = token.map(|token| format!("Bearer {token}"));
        let head = bearer.as_ref().map(|bearer| ("Authorization", bearer.as_str()));
        self.send(method, path, head.as_slice(), body)
    }

    /// Sends a request with these header lines.
    pub(crate) fn send(
        &self,
        method: &str,
        path: &str,
        head: &[(&str, &str)],
        body: Option<&Value>,
    ) -> Answer {
        let uri = format!("{}{path}", self.url);
        let mut request = ureq::http::Request::builder().method(method).uri(uri);
        for (name, value) in head {
            request = request.header(*name, *value);
        }
        if body.is_some() {
            request = request.header("Content-Type", "application/json");
        }
        let text = body.map(Value::to_string).unwrap_or_default();
        Answer::of(agent().run(request.body(text).unwrap()).unwrap())
    }

    /// Stops the server and returns its folders.
    pub(crate) fn end(mut self) -> TempDir {
        self.stop();
        std::mem::replace(&mut self.place, tempfile::tempdir().unwrap())
    }

    fn stop(&mut self) {
        if let Some(stop) = self.stop.take() {
            stop.send(()).unwrap_or_default();
        }
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}

impl Drop for TestServer {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Answer {
    fn of(response: ureq::http::Response<ureq::Body>) -> Self {
        let (head, body) = response.into_parts();
        let header = |(name, value): (&ureq::http::HeaderName, &ureq::http::HeaderValue)| {
            (name.as_str().to_owned(), value.to_str().unwrap().to_owned())
        };
        let headers = head.headers.iter().map(header).collect();
        let text = body.into_with_config().limit(u64::MAX).read_to_string().unwrap();
        Self { status: head.status.as_u16(), headers, text }
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap_or_else(|_| panic!("no JSON: {self:?}"))
    }

    /// The header of this name, in lower case.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|header| header.0 == name).map(|header| header.1.as_str())
    }

    /// The status, and the code of a refusal.
    pub(crate) fn said(&self) -> String {
        let refusal = serde_json::from_str::<Value>(&self.text).ok();
        let code = refusal.as_ref().and_then(|refusal| refusal["code"].as_str()).unwrap_or("");
        format!("{} {code}", self.status).trim_end().to_owned()
    }
}

/// The name of the user with this role.
pub(crate) fn name(role: Role) -> &'static str {
    match role {
        Role::Viewer => "viewer",
        Role::Operator => "operator",
        Role::Engineer => "engineer",
        Role::Admin => "admin",
    }
}

/// The password of every user.
pub(crate) const PASSWORD: &str = "correct horse";

/// A token of the user with this role. Adds the user if needed.
fn token(users: &Users, role: Role) -> String {
    let name = name(role);
    if !users.roster().users().iter().any(|user| user.name == name) {
        users.add(name, role, PASSWORD).unwrap();
    }
    let wanted = NewToken { name: "tests".to_owned(), lifetime_s: None, role: None };
    users.make_token(name, role, &wanted).unwrap().token
}

fn settings(place: &Path, change: impl FnOnce(&mut Settings)) -> Settings {
    let project = place.join("project");
    std::fs::create_dir_all(&project).unwrap();
    let mut settings = Settings::new(place.join("state"), place.join("runs"));
    settings.projects = vec![project];
    settings.access.cost = CHEAP;
    settings.config = Some(config(place));
    settings.environment.home = Some(place.to_owned());
    settings.listen.address = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    change(&mut settings);
    settings
}

/// A configuration without libraries, so that the user's own one is ignored.
fn config(place: &Path) -> PathBuf {
    let file = place.join("config.yaml");
    std::fs::write(&file, "TYPE: SM_CONFIG\nLIBRARY_PATHS: {}\n").unwrap();
    file
}

/// A client that returns every response unchanged.
fn agent() -> ureq::Agent {
    let config = ureq::Agent::config_builder().http_status_as_error(false).max_redirects(0);
    config.build().into()
}
