//! Everything that requests share.

use crate::Settings;
use crate::access::{Audit, Names, OuterAddress, People, PrivateError};
use crate::change_counters::ChangeCounters;
use crate::documents::Documents;
use crate::history::History;
use crate::plans::Plans;
use crate::projects::Projects;
use crate::python::Python;
use crate::runs::{self, Runs};
use crate::socket::Sockets;
use crate::watch as files;
use rafcon_protocol::api::ServerStatus;
use std::sync::{Arc, OnceLock};
use tokio::sync::watch;

/// The server's parts, one of each.
#[derive(Debug)]
pub struct ServerState {
    /// How it is set up.
    pub(crate) settings: Settings,
    /// Who may come in.
    people: People,
    /// Who did what about that.
    audit: Audit,
    /// What it is called; nothing before it listens.
    names: OnceLock<Names>,
    /// Whether the server is about to end.
    closing: watch::Sender<bool>,
    /// What wakes whoever follows the server.
    pub(crate) news: ChangeCounters,
    /// What runs leave.
    pub(crate) history: History,
    /// The folders with machines, and the libraries.
    pub(crate) projects: Projects,
    /// The open machines.
    pub(crate) documents: Documents,
    /// What looks at scripts.
    pub(crate) python: Python,
    /// What plans.
    pub(crate) plans: Plans,
    /// All runs.
    pub(crate) runs: Runs,
    /// What the connections of clients share.
    pub(crate) sockets: Sockets,
}

/// Why one of the server's parts cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum ServerStateError {
    /// One of its files cannot be read or written.
    #[error(transparent)]
    Private(#[from] PrivateError),
    /// There is no place for runs.
    #[error(transparent)]
    Runs(#[from] rafcon_supervisor::MakeError),
}

impl ServerState {
    /// Prepares everything; nothing listens yet.
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

    /// Begins to look after what happens without requests. To be called once, within the runtime.
    pub(crate) fn begin(self: &Arc<Self>) {
        runs::begin(self);
        files::begin(self);
    }

    /// How everything stands that it looks after.
    pub(crate) async fn status(&self) -> ServerStatus {
        ServerStatus {
            files_revision: self.news.files_revision(),
            machines: self.documents.summaries(),
            runs: self.runs.lively().await,
        }
    }

    /// Who may come in.
    pub fn people(&self) -> &People {
        &self.people
    }

    /// Someone asks for something: who holds control of a run is not silent.
    pub(crate) fn heard(&self, user: &str) {
        self.runs.heard(user);
    }

    /// The record of who came in and who changed whose rights.
    pub fn audit(&self) -> &Audit {
        &self.audit
    }

    /// What it is called. A server that does not listen answers to nothing.
    pub(crate) fn names(&self) -> &Names {
        self.names.get_or_init(Names::nobody)
    }

    /// It listens, under these names.
    pub(crate) fn called(&self, names: Names) {
        self.names.get_or_init(|| names);
    }

    /// The name of the cookie of a login: cookies do not know ports, so that the name has to.
    pub(crate) fn cookie(&self) -> String {
        format!("rafcon_{}", self.names().port)
    }

    /// The header that stores the secret of a login in a browser, for the pages of this server at this address only.
    pub(crate) fn set_cookie(&self, secret: &str, outer: &OuterAddress) -> String {
        let is_secure = outer.is_secure.unwrap_or(self.names().is_secure);
        let secure = if is_secure { "; Secure" } else { "" };
        let path = outer.base.as_str();
        format!("{}={secret}; Path={path}/; HttpOnly; SameSite=Strict{secure}", self.cookie())
    }

    /// Becomes `true` when the server is about to end: connections that last say good-bye.
    pub(crate) fn closing(&self) -> watch::Receiver<bool> {
        self.closing.subscribe()
    }

    /// The server is about to end.
    pub(crate) fn close(&self) {
        self.closing.send_replace(true);
    }

    /// How it is set up.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}
