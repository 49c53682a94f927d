//! State shared by all requests.

use crate::access::{Audit, Names, OuterAddress, People, PrivateError};
use crate::change_counters::ChangeCounters;
use crate::documents::Documents;
use crate::history::History;
use crate::plans::Plans;
use crate::projects::Projects;
use crate::python::Python;
use crate::runs::{self, Runs};
use crate::settings::Robots;
use crate::socket::Sockets;
use crate::watch as files;
use crate::{Failure, Settings};
use rafcon_protocol::api::ServerStatus;
use std::sync::{Arc, OnceLock};
use tokio::sync::watch;

/// All parts of the server.
#[derive(Debug)]
pub struct ServerState {
    pub(crate) settings: Settings,
    /// Users, tokens and logins.
    people: People,
    /// Record of logins and of changes of rights.
    audit: Audit,
    /// Host names of the server. Empty until it listens.
    names: OnceLock<Names>,
    /// `true` once the server shuts down.
    closing: watch::Sender<bool>,
    /// Counters that wake listeners of changes.
    pub(crate) news: ChangeCounters,
    /// Access to recorded runs.
    pub(crate) history: History,
    /// Folders with machines, and the libraries.
    pub(crate) projects: Projects,
    /// Open machines and their sessions.
    pub(crate) documents: Documents,
    /// Analysis of scripts by the interpreter.
    pub(crate) python: Python,
    /// Limits on engines that plan.
    pub(crate) plans: Plans,
    /// All runs of the server.
    pub(crate) runs: Runs,
    /// State shared by the clients' connections.
    pub(crate) sockets: Sockets,
}

/// Reason why a part of the server cannot start.
#[derive(Debug, thiserror::Error)]
pub enum ServerStateError {
    /// One of its files cannot be read or written.
    #[error(transparent)]
    Private(#[from] PrivateError),
    /// The folder of runs cannot be made.
    #[error(transparent)]
    Runs(#[from] rafcon_supervisor::MakeError),
}

impl ServerState {
    /// Opens all parts. Nothing listens yet.
    pub fn new(settings: Settings) -> Result<Arc<Self>, ServerStateError> {
        let news = ChangeCounters::default();
        Ok(Arc::new(Self {
            people: People::open(&settings)?,
            audit: Audit::open(&settings.state)?,
            names: OnceLock::new(),
            closing: watch::Sender::new(false),
            runs: Runs::new(&settings, &news)?,
            sockets: Sockets::default(),
            news,
            history: History::default(),
            python: Python::default(),
            plans: Plans::default(),
            projects: Projects::new(&settings),
            documents: Documents::new(&settings),
            settings,
        }))
    }

    /// What asks the robots of this station. At any other server, `robot` is unknown.
    pub(crate) fn robots(&self, robot: &str) -> Result<Arc<dyn Robots>, Failure> {
        self.settings.robots.clone().ok_or_else(|| {
            let message = format!("robot {robot}: this server is no station");
            Failure::not_found("no_such_robot", message)
        })
    }

    /// Starts the background tasks. Call once, within the runtime.
    pub(crate) fn begin(self: &Arc<Self>) {
        runs::begin(self);
        files::begin(self);
    }

    /// State of the files, of open machines, and of runs that are active or changed since the start.
    pub(crate) async fn status(&self) -> ServerStatus {
        ServerStatus {
            files_revision: self.news.files_revision(),
            machines: self.documents.summaries(),
            runs: self.runs.lively().await,
        }
    }

    /// Users, tokens and logins.
    pub fn people(&self) -> &People {
        &self.people
    }

    /// A request of a user arrived, so the user is not silent as the holder of control.
    pub(crate) fn heard(&self, user: &str) {
        self.runs.heard(user);
    }

    /// The record of logins and of changes of rights.
    pub fn audit(&self) -> &Audit {
        &self.audit
    }

    /// Host names of the server. Before it listens, it has none and refuses every host.
    pub(crate) fn names(&self) -> &Names {
        self.names.get_or_init(Names::nobody)
    }

    /// Sets the host names once the server listens.
    pub(crate) fn called(&self, names: Names) {
        self.names.get_or_init(|| names);
    }

    /// The name of the login cookie. It includes the port, because browsers share cookies between ports.
    pub(crate) fn cookie(&self) -> String {
        format!("rafcon_{}", self.names().port)
    }

    /// Value of the header that stores a login's secret in a browser, for the pages of this server at this address only.
    pub(crate) fn set_cookie(&self, secret: &str, outer: &OuterAddress) -> String {
        let is_secure = outer.is_secure.unwrap_or(self.names().is_secure);
        let secure = if is_secure { "; Secure" } else { "" };
        let path = outer.base.as_str();
        format!("{}={secret}; Path={path}/; HttpOnly; SameSite=Strict{secure}", self.cookie())
    }

    /// Becomes `true` when the server shuts down, so that long connections can close.
    pub(crate) fn closing(&self) -> watch::Receiver<bool> {
        self.closing.subscribe()
    }

    /// Signals the shutdown to all connections.
    pub(crate) fn close(&self) {
        self.closing.send_replace(true);
    }

    /// The settings of the server.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}
